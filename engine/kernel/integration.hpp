// The loop over particles.
#pragma once

#include "engine/kernel/kernel.hpp"
#include "engine/kernel/vector.hpp"
#include "engine/state.hpp"

namespace loam::engine {
namespace {

/// What the deforming frame and the damping are for two particles at once.
struct Motion {
    v8 half_dt, dt_space, along[3], kept_against, kept_with;

    explicit Motion(const IntegrateArguments& a) {
        const double *L = a.velocity_gradient, dt = a.dt;
        half_dt = splat_as<v8>(0.5 * dt);
        dt_space = twice(dt, dt, dt);
        for (int k = 0; k < 3; ++k) along[k] = dt_space * twice(L[k], L[3 + k], L[6 + k]);
        kept_with = splat_as<v8>(1 - a.damping);
        kept_against = splat_as<v8>(1 + a.damping);
    }
    /// Part of the force that damping leaves, from the power of the force.
    v8 kept(v8 power) const {
        const v8 loss = choose(power < 0.0, kept_against, splat_as<v8>(1.0));
        return choose(power > 0.0, kept_with, loss);
    }
};

/// Cundall's local damping and leap-frog integration in the deforming frame; also clears the forces.
/// dw/dt = F/m for the velocity w relative to L·x, dx/dt = w + L·x. Two particles in one vector; the fourth
/// and the eighth lane keep what stands beside the three components.
template <bool Rotation, Measure measure>
void integrate(const IntegrateArguments& a, IntegrateSums& sums) {
    const Motion motion(a);
    const v8 zero = splat_as<v8>(0.0);
    v8 speed2_max = zero, lost = zero, kinetic = zero;
    double force_norm = 0;
    for (std::size_t p = 0; p < a.count; p += 2) {  // after an odd number comes a dummy, which stays at rest
        double* row[2] = {a.particles[p].x, a.particles[p + 1].x};
        double* force_row[2] = {a.forces[p].force, a.forces[p + 1].force};
        const v8 row0 = load8(row[0]), row1 = load8(row[1]);
        const v8 x = lower_halves(row0, row1), v = upper_halves(row0, row1);
        const v8 f = join(load4(force_row[0]), load4(force_row[1]));
        const v8 inverse_mass = spread<3>(v);
        const v8 kick = inverse_mass * f;
        const v8 kept = motion.kept(f * (v + motion.half_dt * kick));
        const v8 v_new = v + (kept * kick) * (2.0 * motion.half_dt);
        const v8 x_new = x + motion.dt_space * v_new + motion.along[0] * spread<0>(x) +
                         motion.along[1] * spread<1>(x) + motion.along[2] * spread<2>(x);
        store8(row[0], lower_halves(x_new, v_new));
        store8(row[1], upper_halves(x_new, v_new));
        store4(force_row[0], lower_half(zero));
        store4(force_row[1], lower_half(zero));
        const v8 speed2 = v_new * v_new;
        speed2_max = larger(speed2_max, speed2);
        if constexpr (measure != Measure::nothing) lost += (f - kept * f) * (v + v_new);
        if constexpr (measure == Measure::all) {
            kinetic += without_fourth(speed2 / inverse_mass);
            force_norm += norm_of(f, 0) + norm_of(f, 4);
        }
        if constexpr (Rotation) {
            double* spin_row[2] = {a.spins[p].radius_spin, a.spins[p + 1].radius_spin};
            const v8 spin = upper_halves(load8(spin_row[0]), load8(spin_row[1]));
            const v8 moment = spread<3>(x) * join(load4(a.forces[p].moment_per_radius),
                                                  load4(a.forces[p + 1].moment_per_radius));
            const v8 inverse_inertia = spread<3>(spin);
            const v8 turn = inverse_inertia * moment;
            const v8 left = motion.kept(moment * (spin + motion.half_dt * turn));
            const v8 spin_new = spin + (left * turn) * (2.0 * motion.half_dt);
            const v8 radius_spin = without_fourth(spread<3>(x) * spin_new);
            store8(spin_row[0], lower_halves(radius_spin, spin_new));
            store8(spin_row[1], upper_halves(radius_spin, spin_new));
            store4(a.forces[p].moment_per_radius, lower_half(zero));
            store4(a.forces[p + 1].moment_per_radius, lower_half(zero));
            if constexpr (measure != Measure::nothing) lost += (moment - left * moment) * (spin + spin_new);
            if constexpr (measure == Measure::all)
                kinetic += without_fourth(spin_new * spin_new / inverse_inertia);
        }
    }
    double bound = 0;  // of the largest speed: every component's largest square
    for (int k = 0; k < 3; ++k) {
        const double first = lane(speed2_max, k), second = lane(speed2_max, k + 4);
        bound += first > second ? first : second;
    }
    sums = {bound, force_norm, 0.5 * sum(kinetic), 0.5 * a.dt * sum(lost)};
}

}  // namespace
}  // namespace loam::engine
