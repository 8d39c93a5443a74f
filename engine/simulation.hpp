// A simulation: spheres in a periodic cell that follows a velocity gradient, or between rigid walls in such a
// cell. Conventions: SI; compression positive in stress and strain; the velocity gradient is L (1/s),
// negative for compression.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "engine/contact/composition.hpp"
#include "engine/crew.hpp"
#include "engine/neighbours.hpp"
#include "engine/packing.hpp"
#include "engine/state.hpp"
#include "engine/walls.hpp"

namespace loam::engine {

struct SimulationOptions {
    bool free_rotation = false;
    double damping = 0.4;           // Cundall's local damping
    double grain_density = 2600.0;  // kg/m³
    // Makes particles smaller than the mean as heavy as its time step demands, so that the smallest does not
    // set it, and their moments of inertia so large that spins do not: harmless where motion is quasi-static.
    bool density_scaling = false;
    double time_step_safety = 0.7;  // over min R sqrt(rho/E), E as the law needs it (composition.hpp)
    double neighbour_skin = 0.13;   // gap over R_i + R_j up to which a pair is listed
    // Overlap over R_i + R_j that the time step of Hertzian contacts is made for; 0: follows the packing.
    double largest_overlap = 0;
    int threads = 1;              // over large packings; the result is the same whatever their number
    bool energy_balance = false;  // measure every step, to integrate work and dissipation

    void validate() const;
};

/// Time spent in the parts of the step (s).
struct StepTimes {
    double neighbours = 0, contacts = 0, integration = 0;
};

/// The packing's state at one instant.
struct Measurement {
    Eigen::Matrix3d stress = Eigen::Matrix3d::Zero();  // Love-Weber (Pa), compression positive
    double mean_stress = 0;                            // Pa
    double contacts = 0;                               // number of contacts between particles
    double wall_contacts = 0;
    double coordination_number = 0;  // contacts of a particle, those with walls among them
    double unbalanced_ratio = 0;     // mean |force on a particle| over mean |normal contact force|
    double max_overlap = 0;          // largest overlap over R_i + R_j
    double affine_stiffness = 0;     // sum k_n l² / (9 V): upper estimate of the bulk modulus (Pa)
    double elastic_energy = 0;       // J
    double kinetic_energy = 0;       // J, relative to the mean velocity field
    double broken_bond_ratio = 0;    // of the contacts that cement_contacts has bonded, broken since
};

/// Energies integrated since the start or the last restart_energy_balance, where options.energy_balance is on
/// (J).
struct EnergyBalance {
    double work = 0;          // done by the cell's deformation and the walls on the packing
    double sliding = 0;       // lost by friction and broken cohesion
    double damping = 0;       // taken out by local damping
    double stored_start = 0;  // elastic and kinetic energy at the start
    double stored = 0;        // elastic and kinetic energy now
    /// |work - sliding - damping - change of stored energy| over the sum of the terms' sizes.
    double error() const;
};

/// A contact, for pictures and fabric.
struct ContactView {
    std::int32_t i, j;
    Eigen::Vector3d branch;  // from i to the touching copy of j (m)
    double normal_force;     // N, compression positive
    Eigen::Vector3d shear;   // on i (N)
};

class Simulation {
  public:
    /// Contacts start without shear force and with fresh cohesion. Throws std::invalid_argument on invalid
    /// input.
    Simulation(const Packing& packing, const ContactLaw& law, const SimulationOptions& options);

    /// Advances `steps` >= 1 steps and measures the last. Throws std::runtime_error when the state is no
    /// longer finite, an overlap exceeds half of a radius sum, the cell collapses, or, with walls, a particle
    /// comes near the cell's faces.
    const Measurement& advance(int steps);

    void set_velocity_gradient(const Eigen::Matrix3d& gradient) { gradient_ = gradient; }
    const Eigen::Matrix3d& velocity_gradient() const { return gradient_; }
    /// Changes the parameters; contacts keep their history, the time step follows the modulus.
    void set_law(const ContactLaw& law);
    /// Bonds the contacts between particles that the last step had, where the law has cementation, in place
    /// of all bonds before; returns their number.
    std::size_t cement_contacts();

    /// Adds a wall that touches particles with its own friction and without cohesion, and returns its number.
    /// A packing between walls stands free in its cell: particles must stay away from the cell's faces, so
    /// that they do not meet their copies, and walls do not reach across. Throws std::invalid_argument.
    std::size_t add_wall(const Wall& wall);
    /// Relative to the mean field (m/s).
    void set_wall_velocity(std::size_t wall, const Eigen::Vector3d& velocity);
    /// From now on the wall's velocity along its normal follows a force (see WallServo); a drive without
    /// speed_per_force ends that.
    void drive_wall(std::size_t wall, const WallDrive& drive);
    const Walls& walls() const { return walls_; }
    /// The volume that stress, porosity and stiffness are taken over in place of the cell's (m³). It follows
    /// the velocity gradient by itself; what walls add by their own velocity the caller sets anew.
    void set_reference_volume(double volume);

    /// Velocities relative to the mean field [3 x n] (m/s); they start at zero.
    void set_velocities(const Eigen::Matrix3Xd& velocities);
    Eigen::Matrix3Xd velocities() const;
    /// Angular velocities [3 x n] (rad/s), about fixed axes; only with free rotation, where they start at
    /// zero.
    void set_spins(const Eigen::Matrix3Xd& spins);
    Eigen::Matrix3Xd spins() const;

    const Measurement& measured() const { return measured_; }
    const EnergyBalance& energy() const { return energy_; }
    /// Begins the balance anew at the last step, which must have been measured: a change of the law alters
    /// what the contacts store without work done.
    void restart_energy_balance();
    const Eigen::Matrix3d& cell() const { return cell_; }
    double volume() const;  // of the cell, or the reference volume (m³)
    double time_step() const { return dt_; }
    std::uint64_t steps() const { return steps_; }
    std::uint64_t rebuilds() const { return rebuilds_; }
    std::size_t particles() const { return count_; }
    double mean_diameter() const { return mean_diameter_; }
    double grain_density() const { return options_.grain_density; }
    double solid_volume() const { return solid_volume_; }
    double porosity() const { return 1.0 - solid_volume_ / volume(); }

    /// Adds the time of every further step to `times`, which costs some 0.1 us a step; nullptr ends it.
    void time_steps(StepTimes* times) { times_ = times; }

    Packing packing() const;                    // the present state, wrapped into the cell
    std::vector<ContactView> contacts() const;  // of the last step

  private:
    void set_spin_inertia();
    void set_time_step();
    void follow_stiffness();
    void step(Measure measure);
    void update_neighbours();
    double drift_since_build();
    void rebuild_neighbours();
    ContactLoop contact_loop(Measure measure) const;
    void contact_forces(ContactSums& sums, Measure measure);
    static void point_to(PairList& pairs, std::size_t first, std::size_t last, ContactArguments& a);
    void wall_forces(ContactArguments a, ContactSums& sums, Measure measure);
    void check_enclosed() const;
    void integrate(IntegrateSums& sums, Measure measure);
    void deform_cell();
    void record(const ContactSums& contacts, const IntegrateSums& motion);
    void balance_energy(const ContactSums& contacts, const IntegrateSums& motion, Measure measure);

    ContactLaw law_;
    Composition composition_;
    SimulationOptions options_;
    const KernelTable* kernel_;
    std::size_t count_ = 0;
    std::vector<std::int32_t> outside_;  // the caller's number of the particle kept at each place
    AlignedVector<ParticleRow> particles_;
    AlignedVector<SpinRow> spins_;
    AlignedVector<ForceRow> forces_;
    PairList pairs_;
    Walls walls_;
    RebuildBuffers rebuild_buffers_;
    Slabs slabs_;
    Crew crew_;
    std::vector<std::size_t>
        reachable_;  // of every part: one past the last pair that may have met since then
    Eigen::Matrix3d cell_, gradient_ = Eigen::Matrix3d::Zero();
    double reference_volume_ = 0;   // 0: the cell's
    double time_step_radius_ = 0;   // of the particle that the time step is made for (m)
    double spin_inertia_ = 1;       // moments of inertia over those of solid spheres
    double time_step_overlap_ = 0;  // over R_i + R_j, that the time step is made for
    double dt_ = 0, solid_volume_ = 0, mean_diameter_ = 0, smallest_diameter_ = 0, largest_diameter_ = 0;
    std::uint64_t steps_ = 0, rebuilds_ = 0;
    std::size_t cemented_ = 0;      // contacts, by cement_contacts
    double drift_since_check_ = 0;  // bound on relative motion since positions were last compared (m)
    double drift_confirmed_ = 0;    // relative motion at that comparison (m)
    std::vector<Eigen::Vector3d> built_at_;  // fractional positions at the last rebuild
    Eigen::Matrix3d built_cell_ = Eigen::Matrix3d::Identity();
    Measurement measured_;
    EnergyBalance energy_;
    double half_work_ = 0;  // half of the work of the last step (J), with options.energy_balance
    StepTimes* times_ = nullptr;
};

}  // namespace loam::engine
