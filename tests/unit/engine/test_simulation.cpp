// The engine against closed forms and symmetries; each expectation is derived in a comment, none by the code
// under test.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "engine/loading.hpp"
#include "engine/packing.hpp"
#include "engine/simulation.hpp"

namespace loam::engine {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

constexpr double pi = std::numbers::pi;

/// Two spheres of radius 0.05 m in a cubic cell of 1 m, `gap` apart along the diagonal direction.
Packing two_spheres(double gap, const Vector3d& direction) {
    Packing packing;
    packing.centres.resize(3, 2);
    packing.centres.col(0) =
        Vector3d(0.98, 0.5, 0.03);  // near a corner, so that the contact crosses the boundary
    packing.centres.col(1) = packing.centres.col(0) + (0.1 + gap) * direction.normalized();
    packing.radii = Eigen::Vector2d(0.05, 0.05);
    return packing;
}

LinearCohesive elastic_law(double modulus) {
    LinearCohesive law;
    law.young_modulus = modulus;
    law.normal_cohesion = law.shear_cohesion = 0;
    law.friction_angle = 0.5;
    return law;
}

SimulationOptions undamped() {
    SimulationOptions options;
    options.damping = 0;
    options.time_step_safety = 0.01;
    return options;
}

/// A face-centred cubic packing of 4 x 4 x 4 cells, nearest neighbours at `spacing`, radii 0.5.
Packing fcc(double spacing) {
    const double a = spacing * std::sqrt(2.0);
    const Vector3d basis[4] = {{0, 0, 0}, {0.5, 0.5, 0}, {0.5, 0, 0.5}, {0, 0.5, 0.5}};
    Packing packing;
    packing.cell = Matrix3d::Identity() * 4 * a;
    packing.centres.resize(3, 256);
    packing.radii = Eigen::VectorXd::Constant(256, 0.5);
    Eigen::Index n = 0;
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j)
            for (int k = 0; k < 4; ++k)
                for (const Vector3d& b : basis) packing.centres.col(n++) = a * (Vector3d(i, j, k) + b);
    return packing;
}

TEST(TwoSpheres, ElasticImpactGivesBackTheSpeedAndTakesHalfAPeriod) {
    // k_n = 2 E R R/(R+R) = E R; reduced mass m/2; contact lasts pi sqrt(m / (2 k_n)).
    const double modulus = 1e7, radius = 0.05, mass = 4.0 / 3 * pi * std::pow(radius, 3) * 2600;
    const Vector3d direction = Vector3d(1, 2, -2) / 3;
    Simulation simulation(two_spheres(1e-5, direction), elastic_law(modulus), undamped());
    Matrix3Xd v(3, 2);
    v.col(0) = 0.05 * direction;
    v.col(1) = -0.05 * direction;
    simulation.set_velocities(v);
    int touching = 0, steps = 0;
    while (steps++ < 100000) {
        if (simulation.advance(1).contacts > 0)
            ++touching;
        else if (touching > 0)
            break;
    }
    EXPECT_NEAR(touching * simulation.time_step(), pi * std::sqrt(mass / (2 * modulus * radius)),
                2 * simulation.time_step());
    EXPECT_LT((simulation.velocities() + v).norm() / v.norm(),
              2e-3);  // reversed; the step's size sets the error
    EXPECT_LT((simulation.velocities().rowwise().sum()).norm(), 1e-15);  // momentum
}

TEST(TwoSpheres, TensionHoldsUpToTheAdhesionAndNoFurther) {
    // a_n = C min(R)^2 = k_n u: the contact parts at a gap of C R^2 / (E R) = C R / E.
    LinearCohesive law = elastic_law(1e7);
    law.normal_cohesion = law.shear_cohesion = 1e5;
    const double parting_gap = 1e5 * 0.05 / 1e7;
    const auto pull = [&](double gap) {
        Simulation simulation(two_spheres(-1e-6, Vector3d::UnitX()), law, undamped());
        simulation.advance(1);
        Matrix3Xd v = Matrix3Xd::Zero(3, 2);
        v(0, 1) = 1.0;  // its energy is ten times what the bond can store, so that it parts
        simulation.set_velocities(v);
        while (simulation.contacts().size() == 1 && simulation.contacts()[0].branch.norm() - 0.1 < gap)
            simulation.advance(1);
        return simulation.contacts().size();
    };
    EXPECT_EQ(pull(0.9 * parting_gap), 1u);
    EXPECT_EQ(pull(1.1 * parting_gap), 0u);
}

TEST(Lattice, FaceCentredCubicModulusMatchesTheSumOverItsBonds) {
    // Uniform strain is an equilibrium of a lattice with a centre of symmetry, so the confined modulus is the
    // Voigt sum (1/V) sum_c D^2 (k_n n_z^4 + k_t n_z^2 (1 - n_z^2)). For fcc: four of six contacts a particle
    // have n_z^2 = 1/2 and V = D^3 / sqrt(2), so M = sqrt(2) (k_n + k_t) / D with k_n = E D / 2, that is E (1
    // + ratio) / sqrt(2).
    LinearCohesive law = elastic_law(1e8);
    law.stiffness_ratio = 0.4;
    law.friction_angle = 1.5;
    law.shear_cohesion = 1e9;
    Simulation simulation(fcc(1 - 1e-4), law, SimulationOptions{});
    const double before = simulation.advance(1).stress(2, 2), height = simulation.cell()(2, 2);
    Matrix3d gradient = Matrix3d::Zero();
    gradient(2, 2) = -1e-8 / simulation.time_step();
    simulation.set_velocity_gradient(gradient);
    const double after = simulation.advance(1001).stress(2, 2);
    const double strain =
        std::log(height / simulation.cell()(2, 2)) * 1000 / 1001;  // the last step's is not yet felt
    EXPECT_NEAR((after - before) / strain, 1e8 * 1.4 / std::sqrt(2.0), 1e8 * 1e-3);
}

TEST(Symmetry, TranslationAcrossTheBoundaryChangesStressOnlyByRounding) {
    PackingOptions options;
    options.particles = 200;
    options.target_porosity = 0.44;
    const Packing packing = make_packing(options).packing;
    Packing moved = packing;
    moved.centres.colwise() += Vector3d(0.37, -0.21, 5.3);
    LinearCohesive law;
    Simulation a(packing, law, {}), b(moved, law, {});
    const Matrix3d sa = a.advance(1).stress, sb = b.advance(1).stress;
    EXPECT_LT((sa - sb).norm() / sa.norm(), 1e-10);
    EXPECT_EQ(a.measured().contacts, b.measured().contacts);
}

TEST(Symmetry, EnlargedParticlesGiveTheSameStressAtTheSameStrain) {
    // Linear contact laws with k ~ E R and adhesion ~ C R^2 have no length of their own.
    PackingOptions options;
    options.particles = 200;
    options.target_porosity = 0.44;
    const Packing packing = make_packing(options).packing;
    Packing large = packing;
    large.cell *= 8;  // a power of two: no rounding
    large.centres *= 8;
    large.radii *= 8;
    LinearCohesive law;
    Simulation a(packing, law, {}), b(large, law, {});
    for (Simulation* s : {&a, &b}) {
        Matrix3d gradient = Matrix3d::Zero();
        gradient(2, 2) = -2e-6 / s->time_step();
        s->set_velocity_gradient(gradient);
        s->advance(500);
    }
    EXPECT_LT((a.measured().stress - b.measured().stress).norm() / a.measured().stress.norm(), 1e-6);
}

TEST(Energy, BalanceClosesInALoadedPacking) {
    PackingOptions options;
    options.particles = 200;
    options.target_porosity = 0.44;
    SimulationOptions how;
    how.energy_balance = true;
    Simulation simulation(make_packing(options).packing, LinearCohesive{}, how);
    Matrix3d gradient = Matrix3d::Zero();
    gradient(2, 2) = -2e-6 / simulation.time_step();
    simulation.set_velocity_gradient(gradient);
    simulation.advance(20000);
    EXPECT_GT(simulation.energy().work, 0);
    EXPECT_GT(simulation.energy().sliding, 0);
    EXPECT_GT(simulation.energy().damping, 0);
    EXPECT_LT(simulation.energy().error(), 0.02);
}

TEST(Neighbours, ResultsDoNotDependOnWhenTheListIsRebuilt) {
    // A thin skin rebuilds often, a thick one hardly ever. If any contact or history were lost, stresses
    // would part by percents within a few steps of yielding; rounding alone parts them by far less over this
    // short path.
    PackingOptions options;
    options.particles = 300;
    options.target_porosity = 0.44;
    const Packing packing = make_packing(options).packing;
    LinearCohesive law;  // strong contacts: buckling, which would magnify rounding, is kept small
    law.friction_angle = 1.2;
    law.normal_cohesion = law.shear_cohesion = 1e7;
    double stress[2];
    std::uint64_t rebuilds[2];
    for (int k = 0; k < 2; ++k) {
        SimulationOptions how;
        how.neighbour_skin = k == 0 ? 0.002 : 0.3;
        Simulation simulation(packing, law, how);
        Matrix3d gradient = Matrix3d::Zero();
        gradient(2, 2) = -2e-6 / simulation.time_step();
        gradient(0, 2) = 1e-6 / simulation.time_step();  // shear turns the cell as well
        simulation.set_velocity_gradient(gradient);
        stress[k] = simulation.advance(1500).stress(2, 2);
        rebuilds[k] = simulation.rebuilds();
    }
    EXPECT_GT(rebuilds[0], 5u);
    EXPECT_LT(rebuilds[1], 3u);
    EXPECT_NEAR(stress[0] / stress[1], 1.0, 1e-4);
}

TEST(Simulation, TheSameInputGivesTheSameBits) {
    PackingOptions options;
    options.particles = 150;
    options.target_porosity = 0.45;
    const Packing packing = make_packing(options).packing;
    Matrix3d stress[2];
    for (Matrix3d& s : stress) {
        Simulation simulation(packing, LinearCohesive{}, {});
        simulation.set_velocity_gradient(-Matrix3d::Identity() * 0.05);
        s = simulation.advance(3000).stress;
    }
    EXPECT_EQ(stress[0], stress[1]);
}

TEST(Rotation, FreePackingsStayFiniteAndKeepTheirMomentum) {
    // Particle numbers that fill the last block of eight pairs to every degree.
    for (const std::uint32_t particles : {150u, 151u, 153u, 157u}) {
        PackingOptions options;
        options.particles = particles;
        options.target_porosity = 0.44;
        SimulationOptions how;
        how.free_rotation = true;
        how.damping = 0;
        Simulation simulation(make_packing(options).packing, LinearCohesive{}, how);
        ASSERT_NO_THROW(simulation.advance(1));
        for (int k = 0; k < 20; ++k) ASSERT_NO_THROW(simulation.advance(50));
        const Packing now = simulation.packing();
        const Eigen::VectorXd mass = now.radii.array().cube();
        const Matrix3Xd v = simulation.velocities();
        EXPECT_LT((v * mass).norm(), 1e-9 * (v.colwise().norm() * mass).value());
    }
}

TEST(Rotation, SlowedSpinsDoNotSetTheTimeStep) {
    LinearCohesive law = elastic_law(1e7);
    law.stiffness_ratio = 1;
    SimulationOptions blocked, free, slowed;
    free.free_rotation = slowed.free_rotation = slowed.density_scaling = true;
    const auto step = [&](const ContactLaw& of, const SimulationOptions& how) {
        return Simulation(fcc(1.0), of, how).time_step();
    };
    EXPECT_LT(step(law, free), 0.9 * step(law, blocked));
    EXPECT_DOUBLE_EQ(step(law, slowed), step(law, blocked));
    // Rolling springs add to the shear springs, at most so much that spins become 2.5 times as inert.
    ContactLaw rolling = law;
    rolling.rolling.friction = 0.1;
    rolling.rolling.stiffness = 3;
    EXPECT_NEAR(step(rolling, slowed), std::sqrt(2.5) * step(rolling, free), 1e-12);
    EXPECT_LT(step(rolling, slowed), step(law, slowed));
}

TEST(Simulation, ExplodingPackingsEndWithAReason) {
    PackingOptions options;
    options.particles = 300;
    Packing packing = make_packing(options).packing;
    packing.radii *= 2.3;  // neighbours overlap by more than half
    EXPECT_THROW(Simulation(packing, LinearCohesive{}, {}).advance(1), std::runtime_error);
}

TEST(Simulation, UnsoundInputIsRefusedByName) {
    const Packing packing = two_spheres(0.01, Vector3d::UnitX());
    LinearCohesive law;
    law.young_modulus = -1;
    try {
        Simulation(packing, law, {});
        FAIL() << "a negative modulus was taken";
    } catch (const std::invalid_argument& error) {
        EXPECT_NE(std::string(error.what()).find("young_modulus"), std::string::npos);
    }
    Packing narrow = packing;
    narrow.cell *= 0.15;
    EXPECT_THROW(Simulation(narrow, LinearCohesive{}, {}), std::invalid_argument);
    Packing broken = packing;
    broken.centres(1, 0) = std::nan("");
    EXPECT_THROW(Simulation(broken, LinearCohesive{}, {}), std::invalid_argument);
    SimulationOptions how;
    how.damping = 1.5;
    EXPECT_THROW(Simulation(packing, LinearCohesive{}, how), std::invalid_argument);
}

}  // namespace
}  // namespace loam::engine
