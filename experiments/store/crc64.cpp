#include "experiments/store/crc64.hpp"

#include <array>

namespace loam::experiments {
namespace {

constexpr std::uint64_t reflected_polynomial = 0xc96c5795d7870f42u;

constexpr std::array<std::uint64_t, 256> table = [] {
    std::array<std::uint64_t, 256> entries{};
    for (std::uint64_t byte = 0; byte < entries.size(); ++byte) {
        std::uint64_t crc = byte;
        for (int bit = 0; bit < 8; ++bit)
            crc = (crc & 1u) != 0 ? (crc >> 1) ^ reflected_polynomial : crc >> 1;
        entries[byte] = crc;
    }
    return entries;
}();

}  // namespace

std::uint64_t crc64(std::string_view bytes, std::uint64_t seed) {
    std::uint64_t crc = ~seed;
    for (const char c : bytes) crc = table[(crc ^ static_cast<unsigned char>(c)) & 0xffu] ^ (crc >> 8);
    return ~crc;
}

}  // namespace loam::experiments
