#!/usr/bin/env python3
"""Times whole scenes and appends one row per scene to a CSV: medians of repeats, mean time of each stage.

    bench_scenes.py [--app build/seldinger] [--repeat 3] [--csv bench/results/scenes.csv] SCENE.toml [SCENE.toml ...] [-- --set key=value ...]
    bench_scenes.py --old OTHER/seldinger ...      old and new in turn, and old over new in processor seconds; the rows are the new one's
"""
import datetime
import json
import sys
import tempfile

import runner

STAGES = ["detect", "evaluate", "reduce", "solve", "wall", "adapt", "record"]
COLUMNS = ["date", "commit", "compiler", "device", "scene", "options", "steps", "nodes", "contacts_max", "steps_per_s", "lowest", "highest",
           *[s + "_ms" for s in STAGES], "state_hash"]


def timed(app, scene, extra):
    with tempfile.TemporaryDirectory() as folder:
        done = runner.call([app, "run", scene, "-o", folder + "/run", "--json", "--quiet", *extra])
        return json.loads(done.stdout) | {"processor_s": done.seconds}


def output_of(*command):
    return runner.call(command).stdout.strip().splitlines()[0]


def main():
    own, extra = runner.split_extra(sys.argv[1:])
    parser = runner.parser(__doc__, "scenes.csv")
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("--old", help="another build's program")
    parser.add_argument("scenes", nargs="+")
    options = parser.parse_args(own)
    table = runner.Table(options.csv, COLUMNS, lambda row: True)
    for scene in options.scenes:
        programs = {"new": options.app} | ({"old": options.old} if options.old else {})
        rounds = runner.in_turn(options.repeat, **{name: lambda app=app: timed(app, scene, extra) for name, app in programs.items()})
        runs = rounds["new"]
        rates = [r["steps_per_s"] for r in runs]
        stages = [runner.median(r["stage_ms"][s] for r in runs) for s in STAGES]
        last = runs[-1]
        table.add([datetime.date.today(), output_of("git", "rev-parse", "--short", "HEAD"), output_of("c++", "--version"), last["device"], scene,
                   " ".join(extra), last["steps"], last["nodes"], last["contacts_max"], f"{runner.median(rates):.0f}", f"{min(rates):.0f}",
                   f"{max(rates):.0f}", *[f"{s:.4f}" for s in stages], last["state_hash"]], show=False)
        print(f"{scene}: {runner.median(rates):.0f} steps/s ({min(rates):.0f} to {max(rates):.0f}), stages [ms]: " +
              ", ".join(f"{n} {s:.3f}" for n, s in zip(STAGES, stages)))
        if options.old:
            ratios = [old["processor_s"] / new["processor_s"] for old, new in zip(rounds["old"], runs)]
            print(f"  old over new, processor seconds: median {runner.median(ratios):.3f} ({min(ratios):.3f} to {max(ratios):.3f}), "
                  f"{'same' if rounds['old'][-1]['state_hash'] == last['state_hash'] else 'another'} state")


if __name__ == "__main__":
    main()
