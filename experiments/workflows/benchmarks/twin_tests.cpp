#include "experiments/workflows/benchmarks/twin_tests.hpp"

#include <cmath>
#include <random>

namespace loam::experiments {

using Eigen::Index;

lab_data::Test test_without_readings(lab_data::TestKind kind, std::string file, const char* x, double to,
                                     int readings, std::initializer_list<const char*> channels) {
    lab_data::Test test;
    test.kind = kind;
    test.file = std::move(file);
    for (int k = 1; k <= readings; ++k) {
        test.columns[x].push_back(to * std::pow(static_cast<double>(k) / readings, 2));
        for (const char* channel : channels) test.columns[channel].push_back(0);
        test.lines.push_back(k + 1);
    }
    return test;
}

lab_data::Test oedometer_without_readings(double seating_stress, std::initializer_list<double> stages) {
    lab_data::Test test;
    test.file = "oedometer.csv";
    test.seating_stress = seating_stress;
    for (const double stage : stages) {
        const bool falls = !test.lines.empty() && stage < test.columns["axial_stress"].back();
        test.columns["axial_stress"].push_back(stage);
        test.columns["axial_strain"].push_back(0);
        test.phase.emplace_back(falls ? "unloading" : "loading");
        test.lines.push_back(static_cast<int>(test.lines.size()) + 2);
    }
    return test;
}

Observation observed(const Observation& form, const std::vector<Index>& columns, const RunRecord& run,
                     std::uint64_t seed) {
    Observation out = form;
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    for (const ObservedCurve& curve : out.curves)
        for (Index k = curve.first; k < curve.first + curve.count; ++k) {
            const double y = run.outputs[columns[static_cast<std::size_t>(k)]];
            out.measured[k] = y + std::hypot(curve.unit * curve.floor, curve.relative * y) * normal(random);
        }
    return out;
}

}  // namespace loam::experiments
