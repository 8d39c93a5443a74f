// Effects on contacts in packings: strength 0 is the base law bit for bit; the loop that contacts with
// effects go through is the base law where their strengths vanish; hertzian_stiffness leaves the mean
// stiffness at its reference pressure; packings come to rest at the time step that the engine chooses.
#include <gtest/gtest.h>

#include <functional>

#include "engine/loading.hpp"
#include "engine/simulation.hpp"
#include "tests/verification/lattice.hpp"

namespace loam::engine {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix3Xd;

struct Effect {
    const char* name;
    std::function<void(ContactLaw&, double)> set;  // to this share of a noticeable strength
};

const std::vector<Effect>& all_effects() {
    static const std::vector<Effect> effects{
        {"adhesion", [](ContactLaw& law, double x) { law.adhesion.stress = x * 1e5; }},
        {"capillarity", [](ContactLaw& law, double x) { law.capillarity.suction = x * 1e5; }},
        {"cementation", [](ContactLaw& law, double x) { law.cementation.strength = x * 1e5; }},
        {"hertzian_stiffness", [](ContactLaw& law, double x) { law.hertzian.share = x; }},
        {"plastic_contact", [](ContactLaw& law, double x) { law.plastic.share = 0.5 * x; }},
    };
    return effects;
}

std::vector<ContactLaw> base_laws() {
    LinearCohesive cohesive;
    cohesive.normal_cohesion = cohesive.shear_cohesion = 2e4;
    return {ContactLaw(cohesive), ContactLaw(LinearDamped{}), ContactLaw(HertzMindlin{})};
}

bool go_together(const ContactLaw& law, const Effect& effect) {
    return law.base.index() != 2 || std::string(effect.name) != "hertzian_stiffness";
}

Packing test_packing() {
    PackingOptions options;
    options.particles = 200;
    return make_packing(options).packing;
}

/// Centres after compression, during which contacts slide, break and form.
Matrix3Xd compressed(const Packing& packing, const ContactLaw& law, bool free_rotation) {
    SimulationOptions how;
    how.free_rotation = free_rotation;
    how.largest_overlap = 0.05;
    how.time_step_safety = 0.2;
    Simulation simulation(packing, law, how);
    simulation.advance(1);
    simulation.cement_contacts();
    Matrix3d gradient = Matrix3d::Zero();
    gradient(2, 2) = -2e-5 / simulation.time_step();
    gradient(0, 2) = 2e-5 / simulation.time_step();
    simulation.set_velocity_gradient(gradient);
    simulation.advance(400);
    return simulation.packing().centres;
}

TEST(EffectsInPackings, OfStrengthZeroAreTheBaseLawBitForBit) {
    const Packing packing = test_packing();
    for (const bool free_rotation : {false, true})
        for (const ContactLaw& base : base_laws()) {
            const Matrix3Xd without = compressed(packing, base, free_rotation);
            for (const Effect& effect : all_effects()) {
                if (!go_together(base, effect)) continue;
                ContactLaw law = base;
                effect.set(law, 0);
                EXPECT_EQ(compressed(packing, law, free_rotation), without) << effect.name;
                effect.set(law, 1);
                EXPECT_NE(compressed(packing, law, free_rotation), without) << effect.name;
            }
        }
}

TEST(EffectsInPackings, TheirLoopIsTheBaseLawWhereStrengthsVanish) {
    // The same motion in another order of rounding, 400 steps long: 1e-10 of a diameter.
    const Packing packing = test_packing();
    for (const bool rolling : {false, true})
        for (ContactLaw law : base_laws()) {
            if (rolling) law.rolling.friction = 0.1;
            const Matrix3Xd base = compressed(packing, law, rolling);
            law.capillarity.suction = 1e-200;
            const Matrix3Xd other = compressed(packing, law, rolling);
            EXPECT_LT((other - base).cwiseAbs().maxCoeff(), 1e-10 * 0.11) << law.base.index();
        }
}

TEST(EffectsInPackings, HertzianStiffnessLeavesThatOfTheReferencePressure) {
    // In a face-centred lattice the pressure is sqrt(8) F/l² for the force F and the distance l; the force is
    // 4 P R² at the pressure sqrt(8) P (2R/l)², where solid fraction times coordination number is more than
    // pi. Differences over 1 % of the overlap: 1e-4.
    const double reference = 2e5, radius = 0.5, k = 1e8 * radius;
    for (const double share : {0.0, 0.4, 1.0}) {
        LinearCohesive base;
        base.young_modulus = 1e8;
        ContactLaw law(base);
        law.hertzian = {.share = share, .reference_pressure = reference};
        const double overlap = 4 * reference * radius * radius / (k * (1 - share / 3)), h = 0.01 * overlap;
        const auto force_at = [&](double u, double* affine) {
            Simulation simulation(face_centred_cubic(2, 2 * radius - u), law, SimulationOptions{});
            const Measurement& now = simulation.advance(1);
            if (affine != nullptr) *affine = now.affine_stiffness * simulation.volume();
            const double distance = 2 * radius - u;
            return now.mean_stress * distance * distance / std::sqrt(8.0);
        };
        double affine = 0;
        EXPECT_NEAR(force_at(overlap, &affine), reference, 1e-9 * reference) << share;  // 4 P R²
        EXPECT_NEAR((force_at(overlap + h, nullptr) - force_at(overlap - h, nullptr)) / (2 * h), k, 1e-4 * k)
            << share;
        const double bonds = 6 * 32, distance = 2 * radius - overlap;
        EXPECT_NEAR(affine, bonds * k * distance * distance / 9, 1e-9 * affine) << share;
    }
}

TEST(EffectsInPackings, ComeToRestUnderPressureAndKeepIt) {
    // A time step too long for the springs would shake the packing for ever.
    const Packing packing = test_packing();
    for (const bool free_rotation : {false, true})
        for (const ContactLaw& base : base_laws())
            for (const Effect& effect : all_effects()) {
                if (!go_together(base, effect)) continue;
                ContactLaw law = base;
                std::visit([](auto& one) { one.young_modulus = 2e8; }, law.base);
                effect.set(law, 1);
                SimulationOptions how;
                how.free_rotation = free_rotation;
                Simulation simulation(packing, law, how);
                const ServoSummary rest = consolidate(simulation, 1e5, ServoOptions{}, {});
                EXPECT_TRUE(rest.converged) << effect.name << " on " << law.base.index();
            }
}

}  // namespace
}  // namespace loam::engine
