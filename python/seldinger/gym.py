"""Gymnasium environments: `seldinger/Navigate-v1`, alone and as a vector of systems of one world.

Importing this module registers them; `gymnasium.make("seldinger.gym:seldinger/Navigate-v1")` imports it by itself. It needs gymnasium
(`pip install seldinger[gym]`). `seldinger/Navigate-v0` is the same with the earlier defaults: wall_force_limit=1.0, image_channels=1.

>>> import gymnasium, seldinger.gym
>>> env = gymnasium.make("seldinger/Navigate-v1", target="left-subclavian")
>>> observation, info = env.reset(seed=1)
>>> observation, reward, terminated, truncated, info = env.step(env.action_space.sample())
>>> sorted(info)[:3]
['advance', 'distance', 'failed']
>>> episode = env.unwrapped.save()                          # hubs, clock, progress and generator, too
>>> after = env.step(env.action_space.sample())
>>> env.unwrapped.restore(episode)
>>> env.close()
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, Optional, Union

import gymnasium
import numpy as np
from gymnasium.vector import AutoresetMode, VectorEnv

from ._errors import Error
from ._fleet import Fleets, checked
from ._navigate import MEASURES, TERMS, Navigate, branches, target_point
from ._world import World

__all__ = ["Episode", "Navigate", "NavigateEnv", "NavigateVectorEnv", "branches", "target_point"]


@dataclass(frozen=True)
class Episode:
    """What `save()` of an environment returns: the state of its worlds, hubs, clock, progress, pictures and generators. It can be
    pickled."""

    task: dict[str, str]
    variants: list[int]
    fleet: Any
    generators: list[dict[str, Any]]
    ended: Optional[np.ndarray] = None
    asked: list[Optional[int]] = field(default_factory=list)  # variants, by options of reset


def _check_render_mode(render_mode: Optional[str]) -> Optional[str]:
    if render_mode not in (None, "rgb_array"):
        raise ValueError(f"render_mode: got \"{render_mode}\"; expected None or \"rgb_array\"")
    return render_mode


class _OnAFleet:
    """The worlds behind an environment, made at the first use: who only asks for spaces starts no OpenCL, and may be forked
    (AsyncVectorEnv). Copies and pickles carry the episode, and make their worlds when they need them."""

    task: Navigate
    _device: int
    _variants: list[list[str]]                     # overrides of each
    _now: list[int]                                # variant of each environment
    _asked: list[Optional[int]]                    # the same, by options of reset
    _home: list[int]                               # the same, where nothing else is said
    _draws: bool                                   # each episode its own
    _redraws = False                               # any environment may take any variant, in the same worlds
    _made: Optional[Fleets] = None
    _awaited: Optional[Episode] = None             # to be restored when the worlds are made
    _ended_for_good = False

    @property
    def variants(self) -> list[list[str]]:
        """Overrides of each variant, by number."""
        return self._variants

    @property
    def _fleet(self) -> Fleets:
        if self._ended_for_good:
            raise Error("environment: got a call after close(); expected an open environment. Fix: make a new one", 2)
        if self._made is None:
            made = Fleets(self.task, self._now, self._redraws, self._device)
            if self._awaited is not None:
                made.restore(self._awaited.fleet)
            self._made, self._awaited = made, None
        return self._made

    def _let_go(self) -> None:
        if self._made is not None:
            self._made.close()
        self._made = self._awaited = None

    def _generators(self) -> list[np.random.Generator]:
        raise NotImplementedError

    def save(self) -> Episode:
        """The whole episode: state of the worlds, hubs, clock, progress, pictures and generators."""
        ended = getattr(self, "_ended", None)
        return Episode(self.task.identity(), list(self._now), self._fleet.save(), [g.bit_generator.state for g in self._generators()],
                       None if ended is None else ended.copy(), list(self._asked))

    def restore(self, episode: Episode) -> None:
        """Returns to a saved episode of this environment or of one with the same settings: what follows has the same bits.

        Raises
        ------
        TypeError, ValueError
            Not an episode; one of other settings. Nothing has changed then.
        """
        if not isinstance(episode, Episode):
            raise TypeError(f"episode: got {type(episode).__name__}; expected what env.save() returned")
        own = {**self.task.identity(), "environments": str(len(self._now))}
        other = {**episode.task, "environments": str(len(episode.variants))}
        for name in sorted(own.keys() | other.keys()):
            if own.get(name) != other.get(name):
                raise ValueError(f"episode: got one with {name} = {other.get(name)}; expected {own.get(name)}. Fix: restore it into an "
                                 "environment with the settings of the one that saved it")
        self._take_variants(episode.variants)
        self._fleet.restore(episode.fleet)
        self._asked = list(episode.asked)
        for generator, state in zip(self._generators(), episode.generators):
            generator.bit_generator.state = state
        if episode.ended is not None:
            self._ended = episode.ended.copy()

    def _take_variants(self, now: list[int]) -> None:
        """Makes other worlds, unless those that are there have these variants, too."""
        if self._made is not None and not all(self._made.has(i, v) for i, v in enumerate(now)):
            self._let_go()
        if self._made is None and now != self._now:
            self._now, self._awaited = list(now), None

    def _ask(self, which: np.ndarray, options: Optional[dict[str, Any]]) -> list[int]:
        """Heeds options["variant"], and draws.

        @param which  environments that begin an episode. @return variant of each environment
        """
        asked = list(self._asked)
        if options and "variant" in options:
            given = options["variant"]
            for i in np.flatnonzero(which):
                one = given[i] if isinstance(given, (list, tuple, np.ndarray)) and len(given) == len(asked) else given
                if one is not None and not (isinstance(one, (int, np.integer)) and 0 <= one < len(self._variants)):
                    raise ValueError(f"variant: got {given!r}; expected None, or 0 to {len(self._variants) - 1}, one or one for each "
                                     "environment")
                asked[i] = None if one is None else int(one)
        now = list(self._now)
        fixed = [i for i in np.flatnonzero(which) if asked[i] is not None or not self._draws]
        for i in fixed:
            now[i] = self._home[i] if asked[i] is None else asked[i]
        if not which.all() and not all(self._fleet.has(i, now[i]) for i in fixed):
            raise ValueError("variant: got one that needs other worlds, with reset_mask; expected a reset of all environments. "
                             "Fix: make the environment with variant=\"draw\"")
        self._asked = asked
        for i in np.flatnonzero(which):
            if asked[i] is None and self._draws:
                now[i] = int(self._generators()[i].integers(len(self._variants)))
        return now

    def __getstate__(self) -> dict[str, Any]:
        kept = {name: value for name, value in self.__dict__.items() if name != "_made"}
        return {**kept, "_awaited": self.save() if self._made is not None else self._awaited}


class NavigateEnv(_OnAFleet, gymnasium.Env):
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
        image [rows, columns, channels] uint8, with `image`; with observation=() it is the observation.

    Reward, termination, truncation
        See `Navigate`: progress along the path, arrival, time, wall force. Terminated: arrived, or `hand_force_stop`.
        Truncated:
        `max_steps`, or a step of the engine that failed (info["failed"]).

    info
        way, distance [m], hand_force, wall_force [N], hand_torque [N m], advance [m], turn [rad], time [s], failed, success
        (is_success is the same), variant (its number; `variants` has the overrides), and the terms of the reward:
        reward_progress, reward_time, reward_force, reward_success; 0 after a reset.

    reset(seed=s)
        Only the seeded generator draws the start: the same seed gives the same episode, bit for bit.
    """

    metadata = {"render_modes": ["rgb_array"], "render_fps": 60}

    def __init__(self, render_mode: Optional[str] = None, device: int = -1, **settings: Any) -> None:
        self.render_mode, self._device = _check_render_mode(render_mode), device
        self.task = Navigate(**settings)
        self._variants = self.task.variants()
        fixed = isinstance(self.task.variant, (int, np.integer))
        self._home, self._asked = [int(self.task.variant) % len(self._variants) if fixed else 0], [None]
        self._now, self._draws = list(self._home), not fixed and len(self._variants) > 1
        self.observation_space, self.action_space = self.task.spaces()

    @property
    def world(self) -> World:
        """The world, for inspection. Its `step`, `settle`, `run` and `restore` are refused, as they would change the episode."""
        return self._fleet.world

    @property
    def variant(self) -> int:
        """Number of this episode's variant."""
        return self._now[0]

    def _generators(self) -> list[np.random.Generator]:
        return [self.np_random]

    def _observation(self) -> Any:
        if self.task.flat:
            return self._fleet.flat()[0]
        if self.task.pixels_alone:
            return self._fleet.pictures[0].copy()
        all_parts = self._fleet.seen[0]
        seen: dict[str, np.ndarray] = {p: all_parts[s].copy() for p, s in self._fleet.parts.items()}
        if self.task.image is not None:
            seen["image"] = self._fleet.pictures[0].copy()
        return seen

    def _info(self) -> dict[str, Any]:
        info: dict[str, Any] = dict(zip(MEASURES, self._fleet.measured[0].tolist()))
        info["failed"] = info["failed"] > 0
        info["success"] = info["is_success"] = not info["failed"] and info["distance"] <= self.task.target_radius
        return {**info, **dict(zip(TERMS, self._fleet.terms[0].tolist())), "variant": self.variant}

    def reset(self, *, seed: Optional[int] = None, options: Optional[dict[str, Any]] = None) -> tuple[Any, dict[str, Any]]:
        """Begins an episode. options: {"start": k} takes that start; {"variant": k} that variant, and in later episodes, too,
        until it is None."""
        super().reset(seed=seed)
        now = self._ask(np.ones(1, bool), options)
        self._take_variants(now)
        start = int(self.np_random.integers(self.task.starts))
        start = (options or {}).get("start", start) % self.task.starts
        self._fleet.begin([(0, start, now[0])])  # AsyncVectorEnv logs the traceback of an error here, and stumbles over a percent sign
        self._fleet.shoot(np.ones(1, bool))
        return self._observation(), self._info()

    def step(self, action: Any) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        """One control."""
        reward, terminated, truncated = self._fleet.act(checked(action, self.action_space.shape, self._fleet.wires))
        self._fleet.shoot(np.ones(1, bool))
        return self._observation(), float(reward[0]), bool(terminated[0]), bool(truncated[0]), self._info()

    def render(self) -> Optional[np.ndarray]:
        """[480, 640, 3] uint8, with render_mode="rgb_array"."""
        return self._fleet.render(640, 480)[0] if self.render_mode else None

    def close(self) -> None:
        """Gives the world's memory back."""
        self._let_go()
        self._ended_for_good = True


class NavigateVectorEnv(_OnAFleet, VectorEnv):
    """`num_envs` environments as systems of one world (of several, where variants differ in more than instruments, feed and friction),
    with one launch of each stage for all. Each has the bits of a single environment, resets included: environment i of
    `NavigateEnv(variant=i % variants)`, or with variant="draw", where every episode draws one, of NavigateEnv(variant="draw").

    Autoreset: `autoreset_mode`, NEXT_STEP by default. DISABLED continues an ended episode until reset(options={"reset_mask":
    [num_envs] bool}).
    """

    def __init__(self, num_envs: int = 1, autoreset_mode: Union[str, AutoresetMode] = AutoresetMode.NEXT_STEP,
                 render_mode: Optional[str] = None, device: int = -1, max_episode_steps: Optional[int] = None, **settings: Any) -> None:
        if num_envs < 1:
            raise ValueError(f"num_envs: got {num_envs}; expected 1 or more")
        if max_episode_steps is not None:  # what make_vec calls max_steps
            settings["max_steps"] = max_episode_steps
        self.task, self.render_mode, self.num_envs = Navigate(**settings), _check_render_mode(render_mode), int(num_envs)
        self._device, self.autoreset_mode = device, AutoresetMode(autoreset_mode)
        self.metadata = {"render_modes": ["rgb_array"], "render_fps": 60, "autoreset_mode": self.autoreset_mode}
        self._variants, given = self.task.variants(), self.task.variant
        several = len(self._variants)
        self._home = [(i if given is None or given == "draw" else int(given)) % several for i in range(num_envs)]
        self._now, self._asked = list(self._home), [None] * num_envs
        self._draws = self._redraws = given == "draw" and several > 1
        if self._redraws and num_envs * several > 4096:
            raise ValueError(f"variant: got \"draw\" of {several} variants for {num_envs} environments; expected at most 4096 pairs, "
                             "as each is a system. Fix: vary fewer values, or use several vectors")
        self.single_observation_space, self.single_action_space = self.task.spaces()
        self.observation_space = gymnasium.vector.utils.batch_space(self.single_observation_space, num_envs)
        self.action_space = gymnasium.vector.utils.batch_space(self.single_action_space, num_envs)
        self._random = [np.random.default_rng() for _ in range(num_envs)]
        self._ended = np.zeros(num_envs, bool)

    @property
    def world(self) -> World:
        """The world of all environments; where `vary` needs several, that of the first."""
        return self._fleet.world

    @property
    def worlds(self) -> list[World]:
        """Worlds, one for each kind of scene among the variants."""
        return self._fleet.worlds

    @property
    def variant(self) -> np.ndarray:
        """Number of the variant of each environment's episode [num_envs]."""
        return np.array(self._now)

    def _generators(self) -> list[np.random.Generator]:
        return self._random

    def _observation(self) -> Any:
        if self.task.flat:
            return self._fleet.flat()
        if self.task.pixels_alone:
            return self._fleet.pictures.copy()
        all_parts = self._fleet.seen.copy()
        seen: dict[str, np.ndarray] = {p: all_parts[:, s] for p, s in self._fleet.parts.items()}
        if self.task.image is not None:
            seen["image"] = self._fleet.pictures.copy()
        return seen

    def _info(self) -> dict[str, Any]:
        info: dict[str, Any] = dict(zip(MEASURES, self._fleet.measured.T.copy()))
        info["failed"] = info["failed"] > 0
        info["success"] = ~info["failed"] & (info["distance"] <= self.task.target_radius)
        info["is_success"] = info["success"].copy()
        info.update(zip(TERMS, self._fleet.terms.T.copy()), variant=self.variant)
        return {**info, **dict.fromkeys(("_" + name for name in info), np.ones(self.num_envs, bool))}

    def _final(self, done: np.ndarray) -> dict[str, Any]:
        """What SAME_STEP says of the episodes that have ended: as gymnasium does, one observation for each of them, None for the others."""
        seen, last = self._observation(), np.full(self.num_envs, None, object)
        for s in np.flatnonzero(done):
            last[s] = {p: part[s] for p, part in seen.items()} if isinstance(seen, dict) else seen[s]
        return {"final_obs": last, "final_info": self._info(), "_final_obs": done.copy(), "_final_info": done.copy()}

    def _begin(self, which: np.ndarray, options: Optional[dict[str, Any]] = None) -> None:
        """@param options  of reset(): start and variant of all, or of each; else the generators draw them"""
        now = self._ask(which, options)
        if which.all():
            self._take_variants(now)
        fleet, chosen, episodes = self._fleet, (options or {}).get("start"), []
        for s in np.flatnonzero(which):
            drawn = int(self._random[s].integers(self.task.starts))
            start = drawn if chosen is None else int(np.broadcast_to(chosen, self.num_envs)[s]) % self.task.starts
            episodes.append((int(s), start, now[s]))
        fleet.begin(episodes)
        self._ended[which] = False

    def reset(self, *, seed: Union[None, int, Sequence[Optional[int]]] = None,
              options: Optional[dict[str, Any]] = None) -> tuple[Any, dict[str, Any]]:
        """Begins an episode in all environments. seed s: environment i has s + i, as in gymnasium's vector environments. options:
        {"start": k} takes that start, {"variant": k} that variant (and in later episodes, too, until it is None), [num_envs] one
        for each; {"reset_mask": [num_envs] bool} begins some only."""
        seeds = [seed + i for i in range(self.num_envs)] if isinstance(seed, (int, np.integer)) else seed or [None] * self.num_envs
        if len(seeds) != self.num_envs:
            raise ValueError(f"seed: got {len(seeds)}; expected one or {self.num_envs}")
        which = np.asarray((options or {}).get("reset_mask", np.ones(self.num_envs, bool)))
        if which.shape != (self.num_envs,) or which.dtype != bool:
            raise ValueError(f"reset_mask: got {which.dtype} {which.shape}; expected [{self.num_envs}] bool")
        for s, own in enumerate(seeds):
            if own is not None and which[s]:
                self._random[s] = gymnasium.utils.seeding.np_random(int(own))[0]
        self._begin(which, options)
        self._fleet.shoot(which)
        return self._observation(), self._info()

    def step(self, actions: Any) -> tuple[Any, np.ndarray, np.ndarray, np.ndarray, dict[str, Any]]:
        """One control of all environments. With NEXT_STEP, the step after an episode's end begins the next one and ignores its
        action."""
        ended, everyone = self._ended.copy(), np.ones(self.num_envs, bool)
        reward, terminated, truncated = self._fleet.act(checked(actions, self.action_space.shape, self._fleet.wires))
        final: dict[str, Any] = {}
        if self.autoreset_mode == AutoresetMode.NEXT_STEP and ended.any():
            self._begin(ended)
            reward[ended], terminated[ended], truncated[ended] = 0.0, False, False
        self._fleet.shoot(everyone)
        done = terminated | truncated
        if self.autoreset_mode == AutoresetMode.SAME_STEP and done.any():
            final = self._final(done)
            self._begin(done)
            self._fleet.shoot(done)
        else:
            self._ended = done.copy()
        return self._observation(), reward, terminated, truncated, {**self._info(), **final}

    def render(self) -> Optional[tuple[np.ndarray, ...]]:
        """A picture [480, 640, 3] uint8 of each environment, with render_mode="rgb_array"."""
        return tuple(self._fleet.render(640, 480)) if self.render_mode else None

    def close_extras(self, **_: Any) -> None:
        """Gives the world's memory back."""
        self._let_go()
        self._ended_for_good = True


for _version, _settings in (("v0", {"wall_force_limit": 1.0, "image_channels": 1}), ("v1", {})):
    if f"seldinger/Navigate-{_version}" not in gymnasium.registry:
        gymnasium.register(id=f"seldinger/Navigate-{_version}", entry_point="seldinger.gym:NavigateEnv",
                           vector_entry_point="seldinger.gym:NavigateVectorEnv", kwargs=_settings)
