// A checksum that tells a whole record from a torn or damaged one.
#pragma once

#include <cstdint>
#include <string_view>

namespace loam::experiments {

/// CRC-64/XZ (polynomial of ECMA-182, reflected): detects every burst of up to 64 bits. `seed` is the result
/// for what came before, so that crc64(b, crc64(a)) == crc64(a + b).
std::uint64_t crc64(std::string_view bytes, std::uint64_t seed = 0);

}  // namespace loam::experiments
