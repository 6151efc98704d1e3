#!/usr/bin/env python3
"""What adaptive nodes save: experiment 2 (first 24 cm) with uniform and with adaptive nodes against a fine uniform wire.

    bench/adaptive_nodes.py --scene SCENE.toml [--app build/seldinger] [--runs DIR] [--csv bench/results/validation/adaptive_nodes.csv]
                            [--adaptive 1e-6 2e-6] [--fine 2001]

Every run is kept in --runs and used again: the fine one takes minutes. Errors are of the tip's position at every 0.1 s, of the hand
force and of the friction, both smoothed over 20 ms; rms and largest over the run. `saved` of the adaptive rows: nodes (mean over the
run) that a uniform wire needs for the same error over those of the adaptive one, by linear interpolation of log(error) against
log(nodes) between the uniform rows.
"""
import argparse
import csv
import os
import pathlib
import re
import struct
import subprocess
import sys

import numpy as np

LENGTH = 0.6      # [m], of the scene's wire
UNTIL = 12.0      # [s]: 24 cm at 2 cm/s
SMOOTH = 20       # steps of 1 ms
QUANTITIES = {"tip": 1e3, "hand": 1e3, "friction": 1e3}  # written in mm and mN


def run(app, scene, folder, overrides):
    """Runs the scene into `folder` unless a finished run is there."""
    if (folder / "summary.json").exists():
        return
    settings = {"scene.duration_s": UNTIL, "scene.record_every": 1, "output.wire_every": 100, "output.contacts_every": 0, **overrides}
    command = [app, "run", scene, "-o", str(folder), "--overwrite", "--quiet"]
    for key, value in settings.items():
        command += ["--set", f"{key}={value}"]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(command)}: exit {done.returncode}: {done.stderr.strip()}")


def tip_of(frame):
    """Position of node 0 [m] in a .vtp frame with raw appended doubles."""
    data = frame.read_bytes()
    offset = int(re.search(rb'Name="Points"[^>]*offset="(\d+)"', data).group(1))
    begin = data.index(b"_", data.index(b"<AppendedData")) + 1 + offset + 8  # 8: the block's own size
    return struct.unpack_from("<3d", data, begin)


def smoothed(values):
    return np.convolve(values, np.ones(SMOOTH) / SMOOTH, mode="valid")


def read(folder):
    trace = np.genfromtxt(folder / "trace.csv", delimiter=",", names=True)
    return {"nodes": trace["nodes"],
            "tip": np.array([tip_of(f) for f in sorted(folder.glob("wire_*.vtp"))]),
            "hand": smoothed(trace["hand_force_n"]),
            "friction": smoothed(trace["friction_n"])}


def errors(result, fine):
    """{quantity: (rms, largest)} [m] or [N]"""
    found = {}
    for name in QUANTITIES:
        distance = np.abs(result[name] - fine[name])
        if distance.ndim == 2:
            distance = np.linalg.norm(result[name] - fine[name], axis=1)
        found[name] = (float(np.sqrt(np.mean(distance**2))), float(distance.max()))
    return found


def equivalent_nodes(error, uniform):
    """Mean nodes of a uniform wire with this error. @param uniform [(nodes, error)] in order of nodes"""
    logs = np.log(np.array(uniform))
    for (n0, e0), (n1, e1) in zip(logs, logs[1:]):
        if e1 <= np.log(error) <= e0 or n1 == logs[-1][0]:
            return float(np.exp(n0 + (np.log(error) - e0) / (e1 - e0) * (n1 - n0)))
    return float("nan")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--app", default="build/seldinger")
    parser.add_argument("--scene", required=True, help="experiment 2 (assets/scenes/experiment2.toml, or on the patient's arch)")
    parser.add_argument("--runs", default="adaptive-runs", help="folder of the runs")
    parser.add_argument("--csv", default="bench/results/validation/adaptive_nodes.csv")
    parser.add_argument("--fine", type=int, default=2001, help="nodes over the whole wire of the run that errors are taken against")
    parser.add_argument("--uniform", type=int, nargs="*", default=[51, 101, 201, 401])
    parser.add_argument("--adaptive", type=float, nargs="*", default=[0.5e-6, 1e-6, 2e-6, 4e-6], help="wire.edge_error_m of the adaptive runs")
    options = parser.parse_args()
    runs = pathlib.Path(options.runs)
    runs.mkdir(parents=True, exist_ok=True)

    def result(name, overrides):
        run(options.app, options.scene, runs / name, overrides)
        return read(runs / name)

    fine = result(f"uniform-{options.fine}", {"wire.nodes": options.fine})
    rows, uniform = [], []
    for nodes in options.uniform:
        found = result(f"uniform-{nodes}", {"wire.nodes": nodes})
        uniform.append(((found["nodes"][-1], found["nodes"].mean()), errors(found, fine)))
        rows.append((f"uniform {nodes}", found["nodes"], uniform[-1][1], False))
    for allowed in options.adaptive:
        found = result(f"adaptive-{allowed:g}", {"wire.nodes": "adaptive", "wire.edge_error_m": allowed})
        rows.append((f"adaptive {allowed:g}", found["nodes"], errors(found, fine), True))

    with open(options.csv, "w", newline="") as file:
        table = csv.writer(file)
        table.writerow(["wire", "nodes_end", "nodes_mean", *[f"{q}_{k}_{u}" for q, u in
                        (("tip", "mm"), ("hand", "mn"), ("friction", "mn")) for k in ("rms", "max")],
                        *[f"saved_{q}_{k}" for k in ("end", "mean") for q in QUANTITIES]])
        for name, nodes, found, adaptive in rows:
            line = [name, int(nodes[-1]), f"{nodes.mean():.1f}"]
            line += [f"{found[q][k] * scale:.3g}" for q, scale in QUANTITIES.items() for k in (0, 1)]
            if adaptive:
                line += [f"{equivalent_nodes(found[q][0], [(n[k], e[q][0]) for n, e in uniform]) / (nodes[-1], nodes.mean())[k]:.2f}"
                         for k in (0, 1) for q in QUANTITIES]
            else:
                line += [""] * 2 * len(QUANTITIES)
            table.writerow(line)
            print(("{:>18}" + "{:>10}" * (len(line) - 1)).format(*line))


if __name__ == "__main__":
    os.environ.setdefault("POCL_CACHE_DIR", "build/pocl-cache")
    main()
