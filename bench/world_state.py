#!/usr/bin/env python3
"""Size of the saved state of a world of many pairs, and how long save, restore and hash take.

bench/world_state.py [--pairs 200] [--seconds 0.5] [--repeats 7] [--scene assets/scenes/experiment2-pair.toml]

Each pair is a catheter over a wire, the wire on its way into the arch after `seconds`. Times are processor milliseconds, medians of the repeats; memory
is that of the process with the world in it, before the first save and with one saved state.
"""

import time

import seldinger

import runner


def milliseconds(function, repeats):
    times = []
    for _ in range(repeats):
        begun = time.process_time()
        result = function()
        times.append(1e3 * (time.process_time() - begun))
        del result
    return runner.median(times)


def main():
    parser = runner.parser(__doc__, app=False)
    parser.add_argument("--pairs", type=int, default=200)
    parser.add_argument("--seconds", type=float, default=0.5)
    parser.add_argument("--repeats", type=int, default=7)
    parser.add_argument("--scene", default=runner.ROOT / "assets/scenes/experiment2-pair.toml")
    options = parser.parse_args()
    print("| model | steps | saved state [MB] | save [ms] | restore [ms] | hash [ms] | memory [MB] | with a state [MB] |\n|---|---|---|---|---|---|---|---|")
    for model in ("merged", "separate"):
        world = seldinger.World(options.scene, copies=[{}] * options.pairs, set=[f"coaxial.model={model}"])
        steps = round(options.seconds * 1000)
        world.step(n=steps)
        before = runner.memory_mb()
        state = world.save()
        after = runner.memory_mb()
        digits = world.state_hash()
        save = milliseconds(world.save, options.repeats)
        restore = milliseconds(lambda: world.restore(state), options.repeats)
        hashed = milliseconds(world.state_hash, options.repeats)
        assert world.state_hash() == digits
        print(f"| {model} | {steps} | {len(state.bytes) / 1e6:.1f} | {save:.0f} | {restore:.0f} | {hashed:.0f} | {before:.0f} | {after:.0f} |", flush=True)
        world.close()


if __name__ == "__main__":
    main()
