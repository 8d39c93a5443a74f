// The search for a missing effect on top of a studied model: where it fails, what each effect would change,
// which of them the tests cannot tell apart, what the leaders make of the data, and the verdict.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "experiments/diagnosis/fingerprints.hpp"
#include "experiments/diagnosis/locate.hpp"
#include "experiments/diagnosis/model_study.hpp"
#include "experiments/diagnosis/verdict.hpp"
#include "experiments/effects/model_effects.hpp"

namespace loam::experiments {

/// An effect of the library against these tests, before any ensemble of its own.
struct Probe {
    const ModelEffect* effect = nullptr;
    Fingerprint print;
    double usual_strength = 1;       // of its prior: root of the mean square, SI; 1 where it is there or not
    double detectable_strength = 0;  // SI; infinity where these tests cannot show it; NaN where a fingerprint
                                     // cannot tell, as rotation is freed with the effect
    Explained explained;
    std::size_t runs = 0, failed = 0;
};

/// A leading effect.
struct Leader {
    const ModelEffect* effect;
    std::unique_ptr<StudiedModel> model;
    std::vector<Region> regions;
    Location location;                   // the test by which the base failed, on this model
    std::vector<HeldOutScore> held_out;  // each test predicted from the others
    Finalist finalist;
};

struct Search {
    std::vector<Region> regions;
    Location location;
    std::vector<HeldOutScore> held_out;
    std::vector<Probe> probes;  // effects that show in these tests
    FingerprintTable table;     // of the probes
    std::vector<Leader> leaders;
    Verdict verdict;
    std::vector<double> probabilities;  // of the leaders; last: none of them
    std::vector<std::string> warnings;

    /// The leader of that name, or nullptr.
    const Leader* leader(std::string_view effect) const;
};

/// Told of every step as it begins.
using StepReport = std::function<void(const std::string&)>;

/// Searches on top of `base`. Ensembles of effects go into sub-folders of `folder`. Throws what study_model
/// throws, but that an effect whose runs fail is left out with a warning.
Search search_for_effect(StudiedModel& base, const lab_data::Sample& sample,
                         const std::filesystem::path& folder, RunLog* log, const StepReport& report);

/// Effects that the model of the settings has not, and that can show in the sample's tests.
std::vector<const ModelEffect*> candidates_for(const Settings& settings, const Campaign& campaign);

}  // namespace loam::experiments
