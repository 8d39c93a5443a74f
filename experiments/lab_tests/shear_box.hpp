// The walls of a direct shear box: two halves of four sides each, a bottom, a platen on top, and flanges that
// close what the displacement opens.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>

#include "engine/box.hpp"
#include "engine/simulation.hpp"

namespace loam::experiments {

class ShearBox {
  public:
    /// Adds the walls around `box` (m). Halves meet at half its height, `gap` (m) apart; `travel` (m) is how
    /// far the upper one is going to move along x. Throws std::invalid_argument.
    ShearBox(engine::Simulation& simulation, const engine::Box& box, double gap, double travel,
             double friction_angle);

    std::size_t platen() const { return platen_; }
    double plan() const { return plan_; }  // length times width (m²)

    /// The upper half's velocity along x (m/s); the platen keeps its drive.
    void move(engine::Simulation& simulation, double speed) const;
    double height(const engine::Simulation& simulation) const;        // from bottom to platen (m)
    double displacement(const engine::Simulation& simulation) const;  // of the upper half (m)
    /// Of all walls of the upper half on the particles, along x, in the last step (N).
    double shear_force(const engine::Simulation& simulation) const;
    /// Downwards, of the particles on the sides and the flange of the upper half, in the last step (N).
    double load_of_sides(const engine::Simulation& simulation) const;

  private:
    void add_half(engine::Simulation& simulation, const engine::Box& box, double low, double high,
                  std::array<std::size_t, 4>& walls);

    std::array<std::size_t, 4> lower_{}, upper_{};  // low and high x, low and high y
    std::size_t bottom_ = 0, platen_ = 0, upper_flange_ = 0;
    double plan_ = 0, start_ = 0, reach_ = 0, friction_angle_ = 0;
};

/// The packing in a periodic cell with room for the displacement, and its box there.
struct RoomyPacking {
    engine::Packing packing;
    engine::Box box;
};
RoomyPacking with_room(const engine::Packing& packing, const engine::Box& box, double travel);

}  // namespace loam::experiments
