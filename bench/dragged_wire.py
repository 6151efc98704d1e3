#!/usr/bin/env python3
"""A wire dragged along a wall: true friction against what the hand feels and what the trace reports.

    python3 bench/dragged_wire.py [--app build/seldinger] [--csv bench/results/validation/dragged_wire.csv]

20 cm of 0.035 inch wire lie on a wall and are drawn at 2 cm/s by their base, under every scheme, law of friction and step. The true
friction is mu_sliding times the force on the wall; `smooth` gives v/(v + 1 mm/s) = 0.952 of it by its law. The layer of the published
method wants triangles smaller than the wire, so there the wall is a tube of 800,000 of them; the other runs are on a plane.
"""
import math

import runner

R, RHO, MU, LENGTH, SPEED = 0.4445e-3, 7900.0, 0.1, 0.2, 0.02
WEIGHT = RHO * math.pi * R * R * 9.81 * LENGTH
DEEP = 0.4e-6  # [m] what the weight sinks in: the base is held that deep, so that it carries its share and no more

SCENE = {
    "scene": {"duration_s": 0.5, "dt_s": 0.001, "record_every": 1},
    "wire": {"length_m": LENGTH, "radius_m": R, "density": RHO, "bend_nm2": 1.0e-4, "twist_nm2": 7.7e-5, "stretch_n": 1.0e4, "nodes": 41,
             "velocity_m_s": [-SPEED, 0.0, 0.0]},
    "contact": {"mu_static": 0.12, "mu_sliding": MU},
    "hold": [{"at": "base", "position": True, "direction": False, "spin": True, "velocity_m_s": [-SPEED, 0.0, 0.0]}]}
PLANE = {"shape": "plane", "origin": [0.1, 0.0, 0.0], "normal": [0.0, 0.0, 1.0], "size_m": 0.5, "triangles": 20000}
TUBE = {"shape": "tube", "origin": [-0.05, 0.0, 0.0], "axis": [1.0, 0.0, 0.0], "radius_m": 0.01, "length_m": 0.28, "triangles": 800000}

SCHEMES = {
    "newton": [],
    "trapezoid": ["integrator.beta=0.25", "integrator.gamma=0.5"],
    "conserve": ["integrator.conserve=true"],
    "linearised": ["integrator.scheme=linearised"],
    "explicit": ["integrator.scheme=explicit"],
}
STEPS = (1e-3, 5e-3, 1 / 60)


def measure(app, scheme, detection, law, dt):
    layer = detection == "layer"
    place = {"shape": "straight", "base": [0.0, 0.0, R - DEEP - (0.01 if layer else 0)], "direction": [1.0, 0.0, 0.0]}
    scene = runner.scene(SCENE | {"wire": SCENE["wire"] | {"place": place}, "vessel": {"youngs_pa": 1.0e6, **(TUBE if layer else PLANE)}})
    settings = [f"scene.dt_s={dt!r}", f"scene.duration_s={round(0.5 / dt) * dt!r}", f"contact.detection={detection}",
                f"contact.friction={law}"] + SCHEMES[scheme]
    run = runner.run(app, scene, settings=settings, accept=None)
    rows = run.rows()
    rows = rows[len(rows) // 2:]
    if run.code != 0 or not rows:
        return {"outcome": "stopped"}
    felt, reported, pressed = (sum(row[name] for row in rows) / len(rows) for name in ("hand_force_n", "friction_n", "normal_n"))
    true = MU * WEIGHT * (SPEED / (SPEED + 1e-3) if law == "smooth" else 1)
    worst = max(abs(-row["hand_force_n"] - true) for row in rows)
    return {"outcome": "ran", "true_n": true, "felt_n": -felt, "reported_n": reported, "normal_n": pressed, "worst_n": worst}


def main():
    options = runner.parser(__doc__, "validation/dragged_wire.csv").parse_args()
    table = runner.Table(options.csv, ["scheme", "detection", "law", "dt_s", "outcome", "true_n", "felt_n", "reported_n", "normal_n", "worst_n"])
    for scheme in SCHEMES:
        for detection in ("swept", "layer") if scheme == "linearised" else ("swept",):
            for law in ("stick-slip", "smooth", "sign"):
                for dt in STEPS:
                    row = {"scheme": scheme, "detection": detection, "law": law, "dt_s": dt} | measure(options.app, scheme, detection, law, dt)
                    table.add(row, show=False)
                    shown = {k: f"{1e3 * v:.4g} mN" for k, v in row.items() if k.endswith("_n")}
                    print(f"{scheme:10} {detection:8} {law:10} {1e3 * dt:5.1f} ms  {row['outcome']:8}", shown, flush=True)


if __name__ == "__main__":
    main()
