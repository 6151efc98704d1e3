#!/usr/bin/env python3
"""Wire-steps a second of `seldinger batch`: one scene, many wires, converged and linearised, at 60 steps a second; medians of repeats.

    bench_batch.py [--app build/seldinger] [--wires 1000] [--repeat 3] [--csv FILE] [--steps 120]

The start (settling, loading) is timed by a run of one step and taken off.
"""
import datetime
import json
import pathlib
import tempfile

import runner

SCENE = "assets/scenes/study/thousand.toml"
SWEEP = runner.ROOT / "bench/thousand-sweep.toml"


def batch(app, sweep, settings):
    with tempfile.TemporaryDirectory() as folder:
        done = runner.call([app, "batch", SCENE, "--vary", sweep, "-o", folder + "/batch", "--json", "--quiet", *runner.sets(settings)])
        return json.loads(done.stdout), runner.read_rows(folder + "/batch/results.csv")


def main():
    parser = runner.parser(__doc__, "")
    parser.add_argument("--wires", type=int, default=1000)
    parser.add_argument("--steps", type=int, default=120)
    parser.add_argument("--repeat", type=int, default=3)
    options = parser.parse_args()
    commit = runner.call(["git", "rev-parse", "--short", "HEAD"]).stdout.strip()
    table = runner.read_rows(options.csv)
    with tempfile.TemporaryDirectory() as folder:
        sweep = pathlib.Path(folder) / "sweep.toml"
        sweep.write_text(SWEEP.read_text().replace("n = 1000", f"n = {options.wires}"))
        for scheme in ("newton", "linearised"):
            def of(duration):
                return batch(options.app, sweep, {"integrator.scheme": scheme, "scene.duration_s": duration})

            rounds = runner.in_turn(options.repeat, start=lambda: of(0.0166666666667), whole=lambda: of(options.steps / 60))
            rates = [(whole["wire_steps"] - start["wire_steps"]) / (whole["wall_s"] - start["wall_s"])
                     for (start, _), (whole, _) in zip(rounds["start"], rounds["whole"])]
            whole, rows = rounds["whole"][-1]
            contacts = [float(row["contacts"]) for row in rows]
            halved = sum(int(row["halved_steps"]) for row in rows)
            mean = {name: runner.median(one["stage_ms"][name] for one, _ in rounds["whole"]) for name in whole["stage_ms"]}
            print(f"{scheme}: {runner.median(rates):.0f} wire-steps/s ({min(rates):.0f} to {max(rates):.0f}); {options.wires} wires, "
                  f"contacts at the end {min(contacts):.0f} to {max(contacts):.0f}, {halved} steps halved; ms per step of all: " +
                  ", ".join(f"{name} {value:.1f}" for name, value in mean.items()))
            table.append({"date": datetime.date.today(), "commit": commit, "device": whole["device"], "scheme": scheme, "wires": options.wires,
                          "nodes": 24, "steps": options.steps, "wire_steps_per_s": f"{runner.median(rates):.0f}", "lowest": f"{min(rates):.0f}",
                          "highest": f"{max(rates):.0f}", "contacts_least": f"{min(contacts):.0f}",
                          **{f"{name}_ms": f"{value:.3f}" for name, value in mean.items()}})
    runner.write_rows(options.csv, table)


if __name__ == "__main__":
    main()
