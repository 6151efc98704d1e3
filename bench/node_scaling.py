#!/usr/bin/env python3
"""Time per step against the number of nodes: a clamped wire that swings under its weight, and a wire pushed along a tube.

    bench/node_scaling.py [--app build/seldinger] [--repeat 3] [--most 3200] [--csv bench/results/node_scaling.csv]

Processor time, so that other work on the machine counts little: that of 1,040 steps less that of 40, over 1,000; medians of the repeats.
Slope of log(time) against log(nodes) by least squares from 200 nodes on.
"""
import numpy as np

import runner

NODES = [25, 50, 100, 200, 400, 800, 1600, 3200]

WIRE = {"length_m": 0.4, "radius_m": 0.0004445, "density": 7900, "youngs_pa": 60.0e9, "poisson": 0.3}
SCENE = {"gravity": [0.0, 0.0, -9.81], "dt_s": 0.001, "record_every": 20}
SWING = runner.scene({"scene": SCENE, "wire": WIRE | {"place": runner.LEVEL}, "hold": [runner.HELD], "output": runner.QUIET})
TUBE = runner.scene({
    "scene": SCENE | {"start": "settled"}, "wire": WIRE | {"place": runner.LEVEL | {"base": [0.0, 0.0, -0.00455]}},
    "vessel": {"youngs_pa": 1.0e6, "shape": "tube", "radius_m": 0.005, "length_m": 0.6, "axis": [1.0, 0.0, 0.0], "triangles": 20000},
    "hold": [{"at": "base", "position": True, "direction": True, "velocity_m_s": [0.02, 0.0, 0.0]}], "output": runner.QUIET})


def time_step(app, scene, nodes, repeat):
    """(seconds per step, Newton iterations per step, contacts)"""
    def run(duration):
        return runner.run(app, scene, settings={"wire.nodes": nodes, "scene.duration_s": duration})

    rounds = runner.in_turn(repeat, long=lambda: run(1.04), short=lambda: run(0.04))
    trace = rounds["long"][-1].trace()
    seconds = runner.median(long.seconds - short.seconds for long, short in zip(rounds["long"], rounds["short"])) / 1000
    return seconds, trace["newton"].mean(), int(trace["contacts"].max())


def main():
    parser = runner.parser(__doc__, "")
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("--most", type=int, default=NODES[-1], help="nodes of the longest run")
    options = parser.parse_args()
    counts = [n for n in NODES if n <= options.most]
    table = runner.Table(options.csv, ["scene", "nodes", "us_per_step", "us_per_step_and_node", "newton_per_step", "contacts_max"])
    for name, scene in (("swing", SWING), ("tube", TUBE)):
        times = []
        for nodes in counts:
            seconds, iterations, contacts = time_step(options.app, scene, nodes, options.repeat)
            times.append(seconds)
            table.add([name, nodes, f"{1e6 * seconds:.1f}", f"{1e6 * seconds / nodes:.3f}", f"{iterations:.1f}", contacts])
        n, t = np.log(np.array([(a, b) for a, b in zip(counts, times) if a >= min(200, counts[-2])])).T
        print(f"{name}: slope {np.polyfit(n, t, 1)[0]:.2f}")


if __name__ == "__main__":
    main()
