// loam bench twins: soils of known parameters, drawn from the prior's central 80 %, made with three times as
// many particles and other packings than the ensemble, with measurement noise of 1 % plus 5e-5; each is
// fitted through one shared ensemble. The floor is what the twins' own packings allow: half the spread
// between two packings of one soil.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>

#include "experiments/calibration.hpp"
#include "experiments/ensemble/run_seed.hpp"
#include "experiments/quantile.hpp"
#include "experiments/settings/run_folder.hpp"
#include "experiments/workflows/benchmarks/benchmarks.hpp"
#include "experiments/workflows/benchmarks/twin_tests.hpp"
#include "experiments/workflows/parameter_summary.hpp"
#include "surrogate/designs.hpp"

namespace loam::experiments {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr Index soils = 48;
constexpr int twin_enlargement = 3, shared_runs = 400;
constexpr double relative_noise = 0.01, absolute_noise = 5e-5;

/// A standard normal number from (seed, k): Box and Muller on two hashed uniform numbers.
double normal(std::uint64_t seed, std::uint64_t k) {
    const auto uniform = [](std::uint64_t bits) {
        return (static_cast<double>(bits >> 11) + 0.5) * 0x1.0p-53;
    };
    const double u = uniform(run_seed(seed, 2 * k, twin_noise)),
                 v = uniform(run_seed(seed, 2 * k + 1, twin_noise));
    return std::sqrt(-2 * std::log(u)) * std::cos(2 * std::numbers::pi * v);
}

struct TwinOutcome {
    VectorXd truth, estimate;  // SI, all parameters of the law
    std::vector<ParameterSummary> summary;
};

}  // namespace

int bench_twins(const Settings& given) {
    Settings settings = given;
    settings.calibration.specimen_particles = twin_enlargement * settings.particles;
    // One ensemble serves all soils of the prior, so it is larger than a calibration's own.
    if (settings.runs == Settings{}.runs) settings.runs = shared_runs;
    const lab_data::Sample sample = reference_sample();
    const RunFolder folder(given);
    RunLog log(folder.file("log.txt"));
    Campaign campaign(settings, sample, folder.path(), &log);
    const ParameterSpace& space = campaign.space();

    std::vector<Index> columns;
    const Observation observation = observation_of(campaign, columns);
    const std::vector<RunRecord> training = training_runs(campaign);

    Eigen::MatrixXd u =
        surrogate::maximin_latin_hypercube(soils, space.dimension(), run_seed(settings.seed, 0, twin_design));
    u = (0.1 + 0.8 * u.array()).matrix();
    const Eigen::MatrixXd x = space.from_probabilities(u);
    std::vector<RunSpec> specs;
    for (Index k = 0; k < 2 * soils; ++k) {  // two packings of every soil
        const std::uint64_t index = twins_from + static_cast<std::uint64_t>(k);
        specs.push_back({index, "twin", space.physical(x.row(k / 2).transpose()),
                         run_seed(settings.seed, index, twin_packings),
                         static_cast<std::uint32_t>(twin_enlargement * settings.particles)});
    }
    const std::vector<RunRecord> twins = campaign.run("twins", specs);

    std::vector<Observation> observed(twins.size(), observation);
    std::map<double, TrainedEmulator> trained;  // by scale: soils of like strains share one
    for (std::size_t k = 0; k < twins.size(); ++k) {
        if (!twins[k].ok) continue;
        VectorXd& measured = observed[k].measured;
        for (Index m = 0; m < measured.size(); ++m) {
            const double y = twins[k].outputs[m], sd = std::hypot(relative_noise * y, absolute_noise);
            measured[m] = y + sd * normal(settings.seed, 1000 * k + static_cast<std::uint64_t>(m));
        }
        const double scale = transform_for(observed[k]).scale;
        if (!trained.contains(scale))
            trained.emplace(scale,
                            train_emulator(training, space, columns, transforms_of(observed[k]), settings));
    }
    std::vector<std::optional<TwinOutcome>> outcomes(twins.size());
#pragma omp parallel for schedule(dynamic)
    for (std::size_t k = 0; k < twins.size(); ++k) {
        if (!twins[k].ok) continue;
        const Observation& mine = observed[k];
        const Fit found = fit(trained.at(transform_for(mine).scale), space, mine, settings);
        outcomes[k] =
            TwinOutcome{twins[k].spec.parameters, space.physical(found.estimate), summarise(campaign, found)};
    }

    nlohmann::json result = nlohmann::json::object();
    std::string text = fmt::format("{:<16} {:>7} {:>14} {:>9} {:>16} {:>12}\n", "parameter", "soils",
                                   "median error", "floor", "90 % covers (%)", "identified (%)");
    for (std::size_t p = 0; p < space.parameters.size(); ++p) {
        std::vector<double> errors, floors;
        double covered = 0, identified = 0;
        bool logarithmic = false;
        for (std::size_t k = 0; k < outcomes.size(); k += 2) {
            if (!outcomes[k]) continue;
            const ParameterSummary& s = outcomes[k]->summary[p];
            logarithmic = s.logarithmic;
            const auto at = static_cast<Index>(p);
            // Of a parameter on a log scale the error is relative: |estimate/truth - 1|.
            const auto error = [&](double a, double b) {
                return logarithmic ? std::abs(a / b - 1) : std::abs(a - b);
            };
            errors.push_back(error(outcomes[k]->estimate[at], outcomes[k]->truth[at]));
            covered += outcomes[k]->truth[at] >= s.q05 && outcomes[k]->truth[at] <= s.q95 ? 1 : 0;
            identified += s.identified ? 1 : 0;
            if (outcomes[k + 1])
                floors.push_back(error(outcomes[k]->estimate[at], outcomes[k + 1]->estimate[at]) /
                                 std::numbers::sqrt2);
        }
        const double n = static_cast<double>(errors.size());
        const std::string name(space.parameters[p].name);
        result[name] = {{"soils", errors.size()},         {"median_error", quantile(errors, 0.5)},
                        {"floor", quantile(floors, 0.5)}, {"coverage90", covered / n},
                        {"identified", identified / n},   {"relative", logarithmic}};
        text += fmt::format("{:<16} {:>7} {:>12.3f}{:<2} {:>9.3f} {:>16.1f} {:>12.1f}\n", name, errors.size(),
                            quantile(errors, 0.5), logarithmic ? " *" : "", quantile(floors, 0.5),
                            100 * covered / n, 100 * identified / n);
    }
    text += fmt::format(
        "* relative. {} training runs; the floor is the median difference of two packings' estimates over "
        "the root of two\n",
        training.size());
    fmt::print("{}", settings.json ? result.dump(1) + "\n" : text);
    return 0;
}

}  // namespace loam::experiments
