#!/usr/bin/env python3
"""What each normal law costs and how far it lets the wire sink in, on one scene; one row per law, appended to a CSV.

    normal_laws.py [--app build/seldinger] [--csv bench/results/normal_laws.csv] [--laws a,b] SCENE.toml [-- --set key=value ...]

Newton iterations: mean and largest over steps. Overlap: deepest of each step, its mean over steps with contact and its worst, over the
wire's radius; and the mean over all contacts of 200 frames. `static`: the same mean of the depth at which the wall's own law carries each
contact's force without damping.
"""
import os
import re
import sys

import runner

LAWS = ["hunt-crossley", "lankarani-nikravesh", "augmented", "constraint", "impulse", "barrier"]


def mean(values):
    return sum(values) / len(values) if values else 0.0


def static_depth(per_metre, stiffness, exponent, limit):
    """depth with stiffness depth^n / (1 - depth/limit) = per_metre, by bisection"""
    low, high = 0.0, limit
    for _ in range(60):
        middle = (low + high) / 2
        if stiffness * middle**exponent < per_metre * (1 - middle / limit):
            low = middle
        else:
            high = middle
    return low


def law_row(app, scene, law, extra):
    # a frame every so often, without changing the simulation
    run = runner.run(app, scene, settings={"contact.normal": law, "scene.record_every": 1}, more=extra)
    summary, trace = run.summary, run.rows()
    radius = float(re.search(r"radius_m = ([\d.e+-]+)", (run.folder / "scene.toml").read_text()).group(1))
    newton = [row["newton"] for row in trace]
    deepest = [row["overlap_m"] for row in trace if row["contacts"] > 0]
    model = summary["model"]
    spacing = 1e-3 * float(re.search(r"([\d.e+-]+) mm apart", model["contact samples"]).group(1))
    stiffness, exponent = (float(x) for x in re.search(r"([\d.e+-]+) N/m.*exponent ([\d.]+)", model["line stiffness"]).groups())
    limit = 1e-3 * float(re.search(r"([\d.e+-]+) mm", model["overlap limit"]).group(1))
    overlaps, static = [], []
    for frame in sorted(run.folder.glob("contacts_*.vtp")):
        for force, gap in zip(*runner.vtp_arrays(frame, "normal_n", "gap", width=1)):
            overlaps.append(max(0.0, -gap))
            static.append(static_depth(force / spacing, stiffness, exponent, limit))
    return [law, len(trace), f"{mean(newton):.2f}", f"{max(newton):.0f}", summary["halved_steps"], f"{mean(deepest) / radius:.5f}",
            f"{max(deepest, default=0.0) / radius:.5f}", f"{mean(overlaps) / radius:.6f}", f"{mean(static) / radius:.6f}",
            f"{summary['friction_max_n']:.4g}", f"{summary['hand_force_n']:.4g}", f"{summary['outside_max_m']:.3g}",
            f"{summary['steps_per_s']:.0f}", summary["state_hash"]]


def main():
    own, extra = runner.split_extra(sys.argv[1:])
    parser = runner.parser(__doc__, "normal_laws.csv")
    parser.add_argument("--laws", default=",".join(LAWS))
    parser.add_argument("scene")
    options = parser.parse_args(own)
    header = ["scene", "options", "law", "steps", "newton_mean", "newton_max", "halved_steps", "deepest_mean_r", "deepest_max_r",
              "contact_mean_r", "static_mean_r", "friction_max_n", "hand_force_n", "outside_max_m", "steps_per_s", "state_hash"]
    table = runner.Table(options.csv, header, lambda row: True)
    for law in options.laws.split(","):
        row = [os.path.basename(options.scene), " ".join(extra), *law_row(options.app, options.scene, law, extra)]
        table.add(row, show=False)
        print("  ".join(f"{name} {value}" for name, value in zip(header[2:], row[2:])), flush=True)


if __name__ == "__main__":
    main()
