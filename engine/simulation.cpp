#include "engine/simulation.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include "engine/contact/composition.hpp"
#include "engine/kernel/kernel.hpp"
#include "engine/neighbours.hpp"
#include "engine/require.hpp"

namespace loam::engine {
namespace {

// Parts of the skin: how far particles may have moved between two looks at their true motion, and the true
// motion at which the list is rebuilt.
constexpr double check_fraction = 0.25;
constexpr double rebuild_fraction = 0.7;

// Of the moments of inertia over those of solid spheres, where they are scaled. On 12 packings of 700 with
// rolling resistance, whose spins ask for 5, inertia of 2.5 moved the mean settlement of direct shear by 0.8
// to 1.5 % of the largest one, and triaxial curves by 0.3 %; 5 moved them twice as far.
constexpr double largest_spin_inertia = 2.5;

/// Adds the time between laps to the parts of the step; idle without them.
class Stopwatch {
  public:
    explicit Stopwatch(StepTimes* times) : times_(times) {
        if (times_ != nullptr) last_ = Clock::now();
    }
    void lap(double StepTimes::*part) {
        if (times_ == nullptr) return;
        const auto now = Clock::now();
        times_->*part += std::chrono::duration<double>(now - last_).count();
        last_ = now;
    }

  private:
    using Clock = std::chrono::steady_clock;
    StepTimes* times_;
    Clock::time_point last_;
};

}  // namespace

void SimulationOptions::validate() const {
    require(damping >= 0 && damping < 1, "damping", damping, "within 0..1 (below 1)");
    require(std::isfinite(grain_density) && grain_density > 0, "grain_density", grain_density,
            "positive (kg/m3)");
    require(time_step_safety > 0 && time_step_safety <= 1.5, "time_step_safety", time_step_safety,
            "within 0..1.5");
    require(threads >= 1, "threads", threads, "at least 1");
    require(largest_overlap >= 0 && largest_overlap <= 0.5, "largest_overlap", largest_overlap,
            "within 0..0.5");
    require(neighbour_skin > 0 && neighbour_skin <= 0.5, "neighbour_skin", neighbour_skin, "within 0..0.5");
}

double EnergyBalance::error() const {
    const double change = stored - stored_start;
    const double scale = std::abs(work) + std::abs(sliding) + std::abs(damping) + std::abs(change);
    return scale > 0 ? std::abs(work - sliding - damping - change) / scale : 0.0;
}

Simulation::Simulation(const Packing& packing, const ContactLaw& law, const SimulationOptions& options)
    : options_(options), kernel_(&select_kernel()), cell_(packing.cell) {
    validate(packing);
    options.validate();
    time_step_overlap_ = options.largest_overlap > 0 ? options.largest_overlap : 0.02;
    count_ = static_cast<std::size_t>(packing.radii.size());
    outside_ = locality_order(packing);
    time_step_radius_ = options.density_scaling ? packing.radii.mean() : packing.radii.minCoeff();
    particles_.resize(count_ + 2);  // and two dummies, which fill the last block of pairs
    forces_.assign(count_ + 2, ForceRow{});
    if (options_.free_rotation) spins_.assign(count_ + 2, SpinRow{});
    double smallest = packing.radii[0], largest = smallest, sum = 0;
    for (std::size_t p = 0; p < count_; ++p) {
        const auto at = static_cast<Eigen::Index>(outside_[p]);
        const double r = packing.radii[at], volume = 4.0 / 3.0 * std::numbers::pi * r * r * r,
                     mass =
                         volume * options_.grain_density * std::max(1.0, std::pow(time_step_radius_ / r, 2));
        const Eigen::Vector3d x = packing.centres.col(at);
        particles_[p] = {{x.x(), x.y(), x.z()}, r, {0, 0, 0}, 1.0 / mass};
        solid_volume_ += volume;
        sum += r;
        smallest = std::min(smallest, r);
        largest = std::max(largest, r);
    }
    // Dummies stay at rest; what is divided by must not be zero.
    if (options_.free_rotation) spins_[count_].inverse_inertia = spins_[count_ + 1].inverse_inertia = 1;
    particles_[count_] = {{0, 0, 0}, 0, {0, 0, 0}, 1};
    particles_[count_ + 1] = {{1, 0, 0}, 0, {0, 0, 0}, 1};
    mean_diameter_ = 2 * sum / static_cast<double>(count_);
    smallest_diameter_ = 2 * smallest;
    largest_diameter_ = 2 * largest;
    slabs_ = Slabs(slab_count(count_, cell_, largest_diameter_));
    crew_ = Crew(slabs_.count() == 1 ? 1 : std::min(options.threads, slabs_.count()));
    set_law(law);
    drift_since_check_ = 1e300;  // forces the first rebuild
}

void Simulation::set_law(const ContactLaw& law) {
    composition_ = compose(law, options_.grain_density, options_.free_rotation);
    law_ = law;
    pairs_.further.resize(composition_.history);
    for (auto& values : pairs_.further) values.resize(pairs_.padded());  // new history starts at zero
    walls_.set_history(composition_.history);
    if (options_.free_rotation) set_spin_inertia();
    set_time_step();
}

/// Solid spheres', or with density scaling as much more as spins must be slowed so that they do not set the
/// time step. For a law and not for its time step, lest kinetic energy change on the way.
void Simulation::set_spin_inertia() {
    const WaveModuli modulus = wave_moduli(law_, composition_, time_step_overlap_);
    spin_inertia_ = options_.density_scaling
                        ? std::clamp(modulus.turning / modulus.moving, 1.0, largest_spin_inertia)
                        : 1.0;
    for (std::size_t p = 0; p < count_; ++p) {
        const double r = particles_[p].radius;
        spins_[p].inverse_inertia = 2.5 * particles_[p].inverse_mass / (spin_inertia_ * r * r);
    }
}

std::size_t Simulation::cement_contacts() {
    cemented_ = 0;
    if (law_.cementation.strength == 0) return 0;
    auto& cement = pairs_.further[composition_.memory() + 2];
    for (std::size_t k = 0; k < pairs_.padded(); ++k) {
        const bool touches = pairs_.bond[k] != bond_none && pairs_.bond[k] != bond_apart;
        cement[k] = touches ? 1.0 : 0.0;
        if (touches) ++cemented_;
    }
    return cemented_;
}

/// The time of a p-wave across the smallest particle that is not made heavier, times the safety factor
/// (Smilauer et al. 2015).
void Simulation::set_time_step() {
    const WaveModuli modulus = wave_moduli(law_, composition_, time_step_overlap_);
    dt_ = options_.time_step_safety * time_step_radius_ *
          std::sqrt(options_.grain_density / std::max(modulus.moving, modulus.turning / spin_inertia_));
}

/// Hertzian contacts stiffen with their overlap: the time step is made for twice the largest one, and made
/// anew when that has been passed or has become far too large.
void Simulation::follow_stiffness() {
    if (!stiffens(law_) || options_.largest_overlap > 0 || measured_.max_overlap <= 0) return;
    const double wanted = std::clamp(2 * measured_.max_overlap, 1e-7, 0.5);
    if (1.5 * measured_.max_overlap < time_step_overlap_ && time_step_overlap_ < 4 * wanted) return;
    time_step_overlap_ = wanted;
    set_time_step();
}

double Simulation::volume() const {
    return reference_volume_ > 0 ? reference_volume_ : cell_.determinant();
}

const Measurement& Simulation::advance(int steps) {
    for (int k = 1; k < steps; ++k) {
        const bool first = steps_ == 0;  // the energy balance starts from what is stored then
        step(!options_.energy_balance ? Measure::nothing : first ? Measure::all : Measure::energies);
    }
    step(Measure::all);
    const double speed = measured_.kinetic_energy;
    if (!std::isfinite(measured_.mean_stress) || !std::isfinite(speed))
        throw std::runtime_error(
            "the simulation is numerically broken: stress or velocity is not a finite number");
    if (measured_.max_overlap > 0.5)
        throw std::runtime_error(
            "particles overlap by more than half of their size: the contacts are too soft");
    if (walls_.pierced())
        throw std::runtime_error("a particle was pressed into a wall by half of its radius or more");
    follow_stiffness();
    return measured_;
}

void Simulation::step(Measure measure) {
    ContactSums contacts{};
    IntegrateSums motion{};
    Stopwatch watch(times_);
    update_neighbours();
    watch.lap(&StepTimes::neighbours);
    contact_forces(contacts, measure);
    watch.lap(&StepTimes::contacts);
    integrate(motion, measure);
    watch.lap(&StepTimes::integration);
    if (measure == Measure::all) record(contacts, motion);
    if (options_.energy_balance) balance_energy(contacts, motion, measure);
    deform_cell();
    double speed = std::sqrt(motion.max_speed_squared);
    if (!walls_.empty()) speed = std::max(speed, walls_.largest_speed(gradient_));
    drift_since_check_ +=
        dt_ * (2 * speed / smallest_diameter_ + gradient_.norm() * (1 + options_.neighbour_skin));
    ++steps_;
}

/// Pairs outside of the list were farther apart than the skin when it was built. Relative motion since then
/// is bounded by the speeds at every step; when the bound has grown by a part of the skin the true motion is
/// computed, and the list rebuilt if due. Within the list, too, the bound tells which pairs can have met.
void Simulation::update_neighbours() {
    const double skin = options_.neighbour_skin;
    if (drift_since_check_ > check_fraction * skin || drift_confirmed_ + drift_since_check_ >= skin) {
        const bool listed = built_at_.size() == count_ && drift_since_check_ < 1e299;
        if (listed) {
            drift_confirmed_ = drift_since_build();
            drift_since_check_ = 0;
        }
        if (!listed || drift_confirmed_ >= rebuild_fraction * skin) rebuild_neighbours();
    }
    // A pair that has met may hold a bond: the part of the list that is looked at never shrinks.
    for (std::size_t p = 0; p < pairs_.parts.size(); ++p)
        reachable_[p] = std::max(reachable_[p],
                                 pairs_.within_reach(pairs_.parts[p], drift_confirmed_ + drift_since_check_));
}

/// Bound on the relative motion of any two particles since the last rebuild, over the sum of their radii.
double Simulation::drift_since_build() {
    const auto pieces = static_cast<std::size_t>(slabs_.count());
    std::array<double, most_slabs> furthest{};
    crew_.run(pieces, [&](std::size_t piece) {
        for (std::size_t p = piece * count_ / pieces; p < (piece + 1) * count_ / pieces; ++p) {
            const Eigen::Vector3d x(particles_[p].x[0], particles_[p].x[1], particles_[p].x[2]);
            furthest[piece] = std::max(furthest[piece], (x - cell_ * built_at_[p]).squaredNorm());
        }
    });
    const double largest = *std::ranges::max_element(furthest);
    const Eigen::Matrix3d deformation = cell_ * built_cell_.inverse() - Eigen::Matrix3d::Identity();
    double way = std::sqrt(largest);
    if (!walls_.empty()) way = std::max(way, walls_.motion_since_build(cell_ * built_cell_.inverse()));
    return 2 * way / smallest_diameter_ + deformation.norm() * (1 + options_.neighbour_skin);
}

void Simulation::rebuild_neighbours() {
    if (!walls_.empty()) check_enclosed();
    rebuild_pairs(pairs_, rebuild_buffers_, particles_, count_, cell_, options_.neighbour_skin, slabs_,
                  crew_);
    const Eigen::Matrix3d inverse = cell_.inverse();
    built_at_.resize(count_);
    for (std::size_t p = 0; p < count_; ++p)
        built_at_[p] = inverse * Eigen::Vector3d(particles_[p].x[0], particles_[p].x[1], particles_[p].x[2]);
    built_cell_ = cell_;
    if (!walls_.empty()) walls_.rebuild(particles_, spins_, forces_, count_, options_.neighbour_skin);
    drift_confirmed_ = drift_since_check_ = 0;
    reachable_.assign(pairs_.parts.size(), 0);
    ++rebuilds_;
}

void Simulation::deform_cell() {
    if (!walls_.empty()) walls_.move(dt_, gradient_);
    if (reference_volume_ > 0)
        reference_volume_ *= (Eigen::Matrix3d::Identity() + dt_ * gradient_).determinant();
    cell_ += dt_ * (gradient_ * cell_);
}

void Simulation::record(const ContactSums& contacts, const IntegrateSums& motion) {
    const double v = volume(), n = static_cast<double>(count_);
    for (int p = 0; p < 3; ++p)
        for (int q = 0; q < 3; ++q) measured_.stress(p, q) = contacts.stress[3 * p + q] / v;
    measured_.mean_stress = measured_.stress.trace() / 3;
    measured_.contacts = contacts.contacts;
    measured_.wall_contacts = walls_.contacts();
    measured_.coordination_number = (2 * contacts.contacts + measured_.wall_contacts) / n;
    const double all_contacts = contacts.contacts + measured_.wall_contacts;
    const double mean_contact = all_contacts > 0 ? contacts.normal_force / all_contacts : 0;
    measured_.unbalanced_ratio = mean_contact > 0 ? motion.force_norm / n / mean_contact : 1.0;
    measured_.max_overlap = contacts.max_overlap;
    measured_.affine_stiffness = contacts.stiffness_sum / (9 * v);
    measured_.elastic_energy = contacts.elastic_energy;
    measured_.kinetic_energy = motion.kinetic_energy;
    if (cemented_ > 0) measured_.broken_bond_ratio = 1 - contacts.cemented / static_cast<double>(cemented_);
}

void Simulation::balance_energy(const ContactSums& contacts, const IntegrateSums& motion, Measure measure) {
    if (measure == Measure::all) energy_.stored = contacts.elastic_energy + motion.kinetic_energy;
    if (steps_ == 0) energy_.stored_start = energy_.stored;
    // Trapezoidal: the stress of both ends of every step, so that the error is of second order.
    const double half_work = -0.5 * dt_ * contacts.power;
    if (steps_ > 0) energy_.work += half_work_ + half_work;
    half_work_ = half_work;
    energy_.sliding += contacts.dissipation;
    energy_.damping += motion.dissipation;
}

void Simulation::restart_energy_balance() {
    const double stored = measured_.elastic_energy + measured_.kinetic_energy;
    energy_ = {};
    energy_.stored_start = energy_.stored = stored;
}

void Simulation::set_velocities(const Eigen::Matrix3Xd& velocities) {
    if (velocities.cols() != static_cast<Eigen::Index>(count_) || !velocities.allFinite())
        throw std::invalid_argument("velocities: one finite column for each particle is needed");
    for (std::size_t p = 0; p < count_; ++p)
        for (int k = 0; k < 3; ++k) particles_[p].v[k] = velocities(k, outside_[p]);
    drift_since_check_ = 1e300;
}

Eigen::Matrix3Xd Simulation::velocities() const {
    Eigen::Matrix3Xd out(3, static_cast<Eigen::Index>(count_));
    for (std::size_t p = 0; p < count_; ++p)
        for (int k = 0; k < 3; ++k) out(k, outside_[p]) = particles_[p].v[k];
    return out;
}

void Simulation::set_spins(const Eigen::Matrix3Xd& spins) {
    if (!options_.free_rotation) throw std::invalid_argument("spins: rotations are blocked");
    if (spins.cols() != static_cast<Eigen::Index>(count_) || !spins.allFinite())
        throw std::invalid_argument("spins: one finite column for each particle is needed");
    for (std::size_t p = 0; p < count_; ++p)
        for (int k = 0; k < 3; ++k) {
            spins_[p].spin[k] = spins(k, outside_[p]);
            spins_[p].radius_spin[k] = particles_[p].radius * spins_[p].spin[k];
        }
}

Eigen::Matrix3Xd Simulation::spins() const {
    Eigen::Matrix3Xd out = Eigen::Matrix3Xd::Zero(3, static_cast<Eigen::Index>(count_));
    for (std::size_t p = 0; p < spins_.size() && p < count_; ++p)
        for (int k = 0; k < 3; ++k) out(k, outside_[p]) = spins_[p].spin[k];
    return out;
}

Packing Simulation::packing() const {
    Packing out;
    out.cell = cell_;
    out.centres.resize(3, static_cast<Eigen::Index>(count_));
    out.radii.resize(static_cast<Eigen::Index>(count_));
    const Eigen::Matrix3d inverse = cell_.inverse();
    for (std::size_t p = 0; p < count_; ++p) {
        const auto at = static_cast<Eigen::Index>(outside_[p]);
        Eigen::Vector3d f =
            inverse * Eigen::Vector3d(particles_[p].x[0], particles_[p].x[1], particles_[p].x[2]);
        for (int k = 0; k < 3; ++k) f[k] -= std::floor(f[k]);
        out.centres.col(at) = cell_ * f;
        out.radii[at] = particles_[p].radius;
    }
    return out;
}

std::vector<ContactView> Simulation::contacts() const {
    std::vector<ContactView> out;
    for (std::size_t k = 0; k < pairs_.padded(); ++k) {
        if (pairs_.bond[k] == bond_none || pairs_.bond[k] == bond_apart) continue;
        const int n = pairs_.image[k];
        const ParticleRow &a = particles_[static_cast<std::size_t>(pairs_.i[k])],
                          &b = particles_[static_cast<std::size_t>(pairs_.j[k])];
        const Eigen::Vector3d branch = Eigen::Vector3d(b.x[0] - a.x[0], b.x[1] - a.x[1], b.x[2] - a.x[2]) +
                                       cell_ * Eigen::Vector3d(n / 9 - 1, (n / 3) % 3 - 1, n % 3 - 1);
        const Touch<double> pair{pairs_.radius_sum[k] - branch.norm(), pairs_.radius_sum[k],
                                 b.radius - a.radius, pairs_.reduced_radius[k], pairs_.area[k]};
        std::array<double, 3> memory{};
        if (composition_.with_effects)
            for (std::size_t q = 0; q < 3; ++q) memory[q] = pairs_.further[composition_.memory() + q][k];
        const double force = normal_force(composition_, pair, pairs_.bond[k], memory);
        const Eigen::Vector3d shear(pairs_.shear[0][k], pairs_.shear[1][k], pairs_.shear[2][k]);
        ContactView view{outside_[static_cast<std::size_t>(pairs_.i[k])],
                         outside_[static_cast<std::size_t>(pairs_.j[k])], branch, force, shear};
        if (view.i > view.j) view = {view.j, view.i, -branch, view.normal_force, -shear};
        out.push_back(view);
    }
    std::stable_sort(out.begin(), out.end(), [](const ContactView& a, const ContactView& b) {
        return a.i != b.i ? a.i < b.i : a.j < b.j;
    });
    return out;
}

}  // namespace loam::engine
