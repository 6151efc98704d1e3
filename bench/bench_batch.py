#!/usr/bin/env python3
"""Wire-steps a second of `seldinger batch`: one scene, many wires, converged and linearised, at 60 steps a second; medians of repeats.

    bench_batch.py [--app build/seldinger] [--wires 1000] [--repeat 3] [--csv FILE] [--steps 120]

The start (settling, loading) is timed by a run of one step and taken off.
"""
import argparse
import csv
import datetime
import json
import os
import statistics
import subprocess
import sys
import tempfile

SCENE = "assets/scenes/study/thousand.toml"
SWEEP = "bench/thousand-sweep.toml"


def batch(app, sweep, *sets):
    with tempfile.TemporaryDirectory() as folder:
        command = [app, "batch", SCENE, "--vary", sweep, "-o", os.path.join(folder, "batch"), "--json", "--quiet"]
        for key in sets:
            command += ["--set", key]
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode != 0:
            sys.exit(f"{' '.join(command)}: exit {done.returncode}: {done.stderr.strip()}")
        with open(os.path.join(folder, "batch", "results.csv"), newline="") as file:
            rows = list(csv.DictReader(file))
        return json.loads(done.stdout), rows


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--app", default="build/seldinger")
    parser.add_argument("--wires", type=int, default=1000)
    parser.add_argument("--steps", type=int, default=120)
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("--csv")
    options = parser.parse_args()
    commit = subprocess.run(["git", "rev-parse", "--short", "HEAD"], capture_output=True, text=True).stdout.strip()
    with tempfile.TemporaryDirectory() as folder:
        sweep = os.path.join(folder, "sweep.toml")
        with open(SWEEP) as source, open(sweep, "w") as target:
            target.write(source.read().replace("n = 1000", f"n = {options.wires}"))
        lines = []
        for scheme in ("newton", "linearised"):
            rates, stages = [], []
            for _ in range(options.repeat):
                start, _ = batch(options.app, sweep, f"integrator.scheme={scheme}", "scene.duration_s=0.0166666666667")
                whole, rows = batch(options.app, sweep, f"integrator.scheme={scheme}", f"scene.duration_s={options.steps / 60}")
                rates.append((whole["wire_steps"] - start["wire_steps"]) / (whole["wall_s"] - start["wall_s"]))
                stages.append(whole["stage_ms"])
            contacts = [float(row["contacts"]) for row in rows]
            halved = sum(int(row["halved_steps"]) for row in rows)
            mean = {name: statistics.median(stage[name] for stage in stages) for name in stages[0]}
            print(f"{scheme}: {statistics.median(rates):.0f} wire-steps/s ({min(rates):.0f} to {max(rates):.0f}); {options.wires} wires, "
                  f"contacts at the end {min(contacts):.0f} to {max(contacts):.0f}, {halved} steps halved; ms per step of all: " +
                  ", ".join(f"{name} {value:.1f}" for name, value in mean.items()))
            lines.append([datetime.date.today(), commit, whole["device"], scheme, options.wires, 24, options.steps,
                          f"{statistics.median(rates):.0f}", f"{min(rates):.0f}", f"{max(rates):.0f}", f"{min(contacts):.0f}",
                          *[f"{value:.3f}" for value in mean.values()]])
        if options.csv:
            fresh = not os.path.exists(options.csv)
            with open(options.csv, "a", newline="") as file:
                table = csv.writer(file)
                if fresh:
                    table.writerow(["date", "commit", "device", "scheme", "wires", "nodes", "steps", "wire_steps_per_s", "lowest",
                                    "highest", "contacts_least", *[f"{name}_ms" for name in mean]])
                table.writerows(lines)


if __name__ == "__main__":
    main()
