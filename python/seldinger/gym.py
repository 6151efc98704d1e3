"""Gymnasium environments: `seldinger/Navigate-v0`, alone and as a vector of systems of one world.

Importing this module registers them. It needs gymnasium (`pip install seldinger[gym]`).

>>> import gymnasium, seldinger.gym
>>> env = gymnasium.make("seldinger/Navigate-v0", target="left-subclavian")
>>> observation, info = env.reset(seed=1)
>>> observation, reward, terminated, truncated, info = env.step(env.action_space.sample())
>>> sorted(info)[:3]
['advance', 'distance', 'failed']
>>> env.close()
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Optional, Union

import gymnasium
import numpy as np
from gymnasium.vector import AutoresetMode, VectorEnv

from ._navigate import MEASURES, Fleet, Navigate, branches, fleet_of, starts_of, target_point
from ._world import World

__all__ = ["Navigate", "NavigateEnv", "NavigateVectorEnv", "branches", "target_point"]


class NavigateEnv(gymnasium.Env):
    """Steers a wire to a target inside a vessel.

    Actions
        Box(-1, 1, [2 instruments]): advance and turn of each hub, as fractions of `advance_rate` and `turn_rate`.

    Observations (float32, within -10 ... 10), of the first instrument
        tip [8]: remaining path / 0.1 m; offset from the centreline in radii of the lumen, along its normals n and b; the tip's
        direction along (u, n, b), u the direction of the path; the side to which the tip bends, along n and b.
        ahead [3 each]: points of the path ahead, from the tip / 0.1 m, along its direction, its side, and across both.
        shape [3 each]: points of the wire behind the tip: path from the tip / 0.1 m, offset from the centreline in radii.
        hand [2]: force / 0.5 N, torque / 1 N mm.   wall [2]: sum of normal forces / 0.5 N, contacts / 10.
        hub [3]: advance / 0.1 m, sine and cosine of the turn.

    Reward, termination, truncation
        See `Navigate`: progress along the path, arrival, time, wall force. Terminated: arrived, or `hand_force_stop`.
        Truncated:
        `max_steps`, or a step of the engine that failed (info["failed"]).

    info
        way, distance [m], hand_force, wall_force [N], hand_torque [N m], advance [m], turn [rad], time [s], failed, success.

    reset(seed=s)
        Only the seeded generator draws the start: the same seed gives the same episode, bit for bit.
    """

    metadata = {"render_modes": ["rgb_array"], "render_fps": 60}

    def __init__(self, render_mode: Optional[str] = None, device: int = -1, **settings: Any) -> None:
        if render_mode not in (None, "rgb_array"):
            raise ValueError(f"render_mode: \"{render_mode}\" given; None or \"rgb_array\" expected")
        self.render_mode, self._device = render_mode, device
        self.task = Navigate(**settings)
        self._variants = self.task.variants()
        self._variant = -1
        self._use((self.task.variant or 0) % len(self._variants))
        self.observation_space, self.action_space = self._fleet.spaces()

    def _use(self, variant: int) -> None:
        if variant == self._variant:
            return
        if self._variant >= 0:
            self._fleet.close()
        self._variant = variant
        self._fleet = Fleet(self.task, [self._variants[variant]], self._device)
        self._fleet.keep([starts_of(self.task, self._variants[variant])])

    @property
    def world(self) -> World:
        """The world, for inspection; stepping it changes the episode."""
        return self._fleet.world

    def _observation(self) -> Any:
        if self.task.flat:
            return self._fleet.flat()[0]
        seen: dict[str, np.ndarray] = {p: self._fleet.seen[0, s].copy() for p, s in self._fleet.parts.items()}
        if self.task.image is not None:
            seen["image"] = self._fleet.images()[0]
        return seen

    def _info(self) -> dict[str, Any]:
        info: dict[str, Any] = dict(zip(MEASURES, self._fleet.measured[0].tolist()))
        info["failed"] = info["failed"] > 0
        info["success"] = not info["failed"] and info["distance"] <= self.task.target_radius
        return info

    def reset(self, *, seed: Optional[int] = None, options: Optional[dict[str, Any]] = None) -> tuple[Any, dict[str, Any]]:
        """Begins an episode. options: {"start": k} takes that start."""
        super().reset(seed=seed)
        if self.task.variant is None and len(self._variants) > 1:
            self._use(int(self.np_random.integers(len(self._variants))))
        start = int(self.np_random.integers(self.task.starts))
        self._fleet.begin(0, (options or {}).get("start", start) % self.task.starts)
        return self._observation(), self._info()

    def step(self, action: Any) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        """One control."""
        reward, terminated, truncated = self._fleet.act(self._fleet.check(action, self.action_space.shape))
        return self._observation(), float(reward[0]), bool(terminated[0]), bool(truncated[0]), self._info()

    def render(self) -> Optional[np.ndarray]:
        """[480, 640, 3] uint8, with render_mode="rgb_array"."""
        return self._fleet.world.render(640, 480) if self.render_mode else None

    def close(self) -> None:
        """Gives the world's memory back."""
        self._fleet.close()


class NavigateVectorEnv(VectorEnv):
    """`num_envs` environments as systems of one world (one for each vessel, where `vary` has several), with one launch of each
    stage for all. Each has the bits of a single environment (environment i: `NavigateEnv(variant=i % variants)`), resets
    included.

    Autoreset: `autoreset_mode`, NEXT_STEP by default. DISABLED continues an ended episode until reset(options={"reset_mask":
    [num_envs] bool}).
    """

    def __init__(self, num_envs: int = 1, autoreset_mode: Union[str, AutoresetMode] = AutoresetMode.NEXT_STEP,
                 render_mode: Optional[str] = None, device: int = -1, **settings: Any) -> None:
        if num_envs < 1:
            raise ValueError(f"num_envs: {num_envs} given, 1 or more expected")
        self.task, self.render_mode, self.num_envs = Navigate(**settings), render_mode, int(num_envs)
        self.autoreset_mode = AutoresetMode(autoreset_mode)
        self.metadata = {"render_modes": ["rgb_array"], "render_fps": 60, "autoreset_mode": self.autoreset_mode}
        variants = self.task.variants()
        own = [variants[i % len(variants)] for i in range(num_envs)]
        self._fleet = fleet_of(self.task, own, device)
        self._fleet.keep([starts_of(self.task, v) for v in own])
        self.single_observation_space, self.single_action_space = self._fleet.spaces()
        self.observation_space = gymnasium.vector.utils.batch_space(self.single_observation_space, num_envs)
        self.action_space = gymnasium.vector.utils.batch_space(self.single_action_space, num_envs)
        self._random = [np.random.default_rng() for _ in range(num_envs)]
        self._ended = np.zeros(num_envs, bool)

    @property
    def world(self) -> World:
        """The world of all environments; with several vessels (`vary`), that of the first."""
        return self._fleet.world

    @property
    def worlds(self) -> list[World]:
        """Worlds, one for each vessel."""
        return self._fleet.worlds

    def _observation(self) -> Any:
        if self.task.flat:
            return self._fleet.flat()
        all_parts = self._fleet.seen.copy()
        seen: dict[str, np.ndarray] = {p: all_parts[:, s] for p, s in self._fleet.parts.items()}
        if self.task.image is not None:
            seen["image"] = self._fleet.images()
        return seen

    def _info(self) -> dict[str, Any]:
        info: dict[str, Any] = dict(zip(MEASURES, self._fleet.measured.T.copy()))
        info["failed"] = info["failed"] > 0
        info["success"] = ~info["failed"] & (info["distance"] <= self.task.target_radius)
        return {**info, **dict.fromkeys(("_" + name for name in info), np.ones(self.num_envs, bool))}

    def _begin(self, which: np.ndarray) -> None:
        for s in np.flatnonzero(which):
            self._fleet.begin(int(s), int(self._random[s].integers(self.task.starts)))
        self._ended[which] = False

    def reset(self, *, seed: Union[None, int, Sequence[Optional[int]]] = None,
              options: Optional[dict[str, Any]] = None) -> tuple[Any, dict[str, Any]]:
        """Begins an episode in all environments. seed s: environment i has s + i, as in gymnasium's vector environments."""
        seeds = [seed + i for i in range(self.num_envs)] if isinstance(seed, (int, np.integer)) else seed or [None] * self.num_envs
        if len(seeds) != self.num_envs:
            raise ValueError(f"seed: {len(seeds)} given, one or {self.num_envs} expected")
        which = np.asarray((options or {}).get("reset_mask", np.ones(self.num_envs, bool)))
        if which.shape != (self.num_envs,) or which.dtype != bool:
            raise ValueError(f"reset_mask: [{self.num_envs}] bool expected")
        for s, own in enumerate(seeds):
            if own is not None and which[s]:
                self._random[s] = gymnasium.utils.seeding.np_random(int(own))[0]
        self._begin(which)
        return self._observation(), self._info()

    def step(self, actions: Any) -> tuple[Any, np.ndarray, np.ndarray, np.ndarray, dict[str, Any]]:
        """One control of all environments. With NEXT_STEP, the step after an episode's end begins the next one and ignores its
        action."""
        ended = self._ended.copy()
        reward, terminated, truncated = self._fleet.act(self._fleet.check(actions, self.action_space.shape))
        final: dict[str, Any] = {}
        if self.autoreset_mode == AutoresetMode.NEXT_STEP and ended.any():
            self._begin(ended)
            reward[ended], terminated[ended], truncated[ended] = 0.0, False, False
        done = terminated | truncated
        if self.autoreset_mode == AutoresetMode.SAME_STEP and done.any():
            final = {"final_obs": self._observation(), "final_info": self._info(), "_final_obs": done.copy(),
                     "_final_info": done.copy()}
            self._begin(done)
        else:
            self._ended = done.copy()
        return self._observation(), reward, terminated, truncated, {**self._info(), **final}

    def render(self) -> Optional[tuple[np.ndarray, ...]]:
        """A picture of each world, all its systems in it."""
        return tuple(world.render(640, 480) for world in self._fleet.worlds) if self.render_mode else None

    def close_extras(self, **_: Any) -> None:
        """Gives the world's memory back."""
        self._fleet.close()


if "seldinger/Navigate-v0" not in gymnasium.registry:
    gymnasium.register(id="seldinger/Navigate-v0", entry_point="seldinger.gym:NavigateEnv",
                       vector_entry_point="seldinger.gym:NavigateVectorEnv")
