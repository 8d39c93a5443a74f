// loam bench bulk: what a data set costs as its samples grow in number. Oedometer curves of soils drawn from
// the prior's central 80 %, on other packings than the ensemble's and with 1 % of noise; each number of
// samples is a study of its own from the first run to the report, with direct runs for 20 of them.
#include "experiments/workflows/bulk.hpp"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>

#include "experiments/calibration.hpp"
#include "experiments/ensemble/run_seed.hpp"
#include "experiments/output/atomic_file.hpp"
#include "experiments/settings/run_folder.hpp"
#include "experiments/workflows/benchmarks/benchmarks.hpp"
#include "experiments/workflows/benchmarks/twin_tests.hpp"
#include "surrogate/designs.hpp"

namespace loam::experiments {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr Index most_soils = 250;  // samples beyond that measure the same specimens, with other noise
constexpr int ensemble = 959, fewest = 125, growth = 4, most_by_default = 2000;

struct Soils {
    Observation form;
    std::vector<Index> columns;
    std::vector<RunRecord> runs;
};

Soils make_soils(Index soils, const Settings& settings, const std::filesystem::path& folder, RunLog& log) {
    const lab_data::Sample sample = reference_sample();
    Campaign campaign(settings, sample, folder / "soils", &log);
    Soils out;
    out.form = observation_of(campaign, out.columns);
    const ParameterSpace& space = campaign.space();
    const MatrixXd u =
        surrogate::maximin_latin_hypercube(soils, space.dimension(), run_seed(settings.seed, 0, twin_design));
    const MatrixXd x = space.from_probabilities((0.1 + 0.8 * u.array()).matrix());
    std::vector<RunSpec> specs;
    for (Index k = 0; k < soils; ++k) {
        const auto index = static_cast<std::uint64_t>(k);
        specs.push_back({index, "twin", space.physical(x.row(k).transpose()),
                         run_seed(settings.seed, index, twin_packings),
                         static_cast<std::uint32_t>(settings.particles)});
    }
    for (RunRecord& run : campaign.run("soils", specs))
        if (run.ok) out.runs.push_back(std::move(run));
    return out;
}

lab_data::DataSet data_set(const Soils& of, std::size_t samples, std::uint64_t seed) {
    lab_data::DataSet set;
    set.name = fmt::format("{} samples", samples);
    set.source = "made by loam bench bulk";
    set.licence = "CC0-1.0";
    set.measured = false;
    const lab_data::Test form = reference_sample().tests.front();
    for (std::size_t k = 0; k < samples; ++k) {
        const Observation noisy =
            observed(of.form, of.columns, of.runs[k % of.runs.size()], run_seed(seed, k, twin_noise));
        lab_data::Test test = form;
        test.columns["axial_strain"] = {noisy.measured.begin(), noisy.measured.end()};
        set.rows.push_back({fmt::format("S{:05}", k + 1), form.file, static_cast<int>(k) + 2, {}, test});
    }
    return set;
}

/// Of the process so far (MB).
double peak_memory() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<double>(usage.ru_maxrss) / 1024;
}

}  // namespace

int bench_bulk(const Settings& given) {
    Settings settings = given;
    const Settings defaults;
    if (settings.runs == defaults.runs) settings.runs = ensemble;
    if (settings.engine.haste == defaults.engine.haste) settings.engine.haste = 4;
    if (settings.confirm == defaults.confirm) settings.confirm = "20";
    const RunFolder folder(given);
    RunLog log(folder.file("log.txt"));
    const int most = settings.twins > 0 ? settings.twins : most_by_default;
    const Soils of = make_soils(std::min<Index>(most_soils, most), settings, folder.path(), log);
    nlohmann::json rows = nlohmann::json::array();
    std::string text = fmt::format("{:>8} {:>9} {:>12} {:>14} {:>12} {:>17}\n", "samples", "time (s)",
                                   "training (s)", "of a sample (s)", "calibrated", "peak memory (MB)");
    for (int samples = std::min(fewest, most);; samples = std::min(samples * growth, most)) {
        const std::filesystem::path place = folder.path() / std::to_string(samples);
        std::filesystem::create_directories(place);
        const auto n = static_cast<std::size_t>(samples);
        const nlohmann::json result =
            calibrate_data_set(settings, data_set(of, n, settings.seed), place, log);
        const double seconds = result["seconds"];
        const double training = result["parts"]["training runs"].get<double>() +
                                result["parts"]["further training runs"].get<double>();
        rows.push_back({{"samples", samples},
                        {"seconds", seconds},
                        {"training_seconds", training},
                        {"calibrated", result["overall"]["calibrated"]},
                        {"peak_memory_MB", peak_memory()}});
        text += fmt::format("{:>8} {:>9.0f} {:>12.0f} {:>14.3f} {:>12} {:>17.0f}\n", samples, seconds,
                            training, (seconds - training) / samples,
                            result["overall"]["calibrated"].get<int>(), peak_memory());
        if (samples == most) break;
    }
    fmt::print("{}", settings.json ? rows.dump(1) + "\n" : text);
    return 0;
}

}  // namespace loam::experiments
