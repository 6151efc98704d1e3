#!/usr/bin/env python3
"""Newton iterations per step by friction law and coefficient: experiment 2 to 24 cm, mean over steps in contact and largest. Rows go to a CSV.

    newton_iterations.py [--app build/seldinger] [--csv bench/results/validation/newton.csv] [--scene assets/scenes/experiment2.toml]
                         [--duration 12]
"""
import sys

import runner

CASES = [("none", 0.1)] + [(law, mu) for law in ("stick-slip", "smooth", "sign") for mu in (0.1, 0.48)]


def main():
    parser = runner.parser(__doc__, "validation/newton.csv")
    parser.add_argument("--scene", default="assets/scenes/experiment2.toml")
    parser.add_argument("--duration", type=float, default=12.0)
    options = parser.parse_args()
    table = runner.Table(options.csv, ["friction", "mu", "steps_in_contact", "iterations_mean", "iterations_largest", "iterations_99th", "halved_steps"])
    for law, mu in CASES:
        run = runner.run(options.app, options.scene, settings={
            "contact.friction": law, "contact.mu_static": mu, "contact.mu_sliding": mu, "scene.duration_s": options.duration,
            "scene.record_every": 1, "output.wire_every": 0, "output.contacts_every": 0})
        counts = sorted(row["newton"] for row in run.rows() if row["contacts"] > 0) or sys.exit("got a run without contact. Fix: a longer --duration")
        table.add([law, mu, len(counts), f"{sum(counts) / len(counts):.2f}", int(counts[-1]), int(counts[int(0.99 * len(counts))]),
                   run.summary["halved_steps"]])


if __name__ == "__main__":
    main()
