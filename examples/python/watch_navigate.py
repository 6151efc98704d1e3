#!/usr/bin/env python3
"""One episode of a policy of train_navigate.py as a strip of six pictures. watch_navigate.py POLICY.npz|zero TARGET STRIP.png [START]

The starts are those that training is evaluated on. `zero` is what training begins with, pushed at half speed.
"""

import sys

import numpy as np
from matplotlib import pyplot

import seldinger.gym
from train_navigate import START_SEED, act

policy, target, strip = sys.argv[1:4]
env = seldinger.gym.NavigateEnv(flat=True, observation=("ahead",), target=target, starts=16, start_seed=START_SEED["evaluation"],
                                max_steps=240, render_mode="rgb_array")
if policy == "zero":
    weights = np.zeros((2, env.observation_space.shape[0] + 1))
    weights[0, -1] = 0.55
else:
    weights = np.load(policy)["mean"]
seen, info = env.reset(seed=0, options={"start": int(sys.argv[4]) if len(sys.argv) > 4 else 0})
pictures, over = [env.render()], False
while not over:
    seen, _, terminated, truncated, info = env.step(act(weights[None], seen[None])[0])
    over = terminated or truncated
    pictures.append(env.render())
chosen = [pictures[i] for i in np.linspace(0, len(pictures) - 1, 6).astype(int)]
rows = [np.concatenate([p[::2, ::2] for p in chosen[k:k + 3]], axis=1) for k in (0, 3)]
pyplot.imsave(strip, np.concatenate(rows, axis=0))
print(f"{'arrived' if info['success'] else 'did not arrive'} after {len(pictures) - 1} controls, {1e3 * info['distance']:.0f} mm from the target")
