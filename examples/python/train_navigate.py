#!/usr/bin/env python3
"""Learns to steer a wire into a branch of the aortic arch, by the cross-entropy method with NumPy alone.

train_navigate.py [--target left-subclavian] [--minutes 60] [--seed 0] [-o DIR]

A policy is linear in what it sees, with a tanh; a generation is a set of policies drawn from a normal distribution, each tried from the
same few random starts, all at once in one world; the best quarter is the next distribution. Success is measured on other starts than
those learnt from, with the distribution's mean. Writes curve.csv, policy.npz and, where matplotlib is installed, curve.png.
"""

import argparse
import csv
import time
from pathlib import Path

import numpy as np
from gymnasium.vector import AutoresetMode

import seldinger.gym

SEEN = ("tip", "ahead", "hand")


def make(count, target, start_seed, steps):
    return seldinger.gym.NavigateVectorEnv(count, autoreset_mode=AutoresetMode.DISABLED, flat=True, observation=SEEN, target=target,
                                           starts=16, start_seed=start_seed, max_steps=steps)


def play(env, policies, seed):
    """One episode of each environment under its own policy. @return summed rewards, arrived, controls taken"""
    n = env.num_envs
    seen, _ = env.reset(seed=seed)
    running, total, arrived, taken = np.ones(n, bool), np.zeros(n), np.zeros(n, bool), np.zeros(n, int)
    while running.any():
        inputs = np.concatenate([seen, np.ones((n, 1))], axis=1)
        actions = np.tanh(np.einsum("nai,ni->na", policies, inputs))
        actions[~running] = 0.0  # those that have ended wait where they are
        seen, reward, terminated, truncated, info = env.step(actions)
        total += np.where(running, reward, 0.0)
        arrived |= running & info["success"]
        taken += running
        running &= ~(terminated | truncated)
    return total, arrived, taken


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--target", default="left-subclavian")
    parser.add_argument("--minutes", type=float, default=60.0)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--policies", type=int, default=24)
    parser.add_argument("--starts", type=int, default=2, help="that each policy is tried from in a generation")
    parser.add_argument("--steps", type=int, default=240, help="controls in an episode")
    parser.add_argument("--evaluate-every", type=int, default=5)
    parser.add_argument("-o", dest="out", type=Path, default=Path("out/train"))
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    begun = time.perf_counter()
    rng = np.random.default_rng(options.seed)
    count = options.policies * options.starts
    env = make(count, options.target, 0, options.steps)
    other = make(16, options.target, 1, options.steps)
    inputs = env.single_observation_space.shape[0] + 1
    mean, spread = np.zeros((2, inputs)), np.full((2, inputs), 0.5)
    mean[0, -1] = 0.5  # forward
    rows = []
    for generation in range(1_000_000):
        minutes = (time.perf_counter() - begun) / 60
        last = minutes > options.minutes
        if generation % options.evaluate_every == 0 or last:
            total, arrived, taken = play(other, np.repeat(mean[None], 16, axis=0), 10_000)
            rows.append({"minutes": minutes, "generation": generation, "success": arrived.mean(), "reward": total.mean(),
                         "controls": taken.mean()})
            print(f"{minutes:6.1f} min  generation {generation:4d}: success {arrived.mean():.2f} on other starts, reward "
                  f"{total.mean():6.2f}", flush=True)
            with (options.out / "curve.csv").open("w", newline="") as file:
                table = csv.DictWriter(file, rows[0])
                table.writeheader()
                table.writerows(rows)
            np.savez(options.out / "policy.npz", mean=mean, spread=spread, seen=SEEN)
        if last:
            break
        draws = mean + spread * rng.standard_normal((options.policies, *mean.shape))
        seeds = [int(s) for s in rng.integers(1 << 30, size=options.starts)]
        order = np.repeat(draws, options.starts, axis=0)
        total, arrived, _ = play(env, order, seeds * options.policies)
        score = total.reshape(options.policies, options.starts).mean(axis=1)
        best = draws[np.argsort(-score)[: options.policies // 4]]
        mean = 0.3 * mean + 0.7 * best.mean(axis=0)
        spread = np.maximum(0.3 * spread + 0.7 * best.std(axis=0), 0.03)
        print(f"         generation {generation:4d}: best {score.max():6.2f}, mean {score.mean():6.2f}, arrived {arrived.mean():.2f}",
              flush=True)
    try:
        import matplotlib
        matplotlib.use("Agg")
        from matplotlib import pyplot
        pyplot.plot([r["minutes"] for r in rows], [100 * r["success"] for r in rows], marker=".")
        pyplot.xlabel("minutes")
        pyplot.ylabel("success on other starts [%]")
        pyplot.ylim(0, 100)
        pyplot.title(options.target)
        pyplot.savefig(options.out / "curve.png", dpi=120)
    except ImportError:
        print("no curve.png: python3-matplotlib is not installed")


if __name__ == "__main__":
    main()
