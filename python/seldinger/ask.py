"""Searches for the motions of a hand that reach a scene's target with the least force, for each choice, and ranks the choices.

    python3 -m seldinger.ask SCENE --choose 'wire.preset=["bentson-035", "terumo-angled-035"]' --least patch_force --hands 16 -o FOLDER

A motion is `--knots` parts of equal time, each with a speed and a turn. The first hand of each choice pushes steadily; CMA-ES (the package
`cma`) finds the others, `--hands` at a time in one world, for `--rounds` rounds. The best motion of each choice is written as a scene (`seldinger run
FOLDER/best-0.toml`). Its band is three times what half the step changes, as in a batch with --bands. Same `--seed`, same answer.
"""

from __future__ import annotations

import argparse
import itertools
import json
import math
import sys
import warnings
from pathlib import Path
from typing import Any, Optional

import numpy as np

import seldinger

from . import _toml

LEAST = {"patch_force": "until_patch_force_max_n", "wall_force": "until_wall_force_max_n", "hand_force": "until_hand_force_max_n"}
_CHUNK = 25  # steps between looks at the targets


def choices(texts: list[str]) -> list[list[str]]:
    """Overrides of each choice: all combinations of the lists in "table.key=[a, b]"."""
    lists = []
    for text in texts:
        key, _, values = text.partition("=")
        try:
            lists.append([f"{key.strip()}={_toml.value(v, key)}" for v in json.loads(values)])
        except (ValueError, TypeError):
            raise seldinger.Error(f"--choose: got \"{text}\"; expected table.key=[a, b], with texts in quotes", 2) from None
    return [list(one) for one in itertools.product(*lists)]


class Hands:
    """So many hands, each with a system of one world that begins as the scene does."""

    def __init__(self, scene: seldinger.Scene, count: int, knots: int, speed: float, least: str) -> None:
        self.world = seldinger.World(scene, copies=[[]] * count)
        start = self.world._world.start()
        if len(start) != count:
            raise seldinger.Error("scene: got several instruments; expected one", 2)
        _, advance, turn, length = start[0]
        self.home, self.longest, self.least = np.array([advance, turn]), length - 0.02, LEAST[least]
        self.begin, self.knots, self.speed = self.world.save(), knots, speed
        self.part = max(1, self.world._steps // knots)  # steps

    def ways(self, motions: np.ndarray) -> np.ndarray:
        """Where hubs are at the ends of the parts [hands, knots, 2], of shares of the speed and of half a turn [hands, knots, 2]."""
        steps = np.clip(motions, [-0.5, -1.0], [1.0, 1.0]) * [self.speed * self.part * self.world.dt, math.pi]
        ways = self.home + np.cumsum(steps, axis=1)
        ways[:, :, 0] = np.clip(ways[:, :, 0], self.home[0], self.longest)
        return ways

    def try_all(self, motions: np.ndarray) -> tuple[np.ndarray, list[dict[str, Any]]]:
        """Cost [hands], to be as small as can be, and what became of the task."""
        self.world.restore(self.begin)
        ways, at = self.ways(motions), np.tile(self.home, (len(motions), 1))
        for k in range(self.knots):
            for done in range(0, self.part, _CHUNK):
                n = min(_CHUNK, self.part - done)
                self.world.step(at + (ways[:, k] - at) * (done + n) / self.part, n=n)
                if all(self.world.task(s)["reached"] for s in range(len(motions))):
                    break
            at = ways[:, k]
        tasks = [self.world.task(s) for s in range(len(motions))]
        return np.array([task[self.least] if task["reached"] else 1e3 * (1 + task["distance_m"]) for task in tasks]), tasks

    def keys(self, motion: np.ndarray) -> str:
        """feed.keys of a motion, as an override."""
        times = np.arange(self.knots + 1) * self.part * self.world.dt
        ways = np.vstack([self.home, self.ways(motion[None])[0]])
        return "feed.keys=" + _toml.value([{"t_s": t, "advance_m": a, "turn_rad": r} for t, (a, r) in zip(times.tolist(), ways.tolist())])


def search(scene: seldinger.Scene, hands: int, rounds: int, knots: int, speed: float, least: str, seed: int) -> tuple[float, str, dict[str, Any]]:
    """The best motion: its cost, its key frames, what became of the task."""
    try:
        import cma
    except ImportError:
        raise seldinger.Error("ask: the package cma is not installed. Fix: pip install cma", 2) from None
    own = Hands(scene, hands, knots, speed, least)
    steady = np.zeros((knots, 2))
    steady[:, 0] = 1.0
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        finder = cma.CMAEvolutionStrategy(steady.ravel(), 0.3, {"seed": seed + 1, "popsize": hands, "verbose": -9})
    best: tuple[float, Any, dict[str, Any]] = (math.inf, None, {})
    for number in range(rounds):
        asked = [np.array(one) for one in finder.ask()]
        if number == 0:
            asked[0] = steady.ravel()
        costs, tasks = own.try_all(np.array(asked).reshape(hands, knots, 2))
        finder.tell(asked, costs.tolist())
        first = int(costs.argmin())
        if costs[first] < best[0]:
            best = (float(costs[first]), own.keys(asked[first].reshape(knots, 2)), tasks[first])
    own.world.close()
    return best


def ask(scene: Any, choose: list[str], folder: Path, *, least: str = "patch_force", hands: int = 16, rounds: int = 8, knots: int = 4,
        speed: float = 0.03, seed: int = 0, set: list[str] = []) -> list[dict[str, Any]]:  # noqa: B006
    """Choices with their best motions, the best first; their scenes are in the folder, as best-0.toml and so on."""
    folder.mkdir(parents=True, exist_ok=True)
    found = []
    for number, choice in enumerate(choices(choose)):
        given = seldinger.Scene(scene, set=[*set, *choice, "scene.until=\"reached\""])
        cost, keys, task = search(given, hands, rounds, knots, speed, least, seed)
        if not task.get("reached"):
            found.append({"choice": choice, "reached": False, "distance_m": task.get("distance_m")})
            continue
        with seldinger.World(given, set=[keys]) as world:
            text, dt = world._world.scene_text(str(folder)), world.dt
        (folder / f"best-{number}.toml").write_text(text, encoding="utf-8")
        values = seldinger.batch(folder / f"best-{number}.toml", {"scene.dt_s": [dt, dt / 2]})[LEAST[least]]
        found.append({"choice": choice, "reached": True, "scene": f"best-{number}.toml", LEAST[least]: float(values[0]),
                      "band_n": 3 * float(abs(values[1] - values[0]))})
    return sorted(found, key=lambda one: one.get(LEAST[least], math.inf))


def main(arguments: Optional[list[str]] = None) -> int:
    words = argparse.ArgumentParser(prog="seldinger.ask", description="Motions that reach the target with the least force, for each choice.")
    words.add_argument("scene", help="scene file with [task] target, or the name of a scene of the package")
    words.add_argument("--choose", action="append", default=[], metavar="KEY=[A, B]", help="what varies; several make combinations")
    words.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="as of the command")
    words.add_argument("--least", choices=LEAST, default="patch_force", help="of all until the target")
    words.add_argument("--hands", type=int, default=16, help="motions that are tried at once")
    words.add_argument("--rounds", type=int, default=8)
    words.add_argument("--knots", type=int, default=4, help="parts of a motion")
    words.add_argument("--speed", type=float, default=0.03, metavar="M_S", help="greatest speed of the hub [m/s]")
    words.add_argument("--seed", type=int, default=0)
    words.add_argument("-o", "--out", type=Path, required=True, metavar="FOLDER")
    given = words.parse_args(arguments)
    try:
        for name, low in (("hands", 4), ("rounds", 1), ("knots", 1)):
            if getattr(given, name) < low:
                raise seldinger.Error(f"--{name}: got {getattr(given, name)}; expected {low} or more", 2)
        ranked = ask(given.scene, given.choose, given.out, least=given.least, hands=given.hands, rounds=given.rounds, knots=given.knots,
                     speed=given.speed, seed=given.seed, set=given.set)
    except seldinger.Error as error:
        print(error, file=sys.stderr)
        return error.code
    (given.out / "ranking.json").write_text(json.dumps(ranked, indent=1) + "\n", encoding="utf-8")
    for one in ranked:
        what = ", ".join(one["choice"]) or "the scene"
        print(f"{what}: {1e3 * one[LEAST[given.least]]:.1f} ± {1e3 * one['band_n']:.1f} mN, {given.out / one['scene']}" if one["reached"]
              else f"{what}: not reached, {1e3 * (one['distance_m'] or 0):.1f} mm away")
    return 0


if __name__ == "__main__":
    sys.exit(main())
