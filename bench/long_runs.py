#!/usr/bin/env python3
"""What long runs do: drift of a stiff wire at large steps, and where the trapezoid's energy grows.

    bench/long_runs.py [--app build/seldinger] [--csv-folder bench/results/validation] [--quick]

drift.csv    a wire of 60 GPa and 0.2 mm radius, 0.2 m long, clamped level, at steps of 1, 5 and 16.7 ms and the default
             settings but for `conserve` where it says so. `rest`: with a shaped tip, from its equilibrium; `swing`: let go straight and level. Drift is how far
             the tip goes from where it was (rest), how much energy is gained in any one step over what there was to lose (swing, backward
             Euler: it may only fall), or how far the energy gets from that after the first step (swing, conserving).
growth.csv   a wire let go from an arc, tip off by `amplitude` of its length, `steps` a first period, 100 periods: largest energy over that after
             the first step, by the trapezoid and by energy-momentum steps. A run that is stopped by its time limit has blown up: steps are
             halved again and again.
"""
import pathlib

import numpy as np

import runner

STIFF = {"scene": {"gravity": [0.0, 0.0, -9.81], "duration_s": 20.0, "dt_s": 0.001, "record_every": 1},
         "wire": {"length_m": 0.2, "radius_m": 0.0002, "density": 6450.0, "youngs_pa": 60.0e9, "poisson": 0.33, "nodes": 101,
                  "place": runner.LEVEL | {"normal": [0.0, 1.0, 0.0]}},
         "hold": [runner.HELD], "output": runner.QUIET}
SHAPED = STIFF | {"wire.section": [{"from_tip_m": [0.0, 0.01], "rest_curvature_1_m": [150.0, 0.0]}]}
PERIOD = 0.0609494718531634  # [s]
PLUCKED = STIFF | {"scene": STIFF["scene"] | {"gravity": [0.0, 0.0, 0.0]}, "integrator": {"tolerance": 1e-9},
                   "wire": {"length_m": 0.1, "radius_m": 0.000178, "density": 6450.0, "bend_nm2": 5.5190957750700876e-5, "twist_nm2": 4.2e-5,
                            "stretch_n": 6966.0, "nodes": 41, "place": {**runner.LEVEL, "shape": "arc", "bend_radius_m": 300.0}}}


def drift(run, duration):
    rows = []
    for dt in (0.001, 0.005, 0.0166667):
        for start, conserve in (("rest", False), ("swing", False), ("rest", True), ("swing", True)):
            settings = {"scene.dt_s": dt, "scene.duration_s": duration, "scene.start": "settled" if start == "rest" else "placed"}
            if conserve:
                settings["integrator.conserve"] = "true"
            trace, finished = run(SHAPED if start == "rest" else STIFF, settings, 600)
            tip = np.column_stack([trace[f"tip_{c}_m"] for c in "xyz"])
            energy = trace["kinetic_j"] + trace["elastic_j"] + trace["gravitational_j"]
            scale = np.ptp(trace["gravitational_j"]) if start == "swing" else np.abs(energy[0])
            moved = np.linalg.norm(tip - tip[0], axis=1).max()
            gained = np.diff(energy).max() / scale if not conserve else np.abs(energy - energy[0]).max() / scale
            flags = trace["flags"].astype(int)
            rows.append({"start": start, "scheme": "energy-momentum" if conserve else "backward Euler", "dt_ms": f"{1e3 * dt:.3g}",
                         "steps": len(trace), "finished": int(finished), "steps_halved": int(np.count_nonzero(flags & 1)),
                         "newton_mean": f"{trace['newton'].mean():.2f}", "newton_max": int(trace["newton"].max()),
                         "tip_moved_m": f"{moved:.2g}", "tip_moved_last_second_m": f"{np.ptp(tip[trace['time_s'] > duration - 1], axis=0).max():.2g}",
                         "energy_drift": f"{gained:.2g}"})
            print(*rows[-1].values(), flush=True)
    return rows


def growth(run, quick):
    rows = []
    amplitudes, counts = ((2e-4, 0.02), (60, 240)) if quick else ((2e-4, 1e-3, 5e-3, 0.02, 0.1), (30, 60, 120, 240, 480))
    for scheme, key, value in (("trapezoid", "integrator.beta", "0.25"), ("energy-momentum", "integrator.conserve", "true")):
        for amplitude in amplitudes:
            for steps in counts:
                settings = {key: value, "wire.place.bend_radius_m": 0.1 / (2 * amplitude), "scene.dt_s": PERIOD / steps,
                            "scene.duration_s": (10 if quick else 100) * PERIOD}
                trace, finished = run(PLUCKED, settings, 60)
                energy = (trace["kinetic_j"] + trace["elastic_j"]) / (trace["kinetic_j"][0] + trace["elastic_j"][0])
                doubled = np.flatnonzero(energy > 2)
                rows.append({"scheme": scheme, "amplitude": amplitude, "steps": steps, "finished": int(finished),
                             "largest": f"{energy.max():.4g}", "smallest": f"{energy.min():.4g}", "within": f"{np.abs(energy - 1).max():.2g}",
                             "doubled_after_periods": f"{doubled[0] / steps:.1f}" if len(doubled) else ""})
                print(*rows[-1].values(), flush=True)
    return rows


def main():
    parser = runner.parser(__doc__)
    parser.add_argument("--csv-folder", type=pathlib.Path)
    parser.add_argument("--only", choices=["drift", "growth"], default=None)
    parser.add_argument("--quick", action="store_true")
    options = parser.parse_args()

    def run(scene, settings, limit):
        """(trace, finished); 4: even the smallest step failed"""
        done = runner.run(options.app, runner.scene(scene), settings=settings, more=["--time-limit", limit], accept=(0, 4, 75))
        return done.trace(), done.code == 0

    for name, make in (("drift", lambda: drift(run, 2 if options.quick else 20)), ("growth", lambda: growth(run, options.quick))):
        if options.only in (None, name):
            runner.write_rows(options.csv_folder and options.csv_folder / f"{name}.csv", make())


if __name__ == "__main__":
    main()
