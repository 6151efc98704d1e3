"""The worlds behind the environments of seldinger/Navigate-v0: systems with their hubs, starts, pictures and saved episodes."""

from __future__ import annotations

import math
import sys
import threading
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from . import _engine
from ._navigate import MEASURES, TERMS, Navigate, target_point
from ._scene import Scene
from ._world import World

_MOST_WIRES = 96  # of a world that makes starts (engine/studies/batch/batch.h)


class Progress:
    """What start-up is at, as a line on stderr, where it takes more than a second."""

    def __init__(self, shown: bool) -> None:
        self.text, self._over, self._thread = "", threading.Event(), threading.Thread(target=self._tell, daemon=True)
        self._shown = shown and sys.stderr is not None

    def __enter__(self) -> "Progress":
        if self._shown:
            self._thread.start()
        return self

    def __exit__(self, *_: Any) -> None:
        self._over.set()
        if self._shown:
            self._thread.join()

    def _tell(self) -> None:
        end, said = ("\r" if sys.stderr.isatty() else "\n"), False
        while not self._over.wait(0.5 if said else 1.0):
            if end == "\r" or not said:
                print(f"{self.text:<100}" if end == "\r" else self.text, end=end, file=sys.stderr, flush=True)
            said = True
        if said and end == "\r":
            print(file=sys.stderr, flush=True)


class Fleet:
    """Systems of one world with their hubs. They share a vessel."""

    def __init__(self, task: Navigate, variants: Sequence[Sequence[str]], device: int = -1) -> None:
        self.task, self.count = task, len(variants)
        self.world = World(task.scene, copies=variants, device=device, **task.overrides)
        start = self.world._world.start()
        self.wires = len(start) // self.count
        for force, on in task.forces:
            if not 0 <= on < self.wires:
                raise ValueError(f"forces: got instrument {on}; expected 0 to {self.wires - 1}")
            self.world.on_step(force, range(on, len(start), self.wires))
        self.world._held = True
        self.home = np.array([[a, t] for _, a, t, _ in start])  # [systems wires, 2]
        self.longest = np.array([length - 0.02 for *_, length in start])
        self.least = self.home[:, 0] + task.least_advance
        self.hubs = self.home.copy()
        self.steps = max(1, round(1 / (task.rate * self.world.dt)))
        self.control = self.steps * self.world.dt
        self.target = target_point(self.world, task.target, task.target_depth)
        self.navigator = _engine.make_navigator(self.world._world, self.target.tolist(), task.shape_points, task.shape_spacing,
                                           task.ahead_points, task.ahead_spacing)
        self.parts = task.parts()
        self.columns = np.concatenate([np.zeros(0, int), *(np.arange(s.start, s.stop) for s in self.parts.values())])
        self.all_columns = len(self.columns) == self.navigator.size()
        self.seen = np.zeros((self.count, self.navigator.size()), np.float32)
        self.measured = np.zeros((self.count, len(MEASURES)))
        self.terms = np.zeros((self.count, len(TERMS)))
        self.elapsed = np.zeros(self.count, np.int64)
        self.started = np.zeros(self.count, np.int64)  # from which start
        self.way = np.zeros(self.count)
        rows, columns, channels = task.picture_shape
        pictured = self.count if task.image is not None else 0
        self.pictures = np.zeros((pictured, rows, columns, channels * task.image_stack), np.uint8)
        self._rates = np.tile([task.advance_rate, task.turn_rate], self.wires) * self.control

    # -- starts -------------------------------------------------------------------------------------------------------

    def make_starts(self, feeds: np.ndarray, told: Callable[[float], None]) -> list[tuple[Any, ...]]:
        """Feeds each system by its advance and turn [systems, 2], as it would go alone.

        @return (state, hubs, observation, measures) of each
        """
        way = np.repeat(feeds, self.wires, axis=0)
        furthest = ((self.home + way) - self.home)[:, 0].reshape(self.count, self.wires).max(axis=1)
        controls = np.ceil(furthest / (self.task.advance_rate * self.control)).astype(int)
        made: list[tuple[Any, ...]] = [()] * self.count
        for k in range(1, int(controls.max()) + 1):
            share = np.repeat(np.minimum(k / controls, 1.0), self.wires)[:, None]
            self._drive(self.home + ((self.home + way) - self.home) * share)
            arrived = np.flatnonzero(controls == k)
            if len(arrived):
                self.look()
            for s in arrived:
                if self.measured[s, 7]:
                    raise RuntimeError("start_advance: got a start at which a step failed; expected one that can be reached. "
                                       "Fix: make scene.dt_s smaller or start_advance shorter")
                own = slice(s * self.wires, (s + 1) * self.wires)
                made[s] = (self.world.save(int(s)), self.hubs[own].copy(), self.seen[s].copy(), self.measured[s].copy())
                self.world._world.retire(int(s))
            told(float(np.minimum(k / controls, 1.0).sum()))
        return made

    def begin(self, s: int, start: int, kept: tuple[Any, ...]) -> None:
        """Puts system s to a start, and takes it in again where it was retired. @param kept  of make_starts()"""
        state, hubs, seen, measured = kept
        self.world._world.restore(state, s)
        self.hubs[s * self.wires:(s + 1) * self.wires] = hubs
        self.seen[s], self.measured[s], self.terms[s] = seen, measured, 0.0
        self.elapsed[s], self.started[s], self.way[s] = 0, start, measured[0]

    # -- one control --------------------------------------------------------------------------------------------------

    def _drive(self, hubs: np.ndarray) -> None:
        self.hubs = hubs
        self.world._world.step(hubs, np.ones(len(hubs), bool), self.steps, self.world.dt, True)

    def look(self) -> None:
        self.navigator.observe(self.world._world, self.seen, self.measured)

    def act(self, actions: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """@param actions [systems, 2 wires] in -1 ... 1. @return rewards, terminated, truncated [systems]"""
        task = self.task
        hubs = self.hubs + (actions * self._rates).reshape(-1, 2)
        advance = hubs[:, 0]
        np.minimum(np.maximum(advance, self.least, out=advance), self.longest, out=advance)
        self._drive(hubs)
        self.look()
        way, distance, hand, _, wall, _, _, gone_wrong, _ = self.measured.T
        failed = gone_wrong > 0
        arrived = (distance <= task.target_radius) & ~failed
        self.terms = np.stack([task.progress * (self.way - way), np.full(self.count, -task.time),
                               task.force * np.minimum(0.0, task.wall_force_limit - wall), task.success * arrived], axis=1)
        self.way = way.copy()
        self.elapsed += 1
        terminated = arrived if task.hand_force_stop is None else arrived | (np.abs(hand) > task.hand_force_stop)
        return self.terms.sum(axis=1), terminated, ~terminated & (failed | (self.elapsed >= task.max_steps))

    def flat(self) -> np.ndarray:
        return self.seen.copy() if self.all_columns else self.seen[:, self.columns]

    # -- pictures -----------------------------------------------------------------------------------------------------

    def shoot(self, which: np.ndarray) -> None:
        """Takes a picture of some systems, behind those of earlier controls. @param which  [systems] bool"""
        own = np.flatnonzero(which) if self.task.image is not None else ()
        if not len(own):
            return
        taken, new = self._shots(own), self.task.picture_shape[2]
        for s, picture in zip(own, taken):
            if self.elapsed[s] == 0:
                self.pictures[s] = np.tile(picture, self.task.image_stack)
            else:
                self.pictures[s] = np.concatenate([self.pictures[s, :, :, new:], picture], axis=2)

    def _shots(self, own: np.ndarray) -> np.ndarray:
        """[own, rows, columns, channels] uint8."""
        task = self.task
        if task.image == "fluoroscopy":
            frames = (self.started[own] << 32) + self.elapsed[own]
            grey = self.world.fluoroscopy(task.image_shape[1], task.image_shape[0], system=own, c_arm=task.views, field=task.image_field,
                                          frame=frames)
            return np.moveaxis(grey >> 4, 1, -1).astype(np.uint8).repeat(task.image_channels, axis=-1)
        pictures = [np.asarray(task.image(self.world, int(s))) for s in own]
        for picture in pictures:
            if picture.shape != task.image_shape or picture.dtype != np.uint8:
                raise ValueError(f"image: got {picture.dtype} {picture.shape}; expected uint8 {task.image_shape}")
        return np.stack(pictures).reshape(len(own), *task.picture_shape)

    # -- the whole episode --------------------------------------------------------------------------------------------

    _KEPT = ("hubs", "seen", "measured", "terms", "elapsed", "started", "way", "pictures")

    def save(self) -> dict[str, Any]:
        return {"world": self.world.save(), **{name: getattr(self, name).copy() for name in self._KEPT}}

    def restore(self, saved: dict[str, Any]) -> None:
        """@throws Error Code 3: not of such a world; nothing has changed then"""
        self.world._world.restore(saved["world"])
        for name in self._KEPT:
            setattr(self, name, saved[name].copy())

    def close(self) -> None:
        self.world.close()


class Fleets:
    """Environments as systems of worlds, one for each kind of scene: variants of a kind differ in instruments, feed and friction."""

    def __init__(self, task: Navigate, now: list[int], redraws: bool = False, device: int = -1) -> None:
        """@param now  variant of each environment; follows what begin() says
        @param redraws  to any other variant, without new worlds"""
        variants = task.variants()
        used = list(range(len(variants))) if redraws else sorted(set(now))
        kinds = _kinds(task, [variants[v] for v in used])
        systems: list[list[tuple[int, int]]] = [[] for _ in range(max(kinds) + 1)]
        for v, kind in zip(used, kinds):
            systems[kind] += [(i, v) for i in range(len(now)) if redraws or now[i] == v]
        self.task, self.count, self.now = task, len(now), now
        self.fleets: list[Fleet] = []
        self._place: dict[tuple[int, int], tuple[int, int]] = {}  # of an environment with a variant: number of its fleet, system
        with Progress(task.progress_line) as told:
            told.text = (f"seldinger: preparing {len(used)} variant{'s' * (len(used) > 1)}; the first start on a machine compiles "
                         "kernels, too")
            for own in systems:
                own.sort()
                self._place.update(((i, v), (len(self.fleets), s)) for s, (i, v) in enumerate(own))
                self.fleets.append(Fleet(task, [variants[v] for _, v in own], device))
        self.parts, self.wires = self.fleets[0].parts, self.fleets[0].wires
        for fleet in self.fleets:
            if fleet.wires != task.hubs():
                raise ValueError(f"vary: got variants with {fleet.wires} instruments; expected {task.hubs()}, as the scene has: an action "
                                 "has two numbers for each. Fix: leave instruments out of vary")
        self._starts = Starts(task, {v: (variants[v], kind) for v, kind in zip(used, kinds)}, device)
        for (i, v), (k, s) in self._place.items():
            if now[i] != v:
                self.fleets[k].world._world.retire(s)
        self._regroup()

    def _regroup(self) -> None:
        """Which environments are in each fleet now, as which systems."""
        at = np.array([self._place[i, v] for i, v in enumerate(self.now)])
        self._own = [np.flatnonzero(at[:, 0] == k) for k in range(len(self.fleets))]
        self._systems = [at[own, 1] for own in self._own]

    def _each(self) -> list[tuple[Fleet, np.ndarray, np.ndarray]]:
        """Fleets with the environments that are in them, and their systems."""
        return [(fleet, own, systems) for fleet, own, systems in zip(self.fleets, self._own, self._systems) if len(own)]

    def has(self, i: int, variant: int) -> bool:
        """Whether environment i can take the variant in these worlds."""
        return (i, variant) in self._place

    @property
    def worlds(self) -> list[World]:
        return [fleet.world for fleet in self.fleets]

    @property
    def world(self) -> World:
        return self.fleets[self._place[0, self.now[0]][0]].world

    def _joined(self, of: Callable[[Fleet], np.ndarray]) -> np.ndarray:
        parts = [(own, of(fleet)[systems]) for fleet, own, systems in self._each()]
        joined = np.empty((self.count, *parts[0][1].shape[1:]), parts[0][1].dtype)
        for own, part in parts:
            joined[own] = part
        return joined

    @property
    def seen(self) -> np.ndarray:
        return self._joined(lambda fleet: fleet.seen)

    @property
    def measured(self) -> np.ndarray:
        return self._joined(lambda fleet: fleet.measured)

    @property
    def terms(self) -> np.ndarray:
        return self._joined(lambda fleet: fleet.terms)

    def flat(self) -> np.ndarray:
        return self._joined(Fleet.flat)

    @property
    def pictures(self) -> np.ndarray:
        return self._joined(lambda fleet: fleet.pictures)

    def shoot(self, which: np.ndarray) -> None:
        """Takes a picture of some environments. @param which  [environments] bool"""
        for fleet, own, systems in self._each():
            asked = np.zeros(fleet.count, bool)
            asked[systems] = which[own]
            fleet.shoot(asked)

    def render(self, width: int, height: int) -> list[np.ndarray]:
        """A picture of each environment, [height, width, 3] uint8."""
        at = [self._place[i, v] for i, v in enumerate(self.now)]
        return [self.fleets[k].world.render(width, height, system=s) for k, s in at]

    def save(self) -> dict[str, Any]:
        return {"now": list(self.now), "fleets": [fleet.save() for fleet in self.fleets]}

    def restore(self, saved: dict[str, Any]) -> None:
        for i, v in enumerate(saved["now"]):
            self._take(i, v)
        for fleet, own in zip(self.fleets, saved["fleets"]):
            fleet.restore(own)

    def _take(self, i: int, variant: int) -> None:
        if variant == self.now[i]:
            return
        k, s = self._place[i, self.now[i]]
        self.fleets[k].world._world.retire(s)
        self.now[i] = variant
        k, s = self._place[i, variant]
        world = self.fleets[k].world
        world._world.restore(world.save(s), s)  # a state that is restored alone is stepped again
        self._regroup()

    def begin(self, episodes: Sequence[tuple[int, int, int]]) -> None:
        """Puts environments to starts of variants. @param episodes  (environment, start, variant) of each"""
        starts = self._starts.of([(variant, start) for _, start, variant in episodes])
        for (i, start, variant), kept in zip(episodes, starts):
            self._take(i, variant)
            k, s = self._place[i, variant]
            self.fleets[k].begin(s, start, kept)

    def act(self, actions: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        reward, terminated, truncated = np.empty(self.count), np.empty(self.count, bool), np.empty(self.count, bool)
        for fleet, own, systems in self._each():
            all_actions = np.zeros((fleet.count, actions.shape[1]))
            all_actions[systems] = actions[own]
            reward[own], terminated[own], truncated[own] = (result[systems] for result in fleet.act(all_actions))
        return reward, terminated, truncated

    def close(self) -> None:
        for fleet in self.fleets:
            fleet.close()


def _kinds(task: Navigate, variants: Sequence[Sequence[str]]) -> list[int]:
    """Number of the world that each variant goes to, from 0."""
    scene = Scene(task.scene, **task.overrides)
    return _engine.world_kinds(scene.text, scene.file, [scene.overrides + list(v) for v in variants])


_STARTS: dict[str, tuple[Any, ...]] = {}  # of the last few tasks, by what they depend on
_MOST_STARTS = 4096                       # kept


class Starts:
    """Starts of variants. Worlds of their own make them, all of a kind together: at first those that are asked for, so that an
    episode begins soon; when another is asked for, all that are missing."""

    def __init__(self, task: Navigate, variants: dict[int, tuple[list[str], int]], device: int) -> None:
        """@param variants  overrides and kind by number"""
        self._task, self._variants, self._device, self._asked = task, variants, device, False
        seen = {name: value for name, value in task.identity().items() if not name.startswith("image") and name != "vary"}
        self._seen = repr((seen, task.start_advance, task.starts, task.start_seed))
        draw = np.random.default_rng([0x5E1D, task.start_seed])
        self._feeds = [(draw.uniform(*task.start_advance), draw.uniform(-math.pi, math.pi)) for _ in range(task.starts)]
        self._own: dict[str, tuple[Any, ...]] = {}

    def _key(self, variant: int, start: int) -> str:
        return f"{self._seen} {self._variants[variant][0]} {start}"

    def of(self, pairs: Sequence[tuple[int, int]]) -> list[tuple[Any, ...]]:
        """@param pairs  (variant, start) of each"""
        keys = [self._key(*pair) for pair in pairs]
        for key in keys:
            if key not in self._own and key in _STARTS:
                self._own[key] = _STARTS[key]
        if not all(key in self._own for key in keys):
            all_pairs = [(v, start) for v in self._variants for start in range(self._task.starts)]
            self._make(all_pairs if self._asked else pairs)
        self._asked = True
        return [self._own[key] for key in keys]

    def _make(self, pairs: Sequence[tuple[int, int]]) -> None:
        missing = {key: pair for pair in pairs if (key := self._key(*pair)) not in self._own}
        done = 0.0

        def tell(part: float) -> None:
            of = len({v for v, _ in missing.values()})
            told.text = (f"seldinger: {len(missing)} start{'s' * (len(missing) > 1)} of {of} variant{'s' * (of > 1)}: "
                         f"{100 * (done + part) / len(missing):.0f} %")

        with Progress(self._task.progress_line) as told:
            tell(0.0)
            for kind in sorted({self._variants[v][1] for v, _ in missing.values()}):
                alike = [key for key, (v, _) in missing.items() if self._variants[v][1] == kind]
                for first in range(0, len(alike), _MOST_WIRES):
                    some = alike[first:first + _MOST_WIRES]
                    fleet = Fleet(self._task, [self._variants[missing[key][0]][0] for key in some], self._device)
                    self._own.update(zip(some, fleet.make_starts(np.array([self._feeds[missing[key][1]] for key in some]), tell)))
                    fleet.close()
                    done += len(some)
        _STARTS.update(self._own)
        while len(_STARTS) > _MOST_STARTS:
            del _STARTS[next(iter(_STARTS))]


def checked(actions: Any, shape: tuple[int, ...], wires: int) -> np.ndarray:
    """Actions [systems, 2 wires] within -1 ... 1."""
    given = np.asarray(actions)
    if given.dtype.kind not in "fiu":
        raise TypeError(f"action: got {given.dtype}; expected numbers")
    if given.shape != shape:
        raise ValueError(f"action: got shape {given.shape}; expected {shape}")
    if not np.isfinite(given).all():
        raise ValueError("action: got a value that is not finite; expected numbers from -1 to 1")
    return np.minimum(np.maximum(given.astype(np.float64), -1.0), 1.0).reshape(-1, 2 * wires)
