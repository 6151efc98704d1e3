#!/usr/bin/env python3
"""Whether a run's readings depend on how its wire is sampled, and whether the band that it prints holds the true value.

    bench/readings.py [--app build/seldinger] [-o readings.csv] [--duration 14]

assets/scenes/aortic-arch.toml with 4, 8, 16 and 32 contact samples per edge and steps of 16.7, 4 and 1 ms; the true value of each
sampling is that of steps of 0.25 ms. `--error-estimate off` runs are compared by hash: the twin leaves the bits alone.
"""
import sys

import runner
from audit import largest_mean

SCENE = "assets/scenes/aortic-arch.toml"
SAMPLES = (4, 8, 16, 32)
STEPS = (1 / 60, 0.004, 0.001)
TRUE_STEP = 0.00025
BANDS = {"hand_force_peak_n": "hand_force_n", "friction_peak_n": "friction_n"}  # of the estimate: column of trace.csv


def told(app, settings, step, estimate):
    """Summary of one run, with `last` (row of trace.csv), `largest_sample_n` and the 20 ms peaks of BANDS."""
    run = runner.run(app, SCENE, settings=[f"scene.dt_s={step}", "scene.record_every=1", *settings], estimate=estimate)
    rows = run.rows()
    summary = run.summary | {"last": rows[-1], "largest_sample_n": max((row["normal_n"] for row in run.rows("contacts")), default=0.0)}
    for name, column in BANDS.items():
        summary[name] = largest_mean([abs(row[column]) for row in rows], [row["time_s"] for row in rows])
    return summary


def main():
    parser = runner.parser(__doc__)
    parser.add_argument("-o", "--output", default="readings.csv")
    parser.add_argument("--duration", type=float, default=14.0, help="of the runs [s]")
    options = parser.parse_args()
    inside = total = 0
    table = runner.Table(options.output, ["samples_per_edge", "dt_s", "largest_sample_n", "force_per_length_n_per_m", "patch_force_n", "contact_regions",
                                          "contacts"] + [part for name in BANDS for part in (name, name + "_band", name + "_true", name + "_inside")])
    for samples in SAMPLES:
        settings = [f"contact.samples_per_edge={samples}", f"scene.duration_s={options.duration}",
                    "output.force_window_m=0.0015"]
        true = told(options.app, settings, TRUE_STEP, "off")
        for step in STEPS:
            got = told(options.app, settings, step, "on")
            if told(options.app, settings, step, "off")["state_hash"] != got["state_hash"]:
                sys.exit("readings.py: the estimate has changed the run")
            row = [samples, f"{step:.6g}", got["largest_sample_n"], got["last"]["force_per_length_max_n_per_m"],
                   got["last"]["patch_force_max_n"], got["last"]["contact_regions"], got["last"]["contacts"]]
            for name in BANDS:
                band = got["error_estimate"][name]["band"]
                holds = abs(got[name] - true[name]) <= band
                inside, total = inside + holds, total + 1
                row += [got[name], band, true[name], int(holds)]
            table.add(row, show=False)
    print(f"{inside} of {total} true values inside their bands; {options.output}")


if __name__ == "__main__":
    main()
