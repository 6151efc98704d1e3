#!/usr/bin/env python3
"""Environment steps a processor second: the raw vector form, and PPO of stable-baselines3 through seldinger.sb3.NavigateVecEnv.

bench/ppo_speed.py [--envs 64] [--rollout 64] [--epochs 4] [--batch 1024] [--repeat 3]

Both take the same number of random steps from the same starts. PPO's time has the policy, the buffer and the learning too. Processor seconds of
all threads; worlds and starts are made before the clock runs. Use OMP_NUM_THREADS=1 where PyTorch's threads would wait for each other.
"""

import numpy as np
import seldinger.gym
from seldinger.sb3 import NavigateVecEnv
from stable_baselines3 import PPO
from stable_baselines3.common.vec_env import VecMonitor

import runner


def raw(options):
    env = seldinger.gym.NavigateVectorEnv(options.envs, flat=True, starts=4, autoreset_mode="SameStep")
    env.reset(seed=0)
    actions = np.random.default_rng(0).standard_normal((options.rollout, options.envs, 2)).astype(np.float32)
    begun = runner.own_seconds()
    for action in actions:
        env.step(action)
    spent = runner.own_seconds() - begun
    env.close()
    return options.rollout * options.envs / spent


def through_ppo(options):
    env = VecMonitor(NavigateVecEnv(options.envs, flat=True, starts=4))
    env.reset()
    model = PPO("MlpPolicy", env, n_steps=options.rollout, batch_size=options.batch, n_epochs=options.epochs, seed=0, device="cpu")
    begun = runner.own_seconds()
    model.learn(options.rollout * options.envs)
    spent = runner.own_seconds() - begun
    env.close()
    return options.rollout * options.envs / spent


def main():
    parser = runner.parser(__doc__, app=False)
    parser.add_argument("--envs", type=int, default=64)
    parser.add_argument("--rollout", type=int, default=64)
    parser.add_argument("--epochs", type=int, default=4)
    parser.add_argument("--batch", type=int, default=1024)
    parser.add_argument("--repeat", type=int, default=3)
    options = parser.parse_args()
    rounds = runner.in_turn(options.repeat, raw=lambda: raw(options), ppo=lambda: through_ppo(options))
    shares = [learning / plain for plain, learning in zip(rounds["raw"], rounds["ppo"])]
    for plain, learning, share in zip(rounds["raw"], rounds["ppo"], shares):
        print(f"raw {plain:5.0f} steps a processor second, PPO {learning:5.0f}: {share:.2f}")
    print(f"median {runner.median(shares):.2f}")


if __name__ == "__main__":
    main()
