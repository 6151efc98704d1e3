#!/usr/bin/env python3
"""What labels cost, and how many labelled X-rays an hour two cores make.

Two runs (one wire: the demo; three instruments: sheath-catheter-wire.toml), pictures of 512 and 1024 pixels with body and noise, the arm
standing still. Each command runs with and without --labels in turn; the cost is the difference of processor times (user + system) of
the best round, so that other processes on the machine count little. Frames an hour on two cores: `farm --jobs 2`, one thread each, start
and planning included, from its processor time as if both cores were busy all the time and nothing else ran.

    python3 bench/label_speed.py [--app build/seldinger] [--frames 60] [--rounds 3] [--csv FILE]
"""
import pathlib
import shutil
import tempfile

import runner

SCENES = {1: "aortic-arch.toml", 3: "sheath-catheter-wire.toml"}
RECORDED = {"scene.duration_s": 6, "output.wire_every": 50, "output.contacts_every": 50, "scene.record_every": 50}
FIRST = 60


def measure(app, run, scratch, size, frames, rounds):
    view = ["--view", "fluoro", "--c-arm", "LAO 30", "--field", "0.4", "--size", f"{size}x{size}"]
    render = [app, "render", run, *view, "--quiet", "-o", scratch / "p.png", "--frames"]
    span = f"{FIRST}:{FIRST + frames - 1}"
    start = runner.call([*render, f"{FIRST}:{FIRST}"]).seconds
    times = runner.in_turn(rounds, plain=lambda: runner.call([*render, span]).seconds,
                           labelled=lambda: runner.call([*render, span, "--labels", scratch / "labels"]).seconds)
    plain, labelled = ((min(times[name]) - start) / (frames - 1) for name in ("plain", "labelled"))
    shutil.rmtree(scratch / "farm", ignore_errors=True)
    farm = runner.call([app, "farm", run, "--frames", span, "-o", scratch / "farm", "--tasks", "2", "--jobs", "2", "--threads", "1", "--quiet", *view,
                        "--labels", "labels"])
    return [f"{1e3 * plain:.1f}", f"{1e3 * labelled:.1f}", f"{100 * (labelled / plain - 1):.0f}", f"{2 * 3600 * frames / farm.seconds:.0f}"]


def main():
    parser = runner.parser(__doc__, "")
    parser.add_argument("--frames", type=int, default=60)
    parser.add_argument("--rounds", type=int, default=3)
    options = parser.parse_args()
    table = runner.Table(options.csv, ["instruments", "size", "picture_ms", "labelled_ms", "cost_percent", "labelled_frames_per_hour"])
    with tempfile.TemporaryDirectory() as place:
        scratch = pathlib.Path(place)
        for instruments, scene in SCENES.items():
            runner.run(options.app, runner.ROOT / "assets/scenes" / scene, scratch / f"run{instruments}", RECORDED)
            for size in (512, 1024):
                table.add([instruments, size, *measure(options.app, scratch / f"run{instruments}", scratch, size, options.frames, options.rounds)])


if __name__ == "__main__":
    main()
