"""A run as lines of JSON for other programs, one for each step: positions, forces, readings.

    python3 -m seldinger.lines SCENE [--set table.key=value] [--every N] [--control]

Each line has `step`, `time_s` and `instruments`, a list of `name`, `inserted_m`, `turned_rad`, `hand_force_n`, `hand_torque_nm`, `wall_force_n`,
`tip_m`, `nodes_m`, `contact_force_n` (of the wall on each node) and `sensors`. With --control each line of standard input,
`{"advance_m": 0.1, "turn_rad": 0.0}` or a list of such, one for each instrument, is a step with the hubs there at its end; without, the scene's
key frames are followed. A line that cannot be read ends the program with exit 2.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Iterator
from typing import Any, Optional

import seldinger


def state_of(world: seldinger.World) -> dict[str, Any]:
    """The present state as a line has it."""
    output = world.output
    return {"step": output.step, "time_s": output.time, "instruments": [
        {"name": name, "inserted_m": wire.inserted, "turned_rad": wire.turned, "hand_force_n": wire.hand_force,
         "hand_torque_nm": wire.hand_torque, "wall_force_n": wire.wall_force, "tip_m": wire.tip.tolist(), "nodes_m": wire.nodes.tolist(),
         "contact_force_n": wire.contact_force.tolist(), "sensors": wire.sensors}
        for name, wire in zip(world.instruments, output.instruments)]}


def controls(world: seldinger.World, lines: Optional[Iterator[str]]) -> Iterator[Any]:
    """What each step is given: of a line, or None for the key frames up to the scene's end."""
    if lines is None:
        yield from [None] * world._steps
        return
    for number, line in enumerate(lines, 1):
        try:
            given = json.loads(line)
            yield [[hub["advance_m"], hub.get("turn_rad", 0.0)] for hub in (given if isinstance(given, list) else [given])]
        except (ValueError, KeyError, TypeError, AttributeError):
            raise seldinger.Error(f"line {number}: got {line.strip()!r:.60}; expected {{\"advance_m\": 0.1, \"turn_rad\": 0.0}}", 2) from None


def main(arguments: Optional[list[str]] = None) -> int:
    words = argparse.ArgumentParser(prog="seldinger.lines", description="A run as lines of JSON, one for each step.")
    words.add_argument("scene", help="scene file, or the name of a scene of the package")
    words.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="as of the command")
    words.add_argument("--every", type=int, default=1, metavar="N", help="a line for every Nth step")
    words.add_argument("--control", action="store_true", help="each line of standard input is a step")
    given = words.parse_args(arguments)
    try:
        if given.every < 1:
            raise seldinger.Error(f"--every: got {given.every}; expected 1 or more", 2)
        with seldinger.World(given.scene, set=given.set) as world:
            for step, control in enumerate(controls(world, sys.stdin if given.control else None), 1):
                report = world.step(control)
                if report.failed:
                    raise seldinger.Error(f"step {step}: {report.message}", 4)
                if step % given.every == 0:
                    print(json.dumps(state_of(world)), flush=True)
    except seldinger.Error as error:
        print(error, file=sys.stderr)
        return error.code
    except (TypeError, ValueError) as error:
        print(error, file=sys.stderr)
        return 2
    except BrokenPipeError:  # who reads has read enough
        sys.stdout = None  # type: ignore[assignment]
    return 0


if __name__ == "__main__":
    sys.exit(main())
