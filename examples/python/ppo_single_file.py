#!/usr/bin/env python3
"""PPO in a single file of PyTorch, in the style of CleanRL: everything that happens between a wire and its policy is on this page.

ppo_single_file.py [--target left-subclavian] [--envs 64] [--steps 200000] [-o out/ppo-single]

The vector form steps all environments as systems of one world. SAME_STEP returns the first observation of the next episode with the last
reward of the one before; what the value of a truncated episode is estimated from comes as info["final_obs"]. Writes curve.csv and policy.pt.
Proximal policy optimization: Schulman et al. 2017, arXiv:1707.06347; advantages: Schulman et al. 2016, arXiv:1506.02438. Needs: pip install torch
"""

import argparse
import csv
import time
from pathlib import Path

import numpy as np
import torch
from gymnasium.vector import AutoresetMode
from torch import nn

import seldinger.gym

GAMMA, LAMBDA, CLIP, VALUE_SHARE, EPOCHS, BATCHES, RATE = 0.99, 0.95, 0.2, 0.5, 4, 4, 1e-3


class Agent(nn.Module):
    def __init__(self, inputs, outputs):
        super().__init__()
        def layers(last):
            return nn.Sequential(nn.Linear(inputs, 64), nn.Tanh(), nn.Linear(64, 64), nn.Tanh(), nn.Linear(64, last))

        self.mean, self.value = layers(outputs), layers(1)
        self.log_spread = nn.Parameter(torch.full((outputs,), -0.5))
        with torch.no_grad():
            self.mean[-1].weight.mul_(0.01)

    def actions(self, seen):
        return torch.distributions.Normal(self.mean(seen), self.log_spread.exp())


def rollout(env, agent, seen, controls):
    """What all environments do in so many controls. @return tensors [controls, environments, ...], the next observations, ended episodes"""
    kept, episodes = {name: [] for name in ("seen", "action", "chance", "reward", "done", "value")}, []
    for _ in range(controls):
        with torch.no_grad():
            choice = agent.actions(seen)
            action, value = choice.sample(), agent.value(seen)[:, 0]
        after, reward, terminated, truncated, info = env.step(action.numpy())
        done = terminated | truncated
        if done.any():
            last = np.stack([one for one in info["final_obs"] if one is not None])
            with torch.no_grad():  # an episode that was cut off would have gone on
                reward[done] += GAMMA * truncated[done] * agent.value(torch.as_tensor(last))[:, 0].numpy()
            episodes += info["final_info"]["success"][done].tolist()
        for name, entry in zip(kept, (seen, action, choice.log_prob(action).sum(-1), torch.as_tensor(reward, dtype=torch.float32),
                                      torch.as_tensor(done, dtype=torch.float32), value)):
            kept[name].append(entry)
        seen = torch.as_tensor(after)
    return {name: torch.stack(entries) for name, entries in kept.items()}, seen, episodes


def advantages(kept, last_value):
    """Generalised advantage estimates."""
    found, ahead, value = torch.zeros_like(kept["reward"]), 0.0, last_value
    for t in reversed(range(len(found))):
        goes_on = 1.0 - kept["done"][t]
        ahead = kept["reward"][t] + GAMMA * goes_on * value - kept["value"][t] + GAMMA * LAMBDA * goes_on * ahead
        found[t], value = ahead, kept["value"][t]
    return found


def update(agent, optimizer, kept, gain):
    flat = {name: entries.flatten(0, 1) for name, entries in kept.items()}
    gain = gain.flatten()
    target = gain + flat["value"]
    for _ in range(EPOCHS):
        for batch in torch.randperm(len(gain)).chunk(BATCHES):
            choice, value = agent.actions(flat["seen"][batch]), agent.value(flat["seen"][batch])[:, 0]
            ratio = (choice.log_prob(flat["action"][batch]).sum(-1) - flat["chance"][batch]).exp()
            own = (gain[batch] - gain[batch].mean()) / (gain[batch].std() + 1e-8)
            policy_loss = -torch.min(own * ratio, own * ratio.clamp(1 - CLIP, 1 + CLIP)).mean()
            loss = policy_loss + VALUE_SHARE * ((value - target[batch]) ** 2).mean()
            optimizer.zero_grad()
            loss.backward()
            nn.utils.clip_grad_norm_(agent.parameters(), 0.5)
            optimizer.step()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--target", default="left-subclavian")
    parser.add_argument("--envs", type=int, default=64)
    parser.add_argument("--steps", type=int, default=200_000)
    parser.add_argument("--rollout", type=int, default=64, help="controls of each environment between two updates")
    parser.add_argument("--episode", type=int, default=240, help="controls in an episode")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("-o", dest="out", type=Path, default=Path("out/ppo-single"))
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    torch.manual_seed(options.seed)
    env = seldinger.gym.NavigateVectorEnv(options.envs, autoreset_mode=AutoresetMode.SAME_STEP, target=options.target, flat=True,
                                          observation=("tip", "ahead", "hub"), starts=16, max_steps=options.episode)
    agent = Agent(env.single_observation_space.shape[0], env.single_action_space.shape[0])
    optimizer = torch.optim.Adam(agent.parameters(), RATE, eps=1e-5)
    seen, steps, rows, begun = torch.as_tensor(env.reset(seed=options.seed)[0]), 0, [], time.process_time()
    while steps < options.steps:
        kept, seen, episodes = rollout(env, agent, seen, options.rollout)
        with torch.no_grad():
            gain = advantages(kept, agent.value(seen)[:, 0])
        update(agent, optimizer, kept, gain)
        steps += options.envs * options.rollout
        rows.append({"steps": steps, "cpu_s": time.process_time() - begun, "episodes": len(episodes),
                     "success": float(np.mean(episodes)) if episodes else float("nan"), "reward": float(kept["reward"].mean())})
        print("{steps:8d} steps, {cpu_s:6.0f} s of processor: success {success:.2f} of {episodes} episodes".format(**rows[-1]), flush=True)
    with (options.out / "curve.csv").open("w", newline="") as file:
        table = csv.DictWriter(file, rows[0])
        table.writeheader()
        table.writerows(rows)
    torch.save(agent.state_dict(), options.out / "policy.pt")


if __name__ == "__main__":
    main()
