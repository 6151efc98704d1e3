#!/usr/bin/env python3
"""What labels cost, and how many labelled X-rays an hour two cores make.

Two runs (one wire: the demo; three instruments: sheath-catheter-wire.toml), pictures of 512 and 1024 pixels with body and noise, the arm
standing still. Each command runs with and without --labels in turn; the cost is the difference of processor times (user + system) of
the best round, so that other processes on the machine count little. Frames an hour on two cores: `farm --jobs 2`, one thread each, start
and planning included, from its processor time as if both cores were busy all the time and nothing else ran.

    python3 bench/label_speed.py [--app build/seldinger] [--frames 60] [--rounds 3] [--csv FILE]
"""

import argparse
import csv
import os
import pathlib
import shutil
import subprocess
import tempfile

SCENES = {1: ("aortic-arch.toml", ["scene.duration_s=6", "output.wire_every=50", "output.contacts_every=50", "scene.record_every=50"]),
          3: ("sheath-catheter-wire.toml", ["scene.duration_s=6", "output.wire_every=50", "output.contacts_every=50", "scene.record_every=50"])}
ROOT = pathlib.Path(__file__).resolve().parents[1]


def processor_seconds(words):
    before = os.times()
    subprocess.run(words, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    after = os.times()
    return after.children_user - before.children_user + after.children_system - before.children_system


def make_run(app, folder, instruments):
    scene, changes = SCENES[instruments]
    sets = [word for change in changes for word in ("--set", change)]
    subprocess.run([app, "run", str(ROOT / "assets/scenes" / scene), "-o", str(folder), "--quiet", *sets], check=True)


def measure(app, run, scratch, size, frames, rounds):
    first = 60
    render = [app, "render", str(run), "--view", "fluoro", "--c-arm", "LAO 30", "--field", "0.4", "--size", f"{size}x{size}", "--quiet"]
    plain, labelled = [], []
    start = processor_seconds([*render, "--frames", f"{first}:{first}", "-o", str(scratch / "s.png")])
    for _ in range(rounds):
        span = ["--frames", f"{first}:{first + frames - 1}", "-o", str(scratch / "p.png")]
        plain.append((processor_seconds([*render, *span]) - start) / (frames - 1))
        labelled.append((processor_seconds([*render, *span, "--labels", str(scratch / "labels")]) - start) / (frames - 1))
    farm = scratch / "farm"
    shutil.rmtree(farm, ignore_errors=True)
    words = [app, "farm", str(run), "--frames", f"{first}:{first + frames - 1}", "-o", str(farm), "--tasks", "2", "--jobs", "2", "--threads", "1",
             "--quiet", *render[3:-1], "--labels", "labels"]
    hour = 2 * 3600 * frames / processor_seconds(words)
    return 1e3 * min(plain), 1e3 * min(labelled), hour


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--app", default="build/seldinger")
    parser.add_argument("--frames", type=int, default=60)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--csv")
    options = parser.parse_args()
    app = str(pathlib.Path(options.app).resolve())
    rows = []
    with tempfile.TemporaryDirectory() as place:
        scratch = pathlib.Path(place)
        for instruments in SCENES:
            run = scratch / f"run{instruments}"
            make_run(app, run, instruments)
            for size in (512, 1024):
                plain, labelled, hour = measure(app, run, scratch, size, options.frames, options.rounds)
                rows.append([instruments, size, f"{plain:.1f}", f"{labelled:.1f}", f"{100 * (labelled / plain - 1):.0f}", f"{hour:.0f}"])
                print(*rows[-1], flush=True)
    header = ["instruments", "size", "picture_ms", "labelled_ms", "cost_percent", "labelled_frames_per_hour"]
    if options.csv:
        with open(options.csv, "w", newline="") as file:
            csv.writer(file, lineterminator="\n").writerows([header, *rows])


if __name__ == "__main__":
    main()
