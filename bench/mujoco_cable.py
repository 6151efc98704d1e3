#!/usr/bin/env python3
"""seldinger/Navigate-v1's wire beside a MuJoCo cable of like length in the same arch: controls of 1/60 s a second, in one run.

bench/mujoco_cable.py [--envs 1,16] [--seconds 10] [--threads 2] [--csv FILE]        pip install 'mujoco<4'

MuJoCo's side: the plugin mujoco.elasticity.cable with the wire's radius, density, EI and GJ, 40 capsules of 6 mm on a base that slides and
turns; the arch's triangles as a rigid flex; friction 0.05; Newton's solver, implicitfast; the largest step of a list, with the least damping
of its joints, under which three trial seconds stay in the vessel (both printed); environments by threads, mujoco.rollout. Both are pushed to and
fro at 3 cm/s and turned at random, as far into the arch. What each delivers is measured at the end of every control: `wall_um`, how far a wire's surface is
through the wall at most; `unconverged`, shares of steps that ended above the solver's tolerance (ours: steps that failed).
"""

import math
import os
import sys
import tempfile
import time
from pathlib import Path

import mujoco
import mujoco.rollout
import numpy as np
import seldinger.gym

import runner

CONTROL, SPEED = 1 / 60, 0.03          # [s], [m/s]
RADIUS, DENSITY, BEND, TWIST = 4.445e-4, 3700.0, 2.9e-4, 2.2e-4  # assets/scenes/navigate.toml: [m], [kg/m^3], [N m^2]
LENGTH, SEGMENTS, BACK, TRAVEL = 0.24, 40, 0.10, 0.09            # [m]; the base begins BACK before the inlet and goes TRAVEL on
STEPS = tuple(CONTROL / n for n in (4, 8, 16, 32, 80, 160, 320, 800))  # tried, the largest first [s]
DAMPING = (1e-6, 1e-5, 1e-4, 1e-3)     # tried, the least first; 1e-3 makes a segment take 20 ms to straighten [N m s]


def write_obj(vessel, path):
    points, triangles = vessel
    path.write_text("".join(f"v {x:.9g} {y:.9g} {z:.9g}\n" for x, y, z in points) + "".join(f"f {a} {b} {c}\n" for a, b, c in triangles + 1))


def cable(folder, step, damping):
    """@return the model, its wire at rest on the axis of the descending aorta"""
    inertia = math.pi * RADIUS**4 / 4
    return mujoco.MjModel.from_xml_string(f"""
<mujoco>
  <extension><plugin plugin="mujoco.elasticity.cable"/></extension>
  <compiler meshdir="{folder}"/>
  <option timestep="{step}" integrator="implicitfast" solver="Newton" tolerance="1e-8" iterations="100"/>
  <size memory="200M"/>
  <worldbody>
    <flexcomp name="wall" type="mesh" file="arch.obj" dim="2" rigid="true" radius="1e-5">
      <contact selfcollide="none" friction="0.05 0 0" condim="3" solref="{2 * step} 1"/>
    </flexcomp>
    <body name="base" pos="{-BACK} 0 0">
      <joint name="feed" type="slide" axis="1 0 0" armature="1"/>
      <joint name="roll" type="hinge" axis="1 0 0" armature="1e-3"/>
      <geom type="sphere" size="1e-3" mass="1e-3" contype="0" conaffinity="0"/>
      <composite type="cable" curve="s" count="{SEGMENTS + 1} 1 1" size="{LENGTH}" initial="none">
        <plugin plugin="mujoco.elasticity.cable"><config key="bend" value="{BEND / inertia}"/><config key="twist" value="{TWIST / (2 * inertia)}"/></plugin>
        <joint kind="main" damping="{damping}" armature="0"/>
        <geom type="capsule" size="{RADIUS}" density="{DENSITY}" friction="0.05 0 0" condim="3" contype="1" conaffinity="0"/>
      </composite>
    </body>
  </worldbody>
  <actuator>
    <position joint="feed" kp="1000" dampratio="1"/>
    <position joint="roll" kp="1" dampratio="1"/>
  </actuator>
</mujoco>""")


def hubs(count, controls, rng):
    """Advance and turn of each environment after each control: to and fro, turned at random [count, controls, 2]."""
    path = (np.arange(1, controls + 1) * CONTROL * SPEED) % (2 * TRAVEL)
    advance = np.broadcast_to(np.where(path < TRAVEL, path, 2 * TRAVEL - path), (count, controls))
    return np.stack([advance, np.cumsum(rng.uniform(-1, 1, (count, controls)) * 0.1, axis=1)], axis=2)


def at_rest(model):
    data = mujoco.MjData(model)
    state = np.zeros(mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_FULLPHYSICS))
    mujoco.mj_getState(model, data, state, mujoco.mjtState.mjSTATE_FULLPHYSICS)
    return state


def watch(model, controls, to):
    """Drives one cable and looks at it. @return deepest place in the wall [m], share of unconverged steps, mean contacts, whether it held"""
    data, per = mujoco.MjData(model), round(CONTROL / model.opt.timestep)
    deepest, unconverged, contacts = 0.0, 0, []
    for k in range(controls):
        data.ctrl[:] = to[k]
        for _ in range(per):
            mujoco.mj_step(model, data)
            unconverged += int(data.solver_niter[0] >= model.opt.iterations)
        contacts.append(data.ncon)
        if data.ncon:
            deepest = max(deepest, -float(data.contact.dist.min()))
        if data.warning[mujoco.mjtWarning.mjWARN_BADQACC].number or not np.isfinite(data.qpos).all() or np.abs(data.xpos).max() > 0.4:
            return deepest, unconverged / (per * (k + 1)), float(np.mean(contacts)), False
    return deepest, unconverged / (per * controls), float(np.mean(contacts)), deepest < 1e-3


def stable(folder):
    for step in STEPS:
        for damping in DAMPING:
            model = cable(folder, step, damping)
            seen = watch(model, 180, hubs(1, 180, np.random.default_rng(1))[0])
            print(f"  cable, {1e6 * step:.0f} us, damping {damping:.0e} N m s: wall {1e6 * seen[0]:.0f} um, "
                  f"{seen[2]:.1f} contacts, {'holds' if seen[3] else 'does not hold'}", flush=True)
            if seen[3]:
                return model, damping, seen
    raise SystemExit("no step of the list holds")


def time_cables(model, count, seconds, threads):
    per, states = round(CONTROL / model.opt.timestep), np.repeat(at_rest(model)[None], count, axis=0)
    datas = [mujoco.MjData(model) for _ in range(min(threads, count))]
    done, begun, rng, controls = 0, time.perf_counter(), np.random.default_rng(0), 60
    to = hubs(count, 20_000, rng)
    while time.perf_counter() - begun < seconds:
        control = np.repeat(to[:, done:done + controls], per, axis=1)
        out, _ = mujoco.rollout.rollout(model, datas, initial_state=states, control=control, chunk_size=1)
        states, done = np.ascontiguousarray(out[:, -1]), done + controls
    return count * done / (time.perf_counter() - begun)


def time_ours(count, seconds):
    env = seldinger.gym.NavigateVectorEnv(count, starts=4, start_advance=(0.13, 0.14), autoreset_mode="Disabled")
    env.reset(seed=0)
    to = hubs(count, 20_000, np.random.default_rng(0))
    moves = np.diff(to, axis=1, prepend=0) / (CONTROL * np.array([env.task.advance_rate, env.task.turn_rate]))
    done, deepest, failed, contacts, begun, looking = 0, 0.0, 0, [], time.perf_counter(), 0.0
    while time.perf_counter() - begun - looking < seconds:
        info = env.step(moves[:, done])[4]
        done += 1
        failed += int(info["failed"].sum())
        if done % 10 == 0:
            paused = time.perf_counter()
            rows = env.world.output.contacts
            contacts.append(len(rows) / count)
            deepest = max(deepest, -float(rows["gap"].min()) if len(rows) else 0.0)
            looking += time.perf_counter() - paused
    rate = count * done / (time.perf_counter() - begun - looking)
    env.close()
    return rate, deepest, failed / (count * done), float(np.mean(contacts))


def main():
    parser = runner.parser(__doc__, "", app=False)
    parser.add_argument("--envs", default="1,16")
    parser.add_argument("--seconds", type=float, default=10.0)
    parser.add_argument("--threads", type=int, default=os.cpu_count())
    options = parser.parse_args()
    if int(mujoco.__version__.split(".")[0]) > 3:
        sys.exit(f"mujoco_cable.py: MuJoCo {mujoco.__version__} has no composite cables in its XML: pip install 'mujoco<4'")
    with tempfile.TemporaryDirectory() as folder:
        with seldinger.World("navigate") as world:
            write_obj(world.vessel, Path(folder) / "arch.obj")
        model, _, (deepest, unconverged, contacts, _) = stable(folder)
    rows = []
    for count in map(int, options.envs.split(",")):
        ours, our_deepest, failed, our_contacts = time_ours(count, options.seconds)
        theirs = time_cables(model, count, options.seconds, options.threads)
        rows.append({"who": "seldinger", "envs": count, "step_us": 4167, "controls_per_s": ours, "wall_um": 1e6 * our_deepest,
                     "unconverged": failed, "contacts": our_contacts})
        rows.append({"who": "mujoco " + mujoco.__version__, "envs": count, "step_us": 1e6 * model.opt.timestep, "controls_per_s": theirs,
                     "wall_um": 1e6 * deepest, "unconverged": unconverged, "contacts": contacts})
        for row in rows[-2:]:
            print("{who:15s} {envs:4d} environments, steps of {step_us:.0f} us: {controls_per_s:8.1f} controls/s, wall {wall_um:.1f} um, "
                  "unconverged {unconverged:.4f}, {contacts:.1f} contacts".format(**row), flush=True)
    runner.write_rows(options.csv, rows)


if __name__ == "__main__":
    main()
