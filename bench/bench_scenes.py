#!/usr/bin/env python3
"""Times whole scenes and appends one row per scene to a CSV: medians of repeats, mean time of each stage.

    bench_scenes.py [--app build/seldinger] [--repeat 3] [--csv bench/results/scenes.csv] SCENE.toml [SCENE.toml ...] [-- --set key=value ...]
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

STAGES = ["detect", "evaluate", "reduce", "solve", "wall", "adapt", "record"]


def run(app, scene, extra):
    with tempfile.TemporaryDirectory() as folder:
        command = [app, "run", scene, "-o", os.path.join(folder, "run"), "--json", "--quiet", *extra]
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode != 0:
            sys.exit(f"{' '.join(command)}: exit {done.returncode}: {done.stderr.strip()}")
        return json.loads(done.stdout)


def output_of(*command):
    return subprocess.run(command, capture_output=True, text=True).stdout.strip().splitlines()[0]


def main():
    own, extra = sys.argv[1:], []
    if "--" in own:
        extra, own = own[own.index("--") + 1:], own[:own.index("--")]
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--app", default="build/seldinger")
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("--csv", default="bench/results/scenes.csv")
    parser.add_argument("scenes", nargs="+")
    options = parser.parse_args(own)
    os.makedirs(os.path.dirname(options.csv) or ".", exist_ok=True)
    fresh = not os.path.exists(options.csv)
    with open(options.csv, "a", newline="") as file:
        table = csv.writer(file)
        if fresh:
            table.writerow(["date", "commit", "compiler", "device", "scene", "options", "steps", "nodes", "contacts_max",
                            "steps_per_s", "lowest", "highest", *[s + "_ms" for s in STAGES], "state_hash"])
        for scene in options.scenes:
            runs = [run(options.app, scene, extra) for _ in range(options.repeat)]
            rates = sorted(r["steps_per_s"] for r in runs)
            stages = [statistics.median(r["stage_ms"][s] for r in runs) for s in STAGES]
            last = runs[-1]
            table.writerow([datetime.date.today(), output_of("git", "rev-parse", "--short", "HEAD"), output_of("c++", "--version"),
                            last["device"], scene, " ".join(extra), last["steps"], last["nodes"], last["contacts_max"],
                            f"{statistics.median(rates):.0f}", f"{rates[0]:.0f}", f"{rates[-1]:.0f}",
                            *[f"{s:.4f}" for s in stages], last["state_hash"]])
            print(f"{scene}: {statistics.median(rates):.0f} steps/s ({rates[0]:.0f} to {rates[-1]:.0f}), stages [ms]: " +
                  ", ".join(f"{n} {s:.3f}" for n, s in zip(STAGES, stages)))


if __name__ == "__main__":
    main()
