// The two loops that take nearly all of the time, compiled once for each instruction set and chosen at run
// time. This header must stay free of inline code of other libraries: it is compiled with flags that the rest
// is not.
#pragma once

#include <cstddef>
#include <cstdint>

#include "engine/contact/law_numbers.hpp"

namespace loam::engine {

struct ParticleRow;
struct SpinRow;
struct ForceRow;

/// Doubles of history for each contact beyond shear force and bond.
inline constexpr int max_further_history = 6;

/// How particles turn: not, freely, or against rolling resistance.
enum class Turning { blocked, free, resisted };

/// What the contact loop needs, as plain pointers and numbers (SI). Arrays are 64-byte aligned and padded to
/// eight pairs.
struct ContactArguments {
    const ParticleRow* particles;
    const SpinRow* spins;  // only read with free rotation
    ForceRow* forces;      // added to
    const double* shifts;  // [27][8]: cell shift of every image, x y z then zeros
    std::size_t padded_pairs;
    const std::uint32_t *row_i, *row_j;  // where the particles' rows start (bytes)
    const std::int32_t* image;
    const double *radius_sum, *reduced_radius, *area;
    double *shear_x, *shear_y, *shear_z, *bond;
    double velocity_gradient[9];  // row-major
    double dt;
    LawNumbers law;
    double* further[max_further_history];  // history of sub-models, in the order of their declaration
};

/// Sums over all contacts. Stress sums are -F_a·l_b (compression positive), to be divided by the volume.
struct ContactSums {
    double stress[9];
    double normal_force;    // sum of |F_n|
    double elastic_energy;  // J
    double stiffness_sum;   // sum of k_n l²: the affine stiffness, for the servo
    double contacts;        // number of active contacts
    double max_overlap;     // largest overlap over R_i + R_j
    double dissipation;     // J lost in this step by sliding and by breaking cohesion
    double cemented;        // number of contacts whose cement holds
    double power;           // W of the stresses in the velocity gradient, compression positive

    ContactSums& operator+=(const ContactSums& part) {
        for (int k = 0; k < 9; ++k) stress[k] += part.stress[k];
        normal_force += part.normal_force;
        elastic_energy += part.elastic_energy;
        stiffness_sum += part.stiffness_sum;
        contacts += part.contacts;
        if (part.max_overlap > max_overlap) max_overlap = part.max_overlap;
        dissipation += part.dissipation;
        cemented += part.cemented;
        power += part.power;
        return *this;
    }
};

struct IntegrateArguments {
    ParticleRow* particles;
    SpinRow* spins;     // nullptr with blocked rotation
    ForceRow* forces;   // set to zero again
    std::size_t count;  // without the dummies, of which an odd count takes one along
    double velocity_gradient[9];
    double dt;
    double damping;  // Cundall's local damping
};

struct IntegrateSums {
    double max_speed_squared;  // bound on it, for velocities relative to the mean field
    double force_norm;         // sum of |F|, only when measured
    double kinetic_energy;     // of the same velocities, only when measured
    double dissipation;        // J taken out by damping in this step, only when measured

    IntegrateSums& operator+=(const IntegrateSums& part) {
        if (part.max_speed_squared > max_speed_squared) max_speed_squared = part.max_speed_squared;
        force_norm += part.force_norm;
        kinetic_energy += part.kinetic_energy;
        dissipation += part.dissipation;
        return *this;
    }
};

/// What a step sums up beside moving the particles.
enum class Measure { nothing, energies, all };  // energies: only power and dissipation

using ContactLoop = void (*)(const ContactArguments&, ContactSums&);

/// The loops over contacts by base law (in the order of ContactLaw::base), Turning and Measure.
struct ContactLoops {
    ContactLoop by[3][3][3];
};

/// One instruction set's version of the loops.
struct KernelTable {
    const char* name;
    ContactLoops contacts;
    const ContactLoops* with_effects;                                    // contact/with_effects.hpp
    void (*integrate[2][3])(const IntegrateArguments&, IntegrateSums&);  // by free rotation and Measure
};

extern const KernelTable kernel_avx512;
extern const KernelTable kernel_avx2;
extern const KernelTable kernel_baseline;
extern const ContactLoops effects_avx512;
extern const ContactLoops effects_avx2;
extern const ContactLoops effects_baseline;

/// The fastest table that this processor runs. LOAM_KERNEL=avx512|avx2|baseline in the environment overrides
/// it.
const KernelTable& select_kernel();

}  // namespace loam::engine
