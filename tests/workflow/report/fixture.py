"""Documents for the tests of the report: made-up numbers of plausible size, no result of any simulation.

document() is a calibration of an oedometer and a triaxial test; several_tests=False leaves the oedometer alone.
As a script: fixture.py > document.json
"""
import json
import math
import random
import sys

STRESSES = [8e3, 10e3, 20e3, 40e3, 80e3, 150e3, 300e3, 600e3, 1200e3, 600e3, 150e3, 40e3, 10e3]
PHASES = ["loading"] * 9 + ["unloading"] * 4
MEASURED = [0, 0.00106074, 0.0123867, 0.0236099, 0.0367151, 0.0484175, 0.0642943, 0.0826347, 0.106347,
            0.103644, 0.0979983, 0.0932421, 0.0895808]

PARAMETERS = [
    # name, symbol, unit, meaning, log, centre and spread of the posterior, of the prior (log10 where log)
    ("young_modulus", "E", "Pa", "stiffness of the contacts' elastic columns", True, (6.42, 0.04), (6.6, 0.45)),
    ("stiffness_ratio", "k_t/k_n", "1", "tangential over normal stiffness", False, (0.42, 0.17), (0.4, 0.17)),
    ("friction_angle", "phi", "rad", "angle of Coulomb friction between particles", False, (0.51, 0.035), (0.5, 0.16)),
    ("normal_cohesion", "C_n", "Pa", "tensile strength of a contact over its section", True, (3.1, 0.5), (3.1, 0.5)),
    ("shear_cohesion", "C_t", "Pa", "shear strength of a contact at zero normal force", True, (3.4, 0.3), (3.1, 0.5)),
]
Z90 = 1.645


def value(parameter, coordinate):
    return 10.0 ** coordinate if parameter[4] else coordinate


def parameters():
    rows = []
    for p in PARAMETERS:
        name, symbol, unit, meaning, log, (m, s), (pm, ps) = p
        rows.append({"name": name, "symbol": symbol, "unit": unit, "meaning": meaning, "log": log, "fixed": False,
                     "identified": s < 0.8 * ps, "estimate": value(p, m + 0.1 * s), "q05": value(p, m - Z90 * s),
                     "q50": value(p, m), "q95": value(p, m + Z90 * s), "prior_q05": value(p, pm - Z90 * ps),
                     "prior_q95": value(p, pm + Z90 * ps)})
    rows.append({"name": "interaction_range", "symbol": "γ", "unit": "1", "meaning": "reach of tension over the sum of radii",
                 "estimate": 1.05, "fixed": True})
    return rows


def oedometer(rng):
    simulated = [m + 0.004 * math.sin(1.1 * i) * min(1, i / 3) for i, m in enumerate(MEASURED)]
    simulated[2] += 0.005
    sd = [0.0004 + 0.02 * m for m in MEASURED]
    residual = [m - s for m, s in zip(MEASURED, simulated)]
    return {"kind": "oedometer", "file": "oedometer_1.csv", "channel": "axial_strain", "x_name": "axial_stress", "x_unit": "Pa",
            "x_log": True, "y_unit": "1", "unit": "1", "x": STRESSES, "phase": PHASES, "measured": MEASURED, "simulated": simulated,
            "band_lower": [s - Z90 * (0.0005 + 0.025 * s) for s in simulated],
            "band_upper": [s + Z90 * (0.0005 + 0.025 * s) for s in simulated],
            "residual": residual, "residual_sd": sd,
            "replicates": [[s * (1 + rng.gauss(0, 0.02)) for s in simulated] for _ in range(4)],
            "rmse": math.sqrt(sum(r * r for r in residual) / len(residual)), "r": 0.9961, "points": 13, "held_out": False}


def triaxial(rng, channel):
    strain = [0.001 * i for i in range(180)]
    def curve(e, share):
        if channel == "deviatoric_stress":
            return share * 260e3 * e / (0.012 + e) * (1 + 0.5 * math.exp(-((e - 0.05) / 0.05) ** 2))
        return share * (0.004 * math.exp(-((e - 0.012) / 0.012) ** 2) - 0.06 * e)
    size = 3e3 if channel == "deviatoric_stress" else 4e-4
    measured = [curve(e, 1) + rng.gauss(0, size) for e in strain]
    simulated = [curve(e, 0.94) for e in strain]
    noise = [3 * size] * len(strain)
    residual = [m - s for m, s in zip(measured, simulated)]
    return {"kind": "triaxial", "file": "triaxial_drained_100kPa.csv", "channel": channel, "x_name": "axial_strain", "x_unit": "1",
            "x_log": False, "y_unit": "Pa" if channel == "deviatoric_stress" else "1", "unit": "Pa" if channel == "deviatoric_stress" else "1",
            "x": strain, "phase": ["loading"] * len(strain), "measured": measured, "simulated": simulated,
            "band_lower": [s - 2 * n for s, n in zip(simulated, noise)], "band_upper": [s + 2 * n for s, n in zip(simulated, noise)],
            "residual": residual, "residual_sd": noise, "replicates": [[s * f for s in simulated] for f in (0.97, 1.01, 1.03)],
            "rmse": math.sqrt(sum(r * r for r in residual) / len(residual)), "r": 0.9812, "points": len(strain), "held_out": True}


def posterior(rng, draws):
    rows = []
    for _ in range(draws):
        z = [rng.gauss(0, 1) for _ in PARAMETERS]
        z[2] = -0.7 * z[0] + math.sqrt(1 - 0.49) * z[2]  # stiffer or rougher: the curve cannot quite tell
        rows.append([value(p, p[5][0] + p[5][1] * zk) for p, zk in zip(PARAMETERS, z)])
    prior = []
    for p in PARAMETERS:
        ts = [p[6][0] + p[6][1] * (i - 40) / 14 for i in range(81)]
        prior.append({"x": [value(p, t) for t in ts], "density": [math.exp(-0.5 * ((t - p[6][0]) / p[6][1]) ** 2) for t in ts]})
    return {"names": [p[0] for p in PARAMETERS], "symbols": [p[1] for p in PARAMETERS], "log": [p[4] for p in PARAMETERS],
            "draws": rows, "prior_density": prior, "r_hat": [1.002, 1.004, 1.001, 1.011, 1.006], "ess": [2310, 1890, 2122, 1204, 1655]}


def emulator(rng, runs):
    outputs = [f"{s / 1e3:g} kPa{' unloading' if p == 'unloading' else ''}" for s, p in zip(STRESSES[1:], PHASES[1:])]
    loo, rmse = [], []
    for k in range(len(outputs)):
        sd = 0.0004 * (1 + 0.3 * k)
        errors = []
        for _ in range(runs):
            actual = 0.008 * (k + 1) * math.exp(rng.gauss(0, 0.5))
            z = rng.gauss(0, 1.05)
            loo.append({"output": k, "predicted": actual - z * sd, "actual": actual, "z": z})
            errors.append(z * sd)
        rmse.append(math.sqrt(sum(e * e for e in errors) / runs))
    return {"outputs": outputs, "loo": loo, "coverage90": 0.893, "rmse": rmse, "rounds": [
        {"runs": 72, "difference": 2.9, "shift": 1.3, "limit": 0.5, "text": "The emulator is off by more than its noise between 20 and 80 kPa; 16 runs added around the estimate."},
        {"runs": 88, "difference": 0.9, "shift": 0.2, "limit": 0.6, "text": "Emulator and DEM agree within their noise; stopped."}]}


def sensitivity():
    m = len(STRESSES)
    shape = [[0.25 + 0.05 * i for i in range(m)], [0.02] * m, [0.6 - 0.03 * i for i in range(m)], [0.1 / (1 + i) for i in range(m)],
             [0.15 / (1 + 0.5 * i) for i in range(m)]]
    total = [[min(1, 1.1 * v + 0.02) for v in row] for row in shape]
    low = [[s * (1 + 0.8 * v) for s, v in zip(MEASURED, row)] for row in shape]
    high = [[s * (1 - 0.6 * v) for s, v in zip(MEASURED, row)] for row in shape]
    return {"names": [p[0] for p in PARAMETERS], "test": 0, "x": STRESSES, "first_order": shape, "total": total, "low": low, "high": high}


def packing(rng, side):
    """A jittered lattice of side³ spheres; every near pair is a contact, the steep ones carry more."""
    centres = [[(i + 0.5 + rng.uniform(-0.28, 0.28)) / side for i in (a, b, c)]
               for a in range(side) for b in range(side) for c in range(side)]
    radii = [rng.uniform(0.7, 1.3) * 0.54 / side for _ in centres]
    cells = {}
    for n, c in enumerate(centres):
        cells.setdefault(tuple(int(v * side) % side for v in c), []).append(n)
    contacts = []
    for (a, b, c), members in cells.items():
        for da, db, dc in [(1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 0), (1, 0, 1), (0, 1, 1), (1, -1, 0), (1, 0, -1), (0, 1, -1)]:
            for i in members:
                for j in cells.get(((a + da) % side, (b + db) % side, (c + dc) % side), []):
                    d = [centres[j][k] - centres[i][k] for k in range(3)]
                    d = [v - round(v) for v in d]
                    length = math.sqrt(sum(v * v for v in d))
                    if length < radii[i] + radii[j]:
                        steep = (d[2] / length) ** 2
                        force = (2 + 30 * steep) * math.exp(rng.gauss(0, 0.9)) * rng.choice([1, 1, 1, 1, 1, 1, 1, 1, 1, -0.1])
                        contacts.append([i, j, force])
    return {"cell": [1, 1, 1], "x": centres, "radius": radii, "contacts": contacts, "stress": 1.2e6,
            "caption": "Packing 1 at the end of loading, at the estimate."}


def document(several_tests=True, draws=600, runs=72, side=9, seed=1):
    rng = random.Random(seed)
    tests = [oedometer(rng)]
    if several_tests:
        tests += [triaxial(rng, "deviatoric_stress"), triaxial(rng, "volumetric_strain")]
    return {
        "verb": "calibrate", "name": "report-fixture", "description": "TEST FIXTURE: made-up numbers, no result of any simulation.",
        "version": "0.1.0", "seed": seed, "seconds": 431.7, "dem_runs": 96, "dem_failed": 2,
        "warnings": ["Two of 96 DEM runs failed: the packing could not be brought to the initial void ratio."],
        "verdict": "The model follows the oedometer curve to 0.4 % strain over loading; unloading is too stiff at low stress.",
        "model": {"law": "linear-cohesive", "rotation": "blocked", "effects": []}, "parameters": parameters(), "tests": tests,
        "posterior": posterior(rng, draws), "emulator": emulator(rng, runs), "sensitivity": sensitivity(), "packing": packing(rng, side),
        "quasi_static": {"inertial_number": 4.1e-4, "unbalanced_ratio": 0.0123, "servo_error": 0.0061,
                         "text": "All runs at the estimate were quasi-static: halving the rate moves no stage by more than 5e-4."},
        "settings": "[run]\nseed = 1\nparticles = 700\n\n[model]\nlaw = \"linear-cohesive\"\nrotation = \"blocked\"\n"}


if __name__ == "__main__":
    json.dump(document(), sys.stdout)
