#include "experiments/workflows/bench.hpp"

#include <array>
#include <string_view>
#include <vector>

#include "experiments/workflows/benchmarks/benchmarks.hpp"
#include "lab_data/nearest_name.hpp"
#include "lab_data/user_error.hpp"

namespace loam::experiments {
namespace {

struct Benchmark {
    std::string_view name;
    int (*run)(const Settings&);
};

constexpr std::array benchmarks{
    Benchmark{"twins", bench_twins},       Benchmark{"joint-twins", bench_joint_twins},
    Benchmark{"diagnose", bench_diagnose}, Benchmark{"atlas", bench_atlas},
    Benchmark{"bulk", bench_bulk},         Benchmark{"rate", bench_rate},
    Benchmark{"engine", bench_engine}};

}  // namespace

int run_bench(const Settings& settings) {
    if (!settings.against.empty() && settings.benchmark != "engine")
        throw lab_data::UserError({.column = "--against",
                                   .value = settings.against.front(),
                                   .constraint = "has nothing to be measured beside",
                                   .remedy = "it belongs to loam bench engine"});
    std::vector<std::string_view> names;
    for (const Benchmark& entry : benchmarks) {
        if (entry.name == settings.benchmark) return entry.run(settings);
        names.push_back(entry.name);
    }
    throw lab_data::UserError({.column = "bench",
                               .value = settings.benchmark,
                               .constraint = "is not a benchmark",
                               .remedy = lab_data::suggest_name(settings.benchmark, names)});
}

lab_data::Sample reference_sample() {
    lab_data::Sample sample;
    sample.name = "reference";
    sample.source = sample.description = "stages of De Pue et al. 2019";
    sample.licence = "CC0-1.0";
    sample.measured = false;
    sample.grain_density = 2600;
    lab_data::Test test;
    test.file = "oedometer.csv";
    test.seating_stress = 2000;
    for (const double stage : {15e3, 29e3, 57e3, 113e3, 224e3, 447e3, 895e3, 1786e3}) {
        test.columns["axial_stress"].push_back(stage);
        test.columns["axial_strain"].push_back(0);
        test.lines.push_back(static_cast<int>(test.lines.size()) + 2);
    }
    sample.tests.push_back(test);
    return sample;
}

}  // namespace loam::experiments
