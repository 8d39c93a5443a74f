// Stiffness of a face-centred cubic array of equal spheres against the sum over its bonds.
//
// In a Bravais lattice with a centre of symmetry every affine motion is an equilibrium. With blocked rotation
// the ends of a bond of length D and direction n move by D L n under the displacement gradient L, rigid
// turning included, so that
//   df = D [k_n n (n · L n) + k_t (L n - n (n · L n))]   and   d(sigma_ij) = 1/V sum D df_i n_j = K_ijkl
//   L_kl, K_ijkl = 1/V sum D^2 [k_n n_i n_j n_k n_l + k_t (d_ik - n_i n_k) n_j n_l].
// K has no symmetry in i, j or k, l: blocked spheres take up couples, a simple shear gives sigma_12 unlike
// sigma_21, and even a rigid turning of the cell gives stress. For symmetric strain and the symmetric part of
// stress it becomes
//   C_ijkl = 1/V sum D^2 [(k_n - k_t) n_i n_j n_k n_l + k_t/4 (d_ik n_j n_l + d_il n_j n_k + d_jk n_i n_l +
//   d_jl n_i n_k)],
// (e.g. Chang & Misra 1990; Luding 2004), for fcc with V = D^3 / sqrt(2) a particle
//   C11 = sqrt(2)/D (k_n + k_t), C12 = (k_n - k_t) / (sqrt(2) D), C44 = (k_n + k_t) / (sqrt(2) D).
// Under pure strain spheres that are free do not turn either, by symmetry, and C is the same.
//
// Tolerance 5e-6 of C11 with linear springs: overlaps are 1e-6 and strains 1e-7, so that what follows from
// stress before and from the change of V and n is of order 1e-6, and rounding of the overlaps is 1e-8.
// Hertzian springs have the k_n and k_t of their overlap, here 1e-5; strains are 1e-9, so that k changes by
// 5e-5 and rounding is 1e-6. Tolerance 1e-4.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <ostream>
#include <string>
#include <tuple>

#include "engine/simulation.hpp"
#include "tests/verification/lattice.hpp"

namespace loam::engine {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double modulus = 1e8, ratio = 0.4;

/// A law that does not slide, with the stiffnesses of its contacts at the overlap of the lattice.
struct Springs {
    const char* name;
    ContactLaw law;
    double overlap, strain, tolerance;
    double kn, kt;
    friend void PrintTo(const Springs& springs, std::ostream* out) { *out << springs.name; }
};

Springs linear_cohesive() {
    LinearCohesive law;
    law.young_modulus = modulus;
    law.stiffness_ratio = ratio;
    law.shear_cohesion = 1e9;
    law.normal_cohesion = 0;
    // k_n = 2 E R R / (R + R) = E R with R = 1/2; D = 1 to within the overlap.
    return {"LinearCohesive", law, 1e-6, 1e-7, 5e-6, 0.5 * modulus, 0.5 * ratio * modulus};
}
Springs linear_damped() {
    LinearDamped law;
    law.young_modulus = modulus;
    law.stiffness_ratio = ratio;
    law.friction_angle = 1.4;
    const double kn = 0.25 * std::numbers::pi * modulus;
    return {"LinearDamped", law, 1e-6, 1e-7, 5e-6, kn, ratio * kn};
}
Springs hertz_mindlin() {
    HertzMindlin law;
    law.young_modulus = modulus;
    law.poisson_ratio = 0.25;
    law.friction_angle = 1.4;
    const double overlap = 1e-5, kn = modulus / (1 - 0.0625) * std::sqrt(0.25 * overlap);
    return {"HertzMindlin", law, overlap, 1e-9, 1e-4, kn, 2 * 0.75 / 1.75 * kn};
}

/// Change of stress over strain when the cell is deformed by strain · `direction`; compression positive in
/// both.
Matrix3d response(const Springs& springs, const Matrix3d& direction, bool free_rotation,
                  const Matrix3d& turn = Matrix3d::Identity()) {
    SimulationOptions how;
    how.free_rotation = free_rotation;
    Packing packing = face_centred_cubic(3, 1 - springs.overlap);
    packing.cell = turn * packing.cell;
    packing.centres = turn * packing.centres;
    how.largest_overlap = springs.overlap;  // of Hertzian contacts: a constant time step
    Simulation simulation(packing, springs.law, how);
    const Matrix3d before = simulation.advance(1).stress;
    const int steps = 100;
    simulation.set_velocity_gradient(-springs.strain / steps / simulation.time_step() * direction);
    simulation.advance(steps);
    simulation.set_velocity_gradient(Matrix3d::Zero());
    return (simulation.advance(1).stress - before) / springs.strain;
}

/// Sum over the six bonds that belong to each particle, of V = 1 / sqrt(2).
template <class Term>
double bond_sum(const Term& term, const Matrix3d& turn = Matrix3d::Identity()) {
    double sum = 0;
    for (const Vector3d& n : {Vector3d(1, 1, 0), Vector3d(1, -1, 0), Vector3d(1, 0, 1), Vector3d(1, 0, -1),
                              Vector3d(0, 1, 1), Vector3d(0, 1, -1)})
        sum += term(Vector3d(turn * n.normalized()));
    return sum * std::sqrt(2.0);
}

double blocked_stiffness(double kn, double kt, int i, int j, int k, int l,
                         const Matrix3d& turn = Matrix3d::Identity()) {
    return bond_sum(
        [&](const Vector3d& n) {
            return kn * n[i] * n[j] * n[k] * n[l] + kt * ((i == k ? 1 : 0) - n[i] * n[k]) * n[j] * n[l];
        },
        turn);
}

TEST(BondSums, AreThoseOfTheClosedForms) {
    const double kn = 5e7, kt = 2e7;
    EXPECT_NEAR(blocked_stiffness(kn, kt, 0, 0, 0, 0), std::sqrt(2.0) * (kn + kt), 1e-9 * kn);
    EXPECT_NEAR(blocked_stiffness(kn, kt, 0, 0, 1, 1), (kn - kt) / std::sqrt(2.0), 1e-9 * kn);
    double c44 = 0;
    for (const int swap : {0, 1})
        c44 += 0.25 * (blocked_stiffness(kn, kt, 0, 1, swap, 1 - swap) +
                       blocked_stiffness(kn, kt, 1, 0, swap, 1 - swap));
    EXPECT_NEAR(c44, (kn + kt) / std::sqrt(2.0), 1e-9 * kn);
}

class Lattice : public testing::TestWithParam<std::tuple<bool, Springs>> {};

TEST_P(Lattice, CubicConstantsAreTheSumsOverBonds) {
    const auto& [turns, springs] = GetParam();
    const double kn = springs.kn, kt = springs.kt, tolerance = springs.tolerance;
    const double c11 = std::sqrt(2.0) * (kn + kt), c12 = (kn - kt) / std::sqrt(2.0),
                 c44 = (kn + kt) / std::sqrt(2.0);
    for (int axis = 0; axis < 3; ++axis) {
        Matrix3d stretch = Matrix3d::Zero(), shear = Matrix3d::Zero();
        stretch(axis, axis) = 1;
        const int a = (axis + 1) % 3, b = (axis + 2) % 3;
        shear(a, b) = shear(b, a) = 0.5;
        const Matrix3d s = response(springs, stretch, turns);
        EXPECT_NEAR(s(axis, axis), c11, tolerance * c11);
        EXPECT_NEAR(s(a, a), c12, tolerance * c11);
        EXPECT_NEAR(s(b, b), c12, tolerance * c11);
        EXPECT_LT(std::abs(s(a, b)) + std::abs(s(b, axis)) + std::abs(s(axis, a)), tolerance * c11);
        const Matrix3d t = response(springs, shear, turns);
        EXPECT_NEAR(t(a, b), c44, tolerance * c11);
        EXPECT_NEAR(t(b, a), c44, tolerance * c11);
        EXPECT_LT(t.diagonal().norm(), tolerance * c11);
    }
}

TEST_P(Lattice, PressureIsThatOfItsContacts) {
    // Six contacts a sphere of force F at the distance D: p = 6 F D / (3 V), V = D³/sqrt(2). Hertz: F = 2/3
    // k_n u.
    const auto& [turns, springs] = GetParam();
    const double exponent = std::holds_alternative<HertzMindlin>(springs.law.base) ? 1.5 : 1;
    SimulationOptions how;
    how.free_rotation = turns;
    Simulation simulation(face_centred_cubic(3, 1 - springs.overlap), springs.law, how);
    const Matrix3d stress = simulation.advance(1).stress;
    const double p = 2 * std::sqrt(2.0) * springs.kn * springs.overlap / exponent;
    EXPECT_LT((stress - p * Matrix3d::Identity()).norm(), 5e-5 * p);
}

INSTANTIATE_TEST_SUITE_P(Rotations, Lattice,
                         testing::Combine(testing::Bool(), testing::Values(linear_cohesive(), linear_damped(),
                                                                           hertz_mindlin())),
                         [](const auto& info) {
                             return std::string(std::get<0>(info.param) ? "Free" : "Blocked") +
                                    std::get<1>(info.param).name;
                         });

class BlockedLattice : public testing::TestWithParam<Springs> {};

TEST_P(BlockedLattice, EveryComponentOfTheGradientGivesTheStressOfTheUnsymmetricSum) {
    const Springs& springs = GetParam();
    const double kn = springs.kn, kt = springs.kt, tolerance = springs.tolerance;
    // Also simple shears, which turn the bonds, and a lattice whose axes are not those of the cell's
    // coordinates.
    const Matrix3d turn = Eigen::AngleAxisd(0.7, Vector3d(1, 2, -0.5).normalized()).toRotationMatrix();
    const double c11 = std::sqrt(2.0) * (kn + kt);
    for (const Matrix3d& q : {Matrix3d(Matrix3d::Identity()), turn})
        for (int k = 0; k < 3; ++k)
            for (int l = 0; l < 3; ++l) {
                Matrix3d direction = Matrix3d::Zero();
                direction(k, l) = 1;
                const Matrix3d s = response(springs, direction, false, q);
                for (int i = 0; i < 3; ++i)
                    for (int j = 0; j < 3; ++j)
                        EXPECT_NEAR(s(i, j), blocked_stiffness(kn, kt, i, j, k, l, q), tolerance * c11)
                            << i << j << k << l;
            }
}

TEST_P(BlockedLattice, RigidTurningOfTheCellStrainsTheBlockedContacts) {
    // K_12kl W_kl with W_12 = -W_21 = 1: 1/V sum D^2 k_t n_2^2 = 2 sqrt(2) k_t / D, from four bonds with
    // n_2^2 = 1/2.
    Matrix3d spin = Matrix3d::Zero();
    spin(0, 1) = 1;
    spin(1, 0) = -1;
    const Springs& springs = GetParam();
    const Matrix3d s = response(springs, spin, false);
    EXPECT_NEAR(s(0, 1), 2 * std::sqrt(2.0) * springs.kt, springs.tolerance * springs.kn);
    EXPECT_NEAR(s(1, 0), -2 * std::sqrt(2.0) * springs.kt, springs.tolerance * springs.kn);
}

INSTANTIATE_TEST_SUITE_P(Laws, BlockedLattice,
                         testing::Values(linear_cohesive(), linear_damped(), hertz_mindlin()),
                         [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace loam::engine
