#include "engine/walls.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "engine/kernel/kernel.hpp"
#include "engine/neighbours.hpp"

namespace loam::engine {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr std::int32_t no_wall_bond = -1;

Vector3d position(const ParticleRow& row) {
    return {row.x[0], row.x[1], row.x[2]};
}

double within_unit(double x) {
    return std::min(1.0, std::max(0.0, x));
}

}  // namespace

void Walls::add(const Wall& wall) {
    wall.validate();
    State state;
    state.wall = wall;
    state.built_centre = wall.centre();
    state.normal = wall.normal();
    state.friction_coefficient = std::tan(wall.friction_angle);
    state.per_a = wall.edge_a / wall.edge_a.squaredNorm();
    state.per_b = wall.edge_b / wall.edge_b.squaredNorm();
    walls_.push_back(std::move(state));
    find_fastest();
}

void Walls::set_velocity(std::size_t k, const Vector3d& velocity) {
    if (!velocity.allFinite())
        throw std::invalid_argument("wall " + std::to_string(k) + ": its velocity must be finite");
    at(k).wall.velocity = velocity;
    find_fastest();
}

void Walls::find_fastest() {
    fastest_ = 0;
    for (const State& state : walls_) fastest_ = std::max(fastest_, state.wall.velocity.norm());
}

void Walls::set_history(std::size_t history) {
    history_ = history;
    for (State& state : walls_) {
        state.pairs.further.resize(history);
        for (auto& values : state.pairs.further) values.resize(state.pairs.padded());
    }
}

void Walls::drive(std::size_t k, const WallDrive& drive) {
    drive.validate();
    at(k).drive = drive;
    if (drive.speed_per_force == 0) at(k).mean_speed = 0;
}

void Walls::follow_drive(State& state) {
    const WallDrive& drive = state.drive;
    const double missing = drive.force + state.force.dot(state.normal);
    const double speed =
        std::clamp(missing * drive.speed_per_force + state.mean_speed, -drive.limit, drive.limit);
    state.mean_speed += (speed - state.mean_speed) / drive.mean_over;
    Vector3d& v = state.wall.velocity;
    v += (speed - v.dot(state.normal)) * state.normal;
}

/// Normal to the wall a sphere is near within its reach. Along the wall the rectangle may slide past the
/// sphere when the mean field deforms, by up to the reach times half of its own size, until the lists are
/// made anew.
void Walls::find_near(std::size_t number, const AlignedVector<ParticleRow>& particles, std::size_t count,
                      double reach) {
    const Wall& wall = at(number).wall;
    const Vector3d n = at(number).normal, c = wall.centre();
    const double half_a = 0.5 * wall.edge_a.norm(), half_b = 0.5 * wall.edge_b.norm();
    const Vector3d a = wall.edge_a.normalized(), b = wall.edge_b.normalized();
    const double slide = reach * std::hypot(half_a, half_b);
    near_.clear();
    for (std::size_t p = 0; p < count; ++p) {
        const Vector3d d = position(particles[p]) - c;
        const double normal = d.dot(n), along_a = std::abs(d.dot(a)), along_b = std::abs(d.dot(b));
        if (wall.one_sided && normal < 0 && along_a < half_a && along_b < half_b)
            throw std::runtime_error("a particle has got behind wall " + std::to_string(number) + ", by " +
                                     std::to_string(-normal) + " m");
        const double within = particles[p].radius * (1 + 2 * reach);
        const bool bonded = bond_of_[p] != no_wall_bond;
        const bool close = std::abs(normal) < within && along_a < half_a + within + slide &&
                           along_b < half_b + within + slide;
        if (close || bonded) near_.push_back(static_cast<std::int32_t>(p));
    }
}

void Walls::fill_pairs(State& state, const AlignedVector<ParticleRow>& particles, std::size_t count) {
    PairList& out = state.pairs;
    out.further.resize(history_);
    out.resize_padded(near_.size());
    double sum = 0;
    for (std::size_t k = 0; k < out.count; ++k) {
        const std::int32_t i = near_[k];
        const double r = particles[static_cast<std::size_t>(i)].radius;
        out.i[k] = i;
        out.j[k] = static_cast<std::int32_t>(state.first_foot + k);
        out.row_i[k] = row_offset(i);
        out.row_j[k] = row_offset(out.j[k]);
        out.image[k] = image_home;
        // A flat and rigid wall: all of the overlap is the sphere's.
        out.radius_sum[k] = out.reduced_radius[k] = r;
        out.area[k] = r * r;
        sum += r * r;
        const std::int32_t bond = bond_of_[static_cast<std::size_t>(i)];
        const auto from = static_cast<std::size_t>(bond);
        for (std::size_t q = 0; q < 3; ++q)
            out.shear[q][k] = bond == no_wall_bond ? 0.0 : old_.shear[q][from];
        out.bond[k] = bond == no_wall_bond ? bond_none : old_.bond[from];
        for (std::size_t q = 0; q < out.further.size(); ++q)
            out.further[q][k] =
                bond == no_wall_bond || old_.further.size() <= q ? 0.0 : old_.further[q][from];
    }
    state.mean_radius_squared = out.count > 0 ? sum / static_cast<double>(out.count) : 0;
    fill_with_dummies(out, out.count, out.padded(), count);
}

void Walls::rebuild(AlignedVector<ParticleRow>& particles, AlignedVector<SpinRow>& spins,
                    AlignedVector<ForceRow>& forces, std::size_t count, double reach) {
    std::size_t rows = count + 2;
    for (std::size_t number = 0; number < walls_.size(); ++number) {
        State& state = walls_[number];
        std::swap(state.pairs, old_);
        bond_of_.assign(count, no_wall_bond);
        for (std::size_t k = 0; k < old_.count; ++k)
            if (old_.bond[k] != bond_none)
                bond_of_[static_cast<std::size_t>(old_.i[k])] = static_cast<std::int32_t>(k);
        find_near(number, particles, count, reach);
        state.first_foot = rows;
        rows += near_.size();
        fill_pairs(state, particles, count);
        state.built_centre = state.wall.centre();
    }
    if (particles.size() < rows) {
        ParticleRow foot{};
        foot.inverse_mass = 1;
        particles.resize(rows + rows / 8, foot);
        forces.resize(particles.size(), ForceRow{});
        SpinRow still{};
        still.inverse_inertia = 1;
        if (!spins.empty()) spins.resize(particles.size(), still);
    }
}

/// A rigid wall does not follow the deformation of the field: away from its centre it moves against the
/// field. Returns the smallest d² - R²/4, or 0.
template <bool still>
double Walls::place_feet(const State& state, ParticleRow* particles, const Matrix3d& gradient) {
    const Vector3d o = state.wall.origin, a = state.wall.edge_a, b = state.wall.edge_b, per_a = state.per_a,
                   per_b = state.per_b;
    const Vector3d v =
        still ? state.wall.velocity : Vector3d(state.wall.velocity + gradient * state.wall.centre());
    ParticleRow* foot = particles + state.first_foot;
    double closest = 0;
    for (std::size_t k = 0; k < state.pairs.count; ++k, ++foot) {
        const ParticleRow& sphere = particles[state.pairs.i[k]];
        const Vector3d d = position(sphere) - o;
        const Vector3d along = within_unit(d.dot(per_a)) * a + within_unit(d.dot(per_b)) * b, x = o + along;
        const Vector3d velocity = still ? v : Vector3d(v - gradient * x);
        for (int p = 0; p < 3; ++p) {
            foot->x[p] = x[p];
            foot->v[p] = velocity[p];
        }
        closest = std::min(closest, (d - along).squaredNorm() - 0.25 * sphere.radius * sphere.radius);
    }
    return closest;
}

void Walls::place_feet(ParticleRow* particles, const Matrix3d& gradient) {
    const bool still = gradient.isZero(0);
    for (const State& state : walls_)
        closest_ = std::min(closest_, still ? place_feet<true>(state, particles, gradient)
                                            : place_feet<false>(state, particles, gradient));
}

double Walls::take_forces(const ParticleRow* particles, ForceRow* forces) {
    double power = 0;
    for (State& state : walls_) {
        double sum[3] = {};
        for (std::size_t k = 0; k < state.pairs.count; ++k) {
            ForceRow& row = forces[state.first_foot + k];
            const double* v = particles[state.first_foot + k].v;
            for (int p = 0; p < 3; ++p) {
                sum[p] += row.force[p];
                power += row.force[p] * v[p];
            }
            row = ForceRow{};
        }
        state.force = {sum[0], sum[1], sum[2]};
    }
    return power;
}

void Walls::move(double dt, const Matrix3d& gradient) {
    bool driven = false;
    for (State& state : walls_) {
        if (state.drive.speed_per_force > 0) {
            follow_drive(state);
            driven = true;
        }
        state.wall.origin += dt * (gradient * state.wall.centre() + state.wall.velocity);
    }
    if (driven) find_fastest();
}

void Walls::record(std::size_t k, const ContactSums& sums) {
    State& state = at(k);
    state.contacts = sums.contacts;
    state.stiffness = sums.contacts > 0 ? sums.stiffness_sum / state.mean_radius_squared : 0;
}

double Walls::contacts() const {
    double sum = 0;
    for (const State& state : walls_) sum += state.contacts;
    return sum;
}

/// Bound on the speed normal to a rigid wall at which the field passes it away from its centre.
double Walls::turning(const State& state, const Matrix3d& gradient) {
    const Eigen::RowVector3d n = state.normal.transpose() * gradient;
    return 0.5 * (std::abs(n.dot(state.wall.edge_a)) + std::abs(n.dot(state.wall.edge_b)));
}

double Walls::largest_speed(const Matrix3d& gradient) const {
    double largest = 0;
    if (!gradient.isZero(0))
        for (const State& state : walls_) largest = std::max(largest, turning(state, gradient));
    return fastest_ + largest;
}

double Walls::motion_since_build(const Matrix3d& deformation) const {
    double largest = 0;
    for (const State& state : walls_) {
        const double way = (state.wall.centre() - deformation * state.built_centre).norm();
        largest = std::max(largest, way + turning(state, deformation));
    }
    return largest;
}

}  // namespace loam::engine
