// How often diagnoses of blind twins are right: the confusion matrix and the figures of loam bench diagnose.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "experiments/workflows/benchmarks/diagnosis_twins.hpp"

namespace loam::experiments {

/// What a diagnosis said of a twin: members of its result.json.
struct TwinVerdict {
    std::string verdict;  // as result.json has it, or "failed"
    std::vector<std::string> effects;
    double shrink = 0;  // of the held-out gap; of named effects alone
};

/// Names count as right if what is hidden is among them: effects that the tests cannot tell apart are named
/// together. Of two hidden effects, all that is named must be hidden.
bool is_right(const TwinTruth& truth, const TwinVerdict& verdict);

struct DiagnosisScore {
    /// Twins by what is hidden (an effect, "none", "withheld", "two effects"), then by what is said (the
    /// effect named, "none", "ambiguous, with it", "ambiguous, without it", "outside_library", "failed").
    std::map<std::string, std::map<std::string, int>> confusion;
    std::map<double, std::pair<int, int>> named_rightly;  // of twins with one effect, by its wanted length
    int twins = 0, wrong_names = 0;
    int plain = 0, false_alarms = 0;
    int withheld = 0, withheld_not_named = 0;
    int pairs = 0, pairs_rightly = 0;  // both named
    std::vector<double> shrinks;       // where a strong effect is named rightly
};
DiagnosisScore score(const std::vector<TwinTruth>& truths, const std::vector<TwinVerdict>& verdicts);

nlohmann::json to_json(const DiagnosisScore& score);
std::string to_text(const DiagnosisScore& score);

}  // namespace loam::experiments
