#!/usr/bin/env python3
"""Does `seldinger plan --peak-force-tolerance` keep its promise?

    bench/validate_peaks.py [--app build/seldinger] [-o out/validate-peaks] [--csv bench/results/planned-peaks.csv] [--only NAME ...]
                            [--budget S] [--asked 0.1] [--table]

Scenes of bench/validate_plan.py, planned for peaks within 10 %, or what is asked. The planned scene and a finer one (twice the edges and half the step
of the plan's own reference, run by `seldinger run`) are compared by the largest 20 ms means of hand force, friction and force per
length in trace.csv. `known_to` is what the finer one moved from the plan's own reference. --table prints the rows as Markdown.
"""
import json
import pathlib

import runner
from audit import largest_mean
from validate_plan import scenes

HERE = runner.ROOT
SCENES = ("tube", "tube-narrow", "bend", "bend-coarse", "u-turn", "siphon", "hook-turned", "push-pull")
LEAST = 1e-3  # [N]: a share is one of so much at least; of a force per length on one diameter of the wire
PEAKS = {"hand_force_n": "hand_force_n", "friction_n": "friction_n", "force_per_length_n_per_m": "force_per_length_max_n_per_m"}
COLUMNS = ["scene", "asked", "status", "chosen"] + [f"{name}{what}" for name in PEAKS for what in ("", "_expected", "_error", "_known_to")] + ["within"]


def peaks(app, scene, folder, settings=()):
    rows = runner.run(app, scene, folder, ["scene.record_every=1", *settings], estimate="off").rows()
    times = [row["time_s"] for row in rows]
    return {name: largest_mean([abs(row[column]) for row in rows], times) for name, column in PEAKS.items()}


def validate(app, folder, name, tolerance, text, budget, asked):
    folder.mkdir(parents=True, exist_ok=True)
    scene = folder / "scene.toml"
    scene.write_text(text)
    plan = json.loads(runner.call([app, "plan", scene, "--tolerance", f"{tolerance}mm", "--peak-force-tolerance", f"{100 * asked:g}%",
                                   "--budget", budget, "--json", "-o", folder / "planned.toml"], (0, 4, 6)).stdout)
    row = dict.fromkeys(COLUMNS, "") | {"scene": name, "asked": f"{asked:g}", "status": plan["status"]}
    if plan["status"] != "planned":
        print(f"{name}: {plan['message']}", flush=True)
        return row
    own = plan["reference"]
    got = peaks(app, folder / "planned.toml", folder / "run")
    finer = peaks(app, scene, folder / "finer", [f"wire.nodes={2 * own['nodes'] - 1}", f"scene.dt_s={own['dt_s'] / 2!r}"])
    row["chosen"] = plan["chosen"]["model"]
    for peak, right in finer.items():
        row |= {peak: f"{right:.5g}", f"{peak}_expected": f"{plan['chosen']['peak_error'][peak] / right:.3g}",
                f"{peak}_error": f"{abs(got[peak] - right) / right:.3g}", f"{peak}_known_to": f"{abs(own['peaks'][peak] - right) / right:.2g}"}
    diameter = 2 * float(text.split("radius_m = ")[1].split("\n")[0])
    row["within"] = int(all(abs(got[peak] - right) <= asked * max(right, LEAST / (diameter if "per_length" in peak else 1))
                            for peak, right in finer.items()))
    print(f"{name}: {row['chosen']}: " + ", ".join(f"{peak} {row[f'{peak}_error']}" for peak in PEAKS), flush=True)
    return row


def print_table(rows):
    print("| scene | asked | chosen | hand force [mN] | error | friction [mN] | error | force per length [N/m] | error |\n"
          "|---|---|---|---|---|---|---|---|---|")
    for r in rows:
        if r["status"] != "planned":
            print(f"| {r['scene']} | {100 * float(r['asked']):g} % | {r['status']} | | | | | | |")
            continue
        cells = []
        for peak in PEAKS:
            value = float(r[peak]) * (1 if peak.startswith("force") else 1e3)
            cells.append(f"{value:.3g} | {100 * float(r[peak + '_error']):.2g} % ({100 * float(r[peak + '_expected']):.2g})")
        print(f"| {r['scene']} | {100 * float(r['asked']):g} % | {r['chosen']} | {' | '.join(cells)} |{'' if r['within'] == '1' else ' **outside**'}")


def main():
    parser = runner.parser(__doc__, "planned-peaks.csv")
    parser.add_argument("-o", "--output", type=pathlib.Path, default=HERE / "out" / "validate-peaks")
    parser.add_argument("--only", nargs="+", default=[], metavar="NAME", help="these scenes, again if they are done")
    parser.add_argument("--budget", type=float, default=60, metavar="S", help="of each plan")
    parser.add_argument("--asked", type=float, default=0.1, metavar="SHARE", help="of each peak (default: 0.1)")
    parser.add_argument("--table", action="store_true", help="print the rows that are there as Markdown, run nothing")
    options = parser.parse_args()
    rows = {r["scene"]: r for r in runner.read_rows(options.csv)}
    if options.table:
        return print_table(rows.values())
    for name, tolerance, _, text in scenes(pathlib.Path()):
        if name not in (options.only or SCENES) or name in rows and not options.only:
            continue
        rows[name] = validate(options.app, options.output / name, name, tolerance, text, options.budget, options.asked)
        runner.write_rows(options.csv, list(rows.values()), COLUMNS)


if __name__ == "__main__":
    main()
