// What a diagnosis came to, from its search or its two searches: for result.json, the report and the short
// text.
#pragma once

#include <nlohmann/json.hpp>

#include "experiments/diagnosis/search.hpp"

namespace loam::experiments {

/// A whole diagnosis. `second`: a search on top of the first one's best leader, where there was one.
struct Diagnosis {
    const StudiedModel* base = nullptr;
    Search first;
    std::unique_ptr<Search> second;
    std::string on_top_of;  // the effect that the second search took as given
};

struct Outcome {
    VerdictKind kind = VerdictKind::none;
    std::vector<std::string> effects;     // as result.json has them
    std::string sentence;                 // the verdict in words
    const StudiedModel* model = nullptr;  // the last word: base, or the model with what was named
    std::vector<HeldOutScore> held_out;   // of that model
    std::optional<std::string> next_test;
};

Outcome outcome_of(const Diagnosis& diagnosis, const lab_data::Sample& sample);

/// The members of result.json that are the verb's own.
nlohmann::json diagnosis_result(const Diagnosis& diagnosis, const Outcome& outcome, std::uint64_t seed);

/// What the report shows beyond that: fingerprints, detectable strengths, held-out tests before and after.
nlohmann::json diagnosis_document(const Diagnosis& diagnosis, const Outcome& outcome);

}  // namespace loam::experiments
