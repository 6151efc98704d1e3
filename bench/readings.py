#!/usr/bin/env python3
"""Whether a run's readings depend on how its wire is sampled, and whether the band that it prints holds the true value.

    bench/readings.py [--app build/seldinger] [-o readings.csv] [--duration 14]

assets/scenes/aortic-arch.toml with 4, 8, 16 and 32 contact samples per edge and steps of 16.7, 4 and 1 ms; the true value of each
sampling is that of steps of 0.25 ms. `--error-estimate off` runs are compared by hash: the twin leaves the bits alone.
"""
import argparse
import csv
import json
import pathlib
import subprocess
import sys
import tempfile

from audit import largest_mean

SCENE = "assets/scenes/aortic-arch.toml"
SAMPLES = (4, 8, 16, 32)
STEPS = (1 / 60, 0.004, 0.001)
TRUE_STEP = 0.00025
BANDS = {"hand_force_peak_n": "hand_force_n", "friction_peak_n": "friction_n"}  # of the estimate: column of trace.csv


def run(app, scene, folder, step, estimate, settings=()):
    """Summary of one run, with `last` (row of trace.csv), `largest_sample_n` and the 20 ms peaks of BANDS."""
    options = [f"scene.dt_s={step}", "scene.record_every=1", *settings]
    done = subprocess.run([app, "run", scene, "-o", folder, "--overwrite", "--quiet", "--error-estimate", estimate]
                          + [word for option in options for word in ("--set", option)])
    if done.returncode:
        sys.exit(f"{pathlib.Path(sys.argv[0]).name}: {scene} at {step} s: exit {done.returncode}")
    summary = json.loads((pathlib.Path(folder) / "summary.json").read_text())
    with open(pathlib.Path(folder) / "contacts.csv", newline="") as stream:
        summary["largest_sample_n"] = max((float(row["normal_n"]) for row in csv.DictReader(stream)), default=0.0)
    with open(pathlib.Path(folder) / "trace.csv", newline="") as stream:
        rows = list(csv.DictReader(stream))
    summary["last"] = rows[-1]
    for name, column in BANDS.items():
        summary[name] = largest_mean([abs(float(row[column])) for row in rows], [float(row["time_s"]) for row in rows])
    return summary


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--app", default="build/seldinger")
    parser.add_argument("-o", "--output", default="readings.csv")
    parser.add_argument("--duration", type=float, default=14.0, help="of the runs [s]")
    options = parser.parse_args()
    inside = total = 0
    with tempfile.TemporaryDirectory() as folder, open(options.output, "w", newline="") as stream:
        table = csv.writer(stream)
        table.writerow(["samples_per_edge", "dt_s", "largest_sample_n", "force_per_length_n_per_m", "patch_force_n", "contact_regions",
                        "contacts"] + [part for name in BANDS for part in (name, name + "_band", name + "_true", name + "_inside")])
        for samples in SAMPLES:
            settings = ["contact.detection=capsule", f"contact.samples_per_edge={samples}", f"scene.duration_s={options.duration}",
                        "output.force_window_m=0.0015"]

            def run_at(step, estimate):
                return run(options.app, SCENE, folder, step, estimate, settings)

            true = run_at(TRUE_STEP, "off")
            for step in STEPS:
                told = run_at(step, "on")
                if run_at(step, "off")["state_hash"] != told["state_hash"]:
                    sys.exit("readings.py: the estimate has changed the run")
                row = [samples, f"{step:.6g}", told["largest_sample_n"], told["last"]["force_per_length_max_n_per_m"],
                       told["last"]["patch_force_max_n"], told["last"]["contact_regions"], told["last"]["contacts"]]
                for name in BANDS:
                    band = told["error_estimate"][name]
                    holds = abs(told[name] - true[name]) <= band["band"]
                    inside, total = inside + holds, total + 1
                    row += [told[name], band["band"], true[name], int(holds)]
                table.writerow(row)
                stream.flush()
    print(f"{inside} of {total} true values inside their bands; {options.output}")


if __name__ == "__main__":
    main()
