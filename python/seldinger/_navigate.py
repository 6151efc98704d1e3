"""The task of seldinger/Navigate-v0: its settings, its targets, and the worlds behind its environments."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Optional, Union

import numpy as np
from gymnasium import spaces

from . import _engine
from ._studies import sweep
from ._scene import SceneLike
from ._world import World

MEASURES = ("way", "distance", "hand_force", "hand_torque", "wall_force", "advance", "turn", "failed", "time")
PARTS = ("tip", "ahead", "shape", "hand", "wall", "hub")


@dataclass
class Navigate:
    """Settings of the task; keywords of `gymnasium.make` and `make_vec`.

    Attributes
    ----------
    scene, overrides
        The scene: see `seldinger.World`; `overrides` as a dict.
    target
        A branch of the arch, "left-subclavian", "left-carotid" or "brachiocephalic"; "branch:k", the k-th (from 1) from the root of any
        centreline; or a point [3] [m].
    target_depth, target_radius : float
        Distance of the target along the branch from its origin, and the distance at which the tip has arrived [m].
    rate : float
        Controls a second [1/s]. A control takes round(1 / (rate dt)) steps of the scene's dt.
    advance_rate, turn_rate : float
        Speeds of an action of 1 [m/s], [rad/s].
    least_advance, start_advance : float, (float, float)
        The first is the smallest advance of the hub [m]. An episode starts between the other two, turned by any angle.
    starts, start_seed : int
        Number of starts, and their seed. Use different seeds for training and for evaluation.
    max_steps : int
        Controls after which an episode is truncated.
    observation : tuple of str
        Parts of the observation, from "tip", "ahead", "shape", "hand", "wall", "hub" (see `NavigateEnv`).
    flat : bool
        A Box of all parts instead of a Dict.
    shape_points, shape_spacing, ahead_points, ahead_spacing
        Number and spacing [m] of observed points: on the wire behind its tip, and on the path ahead.
    progress, success, time, force : float
        Reward: per metre of path covered; for arrival; per control; per newton of wall force above `wall_force_limit`.
    wall_force_limit : float
        [N].
    hand_force_stop : float or None
        An episode ends (terminated) at a larger hand force [N].
    vary
        Domain randomisation in the sweep's syntax (`seldinger.sweep`), of keys that may differ between systems of one world:
        the wire, friction, the feed. The vessel may vary too; each has its own world. Environment i of the vector form has
        variant i modulo their number. A single environment has `variant`; if that is None, it draws one at each reset.
    image : "fluoroscopy", callable or None
        A picture for the policy, added to the Dict as "image": 8 bits of `World.fluoroscopy` (its quantum noise is seeded by
        the start and the control: the same seed gives the same bits); or image(world, system) -> uint8 array of `image_shape`.
    image_shape, image_c_arm, image_field
        (rows, columns); position of the C-arm, "LAO 30, CRA 15" (None: the scene's); width of its detector [m].
    """

    scene: SceneLike = "navigate"
    overrides: Mapping[str, Any] = field(default_factory=dict)
    target: Union[str, Sequence[float]] = "left-subclavian"
    target_depth: float = 0.035
    target_radius: float = 0.006
    rate: float = 60.0
    advance_rate: float = 0.05
    turn_rate: float = 2 * math.pi
    least_advance: float = 0.05
    start_advance: tuple[float, float] = (0.12, 0.16)
    starts: int = 8
    start_seed: int = 0
    max_steps: int = 400
    observation: Sequence[str] = PARTS
    flat: bool = False
    shape_points: int = 6
    shape_spacing: float = 0.01
    ahead_points: int = 4
    ahead_spacing: float = 0.01
    progress: float = 20.0
    success: float = 5.0
    time: float = 0.005
    force: float = 0.1
    wall_force_limit: float = 1.0
    hand_force_stop: Optional[float] = None
    vary: Any = None
    variant: Optional[int] = None
    image: Union[None, str, Callable[[World, int], np.ndarray]] = None
    image_shape: tuple[int, ...] = (64, 64)
    image_c_arm: Optional[str] = None
    image_field: Optional[float] = None

    def __post_init__(self) -> None:
        unknown = [p for p in self.observation if p not in PARTS]
        if unknown or not len(self.observation):
            raise ValueError(f"observation: {list(self.observation)} given; some of {list(PARTS)} expected")
        for name in ("rate", "advance_rate", "turn_rate", "target_radius", "max_steps", "starts"):
            if not getattr(self, name) > 0:
                raise ValueError(f"{name}: {getattr(self, name)} given, more than 0 expected")
        low, high = self.start_advance
        if not 0 < low <= high:
            raise ValueError(f"start_advance: {self.start_advance} given; (least, most) in metres expected")
        self.image_shape = tuple(self.image_shape)
        if self.image is not None and self.image != "fluoroscopy" and not callable(self.image):
            raise ValueError(f"image: {self.image!r} given; \"fluoroscopy\", a function or None expected")
        if self.image == "fluoroscopy" and len(self.image_shape) != 2:
            raise ValueError(f"image_shape: {self.image_shape} given; (rows, columns) expected")
        if self.image is not None and self.flat:
            raise ValueError("image: needs flat=False, as it is a part of a Dict")

    def variants(self) -> list[list[str]]:
        """Overrides of each variant."""
        return sweep(self.vary) if self.vary else [[]]


def branches(world: World) -> list[np.ndarray]:
    """Branches of the vessel's axis, points [p, 3] from where each leaves the path from the root [m], in the order in which they leave
    it; the trunk's own end is the last. Branch k of a scene (`task.target.branch`) and target "branch:k" are the k-th, from 1."""
    line = world.centreline
    points, parent = line["points"], line["parent"]
    children = np.bincount(parent[parent >= 0], minlength=len(parent)) if len(parent) else np.zeros(0, int)

    def path_to(leaf: int) -> list[int]:
        path = [leaf]
        while parent[path[-1]] >= 0:
            path.append(int(parent[path[-1]]))
        return path[::-1]

    def length(path: Sequence[int]) -> float:
        return float(np.linalg.norm(np.diff(points[list(path)], axis=0), axis=1).sum())

    paths = [path_to(i) for i in range(len(parent)) if not children[i]]
    trunk = max(range(len(paths)), key=lambda i: length(paths[i]), default=-1)
    found = []
    for i, path in enumerate(paths):
        fork = next((k for k in range(len(path) - 2, -1, -1) if children[path[k]] > 1), 0)
        found.append((np.inf if i == trunk else length(path[:fork + 2]), path[-1], points[path[fork:]]))
    return [p for _, _, p in sorted(found, key=lambda x: x[:2])]


_ARCH = ("left-subclavian", "left-carotid", "brachiocephalic")  # from the diaphragm


def target_point(world: World, target: Union[str, Sequence[float]], depth: float) -> np.ndarray:
    """Position of a target [3] [m]."""
    if not isinstance(target, str):
        point = np.asarray(target, float)
        if point.shape != (3,) or not np.isfinite(point).all():
            raise ValueError(f"target: {target} given; a name or a point [3] in metres expected")
        return point
    found = branches(world)
    name, _, number = target.partition(":")
    k = _ARCH.index(name) if name in _ARCH else int(number) - 1 if name == "branch" and number.isdigit() else -1
    if not 0 <= k < len(found):
        raise ValueError(f"target: \"{target}\" given; {', '.join(_ARCH)} or branch:1 to branch:{len(found)} expected")
    line = found[k]
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))])
    return np.array([np.interp(depth, along, line[:, d]) for d in range(3)])


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
        start = self.world._world.start()
        wires = len(start) // self.count
        if not all(on for on, *_ in start):
            raise ValueError("scene: every instrument of an environment must be fed ([feed] or feed of its [[instrument]])")
        self.wires = wires
        self.home = np.array([[a, t] for _, a, t, _ in start])  # [systems wires, 2]
        self.longest = np.array([length - 0.02 for *_, length in start])
        self.least = self.home[:, 0] + task.least_advance
        self.hubs = self.home.copy()
        self.steps = max(1, round(1 / (task.rate * self.world.dt)))
        self.control = self.steps * self.world.dt
        self.target = target_point(self.world, task.target, task.target_depth)
        self.navigator = _engine.make_navigator(self.world._world, self.target.tolist(), task.shape_points, task.shape_spacing,
                                           task.ahead_points, task.ahead_spacing)
        widths = {"tip": 8, "ahead": 3 * task.ahead_points, "shape": 3 * task.shape_points, "hand": 2, "wall": 2, "hub": 3}
        ends = np.cumsum([widths[p] for p in PARTS])
        self.parts = {p: slice(int(end - widths[p]), int(end)) for p, end in zip(PARTS, ends) if p in task.observation}
        assert ends[-1] == self.navigator.size()
        self.columns = np.concatenate([np.arange(s.start, s.stop) for s in self.parts.values()])
        self.all_columns = len(self.columns) == self.navigator.size()
        self.seen = np.zeros((self.count, self.navigator.size()), np.float32)
        self.measured = np.zeros((self.count, len(MEASURES)))
        self.elapsed = np.zeros(self.count, np.int64)
        self.started = np.zeros(self.count, np.int64)  # from which start
        self.way = np.zeros(self.count)
        self._moves = np.ones(len(self.home), bool)
        self._rates = np.tile([task.advance_rate, task.turn_rate], wires) * self.control
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
                raise RuntimeError("a start could not be reached: make scene.dt_s smaller or start_advance shorter")
            for s in range(self.count):
                own = slice(s * self.wires, (s + 1) * self.wires)
                kept[s].append((self.world.save(s), self.hubs[own].copy(), self.seen[s].copy(), self.measured[s].copy()))
                self.world.restore(before[s])
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

    def check(self, actions: Any, shape: tuple[int, ...]) -> np.ndarray:
        given = np.asarray(actions)
        if given.dtype.kind not in "fiu":
            raise TypeError(f"action: numbers expected, {given.dtype} given")
        if given.shape != shape:
            raise ValueError(f"action: shape {given.shape} given, {shape} expected")
        if not np.isfinite(given).all():
            raise ValueError("action: a value is not finite; numbers from -1 to 1 expected")
        return np.minimum(np.maximum(given.astype(np.float64), -1.0), 1.0).reshape(-1, 2 * self.wires)

    def spaces(self) -> tuple[spaces.Space, spaces.Space]:
        def box(width: int) -> spaces.Box:
            return spaces.Box(-10.0, 10.0, (width,), np.float32)

        seen: spaces.Space = box(len(self.columns))
        if not self.task.flat:
            parts: dict[str, spaces.Space] = {p: box(s.stop - s.start) for p, s in self.parts.items()}
            if self.task.image is not None:
                parts["image"] = spaces.Box(0, 255, self.task.image_shape, np.uint8)
            seen = spaces.Dict(parts)
        return seen, spaces.Box(-1.0, 1.0, (2 * self.wires,), np.float32)

    def images(self) -> np.ndarray:
        """Pictures of every system, [systems, *image_shape] uint8."""
        task = self.task
        if task.image == "fluoroscopy":
            frames = (self.started << 32) + self.elapsed
            grey = self.world.fluoroscopy(task.image_shape[1], task.image_shape[0], system=range(self.count), c_arm=task.image_c_arm,
                                          field=task.image_field, frame=frames)
            return (grey >> 4).astype(np.uint8)
        pictures = [np.asarray(task.image(self.world, s)) for s in range(self.count)]
        for picture in pictures:
            if picture.shape != task.image_shape or picture.dtype != np.uint8:
                raise ValueError(f"image: {picture.dtype} {picture.shape} given, uint8 {task.image_shape} expected")
        return np.stack(pictures)

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

    def images(self) -> np.ndarray:
        return self._joined(Fleet.images)

    def begin(self, s: int, start: int) -> None:
        fleet, local = self._place[s]
        fleet.begin(local, start)

    def act(self, actions: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        reward, terminated, truncated = np.empty(self.count), np.empty(self.count, bool), np.empty(self.count, bool)
        for fleet, own in zip(self.fleets, self.members):
            reward[own], terminated[own], truncated[own] = fleet.act(actions[own])
        return reward, terminated, truncated

    def check(self, actions: Any, shape: tuple[int, ...]) -> np.ndarray:
        return self.fleets[0].check(actions, shape)

    def spaces(self) -> tuple[spaces.Space, spaces.Space]:
        return self.fleets[0].spaces()

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


def starts_of(task: Navigate, overrides: Sequence[str]) -> list[tuple[Any, ...]]:
    """Starts of one variant. A separate world makes them, so a single and a vector environment have the same bits."""
    key = repr((task.scene, sorted(task.overrides.items()), task.target, task.target_depth, task.rate, task.advance_rate,
                task.start_advance, task.starts, task.start_seed, task.shape_points, task.shape_spacing, task.ahead_points,
                task.ahead_spacing, list(overrides)))
    if key not in _STARTS:
        if len(_STARTS) >= 64:
            _STARTS.clear()
        one = Fleet(task, [overrides])
        _STARTS[key] = one.make_starts()[0]
        one.close()
    return _STARTS[key]
