#!/usr/bin/env python3
"""Learns to steer a wire into a branch of the aortic arch, by the cross-entropy method with NumPy alone.

train_navigate.py [--target left-carotid] [--minutes 8] [--generations N] [--seed 0] [-o DIR]

A policy is linear in the points of the way ahead of the tip, with a tanh; all its weights begin at zero. A generation is a set of policies
drawn from a normal distribution, each tried from the same few random starts, all at once in one world; the best quarter is the next
distribution, widened by a noise that fades, so that it does not settle before the first has arrived (Szita and Lorincz 2006,
doi:10.1162/neco.2006.18.12.2936). Success is measured on other starts than those learnt from, with the distribution's mean. Writes curve.csv, policy.npz.
"""

import argparse
import csv
import time
from pathlib import Path

import numpy as np
from gymnasium.vector import AutoresetMode

import seldinger.gym

NOISE, FADE = 1.0, 0.8  # of the weights, per generation
EVALUATED, START_SEED = 16, {"learning": 0, "evaluation": 1}


def make(count, target, start_seed, steps):
    return seldinger.gym.NavigateVectorEnv(count, autoreset_mode=AutoresetMode.DISABLED, flat=True, observation=("ahead",), target=target,
                                           starts=16, start_seed=start_seed, max_steps=steps)


def act(policies, seen):
    """@param policies [n, actions, ahead + 1]. Points of the way come in units of 0.1 m and are a few centimetres off."""
    inputs = np.concatenate([10 * seen, np.ones((len(seen), 1))], axis=1)
    return np.tanh(np.einsum("nai,ni->na", policies, inputs))


def play(env, policies, seed):
    """One episode of each environment under its own policy. @param seed  as of reset. @return summed rewards, arrived, controls taken"""
    n = env.num_envs
    seen, _ = env.reset(seed=seed)
    running, total, arrived, taken = np.ones(n, bool), np.zeros(n), np.zeros(n, bool), np.zeros(n, int)
    while running.any():
        actions = act(policies, seen)
        actions[~running] = 0.0  # those that have ended wait where they are
        seen, reward, terminated, truncated, info = env.step(actions)
        total += np.where(running, reward, 0.0)
        arrived |= running & info["success"]
        taken += running
        running &= ~(terminated | truncated)
    return total, arrived, taken


class Curve:
    """What evaluation found, kept on disk after each row."""

    def __init__(self, path):
        self.path, self.rows = path, []
        self.begun, self.cpu = time.perf_counter(), time.process_time()

    def minutes(self):
        return (time.perf_counter() - self.begun) / 60

    def add(self, generation, steps, result):
        total, arrived, taken = result
        self.rows.append({"minutes": self.minutes(), "cpu_s": time.process_time() - self.cpu, "generation": generation,
                          "learning_steps": steps, "success": arrived.mean(), "reward": total.mean(), "controls": taken.mean()})
        print("{minutes:6.2f} min, {cpu_s:6.0f} s of processor, generation {generation:3d}: success {success:.2f} on other starts, "
              "reward {reward:6.2f}".format(**self.rows[-1]), flush=True)
        with self.path.open("w", newline="") as file:
            table = csv.DictWriter(file, self.rows[0])
            table.writeheader()
            table.writerows([{k: f"{v:.6g}" for k, v in row.items()} for row in self.rows])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--target", default="left-carotid")
    parser.add_argument("--minutes", type=float, default=8.0)
    parser.add_argument("--generations", type=int, help="ends after so many, whatever the clock says")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--policies", type=int, default=32)
    parser.add_argument("--starts", type=int, default=1, help="that each policy is tried from in a generation")
    parser.add_argument("--steps", type=int, default=240, help="controls in an episode")
    parser.add_argument("-o", dest="out", type=Path, default=Path("out/train"))
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    curve = Curve(options.out / "curve.csv")
    rng = np.random.default_rng(options.seed)
    env = make(options.policies * options.starts, options.target, START_SEED["learning"], options.steps)
    other = make(EVALUATED, options.target, START_SEED["evaluation"], options.steps)
    mean = np.zeros((2, env.single_observation_space.shape[0] + 1))
    spread, steps = np.ones_like(mean), 0
    for generation in range(1_000_000):
        curve.add(generation, steps, play(other, np.repeat(mean[None], EVALUATED, axis=0), 10_000))
        np.savez(options.out / "policy.npz", mean=mean, spread=spread)
        if curve.minutes() > options.minutes or generation == options.generations:
            break
        draws = mean + spread * rng.standard_normal((options.policies, *mean.shape))
        seeds = [int(s) for s in rng.integers(1 << 30, size=options.starts)]
        total, arrived, taken = play(env, np.repeat(draws, options.starts, axis=0), seeds * options.policies)
        score = total.reshape(options.policies, options.starts).mean(axis=1)
        best = draws[np.argsort(-score)[: options.policies // 4]]
        mean = 0.3 * mean + 0.7 * best.mean(axis=0)
        spread = np.hypot(0.3 * spread + 0.7 * best.std(axis=0), NOISE * FADE**generation)
        steps += int(taken.sum())
        print(f"    generation {generation:3d}: best {score.max():6.2f}, mean {score.mean():6.2f}, arrived {arrived.mean():.2f}", flush=True)


if __name__ == "__main__":
    main()
