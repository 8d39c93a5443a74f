# Makes triaxial_CASE_N.csv for the cases blocked, rolling and free (README.md) with YADE 2023.02a:
#   yade -n -x triaxial.py CASE N [SHARE]
# With SHARE, the time step over the p-wave estimate, it makes triaxial_CASE_N_SHARE.csv.
# (`yade` gives the names that are not imported.) packing_N.csv, in the folder of this script, is consolidated to
# 100 kPa with the contact parameters of the case,
# then compressed along z at 0.03 /s to 20 % with the lateral stress held.
import math
import os
import sys

import numpy as np
case, number = sys.argv[1], sys.argv[2]
cases = {"blocked": (0.20, 0.0), "rolling": (0.46, 0.15), "free": (0.46, 0.0)}  # friction angle (rad), rolling friction
friction_angle, rolling_friction = cases[case]
folder = os.path.dirname(os.path.abspath(sys.argv[0]))
packing = os.path.join(folder, f"packing_{number}.csv")

O.periodic = True
O.cell.setBox(*[float(x) for x in open(packing).readline().split(":")[1].split(",")])
O.materials.append(
    CohFrictMat(young=1e8, poisson=0.83, frictionAngle=friction_angle, density=2600, isCohesive=False,
                normalCohesion=0, shearCohesion=0, momentRotationLaw=rolling_friction > 0, alphaKr=2, alphaKtw=0,
                etaRoll=rolling_friction, etaTwist=0, label="grains"))
for x, y, z, r in np.loadtxt(packing, delimiter=",", skiprows=2):
    body = O.bodies.append(sphere((x, y, z), r, material="grains"))
    if case == "blocked":
        O.bodies[body].state.blockedDOFs = "XYZ"

phase = "consolidation"
height = volume = 1.0
curve = open(os.path.join(folder, "_".join(["triaxial"] + sys.argv[1:]) + ".csv"), "w")
curve.write("axial_strain,axial_stress_kPa,lateral_stress_kPa,volumetric_strain\n")


def next_phase():
    global phase, height, volume
    if phase == "consolidation":
        O.cell.trsf = Matrix3.Identity
        height, volume = O.cell.size[2], O.cell.volume
        control.stressMask = 3
        control.goal = (-1e5, -1e5, math.log(0.8))
        control.maxStrainRate = (0.3, 0.3, 0.03)
        control.maxUnbalanced = 10
        phase = "compression"
        record()
    else:
        phase = "over"
        curve.close()
        O.pause()


def record():
    if phase != "compression":
        return
    stress = utils.getStress()
    curve.write("%g,%g,%g,%g\n" % (1 - O.cell.size[2] / height, -stress[2, 2] / 1e3,
                                   -(stress[0, 0] + stress[1, 1]) / 2e3, 1 - O.cell.volume / volume))


control = PeriTriaxController(dynCell=True, mass=sum(b.state.mass for b in O.bodies), goal=(-1e5, -1e5, -1e5),
                              stressMask=7, maxUnbalanced=0.01, relStressTol=0.002, globUpdate=5,
                              maxStrainRate=(0.1, 0.1, 0.1), doneHook="next_phase()")
O.engines = [
    ForceResetter(),
    InsertionSortCollider([Bo1_Sphere_Aabb()]),
    InteractionLoop([Ig2_Sphere_Sphere_ScGeom6D()],
                    [Ip2_CohFrictMat_CohFrictMat_CohFrictPhys(setCohesionNow=False)],
                    [Law2_ScGeom6D_CohFrictPhys_CohesionMoment(always_use_moment_law=rolling_friction > 0,
                                                               useIncrementalForm=True)]),
    control,
    NewtonIntegrator(damping=0.4),
    PyRunner(command="record()", iterPeriod=120),
]
# Spins held by rolling springs oscillate faster than the spheres move: at 0.7 the packing never rests.
share = float(sys.argv[3]) if len(sys.argv) > 3 else 0.4 if rolling_friction > 0 else 0.7
O.dt = share * utils.PWaveTimeStep()
O.run(900000, True)
if phase != "over":
    sys.exit(f"{case} {number}: not finished, in {phase}")
