// The walls of a simulation. Every sphere near a wall has a foot: a row of radius zero behind those of the
// particles, placed at every step where the wall is nearest to the sphere. Sphere and foot stand in a pair
// list of the wall's own, so that the loops over contacts need to know nothing of walls.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "engine/state.hpp"
#include "engine/wall.hpp"

namespace loam::engine {

struct ContactSums;

class Walls {
  public:
    bool empty() const { return walls_.empty(); }
    std::size_t size() const { return walls_.size(); }
    const Wall& wall(std::size_t k) const { return at(k).wall; }
    /// On wall k by its contacts, in the last step (N).
    const Eigen::Vector3d& force(std::size_t k) const { return at(k).force; }
    /// Contacts of wall k and the sum of their normal stiffness (N/m), in the last measured step. The
    /// stiffness is weighted by the squares of the radii.
    double contacts(std::size_t k) const { return at(k).contacts; }
    double contacts() const;  // of all walls
    double stiffness(std::size_t k) const { return at(k).stiffness; }
    /// Whether a sphere has come so close to a wall that it may be pressed through.
    bool pierced() const { return closest_ < 0; }

    // The rest is the simulation's.

    /// Throws std::invalid_argument.
    void add(const Wall& wall);
    void set_velocity(std::size_t k, const Eigen::Vector3d& velocity);
    void drive(std::size_t k, const WallDrive& drive);
    /// How many doubles every contact keeps beyond shear force and bond.
    void set_history(std::size_t history);

    /// Finds the spheres whose gap to a wall is below `reach` times their diameter, carries the history of
    /// contacts over, and makes room for the feet behind the `count` particles and two dummies.
    void rebuild(AlignedVector<ParticleRow>& particles, AlignedVector<SpinRow>& spins,
                 AlignedVector<ForceRow>& forces, std::size_t count, double reach);
    /// Puts every foot where its wall is nearest to its sphere, in the field with this gradient.
    void place_feet(ParticleRow* particles, const Eigen::Matrix3d& gradient);
    /// Sums the forces on the feet of each wall and clears them. Returns the power of the forces on the walls
    /// (W), relative to the mean field.
    double take_forces(const ParticleRow* particles, ForceRow* forces);
    /// Moves the walls, those with a drive by the forces of this step.
    void move(double dt, const Eigen::Matrix3d& gradient);
    double friction_coefficient(std::size_t k) const { return at(k).friction_coefficient; }
    PairList& pairs(std::size_t k) { return at(k).pairs; }
    void record(std::size_t k, const ContactSums& sums);

    /// Bound on the speed at which a wall nears a particle at rest in the mean field (m/s).
    double largest_speed(const Eigen::Matrix3d& gradient) const;
    /// Bound on the way that it has made so since the last rebuild, where the field has led to `deformation`.
    double motion_since_build(const Eigen::Matrix3d& deformation) const;

  private:
    struct State {
        Wall wall;
        WallDrive drive;
        double friction_coefficient = 0;
        double mean_speed = 0;                 // of the drive (m/s)
        Eigen::Vector3d normal, per_a, per_b;  // per_a: edge_a over its squared length (1/m)
        PairList pairs;
        std::size_t first_foot = 0;  // the row of the foot of the first pair
        Eigen::Vector3d force = Eigen::Vector3d::Zero(), built_centre = Eigen::Vector3d::Zero();
        double contacts = 0, stiffness = 0;
        double mean_radius_squared = 0;  // of the pairs
    };
    void find_fastest();
    static void follow_drive(State& state);
    template <bool still>
    static double place_feet(const State& state, ParticleRow* particles, const Eigen::Matrix3d& gradient);
    static double turning(const State& state, const Eigen::Matrix3d& gradient);
    State& at(std::size_t k) { return walls_.at(k); }
    const State& at(std::size_t k) const { return walls_.at(k); }
    void find_near(std::size_t k, const AlignedVector<ParticleRow>& particles, std::size_t count,
                   double reach);
    void fill_pairs(State& state, const AlignedVector<ParticleRow>& particles, std::size_t count);

    std::vector<State> walls_;
    std::size_t history_ = 0;
    double fastest_ = 0;  // m/s
    double closest_ = 0;  // smallest d² - R²/4 of any step, where negative (m²)
    std::vector<std::int32_t> near_, bond_of_;
    PairList old_;
};

}  // namespace loam::engine
