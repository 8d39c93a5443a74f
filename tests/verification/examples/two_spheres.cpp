// The shortest use of the engine: two spheres meet and part again. Needs engine/simulation.hpp and nothing
// else.
#include <cmath>
#include <cstdio>

#include "engine/simulation.hpp"

int main() {
    loam::engine::Packing packing;  // a periodic cube of 1 m with two spheres of 0.1 m, 1 um apart
    packing.centres = Eigen::Matrix3Xd{{0.4, 0.6 + 1e-6}, {0.5, 0.5}, {0.5, 0.5}};
    packing.radii = Eigen::Vector2d(0.1, 0.1);
    loam::engine::LinearCohesive law;
    law.young_modulus = 1e7;
    law.normal_cohesion = law.shear_cohesion = 0;
    loam::engine::SimulationOptions options;
    options.damping = 0.3;
    options.time_step_safety = 0.01;
    loam::engine::Simulation simulation(packing, law, options);
    simulation.set_velocities(Eigen::Matrix3Xd{{0.1, -0.1}, {0, 0}, {0, 0}});  // m/s
    while (simulation.advance(1).contacts == 0) {
    }
    while (simulation.advance(1).contacts > 0) {
    }
    const double restitution = -simulation.velocities()(0, 0) / 0.1,
                 expected = std::sqrt((1 - 0.3) / (1 + 0.3));
    std::printf("restitution %.5f, closed form %.5f\n", restitution, expected);
    return std::abs(restitution - expected) < 1e-4 ? 0 : 1;
}
