"""seldinger/Navigate-v1 for stable-baselines3: its VecEnv over the vector form, which steps all environments at once.

It needs stable-baselines3 (`pip install 'seldinger[sb3]'`).

>>> from seldinger.sb3 import NavigateVecEnv
>>> env = NavigateVecEnv(2, flat=True, starts=2)
>>> env.seed(1)
[1, 2]
>>> observations = env.reset()
>>> observations.shape, env.action_space.shape
((2, 45), (2,))
>>> env.close()
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Optional, Union

import gymnasium
import numpy as np
from gymnasium.vector import AutoresetMode
from stable_baselines3.common.vec_env import VecEnv

from .gym import NavigateVectorEnv

__all__ = ["NavigateVecEnv"]

_Which = Union[None, int, Sequence[int]]


class NavigateVecEnv(VecEnv):
    """`num_envs` environments as one `stable_baselines3` VecEnv. Settings are those of `seldinger.gym.Navigate`.

    flat=True is for "MlpPolicy", the Dict for "MultiInputPolicy", and image="fluoroscopy" with observation=() for "CnnPolicy".

    info
        As of `NavigateEnv`; of an episode that has ended also `terminal_observation` and `TimeLimit.truncated`.
    """

    def __init__(self, num_envs: int = 1, render_mode: Optional[str] = None, device: int = -1, **settings: Any) -> None:
        self.env = NavigateVectorEnv(num_envs, autoreset_mode=AutoresetMode.SAME_STEP, render_mode=render_mode, device=device, **settings)
        self._actions: Optional[np.ndarray] = None
        super().__init__(num_envs, self.env.single_observation_space, self.env.single_action_space)

    def reset(self) -> Any:
        """First observations of new episodes, with the seeds of `seed`, starts and variants of `set_options({"start": k})`."""
        names = set(self._options[0])
        if any(set(own) != names for own in self._options) or not names <= {"start", "variant"}:
            raise ValueError(f"options: got {self._options}; expected {{\"start\": k}}, \"variant\" or both for every environment, "
                             "or none")
        chosen = {name: [own[name] for own in self._options] for name in names}
        seen, info = self.env.reset(seed=self._seeds if any(s is not None for s in self._seeds) else None, options=chosen)
        self.reset_infos = self._each(info)
        self._reset_seeds()
        self._reset_options()
        return seen

    def step_async(self, actions: np.ndarray) -> None:
        """Keeps the actions for `step_wait`."""
        self._actions = actions

    def step_wait(self) -> Any:
        """One control of all environments; those whose episode has ended begin another one."""
        seen, rewards, terminated, truncated, info = self.env.step(self._actions)
        done = terminated | truncated
        infos = self._each(info)
        for s in np.flatnonzero(done):
            infos[s] = {**self._one(info["final_info"], s), "terminal_observation": info["final_obs"][s],
                        "TimeLimit.truncated": bool(truncated[s] and not terminated[s])}
        return seen, rewards.astype(np.float32), done, infos

    def _one(self, info: dict[str, Any], s: int) -> dict[str, Any]:
        return {name: value[s].item() for name, value in info.items() if name[0] != "_" and not name.startswith("final")}

    def _each(self, info: dict[str, Any]) -> list[dict[str, Any]]:
        columns = {name: value.tolist() for name, value in info.items() if name[0] != "_" and not name.startswith("final")}
        return [dict(zip(columns, row)) for row in zip(*columns.values())]

    def close(self) -> None:
        """Gives the world's memory back."""
        self.env.close()

    def get_images(self) -> Sequence[Optional[np.ndarray]]:
        """A picture of each environment, with render_mode="rgb_array"."""
        return self.env.render() or [None] * self.num_envs

    # -- what stable-baselines3 asks of single environments, which share one world here --------------------------------

    def get_attr(self, attr_name: str, indices: _Which = None) -> list[Any]:
        """An attribute of the vector form, once for each environment."""
        return [getattr(self.env, attr_name)] * len(list(self._get_indices(indices)))

    def set_attr(self, attr_name: str, value: Any, indices: _Which = None) -> None:
        """Refused: one world has one set of settings."""
        raise NotImplementedError(f"set_attr: got {attr_name}; expected settings given to NavigateVecEnv. Fix: make another one")

    def env_method(self, method_name: str, *method_args: Any, indices: _Which = None, **method_kwargs: Any) -> list[Any]:
        """Refused: there are no single environments."""
        raise NotImplementedError(f"env_method: got {method_name}; expected a method of the vector form. Fix: call {method_name} of .env, for all at once")

    def env_is_wrapped(self, wrapper_class: type[gymnasium.Wrapper], indices: _Which = None) -> list[bool]:
        """No: there are no single environments to be wrapped. VecMonitor and its like wrap all of them."""
        return [False] * len(list(self._get_indices(indices)))
