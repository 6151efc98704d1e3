#!/usr/bin/env python3
"""Do the bands of `--error-estimate` hold on scenes that they were not calibrated on?

    bench/error_bands.py [--app build/seldinger] [--shared ../shared] [-o bench/results/error-bands.csv] [--only NAME ...] [--table]

Scenes x steps of 1, 4 and 16.7 ms; true is the same scene with steps an eighth as long. `inside`: the true value lies in the band.
Scenes whose meshes are not part of the project are left out where --shared does not have them. --table prints the rows as Markdown.
"""
import argparse
import csv
import os
import pathlib
import sys
import tempfile

from readings import BANDS, STEPS, run

HERE = pathlib.Path(__file__).resolve().parent.parent
REFINED = 8
COLUMNS = ["scene", "dt_s", "reading", "value_n", "band_n", "true_n", "inside", "resolved", "warned"]

BEND = """[scene]
duration_s = 4.0
dt_s = 0.001
[wire]
length_m = 0.2
radius_m = 0.0004445
density = 7900.0
bend_nm2 = 5.0e-4
twist_nm2 = 3.8e-4
stretch_n = 1.0e4
nodes = 101
[[wire.section]]
from_tip_m = [0.0, 0.05]
bend_nm2 = 1.0e-5
twist_nm2 = 8.0e-6
[vessel]
youngs_pa = 1.0e6
shape = "arc"
radius_m = 0.004
bend_radius_m = 0.04
angle_deg = 150
lead_in_m = 0.02
lead_out_m = 0.04
axis = [1.0, 0.0, 0.0]
normal = [0.0, 0.0, 1.0]
triangles = 8000
[contact]
mu_static = 0.12
mu_sliding = 0.10
[feed]
inlet = "auto"
keys = [ {t_s = 0.0, advance_m = 0.015, turn_rad = 0.0}, {t_s = 4.0, advance_m = 0.12, turn_rad = 0.0} ]
"""


def scenes(shared):
    """name: (scene file or text, settings)"""
    assets = HERE / "assets" / "scenes"
    stiff = ["wire.preset=amplatz-super-stiff-035"]
    table = {"experiment1": (assets / "experiment1.toml", ["scene.duration_s=6"]),
             "bend of 150 degrees": (BEND, []),
             "phantom guide3d": (shared / "phantom/guide3d/example-feed.toml", []),
             "stiff wire, tha001-arch": (assets / "patients/tha001-arch.toml", stiff + ["scene.duration_s=14",
                                         f'vessel.mesh="{shared}/vessels/tha001-arch/aorta_arch_30k.stl"']),
             "lunderquist, tha001-arch": (assets / "patients/tha001-arch.toml", ["wire.preset=lunderquist-035", "scene.duration_s=20",
                                          f'vessel.mesh="{shared}/vessels/tha001-arch/aorta_arch_30k.stl"'])}
    meshes = {"phantom guide3d": "phantom/guide3d/mesh.stl"} | dict.fromkeys(("stiff wire, tha001-arch", "lunderquist, tha001-arch"),
                                                                             "vessels/tha001-arch/aorta_arch_30k.stl")
    return {name: case for name, case in table.items() if name not in meshes or (shared / meshes[name]).exists()}


def rows_of(app, name, scene, settings, step, folder):
    if isinstance(scene, str):
        text, scene = scene, pathlib.Path(folder) / "scene.toml"
        scene.write_text(text)
    told = run(app, scene, f"{folder}/told", step, "on", settings)
    true = run(app, scene, f"{folder}/true", step / REFINED, "off", settings)
    for reading in BANDS:
        band = told["error_estimate"][reading]
        what = "hand force" if reading.startswith("hand") else "friction"
        yield {"scene": name, "dt_s": f"{step:.6g}", "reading": reading, "value_n": f"{told[reading]:.6g}",
               "band_n": f"{band['band']:.6g}", "true_n": f"{true[reading]:.6g}",
               "inside": int(abs(told[reading] - true[reading]) <= band["band"]), "resolved": int(band["resolved"]),
               "warned": int(any(f"largest {what}" in line for line in told["warnings"]))}


def print_table(rows):
    print("| scene | step [ms] | hand force, largest [mN] | true | friction, largest [mN] | true |\n|---|---|---|---|---|---|")
    for hand, friction in zip(rows[::2], rows[1::2]):
        cells = [f"{1e3 * float(r['value_n']):.4g} ± {1e3 * float(r['band_n']):.2g}{' (warned)' if r['warned'] == '1' else ''} | "
                 f"{1e3 * float(r['true_n']):.4g}{'' if r['inside'] == '1' else ' **outside**'}" for r in (hand, friction)]
        print(f"| {hand['scene']} | {1e3 * float(hand['dt_s']):.3g} | {cells[0]} | {cells[1]} |")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--app", default=str(HERE / "build" / "seldinger"))
    parser.add_argument("--shared", type=pathlib.Path, default=HERE.parent / "shared")
    parser.add_argument("-o", "--output", type=pathlib.Path, default=HERE / "bench/results/error-bands.csv")
    parser.add_argument("--only", nargs="+", default=[], metavar="NAME", help="these scenes, again if they are done")
    parser.add_argument("--table", action="store_true", help="print the rows that are there as Markdown, run nothing")
    options = parser.parse_args()
    rows = list(csv.DictReader(open(options.output, newline=""))) if options.output.exists() else []
    if options.table:
        return print_table(rows)
    table = scenes(options.shared.resolve())
    if unknown := set(options.only) - set(table):
        sys.exit(f"error_bands.py: no such scene: {', '.join(sorted(unknown))}; there are {', '.join(table)}")
    chosen = options.only or [name for name in table if name not in {row["scene"] for row in rows}]
    with tempfile.TemporaryDirectory() as folder:
        for name in chosen:
            done = [row for step in sorted(STEPS) for row in rows_of(options.app, name, *table[name], step, folder)]
            rows = [row for row in rows if row["scene"] != name] + done
            new = options.output.with_suffix(".new")
            with open(new, "w", newline="") as stream:
                writer = csv.DictWriter(stream, COLUMNS, lineterminator="\n")
                writer.writeheader()
                writer.writerows(rows)
            os.replace(new, options.output)
    inside = sum(int(row["inside"]) for row in rows)
    print(f"{inside} of {len(rows)} true values inside their bands; {options.output}")


if __name__ == "__main__":
    main()
