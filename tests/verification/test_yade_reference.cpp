// The same packings loaded as another DEM code loaded them (data/yade/README.md). Tolerances: averaged over
// the four packings, the signed and the mean absolute difference in strain at each of the eight stresses of
// De Pue et al. (2019) are at most 1e-3; that code's own scatter under another time step is about 4e-4.
// Unloading likewise.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <string>
#include <vector>

#include "experiments/lab_tests/oedometer.hpp"
#include "experiments/specimens.hpp"

namespace loam::experiments {
namespace {

const std::string folder = std::string(LOAM_SOURCE_DIR) + "/tests/verification/data/yade/";
const std::vector<double> loading{15, 29, 57, 113, 224, 447, 895, 1786};  // kPa
const std::vector<double> unloading{895, 447, 224, 113, 57, 29, 15};
constexpr double tolerance = 1e-3;

struct Curve {
    std::vector<double> strain, stress;  // stress in kPa
};

Curve read_curve(const std::string& name) {
    std::ifstream file(folder + name);
    EXPECT_TRUE(file) << name;
    std::string line;
    std::getline(file, line);
    Curve curve;
    while (std::getline(file, line)) {
        const std::size_t comma = line.find(',');
        curve.strain.push_back(std::stod(line.substr(0, comma)));
        curve.stress.push_back(std::stod(line.substr(comma + 1)));
    }
    return curve;
}

/// Strain where the stress first passes each stage, on the way up and then on the way down.
std::vector<double> strains_at_stages(const Curve& curve) {
    std::vector<double> out;
    const auto top = static_cast<std::size_t>(std::ranges::max_element(curve.stress) - curve.stress.begin());
    const auto cross = [&](double target, std::size_t from, std::size_t to, double sign) {
        for (std::size_t k = from + 1; k <= to; ++k)
            if ((curve.stress[k] - target) * sign >= 0) {
                const double share = (target - curve.stress[k - 1]) / (curve.stress[k] - curve.stress[k - 1]);
                return curve.strain[k - 1] + share * (curve.strain[k] - curve.strain[k - 1]);
            }
        return std::nan("");
    };
    for (const double s : loading) out.push_back(cross(s, 0, top, 1));
    for (const double s : unloading) out.push_back(cross(s, top, curve.stress.size() - 1, -1));
    return out;
}

/// Force chains that buckle turn rounding into strain: runs of one packing that differ by their time step
/// alone scatter by about 5e-4, as the other code's do. The mean of three is compared.
Eigen::VectorXd mean_strain(const engine::Packing& packing, const engine::LinearCohesive& law,
                            const OedometerOptions& options) {
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(options.stages.size()));
    for (const double safety : {0.68, 0.70, 0.72}) {
        engine::SimulationOptions how;
        how.time_step_safety = safety;
        engine::Simulation simulation(packing, law, how);
        const OedometerResult run = run_oedometer(simulation, law, options);
        EXPECT_TRUE(run.complete) << run.reason;
        EXPECT_LT(run.seating_error, 0.01);
        sum += run.strain;
    }
    return sum / 3;
}

class YadeReference : public testing::TestWithParam<std::pair<const char*, double>> {};

TEST_P(YadeReference, SamePackingsGiveTheSameCurves) {
    const auto [name, friction_angle] = GetParam();
    engine::LinearCohesive law;
    law.young_modulus = 3.1623e8;
    law.friction_angle = friction_angle;
    OedometerOptions options;
    options.strain_rate = 0.02;
    for (const double s : loading) options.stages.push_back(1000 * s);
    options.stages.push_back(2e6);
    for (const double s : unloading) options.stages.push_back(1000 * s);

    const std::size_t count = loading.size() + unloading.size();
    std::vector<double> signed_difference(count, 0.0), difference(count, 0.0);
    for (int packing = 1; packing <= 4; ++packing) {
        const std::string number = std::to_string(packing);
        const Eigen::VectorXd strain =
            mean_strain(load_packing(folder + "packing_" + number + ".csv"), law, options);
        ASSERT_TRUE(strain.allFinite());
        const std::vector<double> reference =
            strains_at_stages(read_curve("oedometer_" + std::string(name) + "_" + number + ".csv"));
        for (std::size_t k = 0; k < count; ++k) {
            const double d = strain[static_cast<Eigen::Index>(k < loading.size() ? k : k + 1)] - reference[k];
            signed_difference[k] += d / 4;
            difference[k] += std::abs(d) / 4;
        }
    }
    for (std::size_t k = 0; k < count; ++k) {
        EXPECT_LE(std::abs(signed_difference[k]), tolerance) << name << ", stage " << k;
        EXPECT_LE(difference[k], tolerance) << name << ", stage " << k;
    }
}

INSTANTIATE_TEST_SUITE_P(Cases, YadeReference,
                         testing::Values(std::pair{"base", 0.31}, std::pair{"rough", 0.6}),
                         [](const auto& info) { return std::string(info.param.first); });

}  // namespace
}  // namespace loam::experiments
