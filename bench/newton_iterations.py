#!/usr/bin/env python3
"""Newton iterations per step by friction law and coefficient: experiment 2 to 24 cm, mean over steps in contact and largest. Rows go to a CSV.

    newton_iterations.py [--app build/seldinger] [--csv bench/results/validation/newton.csv] [--scene assets/scenes/experiment2.toml]
                         [--duration 12]
"""
import argparse
import csv
import os

from validate_contact import Run

CASES = [("none", 0.1)] + [(law, mu) for law in ("stick-slip", "smooth", "sign") for mu in (0.1, 0.48)]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--app", default="build/seldinger")
    parser.add_argument("--csv", default="bench/results/validation/newton.csv")
    parser.add_argument("--scene", default="assets/scenes/experiment2.toml")
    parser.add_argument("--duration", type=float, default=12.0)
    options = parser.parse_args()
    os.makedirs(os.path.dirname(options.csv) or ".", exist_ok=True)
    with open(options.csv, "w", newline="") as file:
        table = csv.writer(file)
        table.writerow(["friction", "mu", "steps_in_contact", "iterations_mean", "iterations_largest", "iterations_99th", "halved_steps", "command"])
        for law, mu in CASES:
            run = Run(options.app, options.scene, contact__friction=law, contact__mu_static=mu, contact__mu_sliding=mu,
                      scene__duration_s=options.duration, scene__record_every=1, output__wire_every=0, output__contacts_every=0)
            counts = sorted(row["newton"] for row in run.trace if row["contacts"] > 0)
            row = [law, mu, len(counts), f"{sum(counts) / len(counts):.2f}", int(counts[-1]), int(counts[int(0.99 * len(counts))]),
                   run.summary["halved_steps"], run.command]
            table.writerow(row)
            file.flush()
            print(*row[:-1], sep="  ", flush=True)


if __name__ == "__main__":
    main()
