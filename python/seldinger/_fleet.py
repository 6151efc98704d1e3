"""The worlds behind the environments of seldinger/Navigate-v0: systems with their hubs, starts, pictures and saved episodes."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any, Union

import numpy as np

from . import _engine
from ._navigate import MEASURES, Navigate, target_point
from ._world import World


def vessel_of(overrides: Sequence[str]) -> tuple[str, ...]:
    """The overrides of a variant that all systems of a world share."""
    return tuple(o for o in overrides if o.startswith("vessel."))


class Fleet:
    """Systems of one world with their hubs, behind single and vector environments. They share a vessel."""

    def __init__(self, task: Navigate, variants: Sequence[Sequence[str]], device: int = -1) -> None:
        self.task, self.count = task, len(variants)
        vessel = vessel_of(variants[0])
        assert all(vessel_of(v) == vessel for v in variants)
        self.world = World(task.scene, set=vessel, copies=[[o for o in v if o not in vessel] for v in variants], device=device,
                           **task.overrides)
        self.world._held = True
        start = self.world._world.start()
        self.wires = len(start) // self.count
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
        self.elapsed = np.zeros(self.count, np.int64)
        self.started = np.zeros(self.count, np.int64)  # from which start
        self.way = np.zeros(self.count)
        rows, columns, channels = task.picture_shape
        pictured = self.count if task.image is not None else 0
        self.pictures = np.zeros((pictured, rows, columns, channels * task.image_stack), np.uint8)
        self._moves = np.ones(len(self.home), bool)
        self._rates = np.tile([task.advance_rate, task.turn_rate], self.wires) * self.control
        self.kept: list[list[tuple[Any, ...]]] = []  # [systems or variants][starts]

    # -- starts -------------------------------------------------------------------------------------------------------

    def keep(self, starts: Sequence[list[tuple[Any, ...]]]) -> None:
        """@param starts  of each system, as make_starts() returns them"""
        self.kept = list(starts)

    def make_starts(self) -> list[list[tuple[Any, ...]]]:
        """Feeds every system to each start, and keeps (state, hubs, observation, measures)."""
        task, draw = self.task, np.random.default_rng(task_seed(self.task))
        before = [self.world.save(s) for s in range(self.count)]
        kept: list[list[tuple[Any, ...]]] = [[] for _ in range(self.count)]
        for _ in range(task.starts):
            to = self.home.copy()
            to[:, 0] += draw.uniform(*task.start_advance)
            to[:, 1] += draw.uniform(-math.pi, math.pi)
            controls = math.ceil((to - self.home)[:, 0].max() / (task.advance_rate * self.control))
            for k in range(1, controls + 1):
                self._drive(self.home + (to - self.home) * (k / controls))
            self.look()
            if self.measured[:, 7].any():
                raise RuntimeError("start_advance: got a start at which a step failed; expected one that can be reached. "
                                   "Fix: make scene.dt_s smaller or start_advance shorter")
            for s in range(self.count):
                own = slice(s * self.wires, (s + 1) * self.wires)
                kept[s].append((self.world.save(s), self.hubs[own].copy(), self.seen[s].copy(), self.measured[s].copy()))
                self.world._world.restore(before[s])
            self.hubs[:] = self.home
        return kept

    def begin(self, s: int, start: int) -> None:
        """Puts system s to a start."""
        state, hubs, seen, measured = self.kept[s][start]
        self.world._world.restore(state, s)
        self.hubs[s * self.wires:(s + 1) * self.wires] = hubs
        self.seen[s], self.measured[s] = seen, measured
        self.elapsed[s], self.started[s], self.way[s] = 0, start, measured[0]

    # -- one control --------------------------------------------------------------------------------------------------

    def _drive(self, hubs: np.ndarray) -> None:
        self.hubs = hubs
        self.world._world.step(hubs, self._moves, self.steps, self.world.dt, True)

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
        reward = task.progress * (self.way - way) - task.time - task.force * np.maximum(0.0, wall - task.wall_force_limit)
        reward += task.success * arrived
        self.way = way.copy()
        self.elapsed += 1
        terminated = arrived if task.hand_force_stop is None else arrived | (np.abs(hand) > task.hand_force_stop)
        return reward, terminated, ~terminated & (failed | (self.elapsed >= task.max_steps))

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
            return np.moveaxis(grey >> 4, 1, -1).astype(np.uint8)
        pictures = [np.asarray(task.image(self.world, int(s))) for s in own]
        for picture in pictures:
            if picture.shape != task.image_shape or picture.dtype != np.uint8:
                raise ValueError(f"image: got {picture.dtype} {picture.shape}; expected uint8 {task.image_shape}")
        return np.stack(pictures).reshape(len(own), *task.picture_shape)

    def render(self, width: int, height: int) -> list[np.ndarray]:
        """A picture of each system, [height, width, 3] uint8."""
        return [self.world.render(width, height, system=s) for s in range(self.count)]

    # -- the whole episode --------------------------------------------------------------------------------------------

    _KEPT = ("hubs", "seen", "measured", "elapsed", "started", "way", "pictures")

    def save(self) -> dict[str, Any]:
        return {"world": self.world.save(), **{name: getattr(self, name).copy() for name in self._KEPT}}

    def restore(self, saved: dict[str, Any]) -> None:
        """@throws Error Code 3: not of such a world; nothing has changed then"""
        self.world._world.restore(saved["world"])
        for name in self._KEPT:
            setattr(self, name, saved[name].copy())

    @property
    def worlds(self) -> list[World]:
        return [self.world]

    def close(self) -> None:
        self.world.close()


class Fleets:
    """Environments with different vessels: a fleet for each vessel, with the interface of one fleet."""

    def __init__(self, task: Navigate, variants: Sequence[Sequence[str]], device: int = -1) -> None:
        groups: dict[tuple[str, ...], list[int]] = {}
        for i, overrides in enumerate(variants):
            groups.setdefault(vessel_of(overrides), []).append(i)
        self.count, self.fleets, self.members = len(variants), [], []
        self._place: list[tuple[Fleet, int]] = [None] * self.count  # type: ignore[list-item]
        for own in groups.values():
            fleet = Fleet(task, [variants[i] for i in own], device)
            self.fleets.append(fleet)
            self.members.append(np.array(own))
            for local, i in enumerate(own):
                self._place[i] = (fleet, local)
        self.parts, self.wires = self.fleets[0].parts, self.fleets[0].wires

    @property
    def worlds(self) -> list[World]:
        return [fleet.world for fleet in self.fleets]

    @property
    def world(self) -> World:
        return self.fleets[0].world

    def keep(self, starts: Sequence[list[tuple[Any, ...]]]) -> None:
        for fleet, own in zip(self.fleets, self.members):
            fleet.keep([starts[i] for i in own])

    def _joined(self, of: Callable[[Fleet], np.ndarray]) -> np.ndarray:
        parts = [of(fleet) for fleet in self.fleets]
        joined = np.empty((self.count, *parts[0].shape[1:]), parts[0].dtype)
        for own, part in zip(self.members, parts):
            joined[own] = part
        return joined

    @property
    def seen(self) -> np.ndarray:
        return self._joined(lambda fleet: fleet.seen)

    @property
    def measured(self) -> np.ndarray:
        return self._joined(lambda fleet: fleet.measured)

    def flat(self) -> np.ndarray:
        return self._joined(Fleet.flat)

    @property
    def pictures(self) -> np.ndarray:
        return self._joined(lambda fleet: fleet.pictures)

    def shoot(self, which: np.ndarray) -> None:
        for fleet, own in zip(self.fleets, self.members):
            fleet.shoot(which[own])

    def render(self, width: int, height: int) -> list[np.ndarray]:
        drawn = [fleet.render(width, height) for fleet in self.fleets]
        return [drawn[self.fleets.index(fleet)][local] for fleet, local in self._place]

    def save(self) -> list[dict[str, Any]]:
        return [fleet.save() for fleet in self.fleets]

    def restore(self, saved: list[dict[str, Any]]) -> None:
        for fleet, own in zip(self.fleets, saved):
            fleet.restore(own)

    def begin(self, s: int, start: int) -> None:
        fleet, local = self._place[s]
        fleet.begin(local, start)

    def act(self, actions: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        reward, terminated, truncated = np.empty(self.count), np.empty(self.count, bool), np.empty(self.count, bool)
        for fleet, own in zip(self.fleets, self.members):
            reward[own], terminated[own], truncated[own] = fleet.act(actions[own])
        return reward, terminated, truncated

    def close(self) -> None:
        for fleet in self.fleets:
            fleet.close()


def fleet_of(task: Navigate, variants: Sequence[Sequence[str]], device: int = -1) -> Union[Fleet, Fleets]:
    """A fleet for one vessel, or fleets for several."""
    return (Fleet if len({vessel_of(v) for v in variants}) == 1 else Fleets)(task, variants, device)


def task_seed(task: Navigate) -> list[int]:
    """Seed of the starts."""
    return [0x5E1D, task.start_seed]


_STARTS: dict[str, list[tuple[Any, ...]]] = {}  # of the last few tasks, by what they depend on


def starts_of(task: Navigate, overrides: Sequence[str], device: int = -1) -> list[tuple[Any, ...]]:
    """Starts of one variant. A separate world makes them, so a single and a vector environment have the same bits."""
    seen = {name: value for name, value in task.identity().items() if not name.startswith("image")}
    key = repr((seen, task.start_advance, task.starts, task.start_seed, list(overrides)))
    if key not in _STARTS:
        if len(_STARTS) >= 64:
            _STARTS.clear()
        one = Fleet(task, [overrides], device)
        _STARTS[key] = one.make_starts()[0]
        one.close()
    return _STARTS[key]


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
