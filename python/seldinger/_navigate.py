"""The task of seldinger/Navigate-v1: its settings and its targets. `_fleet.py` has the worlds behind its environments."""

from __future__ import annotations

import itertools
import math
import pickle
import zlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Optional, Union

import numpy as np
from gymnasium import spaces

from . import _engine
from ._force import Force
from ._scene import Scene, SceneLike
from ._studies import sweep
from ._world import World

MEASURES = ("way", "distance", "hand_force", "hand_torque", "wall_force", "advance", "turn", "failed", "time")
TERMS = ("reward_progress", "reward_time", "reward_force", "reward_success")  # of which the reward is the sum
PARTS = ("tip", "ahead", "shape", "hand", "wall", "hub")


@dataclass
class Navigate:
    """Settings of the task; keywords of `gymnasium.make` and `make_vec`.

    Attributes
    ----------
    scene, overrides
        The scene: see `seldinger.World`; `overrides` as a dict.
    target
        A branch of the arch, "left-subclavian", "left-carotid" or "brachiocephalic"; "branch:k", the k-th (from 1) from the inlet
        of any vessel; "branch:2.1", a path, or "branch:name" (docs/answers.md); or a point [3] [m].
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
        Parts of the observation, from "tip", "ahead", "shape", "hand", "wall", "hub" (see `NavigateEnv`). Empty, with an `image`:
        the picture alone, a Box.
    flat : bool
        A Box of all parts instead of a Dict.
    shape_points, shape_spacing, ahead_points, ahead_spacing
        Number and spacing [m] of observed points: on the wire behind its tip, and on the path ahead.
    progress, success, time, force : float
        Reward: per metre of path covered; for arrival; per control; per newton of wall force above `wall_force_limit`.
    wall_force_limit : float
        [N]; the default is the tip load of a floppy wire (docs/typical-values.md). It says nothing about a patient.
    hand_force_stop : float or None
        An episode ends (terminated) at a larger hand force [N].
    vary
        Domain randomisation in the sweep's syntax (`seldinger.sweep`), of any keys of the scene. Variants that differ in
        instruments, feed and friction alone share a world; others have worlds of their own.
    variant : int, "draw" or None
        The variant of all episodes, or "draw": each episode draws one. None: a single environment draws, and environment i of the
        vector form has variant i modulo their number. `reset(options={"variant": k})` has the last word, until it says None.
    image : "fluoroscopy", callable or None
        A picture for the policy, added to the Dict as "image" [rows, columns, channels]: 8 bits of `World.fluoroscopy` (its quantum
        noise is seeded by the start and the control: the same seed gives the same bits); or image(world, system) -> uint8 array of
        `image_shape`.
    image_channels : int
        3: each position of the C-arm is three equal channels, as programs for colour pictures take them; 1: one.
    image_shape : (int, int)
        Rows and columns; of a function's picture also (rows, columns, channels).
    image_c_arm : str, sequence of str or None
        Position of the C-arm, "LAO 30, CRA 15" (None: the scene's). Several positions follow each other in the channels.
    image_field : float
        Width of the detector [m].
    image_stack : int
        Pictures of the last controls, oldest first, as further channels; an episode begins with copies of its first picture.
    forces : sequence of Force, or of (Force, instrument)
        Forces of your own (docs/forces.md), on the first instrument of each environment or on another one. With `together=True` a force is
        asked once for all environments of a world.
    progress_line : bool
        A line on stderr where start-up takes more than a second.
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
    wall_force_limit: float = 0.01
    hand_force_stop: Optional[float] = None
    vary: Any = None
    variant: Union[None, int, str] = None
    image: Union[None, str, Callable[[World, int], np.ndarray]] = None
    image_channels: int = 3
    image_shape: tuple[int, ...] = (64, 64)
    image_c_arm: Union[None, str, Sequence[str]] = None
    image_field: Optional[float] = None
    image_stack: int = 1
    forces: Sequence[Any] = ()
    progress_line: bool = True

    def __post_init__(self) -> None:
        self.observation = tuple(self.observation)
        self.forces = tuple(given if isinstance(given, tuple) else (given, 0) for given in self.forces)
        for given in self.forces:
            if len(given) != 2 or not isinstance(given[0], Force):
                raise ValueError(f"forces: got {given!r:.60}; expected seldinger.Force objects, or (force, instrument)")
        self._forces_as_given = " ".join(f"{type(force).__qualname__} {_contents(force)} on {on}" for force, on in self.forces)
        unknown = [p for p in self.observation if p not in PARTS]
        if unknown:
            raise ValueError(f"observation: got {unknown}; expected some of {list(PARTS)}")
        if not self.observation and self.image is None:
            raise ValueError("observation: got nothing to observe; expected parts or a picture. Fix: name parts, or set image=\"fluoroscopy\"")
        for name in ("rate", "advance_rate", "turn_rate", "target_radius", "max_steps", "starts", "image_stack"):
            if not getattr(self, name) > 0:
                raise ValueError(f"{name}: got {getattr(self, name)}; expected more than 0")
        low, high = self.start_advance
        if not 0 < low <= high:
            raise ValueError(f"start_advance: got {self.start_advance}; expected (least, most) in metres")
        check_target(self.target)
        if isinstance(self.variant, str) and self.variant != "draw":
            raise ValueError(f"variant: got \"{self.variant}\"; expected a number, \"draw\" or None")
        self._check_image()

    def _check_image(self) -> None:
        self.image_shape = tuple(self.image_shape)
        if self.image is not None and self.image != "fluoroscopy" and not callable(self.image):
            raise ValueError(f"image: got {self.image!r}; expected \"fluoroscopy\", a function or None")
        if self.image is not None and len(self.image_shape) not in ((2,) if self.image == "fluoroscopy" else (2, 3)):
            raise ValueError(f"image_shape: got {self.image_shape}; expected (rows, columns)")
        if self.image_channels not in (1, 3):
            raise ValueError(f"image_channels: got {self.image_channels}; expected 1 or 3")
        if self.image is not None and self.flat:
            raise ValueError("image: got flat=True; expected flat=False, as a picture is a part of a Dict. Fix: flat=False, or observation=() for the picture alone")
        if not isinstance(self.image_c_arm, (str, type(None))):
            self.image_c_arm = tuple(self.image_c_arm)
            if not self.image_c_arm or not all(isinstance(one, str) for one in self.image_c_arm):
                raise ValueError(f"image_c_arm: got {self.image_c_arm}; expected a text as \"LAO 30\", or several")

    @property
    def views(self) -> tuple[Optional[str], ...]:
        """Positions of the C-arm."""
        return self.image_c_arm if isinstance(self.image_c_arm, tuple) else (self.image_c_arm,)

    @property
    def pixels_alone(self) -> bool:
        """Whether an observation is the picture, without a Dict around it."""
        return not self.observation

    @property
    def picture_shape(self) -> tuple[int, int, int]:
        """Of one control: (rows, columns, channels), without those of earlier controls."""
        rows, columns, *rest = self.image_shape
        return rows, columns, rest[0] if rest else self.image_channels * len(self.views) if self.image == "fluoroscopy" else 1

    def variants(self) -> list[list[str]]:
        """Overrides of each variant."""
        return sweep(self.vary) if self.vary else [[]]

    def identity(self) -> dict[str, str]:
        """What a start or a saved episode depends on, in words: two tasks that agree in it can exchange them."""
        scene = Scene(self.scene)
        of = {"scene": f"{scene.file} {scene.overrides} {zlib.crc32(scene.text.encode())}"}
        pictures = ("image_shape", "image_c_arm", "image_stack", "image_channels") if self.image is not None else ()
        for name in ("target", "target_depth", "rate", "advance_rate", "shape_points", "shape_spacing", "ahead_points",
                     "ahead_spacing", "vary", *pictures):
            of[name] = repr(getattr(self, name))
        of["overrides"] = repr(sorted(self.overrides.items()))
        if self.forces:
            of["forces"] = self._forces_as_given
        return of

    def hubs(self) -> int:
        """Number of instruments, read from the scene without a device.

        Raises
        ------
        ValueError
            An instrument without a feed.
        """
        scene = Scene(self.scene, **self.overrides)
        fed = _engine.scene_feeds(scene.text, scene.file, scene.overrides)
        if not all(fed):
            raise ValueError(f"scene: got instruments of which number {fed.index(False)} has no feed; expected each to be fed. "
                             "Fix: [feed], or feed of its [[instrument]]")
        return len(fed)

    def parts(self) -> dict[str, slice]:
        """Columns of each part of the observation among all."""
        widths = {"tip": 8, "ahead": 3 * self.ahead_points, "shape": 3 * self.shape_points, "hand": 2, "wall": 2, "hub": 3}
        ends = np.cumsum([widths[p] for p in PARTS])
        return {p: slice(int(end - widths[p]), int(end)) for p, end in zip(PARTS, ends) if p in self.observation}

    def spaces(self) -> tuple[spaces.Space, spaces.Space]:
        """Of observations and actions; no world is made for them."""
        def box(width: int) -> spaces.Box:
            return spaces.Box(-10.0, 10.0, (width,), np.float32)

        widths = {p: s.stop - s.start for p, s in self.parts().items()}
        rows, columns, channels = self.picture_shape
        picture = spaces.Box(0, 255, (rows, columns, channels * self.image_stack), np.uint8)
        seen: spaces.Space = picture if self.pixels_alone else box(sum(widths.values()))
        if not self.flat and not self.pixels_alone:
            parts: dict[str, spaces.Space] = {p: box(width) for p, width in widths.items()}
            seen = spaces.Dict({**parts, "image": picture} if self.image is not None else parts)
        return seen, spaces.Box(-1.0, 1.0, (2 * self.hubs(),), np.float32)


def _contents(force: Force) -> str:
    """What tells two forces of a class apart: their pickled bytes, or, where they have none, which of the process they are."""
    try:
        return str(zlib.crc32(pickle.dumps(force)))
    except (pickle.PicklingError, AttributeError, TypeError):
        return force.__dict__.setdefault("_number", f"number {next(_unpicklable)}")


_unpicklable = itertools.count()


def branches(world: World) -> list[np.ndarray]:
    """Branches of the vessel's axis with a number, points [p, 3] from where each leaves the path from the inlet [m], in the order of
    their numbers; the trunk's own end is the last. Branch k of a scene (`task.target.branch`) and target "branch:k" are the k-th,
    from 1. `World.branches` has the vessels between forks, too."""
    points = world.centreline["points"]
    ends = sorted((b for b in world.branches() if b["number"]), key=lambda b: b["number"])
    return [points[b["points"]] for b in ends]


_ARCH = ("left-subclavian", "left-carotid", "brachiocephalic")  # from the diaphragm


def check_target(target: Union[str, Sequence[float]]) -> None:
    """Refuses what is a target of no vessel."""
    name, _, number = target.partition(":") if isinstance(target, str) else ("", "", "")
    if isinstance(target, str) and target not in _ARCH and not (name == "branch" and number and number != "0"):
        raise ValueError(f"target: got \"{target}\"; expected {', '.join(_ARCH)}, branch:1 or another number, branch:2.1 or another path or name, "
                         "or a point [3] in metres")
    if not isinstance(target, str) and (np.shape(target) != (3,) or not np.isfinite(np.asarray(target, float)).all()):
        raise ValueError(f"target: got {target}; expected a name or a point [3] in metres")


def target_point(world: World, target: Union[str, Sequence[float]], depth: float) -> np.ndarray:
    """Position of a target [3] [m]."""
    check_target(target)
    if not isinstance(target, str):
        return np.asarray(target, float)
    found = world.branches()
    word = str(_ARCH.index(target) + 1) if target in _ARCH else target.partition(":")[2]
    line = next((b["points"] for b in found if word.isdigit() and b["number"] == int(word)), None)
    if line is None:
        line = next((b["points"] for b in found if word in (b["path"], b["name"]) and not word.isdigit()), None)
    if line is None:
        raise ValueError(f"target: got \"{target}\"; expected branch:1 to branch:{max(b['number'] for b in found) if found else 0} of this vessel, or branch: and one of "
                         f"the paths {', '.join(b['path'] for b in found)}")
    line = world.centreline["points"][line]
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))])
    return np.array([np.interp(depth, along, line[:, d]) for d in range(3)])
