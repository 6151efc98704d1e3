#!/usr/bin/env python3
"""What adaptive nodes cost in accuracy where two instruments go together: the whole of experiment2-pair.toml with adaptive and with even
nodes against finer even ones.

    bench/adaptive_pair.py [--app build/seldinger] [--scene assets/scenes/experiment2-pair.toml] [--model merged] [--even 231 461]
                           [--fine 921] [--runs DIR] [--csv bench/results/validation/adaptive_pair.csv]

Every run is kept in --runs and used again. Nodes are those of each instrument, 0.6 m long. Errors are of the tips' positions and of the
hands' forces after every step, the latter smoothed over 20 ms; rms and largest over the run. Rows of another model stay in the table.
"""
import argparse
import csv
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

SMOOTH = 20  # steps of 1 ms
COLUMNS = ["model", "nodes", "nodes_at_end", "instrument", "tip_rms_mm", "tip_max_mm", "hand_rms_mn", "hand_max_mn", "hand_largest_mn"]


def run(app, scene, folder, overrides):
    """Runs the scene into `folder` unless a finished run is there."""
    if (folder / "summary.json").exists():
        return
    settings = {"scene.record_every": 1, "output.wire_every": 0, "output.contacts_every": 0, **overrides}
    command = [app, "run", scene, "-o", str(folder), "--overwrite", "--quiet", "--error-estimate", "off"]
    for key, value in settings.items():
        command += ["--set", f"{key}={value}"]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(command)}: exit {done.returncode}: {done.stderr.strip()}")


def read(folder, instrument):
    trace = np.genfromtxt(folder / f"trace_{instrument}.csv", delimiter=",", names=True)
    return {"nodes": trace["nodes"][-1],
            "tip": np.stack([trace[f"tip_{c}_m"] for c in "xyz"], axis=1),
            "hand": np.convolve(trace["hand_force_n"], np.ones(SMOOTH) / SMOOTH, mode="valid")}


def compare(got, fine):
    tip = 1e3 * np.linalg.norm(got["tip"] - fine["tip"], axis=1)
    hand = 1e3 * (got["hand"] - fine["hand"])
    return [np.sqrt(np.mean(tip ** 2)), tip.max(), np.sqrt(np.mean(hand ** 2)), np.abs(hand).max(), 1e3 * np.abs(fine["hand"]).max()]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--app", default="build/seldinger")
    parser.add_argument("--scene", default="assets/scenes/experiment2-pair.toml")
    parser.add_argument("--model", default="merged", choices=["merged", "separate"])
    parser.add_argument("--even", nargs="*", type=int, default=[231, 461])
    parser.add_argument("--fine", type=int, default=921)
    parser.add_argument("--runs")
    parser.add_argument("--csv", default="bench/results/validation/adaptive_pair.csv")
    options = parser.parse_args()
    runs = pathlib.Path(options.runs or tempfile.mkdtemp(prefix="adaptive-pair-"))

    def of(nodes):
        folder = runs / f"{options.model}-{nodes}"
        even = {} if nodes == "adaptive" else {f"instrument.{k}.nodes": nodes for k in (0, 1)}
        run(options.app, options.scene, folder, {"coaxial.model": f'"{options.model}"', **even})
        return {name: read(folder, name) for name in ("catheter", "wire")}

    fine = of(options.fine)
    path = pathlib.Path(options.csv)
    rows = []
    if path.exists():
        with open(path, newline="", encoding="utf-8") as file:
            rows = [row for row in list(csv.reader(file))[1:] if row[0] != options.model]
    for nodes in [*options.even, "adaptive"]:
        got = of(nodes)
        for name in ("catheter", "wire"):
            rows.append([options.model, str(nodes), f"{got[name]['nodes']:.0f}", name, *(f"{e:.3g}" for e in compare(got[name], fine[name]))])
            print(", ".join(f"{c} {v}" for c, v in zip(COLUMNS, rows[-1])), flush=True)
    path.parent.mkdir(parents=True, exist_ok=True)
    with open(path, "w", newline="", encoding="utf-8") as file:
        csv.writer(file, lineterminator="\n").writerows([COLUMNS, *rows])


if __name__ == "__main__":
    main()
