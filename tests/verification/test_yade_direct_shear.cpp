// Direct shear of boxes of spheres against the curves that another DEM code gives for the same packings
// (data/yade/README.md), mean of three boxes, to 3 % of the length. Tolerances: 2 % of the shear stress, 2e-4
// of the height in settlement (seen: 1.4 % at the first reading, 0.6 % after, and 1.6e-4). Boxes that are
// loaded fast before they are sheared miss both: at an inertial number of 5e-3 by 16 % and 1e-3.
#include <gtest/gtest.h>

#include <array>
#include <fstream>
#include <string>

#include "experiments/lab_tests/direct_shear.hpp"
#include "experiments/specimens.hpp"

namespace loam::experiments {
namespace {

struct Reading {
    double displacement = 0, shear_stress = 0, normal_stress = 0, settlement = 0;  // SI
};

std::string file(const std::string& name, int number) {
    return std::string(LOAM_SOURCE_DIR) + "/tests/verification/data/yade/" + name + "_" +
           std::to_string(number) + ".csv";
}

/// At a displacement, between the lines of the file.
Reading reference(int number, double displacement) {
    std::ifstream in(file("direct_shear", number));
    std::string line;
    std::getline(in, line);
    Reading before, now;
    char comma = 0;
    while (in >> now.displacement >> comma >> now.shear_stress >> comma >> now.normal_stress >> comma >>
           now.settlement) {
        if (now.displacement >= displacement) {
            const double share =
                (displacement - before.displacement) / (now.displacement - before.displacement);
            now.shear_stress = 1e3 * (before.shear_stress + share * (now.shear_stress - before.shear_stress));
            now.settlement = before.settlement + share * (now.settlement - before.settlement);
            return now;
        }
        before = now;
    }
    ADD_FAILURE() << "the curve of box " << number << " ends before " << displacement;
    return {};
}

TEST(YadeReferenceDirectShear, TheSameBoxesGiveTheSameCurves) {
    const std::array<double, 6> displacements = {0.001, 0.0025, 0.005, 0.01, 0.02, 0.03};
    engine::LinearCohesive law;
    law.young_modulus = 1e8;
    law.stiffness_ratio = 0.83;
    law.friction_angle = 0.2;
    law.normal_cohesion = law.shear_cohesion = 0;
    DirectShearOptions options;
    options.inertial_number = 5e-4;  // as theirs
    options.strain_per_step = 1e-7;
    options.displacements.assign(displacements.begin(), displacements.end());
    std::array<Reading, 6> theirs, ours;
    for (const int number : {1, 2, 3}) {
        engine::Packing packing = load_packing(file("box", number));
        // The cell of the file is the box; round a box of walls it must be larger.
        const Eigen::Vector3d margin = Eigen::Vector3d::Constant(0.3);
        const engine::Box box{margin, margin + packing.cell.diagonal()};
        packing.centres.colwise() += margin;
        packing.cell.diagonal() += 2 * margin;
        const DirectShearResult run = run_direct_shear(packing, box, law, {}, options);
        ASSERT_TRUE(run.complete) << run.reason;
        for (std::size_t k = 0; k < displacements.size(); ++k) {
            const Reading at = reference(number, displacements[k]);
            theirs[k].shear_stress += at.shear_stress / 3;
            theirs[k].settlement += at.settlement / 3;
            ours[k].shear_stress += run.readings[k].shear_stress / 3;
            ours[k].settlement += run.readings[k].settlement / 3;
        }
    }
    for (std::size_t k = 0; k < displacements.size(); ++k) {
        EXPECT_NEAR(ours[k].shear_stress / theirs[k].shear_stress, 1, 0.02) << "at " << displacements[k];
        EXPECT_NEAR(ours[k].settlement, theirs[k].settlement, 2e-4) << "at " << displacements[k];
    }
}

}  // namespace
}  // namespace loam::experiments
