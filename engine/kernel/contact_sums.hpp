// What the loop over contacts sums up beside forces.
#pragma once

#include "engine/kernel/columns.hpp"

namespace loam::engine {
namespace {

LOAM_INLINE Column compliance(Column stiffness) {
    return choose(stiffness > 0.0, splat(1.0) / stiffness, splat(0.0));
}

/// A spring's history in one step: before it, with the step's displacement, and after it has given way.
struct SpringStep {
    Column3 before, trial, now;
    Column stiffness;
};

/// Lanes of the sums over contacts.
struct ContactLanes {
    Column power = {}, lost = {}, stress[9] = {}, normal = {}, elastic = {}, stiffness = {}, active = {},
           overlap = {}, cement = {};

    /// What sliding takes out of a spring: the mean of the force before and after, times the slip.
    void add_sliding(const SpringStep& s) {
        const Column3 sum = {s.before.x + s.now.x, s.before.y + s.now.y, s.before.z + s.now.z};
        lost += 0.5 * (compliance(s.stiffness) * dot(sum, minus(s.trial, s.now)));
    }
    /// The same with a dashpot beside the spring: `force` is of both, `slip` the displacement of the step.
    void add_damped_sliding(const SpringStep& s, const Column3& force, const Column3& slip) {
        const Column3 mean = {force.x + 0.5 * (s.before.x - s.now.x), force.y + 0.5 * (s.before.y - s.now.y),
                              force.z + 0.5 * (s.before.z - s.now.z)};
        lost +=
            dot(mean, slip) - 0.5 * compliance(s.stiffness) * (dot(s.now, s.now) - dot(s.before, s.before));
    }
    /// A change of a spring's stiffness, with its force.
    void add_rescale(const Column3& before, Column stiffness_before, const Column3& now,
                     Column stiffness_now) {
        lost += 0.5 * (compliance(stiffness_before) * dot(before, before) -
                       compliance(stiffness_now) * dot(now, now));
    }
    void add_stored(const Column3& spring, Column stiffness_of_spring, Column twice_normal) {
        elastic += 0.5 * (compliance(stiffness_of_spring) * dot(spring, spring) + twice_normal);
    }
    void add_contacts(Mask on, const Column3& f, const Column3& branch, Column fn, Column kn,
                      Column overlap_now, Column radius_sum) {
        const Column zero = splat(0.0), one = splat(1.0);
        const Column of_f[3] = {f.x, f.y, f.z}, of_branch[3] = {branch.x, branch.y, branch.z};
        for (int p = 0; p < 3; ++p)
            for (int q = 0; q < 3; ++q) stress[3 * p + q] -= of_f[p] * of_branch[q];
        normal += choose(fn < 0, -fn, fn);
        active += choose(on, one, zero);
        stiffness += choose(on, kn * dot(branch, branch), zero);
        overlap = larger(overlap, choose(on, overlap_now / radius_sum, zero));
    }
    void finish(ContactSums& out) const {
        for (int p = 0; p < 9; ++p) out.stress[p] = sum(stress[p]);
        out.normal_force = sum(normal);
        out.elastic_energy = sum(elastic);
        out.stiffness_sum = sum(stiffness);
        out.contacts = sum(active);
        out.dissipation = sum(lost);
        out.power = sum(power);
        out.cemented = sum(cement);
        out.max_overlap = 0;
        for (int l = 0; l < lanes; ++l)
            if (lane(overlap, l) > out.max_overlap) out.max_overlap = lane(overlap, l);
    }
};

}  // namespace
}  // namespace loam::engine
