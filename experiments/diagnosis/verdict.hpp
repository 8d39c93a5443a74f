// The verdict from the numbers: which effect may be named, and when none may.
#pragma once

#include <string>
#include <vector>

namespace loam::experiments {

/// A leading effect, after an ensemble, a fit and direct runs of its own.
struct Finalist {
    std::string effect;
    int group = 0;             // effects of one group cannot be told apart by these tests
    bool is_mundane = false;   // an error of apparatus or specimen
    double log_evidence = 0;   // above the base model's (nats)
    double held_out_gain = 0;  // log score of the held-out curves above the base model's (nats)
    bool gap_shrinks = true;  // the held-out curves' distance from the model, in units of noise, is less than
                              // the base's: a log score can rise by a wider prediction alone
    double gap = 0;           // of the held-out curves beyond noise, with the effect
    double fit_p = 0;         // of the test by which the base failed, on the model with the effect
    bool is_physical = true;  // no parameter ran into a bound that the base did not
    bool is_present = true;   // the strength's interval leaves 0 out, or the effect has no strength
};

enum class VerdictKind { none, named, ambiguous, outside_library };

struct Verdict {
    VerdictKind kind = VerdictKind::none;
    std::vector<std::string>
        effects;         // best first: the one named and those of its group that do as well; the rivals
    std::string reason;  // a sentence
};

/// "none", "named", "ambiguous", "outside_library".
std::string_view to_string(VerdictKind kind);

/// `alarm`: whether the base model's gap is real. `can_hold_out`: whether there are curves to leave out at
/// all; without them nothing is named.
Verdict decide(bool alarm, bool can_hold_out, const std::vector<Finalist>& finalists);

/// Whether an effect needs no ensemble of its own, because one of the finalists so far fits and predicts, and
/// `explained` (nats), what the effect's fingerprint explains, is far below that.
bool is_hopeless(double explained, const std::vector<Finalist>& so_far);

/// Probabilities of the finalists, and last of "none of them", from their evidences with equal prior odds; a
/// model that fails the test has the odds of its p value against it.
std::vector<double> probabilities(const std::vector<Finalist>& finalists);

}  // namespace loam::experiments
