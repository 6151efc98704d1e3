#!/usr/bin/env python3
"""Learns to steer a wire into a branch with PPO of stable-baselines3, over the vector form.

ppo_sb3.py [--target left-subclavian] [--envs 64] [--steps 200000] [--pixels] [-o out/ppo]

Writes MODEL.zip and success.csv: the fraction of 16 other starts from which the policy arrives. --pixels: the policy sees X-ray pictures alone,
from two sides and of the last three controls. Needs: pip install 'seldinger[sb3]'
"""

import argparse
import csv
from pathlib import Path

from stable_baselines3 import PPO
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.vec_env import VecMonitor

from seldinger.sb3 import NavigateVecEnv

LEARNING, EVALUATION = 0, 1  # seeds of the starts


def make(envs, options, start_seed):
    seen = {"flat": True, "observation": ("tip", "ahead", "hub")}
    if options.pixels:
        seen = {"image": "fluoroscopy", "observation": (), "image_c_arm": ("LAO 30", "RAO 30"), "image_stack": 3, "image_field": 0.3}
    return VecMonitor(NavigateVecEnv(envs, target=options.target, starts=16, start_seed=start_seed, max_steps=options.episode, **seen))


class Evaluation(BaseCallback):
    """After every so many steps, one episode from each of the other starts."""

    def __init__(self, env, every, path):
        super().__init__()
        self.env, self.every, self.path, self.rows = env, every, path, []

    def _on_rollout_start(self):
        if len(self.rows) * self.every <= self.num_timesteps:
            self.measure()

    def _on_step(self):
        return True

    def measure(self):
        self.env.seed(0)
        seen, arrived, running = self.env.reset(), [], set(range(self.env.num_envs))
        while running:
            actions, _ = self.model.predict(seen, deterministic=True)
            seen, _, done, infos = self.env.step(actions)
            for s in [s for s in running if done[s]]:
                arrived.append(infos[s]["is_success"])
                running.remove(s)
        self.rows.append({"steps": self.num_timesteps, "success": sum(arrived) / len(arrived)})
        print("{steps:8d} steps: success {success:.2f} from other starts".format(**self.rows[-1]), flush=True)
        with self.path.open("w", newline="") as file:
            table = csv.DictWriter(file, self.rows[0])
            table.writeheader()
            table.writerows(self.rows)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--target", default="left-subclavian")
    parser.add_argument("--envs", type=int, default=64)
    parser.add_argument("--steps", type=int, default=200_000)
    parser.add_argument("--rollout", type=int, default=64, help="controls of each environment between two updates")
    parser.add_argument("--episode", type=int, default=240, help="controls in an episode")
    parser.add_argument("--evaluated", type=int, default=16, help="episodes of an evaluation")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--pixels", action="store_true")
    parser.add_argument("-o", dest="out", type=Path, default=Path("out/ppo"))
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    env, other = make(options.envs, options, LEARNING), make(options.evaluated, options, EVALUATION)
    # four passes over a rollout in large batches: most of the time is the simulation's
    model = PPO("CnnPolicy" if options.pixels else "MlpPolicy", env, n_steps=options.rollout, batch_size=min(1024, options.envs * options.rollout),
                n_epochs=4, learning_rate=1e-3, policy_kwargs={"log_std_init": -0.5}, seed=options.seed, device="cpu" if not options.pixels else "auto")
    evaluation = Evaluation(other, 20_000, options.out / "success.csv")
    model.learn(options.steps, callback=evaluation)
    evaluation.measure()
    model.save(options.out / "model")


if __name__ == "__main__":
    main()
