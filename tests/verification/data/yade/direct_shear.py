# Makes direct_shear_N.csv (README.md) with YADE 2023.02a:
#   yade -n -x direct_shear.py N
# (`yade` gives the names that are not imported.) box_N.csv, in the folder of this script, lies between smooth
# rigid walls, of which the lid presses it to 100 kPa; then the upper half and the lid move along x under that
# pressure, by 3 % of the length. Rotations are blocked.
import math
import os
import sys

import numpy as np
number = sys.argv[1]
folder = os.path.dirname(os.path.abspath(sys.argv[0]))
packing = os.path.join(folder, f"box_{number}.csv")
pressure, modulus, density, inertial_number, largest_displacement = 1e5, 1e8, 2600, 5e-4, 0.03

for name, friction_angle in [("grains", 0.20), ("walls", 0.0)]:
    O.materials.append(FrictMat(young=modulus, poisson=0.83, frictionAngle=friction_angle, density=density, label=name))
spheres = np.loadtxt(packing, delimiter=",", skiprows=2)
for x, y, z, r in spheres:
    O.bodies[O.bodies.append(sphere((x, y, z), r, material="grains"))].state.blockedDOFs = "XYZ"
sides = [float(x) for x in open(packing).readline().split(":")[1].split(",")]
diameter = 2 * spheres[:, 3].mean()
thick = 4 * diameter


def block(low, high):
    centre, extents = [0.5 * (a + b) for a, b in zip(low, high)], [0.5 * (b - a) for a, b in zip(low, high)]
    return O.bodies.append(box(centre, extents, material="walls", fixed=True))


def half(low, high):
    x, y, t = sides[0], sides[1], thick
    return [block((-t, -t, low), (0, y + t, high)), block((x, -t, low), (x + t, y + t, high)),
            block((-2 * t, -t, low), (x + 2 * t, 0, high)), block((-2 * t, y, low), (x + 2 * t, y + t, high))]


half(-thick, sides[2] / 2)
upper = half(sides[2] / 2, sides[2] + thick)
block((-2 * thick, -thick, -thick), (sides[0] + 2 * thick, sides[1] + thick, 0))
lid = block((-2 * thick, -thick, sides[2]), (sides[0] + 2 * thick, sides[1] + thick, sides[2] + thick))
upper.append(lid)

area = sides[0] * sides[1]
unit_rate = math.sqrt(pressure / density) / diameter  # strain rate of inertial number 1
speed = mean_speed = height = 0.0
curve = open(os.path.join(folder, f"direct_shear_{number}.csv"), "w")
curve.write("displacement,shear_stress_kPa,normal_stress_kPa,settlement\n")


def steer():
    """Moves the lid; once the packing has come to rest, shears it."""
    global speed, mean_speed, height
    now = O.forces.f(lid)[2] / area
    limit = (1e-3 if speed else 3e-4) * unit_rate * sides[2]
    missing = (now - pressure) / (0.4 * modulus / sides[2]) * 0.05 / O.dt
    lid_speed = max(-limit, min(limit, missing + mean_speed))
    mean_speed += 0.005 * (lid_speed - mean_speed)
    if not speed and O.iter % 100 == 0 and O.iter > 1000 and abs(now / pressure - 1) < 5e-3 and unbalancedForce() < 3e-3:
        height = O.bodies[lid].state.displ()[2] + sides[2]
        speed = inertial_number * unit_rate * min(height, 10 * diameter)
    for body in upper:
        O.bodies[body].state.vel = Vector3(speed, 0, lid_speed if body == lid else 0)
    if not speed or O.iter % 60:
        return
    displacement = O.bodies[upper[0]].state.displ()[0] / sides[0]
    shear_force = -sum(O.forces.f(body)[0] for body in upper)
    settlement = 1 - (O.bodies[lid].state.displ()[2] + sides[2]) / height
    curve.write("%g,%g,%g,%g\n" % (displacement, shear_force / area / 1e3, now / 1e3, settlement))
    if displacement > largest_displacement:
        O.pause()


O.engines = [
    ForceResetter(),
    InsertionSortCollider([Bo1_Sphere_Aabb(), Bo1_Box_Aabb()], verletDist=0.05 * diameter),
    InteractionLoop([Ig2_Sphere_Sphere_ScGeom(), Ig2_Box_Sphere_ScGeom()], [Ip2_FrictMat_FrictMat_FrictPhys()],
                    [Law2_ScGeom_FrictPhys_CundallStrack()]),
    PyRunner(command="steer()", iterPeriod=1),
    NewtonIntegrator(damping=0.4),
]
O.dt = 0.4 * spheres[:, 3].min() * math.sqrt(density / modulus)
O.run()
O.wait()
curve.close()
os._exit(0)
