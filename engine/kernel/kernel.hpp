// The two loops that take nearly all of the time, compiled once for each instruction set and chosen at run
// time. This header must stay free of inline code of other libraries: it is compiled with flags that the rest
// is not.
#pragma once

#include <cstddef>
#include <cstdint>

namespace loam::engine {

struct ParticleRow;
struct SpinRow;
struct ForceRow;

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
    const double *radius_sum, *stiffness_length, *area;
    double *shear_x, *shear_y, *shear_z, *bond;
    double velocity_gradient[9];  // row-major
    double dt;
    // linear-cohesive (De Pue et al. 2019, eqs 1-7)
    double normal_modulus;  // k_n = normal_modulus × stiffness_length
    double stiffness_ratio;
    double friction_coefficient;
    double normal_cohesion;
    double shear_cohesion;
    double tension_range;  // gap over R_i + R_j up to which tension can act
    bool fragile;          // cohesion is lost for good when its limit is passed
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
    double power;           // W of the stresses in the velocity gradient, compression positive
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
};

/// What a step sums up beside moving the particles.
enum class Measure { nothing, energies, all };  // energies: only power and dissipation

/// One instruction set's version of the loops, by free rotation and Measure.
struct KernelTable {
    const char* name;
    void (*contacts[2][3])(const ContactArguments&, ContactSums&);
    void (*integrate[2][3])(const IntegrateArguments&, IntegrateSums&);
};

extern const KernelTable kernel_avx512;
extern const KernelTable kernel_avx2;
extern const KernelTable kernel_baseline;

/// The fastest table that this processor runs. LOAM_KERNEL=avx512|avx2|baseline in the environment overrides
/// it.
const KernelTable& select_kernel();

}  // namespace loam::engine
