// What an ensemble is of: its parameters, the numbers that a run gives, and everything else that must be the
// same for two runs to belong together. It is kept in ensemble.h5, whose runs are used again only by a
// campaign with the same header.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace loam::experiments {

/// Of ensemble.h5 and ensemble.journal. Rises when an older program could misread a newer file.
inline constexpr std::uint32_t store_format_version = 1;

struct ParameterColumn {
    std::string name;  // DESIGN's vocabulary: "young_modulus"
    std::string unit;  // "Pa"; empty for a ratio
    double lower = 0;  // the prior's truncation bounds
    double upper = 0;
    bool operator==(const ParameterColumn&) const = default;
};

/// One number of a run's output: the value of `channel` where `x_channel` is `x`.
struct OutputColumn {
    std::string file;  // the test it belongs to: "oedometer_1.csv"
    std::string channel;
    std::string unit;
    std::string x_channel;
    std::string x_unit;
    double x = 0;
    bool operator==(const OutputColumn&) const = default;
};

struct DiagnosticColumn {
    std::string name;  // "inertial_number_max"
    std::string unit;
    bool operator==(const DiagnosticColumn&) const = default;
};

struct EnsembleHeader {
    std::uint64_t campaign_seed = 0;
    std::vector<ParameterColumn> parameters;    // [d]
    std::vector<OutputColumn> outputs;          // [m]
    std::vector<DiagnosticColumn> diagnostics;  // [k]
    // Whatever else decides the results: program version, law, rotation, effects, loading, grading, ... A
    // text each, of at most 32,000 bytes.
    std::map<std::string, std::string> attributes;
    bool operator==(const EnsembleHeader&) const = default;
};

/// Throws std::invalid_argument: no parameter or output, an empty or repeated name, a bound that is NaN, a
/// byte 0 in a text, an attribute that is too long or named like one of the store's own.
void validate(const EnsembleHeader& header);

/// The differences in words, in the order seed, parameters, outputs, diagnostics, attributes, e.g. "the
/// campaign seed is 1 there and 2 here". Empty if the headers are equal.
std::vector<std::string> differences(const EnsembleHeader& there, const EnsembleHeader& here);

/// A number that tells headers apart: CRC-64 of all of the header and of the format's version.
std::uint64_t fingerprint(const EnsembleHeader& header);

}  // namespace loam::experiments
