#!/usr/bin/env python3
"""Environment steps a processor second: the raw vector form, and PPO of stable-baselines3 through seldinger.sb3.NavigateVecEnv.

bench/ppo_speed.py [--envs 64] [--rollout 64] [--epochs 4] [--batch 1024] [--repeat 3]

Both take the same number of random steps from the same starts. PPO's time has the policy, the buffer and the learning too. Processor seconds of
all threads; worlds and starts are made before the clock runs. Use OMP_NUM_THREADS=1 where PyTorch's threads would wait for each other.
"""

import argparse
import resource
import statistics

import numpy as np
from stable_baselines3 import PPO
from stable_baselines3.common.vec_env import VecMonitor

import seldinger.gym
from seldinger.sb3 import NavigateVecEnv


def processor_seconds():
    used = resource.getrusage(resource.RUSAGE_SELF)
    return used.ru_utime + used.ru_stime


def raw(options):
    env = seldinger.gym.NavigateVectorEnv(options.envs, flat=True, starts=4, autoreset_mode="SameStep")
    env.reset(seed=0)
    actions = np.random.default_rng(0).standard_normal((options.rollout, options.envs, 2)).astype(np.float32)
    begun = processor_seconds()
    for action in actions:
        env.step(action)
    spent = processor_seconds() - begun
    env.close()
    return options.rollout * options.envs / spent


def through_ppo(options):
    env = VecMonitor(NavigateVecEnv(options.envs, flat=True, starts=4))
    env.reset()
    model = PPO("MlpPolicy", env, n_steps=options.rollout, batch_size=options.batch, n_epochs=options.epochs, seed=0, device="cpu")
    begun = processor_seconds()
    model.learn(options.rollout * options.envs)
    spent = processor_seconds() - begun
    env.close()
    return options.rollout * options.envs / spent


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--envs", type=int, default=64)
    parser.add_argument("--rollout", type=int, default=64)
    parser.add_argument("--epochs", type=int, default=4)
    parser.add_argument("--batch", type=int, default=1024)
    parser.add_argument("--repeat", type=int, default=3)
    options = parser.parse_args()
    shares = []
    for _ in range(options.repeat):
        plain, learning = raw(options), through_ppo(options)
        shares.append(learning / plain)
        print(f"raw {plain:5.0f} steps a processor second, PPO {learning:5.0f}: {shares[-1]:.2f}", flush=True)
    print(f"median {statistics.median(shares):.2f}")


if __name__ == "__main__":
    main()
