// Plain binary encoding of numbers, texts and vectors, little-endian, for the journal and for fingerprints.
#pragma once

#include <Eigen/Core>
#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>

namespace loam::experiments {

static_assert(std::endian::native == std::endian::little,
              "the journal is written as the processor keeps numbers");

class ByteWriter {
  public:
    template <typename Number>
    requires std::is_arithmetic_v<Number>
    void number(Number value) { bytes_.append(reinterpret_cast<const char*>(&value), sizeof value); }
    void text(std::string_view value) {
        number(static_cast<std::uint64_t>(value.size()));
        bytes_.append(value);
    }
    void vector(const Eigen::VectorXd& values) {
        number(static_cast<std::uint64_t>(values.size()));
        for (const double value : values) number(value);
    }
    const std::string& bytes() const { return bytes_; }

  private:
    std::string bytes_;
};

/// Reads in the order of writing. Reading past the end makes it bad, once and for all, and gives zeros.
class ByteReader {
  public:
    explicit ByteReader(std::string_view bytes) : rest_(bytes) {}

    template <typename Number>
    requires std::is_arithmetic_v<Number> Number number() {
        Number value{};
        const std::string_view raw = take(sizeof value);
        if (raw.size() == sizeof value) std::memcpy(&value, raw.data(), sizeof value);
        return value;
    }
    std::string text() { return std::string(take(number<std::uint64_t>())); }
    Eigen::VectorXd vector() {
        const auto size = number<std::uint64_t>();
        if (size > rest_.size() / sizeof(double)) bad_ = true;
        Eigen::VectorXd values(bad_ ? 0 : static_cast<Eigen::Index>(size));
        for (double& value : values) value = number<double>();
        return values;
    }
    /// Everything was there and nothing is left over.
    bool complete() const { return !bad_ && rest_.empty(); }

  private:
    std::string_view take(std::uint64_t size) {
        if (bad_ || size > rest_.size()) {
            bad_ = true;
            return {};
        }
        const std::string_view taken = rest_.substr(0, size);
        rest_.remove_prefix(size);
        return taken;
    }
    std::string_view rest_;
    bool bad_ = false;
};

}  // namespace loam::experiments
