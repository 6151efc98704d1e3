#!/usr/bin/env python3
"""Instruments of one centreline (D12) against a measured robot of three nested tubes, and against an independent model of it.

    validate_tubes.py PHANTOM [--program build/bench/tube_tips] [--rows N] [--edge MM]

PHANTOM holds data.csv (joints and measured tips) and model.py (bending and torsion by shooting; asked where numpy and scipy are
there). Prints the tip's error against the measurement at the nominal parameters, and how far apart the two models are."""
import argparse
import csv
import importlib.util
import math
import pathlib
import subprocess
import tempfile

JOINTS = [f"rotation{k}_rad" for k in (1, 2, 3)] + [f"translation{k}_mm" for k in (1, 2, 3)]
TIP = ["tip_x_mm", "tip_y_mm", "tip_z_mm"]


def tips_of_program(program, joints, edge):
    with tempfile.NamedTemporaryFile("w", suffix=".txt") as table:
        table.writelines(" ".join(map(str, row)) + "\n" for row in joints)
        table.flush()
        run = subprocess.run([program, table.name, str(edge)], stdout=subprocess.PIPE, text=True, check=True)
    return [[float(number) for number in line.split()] for line in run.stdout.splitlines()]


def tips_of_model(phantom, joints):
    """None where its libraries are not there."""
    try:
        import numpy as np

        spec = importlib.util.spec_from_file_location("model", phantom / "model.py")
        model = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(model)
    except ImportError:
        return None
    table = np.array(joints)
    return model.tip_frame(table[:, :3], table[:, 3:], model.NOMINAL)[0].tolist()


def report(name, ours, theirs):
    miss = [math.dist(a, b) for a, b in zip(ours, theirs, strict=True)]
    print(f"{name}: {len(miss)} rows, mean {sum(miss) / len(miss):.3f} mm, largest {max(miss):.3f} mm")


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("phantom", type=pathlib.Path)
    arguments.add_argument("--program", default="build/bench/tube_tips")
    arguments.add_argument("--rows", type=int, default=None)
    arguments.add_argument("--edge", type=float, default=1.5, help="of the line [mm]")
    options = arguments.parse_args()
    with open(options.phantom / "data.csv", newline="") as table:
        rows = list(csv.DictReader(table))[: options.rows]
    joints = [[float(row[name]) for name in JOINTS] for row in rows]
    measured = [[float(row[name]) for name in TIP] for row in rows]
    merged = tips_of_program(options.program, joints, options.edge)
    report("merged against the measurement", merged, measured)
    independent = tips_of_model(options.phantom, joints)
    if independent is None:
        return print("model.py not asked: it needs numpy and scipy")
    report("independent model against the measurement", independent, measured)
    report("merged against the independent model", merged, independent)


if __name__ == "__main__":
    main()
