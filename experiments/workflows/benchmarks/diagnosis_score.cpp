#include "experiments/workflows/benchmarks/diagnosis_score.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "experiments/quantile.hpp"

namespace loam::experiments {
namespace {

bool contains(const std::vector<std::string>& names, const std::string& name) {
    return std::ranges::find(names, name) != names.end();
}

std::string hidden_in(const TwinTruth& truth) {
    if (truth.effects.empty()) return "none";
    if (truth.withheld) return "withheld";
    return truth.effects.size() > 1 ? "two effects" : truth.effects.front();
}

std::string said_of(const TwinTruth& truth, const TwinVerdict& v) {
    if (v.verdict == "named") {
        // Under the name that is right, if one of several is.
        for (const std::string& name : v.effects)
            if (!truth.withheld && contains(truth.effects, name)) return name;
        return v.effects.front();
    }
    if (v.verdict != "ambiguous") return v.verdict;
    const bool with =
        std::ranges::any_of(v.effects, [&](const std::string& e) { return contains(truth.effects, e); });
    return with ? "ambiguous, with it" : "ambiguous, without it";
}

std::string share(int part, int all) {
    return fmt::format("{} of {}{}", part, all,
                       all > 0 ? fmt::format(" ({:.0f} %)", 100.0 * part / all) : "");
}

}  // namespace

bool is_right(const TwinTruth& truth, const TwinVerdict& v) {
    if (v.verdict != "named" || truth.withheld || truth.effects.empty()) return false;
    if (truth.effects.size() == 1) return contains(v.effects, truth.effects.front());
    return std::ranges::all_of(v.effects, [&](const std::string& e) { return contains(truth.effects, e); });
}

DiagnosisScore score(const std::vector<TwinTruth>& truths, const std::vector<TwinVerdict>& verdicts) {
    DiagnosisScore out;
    for (std::size_t k = 0; k < verdicts.size(); ++k) {
        const TwinTruth& truth = truths[k];
        const TwinVerdict& v = verdicts[k];
        const bool named = v.verdict == "named", right = is_right(truth, v);
        ++out.twins;
        ++out.confusion[hidden_in(truth)][said_of(truth, v)];
        out.wrong_names += named && !right ? 1 : 0;
        if (truth.effects.empty()) {
            ++out.plain;
            out.false_alarms += v.verdict != "none" ? 1 : 0;
        } else if (truth.withheld) {
            ++out.withheld;
            out.withheld_not_named += named ? 0 : 1;
        } else if (truth.effects.size() > 1) {
            ++out.pairs;
            out.pairs_rightly += right && v.effects.size() > 1 ? 1 : 0;
        } else {
            auto& [rightly, all] = out.named_rightly[truth.wanted];
            ++all;
            rightly += right ? 1 : 0;
            if (right && truth.wanted >= strong) out.shrinks.push_back(v.shrink);
        }
    }
    return out;
}

nlohmann::json to_json(const DiagnosisScore& s) {
    nlohmann::json out{{"twins", s.twins},
                       {"confusion", s.confusion},
                       {"wrong_names", s.wrong_names},
                       {"without_effect", s.plain},
                       {"false_alarms", s.false_alarms},
                       {"withheld", s.withheld},
                       {"withheld_not_named", s.withheld_not_named},
                       {"two_effects", s.pairs},
                       {"two_effects_named", s.pairs_rightly}};
    for (const auto& [wanted, counts] : s.named_rightly)
        out["named_rightly"].push_back(
            {{"noises", wanted}, {"rightly", counts.first}, {"twins", counts.second}});
    out["median_shrink"] =
        s.shrinks.empty() ? nlohmann::json(nullptr) : nlohmann::json(quantile(s.shrinks, 0.5));
    return out;
}

std::string to_text(const DiagnosisScore& s) {
    std::string text = fmt::format("{:<22} said of it (twins)\n", "hidden");
    for (const auto& [hidden, said] : s.confusion) {
        text += fmt::format("{:<22}", hidden);
        for (const auto& [what, count] : said) text += fmt::format(" {}: {};", what, count);
        text += "\n";
    }
    text += "\n";
    for (const auto& [wanted, counts] : s.named_rightly)
        text += fmt::format("fingerprint of {:>2.0f} noises: named rightly {}\n", wanted,
                            share(counts.first, counts.second));
    text += fmt::format("wrong names: {}\n", share(s.wrong_names, s.twins));
    text += fmt::format("no effect: false alarms {}\n", share(s.false_alarms, s.plain));
    text += fmt::format("effect withheld from the diagnosis: not named {}\n",
                        share(s.withheld_not_named, s.withheld));
    text += fmt::format("two effects: both named {}\n", share(s.pairs_rightly, s.pairs));
    if (!s.shrinks.empty())
        text += fmt::format("strong and named rightly: the held-out gap shrinks by {:.2f} (median)\n",
                            quantile(s.shrinks, 0.5));
    return text;
}

}  // namespace loam::experiments
