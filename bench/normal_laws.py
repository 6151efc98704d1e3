#!/usr/bin/env python3
"""What each normal law costs and how far it lets the wire sink in, on one scene; one row per law, appended to a CSV.

    normal_laws.py [--app build/seldinger] [--csv bench/results/normal_laws.csv] [--laws a,b] SCENE.toml [-- --set key=value ...]

Newton iterations: mean and largest over steps. Overlap: deepest of each step, its mean over steps with contact and its worst, over the
wire's radius; and the mean over all contacts of 200 frames. `static`: the same mean of the depth at which the wall's own law carries each
contact's force without damping.
"""
import argparse
import csv
import json
import os
import re
import struct
import subprocess
import sys
import tempfile

LAWS = ["hunt-crossley", "lankarani-nikravesh", "augmented", "constraint", "impulse", "barrier"]


def mean(values):
    return sum(values) / len(values) if values else 0.0


def frame_arrays(path):
    """normal_n and gap of one frame of contacts (.vtp, raw appended doubles)."""
    data = open(path, "rb").read()
    start = data.index(b"_", data.index(b"<AppendedData")) + 1
    arrays = []
    for name in (b"normal_n", b"gap"):
        offset = int(re.search(rb'Name="' + name + rb'"[^>]*offset="(\d+)"', data).group(1))
        size = struct.unpack_from("<Q", data, start + offset)[0]
        arrays.append(struct.unpack_from(f"<{size // 8}d", data, start + offset + 8))
    return arrays


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


def law_row(app, scene, law, extra, folder):
    out = os.path.join(folder, law)
    # a frame every so often, without changing the simulation
    command = [app, "run", scene, "-o", out, "--json", "--quiet", "--set", f"contact.normal={law}", "--set", "scene.record_every=1", *extra]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(command)}: exit {done.returncode}: {done.stderr.strip()}")
    summary = json.loads(done.stdout)
    radius = float(re.search(r"radius_m = ([\d.e+-]+)", open(os.path.join(out, "scene.toml")).read()).group(1))
    trace = list(csv.DictReader(open(os.path.join(out, "trace.csv"))))
    newton = [float(row["newton"]) for row in trace]
    deepest = [float(row["overlap_m"]) for row in trace if float(row["contacts"]) > 0]
    model = summary["model"]
    spacing = 1e-3 * float(re.search(r"([\d.e+-]+) mm apart", model["contact samples"]).group(1))
    stiffness, exponent = (float(x) for x in re.search(r"([\d.e+-]+) N/m.*exponent ([\d.]+)", model["line stiffness"]).groups())
    limit = 1e-3 * float(re.search(r"([\d.e+-]+) mm", model["overlap limit"]).group(1))
    overlaps, static = [], []
    for name in sorted(os.listdir(out)):
        if re.fullmatch(r"contacts_\d+\.vtp", name):
            for force, gap in zip(*frame_arrays(os.path.join(out, name))):
                overlaps.append(max(0.0, -gap))
                static.append(static_depth(force / spacing, stiffness, exponent, limit))
    return [law, len(trace), f"{mean(newton):.2f}", f"{max(newton):.0f}", summary["halved_steps"], f"{mean(deepest) / radius:.5f}",
            f"{max(deepest, default=0.0) / radius:.5f}", f"{mean(overlaps) / radius:.6f}", f"{mean(static) / radius:.6f}",
            f"{summary['friction_max_n']:.4g}", f"{summary['hand_force_n']:.4g}", f"{summary['outside_max_m']:.3g}",
            f"{summary['steps_per_s']:.0f}", summary["state_hash"]]


def main():
    own, extra = sys.argv[1:], []
    if "--" in own:
        extra, own = own[own.index("--") + 1:], own[:own.index("--")]
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--app", default="build/seldinger")
    parser.add_argument("--csv", default="bench/results/normal_laws.csv")
    parser.add_argument("--laws", default=",".join(LAWS))
    parser.add_argument("scene")
    options = parser.parse_args(own)
    os.makedirs(os.path.dirname(options.csv) or ".", exist_ok=True)
    fresh = not os.path.exists(options.csv)
    with open(options.csv, "a", newline="") as file, tempfile.TemporaryDirectory() as folder:
        table = csv.writer(file)
        header = ["scene", "options", "law", "steps", "newton_mean", "newton_max", "halved_steps", "deepest_mean_r", "deepest_max_r",
                  "contact_mean_r", "static_mean_r", "friction_max_n", "hand_force_n", "outside_max_m", "steps_per_s", "state_hash"]
        if fresh:
            table.writerow(header)
        for law in options.laws.split(","):
            row = [os.path.basename(options.scene), " ".join(extra), *law_row(options.app, options.scene, law, extra, folder)]
            table.writerow(row)
            file.flush()
            print("  ".join(f"{name} {value}" for name, value in zip(header[2:], row[2:])))


if __name__ == "__main__":
    main()
