// The common stages of a data set and the reading of a sample's own stages off them.
#include <gtest/gtest.h>

#include <cmath>

#include "experiments/bulk/stages.hpp"

using namespace loam;
using namespace loam::experiments;
using Eigen::VectorXd;

namespace {

lab_data::Test test_of(const std::vector<double>& stress, const std::vector<std::string>& phase = {}) {
    lab_data::Test test;
    test.seating_stress = 2000;
    test.phase = phase;
    for (std::size_t k = 0; k < stress.size(); ++k) {
        test.columns["axial_stress"].push_back(stress[k]);
        test.columns["axial_strain"].push_back(0.01 * static_cast<double>(k + 1));
        test.lines.push_back(static_cast<int>(k) + 2);
    }
    return test;
}

lab_data::DataSet set_of(const std::vector<std::vector<double>>& samples) {
    lab_data::DataSet set;
    for (const auto& stress : samples) set.rows.push_back({"s", "f", 2, {}, test_of(stress)});
    return set;
}

}  // namespace

TEST(BulkStages, LoadingCurveLeavesOutUnloadingReloadingAndTheSeat) {
    const auto curve =
        loading_curve(test_of({2e3, 5e4, 1e5, 5e4, 1e5, 2e5},
                              {"loading", "loading", "loading", "unloading", "reloading", "loading"}));
    EXPECT_EQ(curve.readings, (std::vector<std::size_t>{1, 2, 5}));
    EXPECT_DOUBLE_EQ(curve.strain[2], 0.06);
}

TEST(BulkStages, FewStressesAreTheStagesThemselves) {
    const StageSet stages = common_stages(set_of({{15e3, 57e3}, {15e3, 29e3, 57e3}}), 12);
    EXPECT_EQ(stages.stress, (std::vector<double>{15e3, 29e3, 57e3}));
    EXPECT_EQ(stages.interpolation(VectorXd{{15e3, 57e3}}), (Eigen::MatrixXd{{1, 0, 0}, {0, 0, 1}}));
    EXPECT_EQ(stages.needed(29e3), 2);
}

TEST(BulkStages, ManyStressesAreReadOffASpreadOfStages) {
    std::vector<std::vector<double>> samples;
    for (int k = 1; k <= 40; ++k) samples.push_back({1e4 * k, 1.07e4 * k, 4e4 * k});
    const StageSet stages = common_stages(set_of(samples), 12);
    ASSERT_EQ(stages.stress.size(), 12u);
    EXPECT_DOUBLE_EQ(stages.stress.front(), 1e4);
    EXPECT_NEAR(stages.stress.back(), 1.6e6, 1e-3);
    // A cubic in log stress that is zero at the seat is read exactly.
    const auto curve = [](double s) {
        const double x = std::log(s / 2000);
        return 0.01 * x + 0.004 * x * x - 0.0003 * x * x * x;
    };
    VectorXd nodes(12);
    for (int k = 0; k < 12; ++k) nodes[k] = curve(stages.stress[static_cast<std::size_t>(k)]);
    const VectorXd at{{1.07e4, 3.3e4, 5e5, 1.5e6}};
    const VectorXd read = stages.interpolation(at) * nodes;
    for (int k = 0; k < 4; ++k) EXPECT_NEAR(read[k], curve(at[k]), 1e-12);
    // Nothing beyond the stages that are needed has a weight.
    const Eigen::Index needed = stages.needed(5e5);
    EXPECT_LT(needed, 12);
    EXPECT_EQ(stages.interpolation(VectorXd{{5e5}}).rightCols(12 - needed).norm(), 0);
}

TEST(BulkStages, ADataSetWithoutStagesIsRefused) {
    EXPECT_THROW(common_stages(set_of({{2000}}), 12), lab_data::UserError);
}
