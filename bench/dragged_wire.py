#!/usr/bin/env python3
"""A wire dragged along a wall: true friction against what the hand feels and what the trace reports.

    python3 bench/dragged_wire.py [--app build/seldinger] [--csv bench/results/validation/dragged_wire.csv]

20 cm of 0.035 inch wire lie on a wall and are drawn at 2 cm/s by their base, under every scheme, law of friction and step. The true
friction is mu_sliding times the force on the wall; `smooth` gives v/(v + 1 mm/s) = 0.952 of it by its law. The layer of the published
method wants triangles smaller than the wire, so there the wall is a tube of 800,000 of them; the other runs are on a plane.
"""
import argparse
import csv
import math
import os
import subprocess
import tempfile

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
R, RHO, MU, LENGTH, SPEED = 0.4445e-3, 7900.0, 0.1, 0.2, 0.02
WEIGHT = RHO * math.pi * R * R * 9.81 * LENGTH
DEEP = 0.4e-6  # [m] what the weight sinks in: the base is held that deep, so that it carries its share and no more

SCENE = """
[scene]
name = "a wire dragged along a wall"
duration_s = 0.5
dt_s = 0.001
record_every = 1
[wire]
length_m = 0.2
radius_m = 0.0004445
density = 7900.0
bend_nm2 = 1.0e-4
twist_nm2 = 7.7e-5
stretch_n = 1.0e4
nodes = 41
velocity_m_s = [-0.02, 0.0, 0.0]
place = {{ shape = "straight", base = [0.0, 0.0, {base}], direction = [1.0, 0.0, 0.0] }}
[vessel]
youngs_pa = 1.0e6
{wall}
[contact]
mu_static = 0.12
mu_sliding = 0.10
[[hold]]
at = "base"
position = true
direction = false
spin = true
velocity_m_s = [-0.02, 0.0, 0.0]
"""
PLANE = 'shape = "plane"\norigin = [0.1, 0.0, 0.0]\nnormal = [0.0, 0.0, 1.0]\nsize_m = 0.5\ntriangles = 20000'
TUBE = 'shape = "tube"\norigin = [-0.05, 0.0, 0.0]\naxis = [1.0, 0.0, 0.0]\nradius_m = 0.01\nlength_m = 0.28\ntriangles = 800000'

SCHEMES = {
    "newton": [],
    "trapezoid": ["integrator.beta=0.25", "integrator.gamma=0.5"],
    "conserve": ["integrator.conserve=true"],
    "linearised": ["integrator.scheme=linearised"],
    "explicit": ["integrator.scheme=explicit"],
}
STEPS = (1e-3, 5e-3, 1 / 60)


def run(app, folder, scheme, detection, law, dt):
    layer = detection == "layer"
    path = os.path.join(folder, "scene.toml")
    with open(path, "w") as file:
        file.write(SCENE.format(base=repr(R - DEEP - (0.01 if layer else 0)), wall=TUBE if layer else PLANE))
    out = os.path.join(folder, "out")
    settings = [f"scene.dt_s={dt!r}", f"scene.duration_s={round(0.5 / dt) * dt!r}", f"contact.detection={detection}",
                f"contact.friction={law}"] + SCHEMES[scheme]
    command = [app, "run", path, "-o", out, "--overwrite", "--quiet"] + [x for s in settings for x in ("--set", s)]
    done = subprocess.run(command, capture_output=True, text=True)
    with open(os.path.join(out, "trace.csv")) as file:
        rows = list(csv.DictReader(file))
    rows = rows[len(rows) // 2:]
    if done.returncode != 0 or not rows:
        return {"outcome": "stopped"}
    mean = lambda name: sum(float(r[name]) for r in rows) / len(rows)
    felt, reported, pressed = -mean("hand_force_n"), mean("friction_n"), mean("normal_n")
    true = MU * WEIGHT * (SPEED / (SPEED + 1e-3) if law == "smooth" else 1)
    worst = max(abs(-float(r["hand_force_n"]) - true) for r in rows)
    return {"outcome": "ran", "true_n": true, "felt_n": felt, "reported_n": reported, "normal_n": pressed, "worst_n": worst}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--app", default=os.path.join(ROOT, "build", "seldinger"))
    parser.add_argument("--csv", default=os.path.join(ROOT, "bench", "results", "validation", "dragged_wire.csv"))
    arguments = parser.parse_args()
    columns = ["scheme", "detection", "law", "dt_s", "outcome", "true_n", "felt_n", "reported_n", "normal_n", "worst_n"]
    table = []
    with tempfile.TemporaryDirectory() as folder:
        for scheme in SCHEMES:
            for detection in ("capsule", "layer") if scheme == "linearised" else ("capsule",):
                for law in ("stick-slip", "smooth", "sign"):
                    for dt in STEPS:
                        row = {"scheme": scheme, "detection": detection, "law": law, "dt_s": dt}
                        row.update(run(arguments.app, folder, scheme, detection, law, dt))
                        table.append(row)
                        shown = {k: f"{1e3 * v:.4g} mN" for k, v in row.items() if k.endswith("_n")}
                        print(f"{scheme:10} {detection:8} {law:10} {1e3 * dt:5.1f} ms  {row['outcome']:8}", shown, flush=True)
    with open(arguments.csv + ".part", "w", newline="") as file:
        writer = csv.DictWriter(file, fieldnames=columns)
        writer.writeheader()
        writer.writerows(table)
    os.replace(arguments.csv + ".part", arguments.csv)


if __name__ == "__main__":
    main()
