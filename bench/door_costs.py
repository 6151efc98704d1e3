"""What forces of one's own cost: processor seconds of steps in the aortic arch, each kind in turn, medians of --rounds.

    PYTHONPATH=build/python SELDINGER_PLUGINS=FOLDER_OF_LIBMAGNET python3 bench/door_costs.py

The spring is that of docs/forces.md, with tangents; the magnet that of examples/doors/magnet_dipole.py and docs/example/magnet.cpp, without: seven
calls a trial. A function is asked once a step. One wire, and 96 wires in one world: asked together, or one by one.
"""

import argparse
import statistics
import sys
import time
from pathlib import Path

import seldinger

sys.path.insert(0, str(Path(__file__).parents[1] / "examples" / "doors"))
import magnet_dipole  # noqa: E402
import spring_to_a_point  # noqa: E402

STRENGTH, SOURCE, DIPOLE = 1e-6, [0.0, 0.5, 0.0], [1.0, 0.0, 0.0]  # too weak to change the path
PLUGIN = f"""[[force]]
plugin = "libmagnet.so"
moment_am2 = {STRENGTH}
source_m = {SOURCE}
source_am2 = {DIPOLE}
"""
KINDS = {1: ("none", "magnet, plugin", "function", "spring", "magnet"), 96: ("none", "spring, together", "magnet, together", "spring")}


def seconds(kind, wires, steps, start):
    """Processor seconds, and the state's hash."""
    copies = {"copies": [[]] * wires} if wires > 1 else {}
    scene = seldinger.Scene("aortic-arch")
    scene.text += PLUGIN if kind.endswith("plugin") else ""
    with seldinger.World(scene, **copies) as world:
        force = {"spring": spring_to_a_point.Spring(SOURCE, 1e-6), "magnet": magnet_dipole.Magnet(0.0, STRENGTH, SOURCE, DIPOLE),
                 "function": lambda p: -1e-6 * p.velocity}.get(kind.removesuffix(", together"))
        if force is not None:
            if kind.endswith("together"):
                force.together = True
            world.on_step(force, instrument=range(wires))
        for s in range(wires):
            world._world.restore(start, s)
        world.step(n=10)
        begin = time.process_time()
        assert not world.step(n=steps).failed
        return time.process_time() - begin, world.state_hash()


if __name__ == "__main__":
    words = argparse.ArgumentParser()
    words.add_argument("--rounds", type=int, default=7)
    words.add_argument("--steps", type=int, default=1000, help="of one wire; 96 wires take a thirtieth")
    words.add_argument("--from-step", type=int, default=10000)
    given = words.parse_args()
    with seldinger.World("aortic-arch") as first:
        first.step(n=given.from_step)
        begun = first.save(0)
        print(f"{1e3 * first.output.inserted:.0f} mm inside, {first.output.contact_count} contacts\n")
    print("| wires | force | processor s | over none | each round over none |\n|---|---|---|---|---|")
    for wires, kinds in KINDS.items():
        taken, hashes = {kind: [] for kind in kinds}, {kind: set() for kind in kinds}
        for _ in range(given.rounds):
            for kind in kinds:
                spent, state = seconds(kind, wires, given.steps if wires == 1 else given.steps // 30, begun)
                taken[kind].append(spent)
                hashes[kind].add(state)
        assert all(len(states) == 1 for states in hashes.values()), hashes
        assert wires == 1 or hashes["spring"] == hashes["spring, together"], hashes
        for kind in kinds:
            over = [a / b for a, b in zip(taken[kind], taken["none"])]
            print(f"| {wires} | {kind} | {statistics.median(taken[kind]):.2f} | {statistics.median(over):.2f} | "
                  f"{', '.join(f'{share:.2f}' for share in over)} |")
