#!/usr/bin/env python3
"""Environment steps a second of seldinger/Navigate-v1, what Python adds to the engine, and memory over many steps.

bench/gym_speed.py [--envs 1,16,64,256,1024] [--seconds 10] [--image] [--memory-steps 100000] [--csv FILE]

A step is a control of 1/60 s, four converged steps of the engine. `engine` is the share of the time that the engine's own step()
takes; `overhead` what the environment adds to that: observations, rewards, resets.
"""

import time

import numpy as np
import seldinger.gym

import runner


class Timed:
    """Calls a function and keeps the time."""

    def __init__(self, function):
        self.function, self.seconds = function, 0.0

    def __call__(self, *arguments):
        begun = time.perf_counter()
        self.function(*arguments)
        self.seconds += time.perf_counter() - begun


def drive(env, seconds, rng):
    """Random walks forward, so that wires are in the arch and touch. @return steps, wall and engine seconds, mean nodes and contacts"""
    fleet, shape = env._fleet.fleets[0], env.action_space.shape
    env.reset(seed=0)
    engine = fleet._drive = Timed(type(fleet)._drive.__get__(fleet))
    begun, steps, contacts = time.perf_counter(), 0, []
    while time.perf_counter() - begun < seconds:
        batch = max(1, min(10, 64 // env.num_envs))
        for action in (rng.uniform(-1, 1, (batch, *shape)) * [0.6, 1.0] + [0.4, 0.0]).astype(np.float32):
            env.step(action)
        steps += batch
        contacts.append(float(fleet.seen[:, -4].mean()) * 10)
    wall = time.perf_counter() - begun
    nodes = [len(w.nodes) for w in env.world.output.instruments]
    return steps, wall, engine.seconds, float(np.mean(nodes)), float(np.mean(contacts))


def main():
    parser = runner.parser(__doc__, "", app=False)
    parser.add_argument("--envs", default="1,16,64,256,1024")
    parser.add_argument("--seconds", type=float, default=10.0)
    parser.add_argument("--image", action="store_true", help="each sees 64 x 64 of its X-ray")
    parser.add_argument("--memory-steps", type=int, default=0, help="controls of 16 environments, memory printed ten times")
    parser.add_argument("--memory-rate", type=float, default=60.0, help="controls a second of those")
    options = parser.parse_args()
    rows = []
    print("envs  env steps/s  real-time factor each  nodes  contacts  engine ms  overhead %")
    for count in map(int, filter(None, options.envs.split(","))):
        env = seldinger.gym.NavigateVectorEnv(count, starts=4, image="fluoroscopy" if options.image else None)
        drive(env, 0.2 * options.seconds, np.random.default_rng(1))  # warm
        steps, wall, engine, nodes, contacts = drive(env, options.seconds, np.random.default_rng(0))
        env.close()
        rate = count * steps / wall
        rows.append({"envs": count, "env_steps_per_s": rate, "real_time_each": rate / count / 60, "nodes": nodes,
                     "contacts": contacts, "engine_ms": 1e3 * engine / steps, "overhead_percent": 100 * (wall / engine - 1)})
        print("{envs:4d}  {env_steps_per_s:11.0f}  {real_time_each:21.2f}  {nodes:5.0f}  {contacts:8.1f}  {engine_ms:9.2f}  "
              "{overhead_percent:10.1f}".format(**rows[-1]), flush=True)
    if options.memory_steps:
        env = seldinger.gym.NavigateVectorEnv(16, starts=4, max_steps=100, rate=options.memory_rate)
        env.reset(seed=0)
        rng = np.random.default_rng(0)
        per = max(1, options.memory_steps // 16 // 10)
        for k in range(11):
            print(f"after {16 * per * k:7d} environment steps: {runner.memory_mb():.1f} MB", flush=True)
            for _ in range(per if k < 10 else 0):
                env.step(rng.uniform(-1, 1, (16, 2)).astype(np.float32))
        env.close()
    runner.write_rows(options.csv, rows)


if __name__ == "__main__":
    main()
