#!/usr/bin/env python3
"""Time per step against the number of nodes: a clamped wire that swings under its weight, and a wire pushed along a tube.

    bench/node_scaling.py [--app build/seldinger] [--repeat 3] [--most 3200] [--csv bench/results/node_scaling.csv]

Processor time, so that other work on the machine counts little: that of 1,040 steps less that of 40, over 1,000; medians of the repeats.
Slope of log(time) against log(nodes) by least squares from 200 nodes on.
"""
import argparse
import csv
import pathlib
import resource
import subprocess
import statistics
import sys
import tempfile

import numpy as np

NODES = [25, 50, 100, 200, 400, 800, 1600, 3200]

SWING = """[scene]
gravity = [0.0, 0.0, -9.81]
duration_s = 0.24
dt_s = 0.001
record_every = 20
[wire]
length_m = 0.4
radius_m = 0.0004445
density = 7900
youngs_pa = 60.0e9
poisson = 0.3
place = { shape = "straight", direction = [1.0, 0.0, 0.0] }
[[hold]]
at = "base"
position = true
direction = true
spin = true
[output]
wire_every = 0
contacts_every = 0
"""

TUBE = (SWING.split("[[hold]]")[0].replace("[wire]", 'start = "settled"\n[wire]')
        .replace("direction = [1.0, 0.0, 0.0]", "base = [0.0, 0.0, -0.00455], direction = [1.0, 0.0, 0.0]")) + """[vessel]
youngs_pa = 1.0e6
shape = "tube"
radius_m = 0.005
length_m = 0.6
axis = [1.0, 0.0, 0.0]
triangles = 20000
[[hold]]
at = "base"
position = true
direction = true
velocity_m_s = [0.02, 0.0, 0.0]
[output]
wire_every = 0
contacts_every = 0
"""


def processor_seconds(command):
    """Of a child, user and system."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(command)}: exit {done.returncode}: {done.stderr.strip()}")
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def time_step(app, scene, nodes, repeat):
    """(seconds per step, Newton iterations per step, contacts)"""
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder)
        (path / "scene.toml").write_text(scene)

        def run(duration):
            return processor_seconds([app, "run", str(path / "scene.toml"), "-o", str(path / "run"), "--overwrite", "--quiet",
                                      "--set", f"wire.nodes={nodes}", "--set", f"scene.duration_s={duration}"])

        best = statistics.median(run(1.04) - run(0.04) for _ in range(repeat)) / 1000
        trace = np.genfromtxt(path / "run" / "trace.csv", delimiter=",", names=True)
        return best, trace["newton"].mean(), int(trace["contacts"].max())


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--app", default="build/seldinger")
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("--most", type=int, default=NODES[-1], help="nodes of the longest run")
    parser.add_argument("--csv", default="")
    options = parser.parse_args()
    counts = [n for n in NODES if n <= options.most]
    rows = []
    for name, scene in (("swing", SWING), ("tube", TUBE)):
        times = []
        for nodes in counts:
            seconds, iterations, contacts = time_step(options.app, scene, nodes, options.repeat)
            times.append(seconds)
            rows.append([name, nodes, f"{1e6 * seconds:.1f}", f"{1e6 * seconds / nodes:.3f}", f"{iterations:.1f}", contacts])
            print(("{:>8}" * 6).format(*rows[-1]), flush=True)
        n, t = np.log(np.array([(a, b) for a, b in zip(counts, times) if a >= min(200, counts[-2])])).T
        print(f"{name}: slope {np.polyfit(n, t, 1)[0]:.2f}")
    if options.csv:
        with open(options.csv, "w", newline="") as file:
            table = csv.writer(file, lineterminator="\n")
            table.writerow(["scene", "nodes", "us_per_step", "us_per_step_and_node", "newton_per_step", "contacts_max"])
            table.writerows(rows)


if __name__ == "__main__":
    main()
