#!/usr/bin/env python3
"""Time to reach a tip error: this engine, MuJoCo's cable and PyElastica on the same wire, each at its cheapest setting that gets there.

    python3 -m venv /tmp/rod-peers && /tmp/rod-peers/bin/pip install 'mujoco<4' pyelastica     # 4 has no cable
    /tmp/rod-peers/bin/python bench/peers/rod_peers.py [--app build/seldinger] [--cap 60] [--quick] [--csv FILE]

Wire: 0.014 inch nitinol, 0.3 m, held level at its base, under its own weight (w L^3 / B = 3.1).
  droop   where it hangs at rest. Reference: the heavy elastica, B theta'' = w (L - s) cos theta, by Runge-Kutta and shooting.
  swing   let go from straight: where the tip is after 0.25 s. Reference: this engine's trapezoid at 401 nodes and 0.05 ms, whose own error is
          estimated from 201 nodes and 0.1 ms; PyElastica's finest run stands beside it as a check by another code.
Time: of the solve or the stepping alone, one process at a time, best of two runs where it is short; no start, no import, no compilation. What is
longer than --cap seconds is broken off and counts as not reached. MuJoCo and PyElastica reach the droop by damped motion, this engine by Newton.
"""
import math
import os
import pathlib
import sys
import tempfile
import time

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
import runner  # noqa: E402

LENGTH, RADIUS, DENSITY, BEND, TWIST, STRETCH = 0.3, 0.000178, 6450.0, 5.5190957750700876e-5, 4.2e-5, 6966.0
YOUNG = BEND / (math.pi * RADIUS**4 / 4)
SHEAR = TWIST / (math.pi * RADIUS**4 / 2)
G = 9.81
SWING = 0.25


class TooLong(Exception):
    pass


def heavy_elastica(steps=4000):
    """Tip (x, z) of the cantilever at rest."""
    w, h = DENSITY * math.pi * RADIUS**2 * G, LENGTH / steps

    def shoot(slope):
        y = np.array([0.0, slope, 0.0, 0.0])  # theta (downwards), theta', x, z

        def rate(s, y):
            return np.array([y[1], -w * (LENGTH - s) * math.cos(y[0]) / BEND, math.cos(y[0]), -math.sin(y[0])])
        for k in range(steps):
            s = k * h
            k1 = rate(s, y)
            k2 = rate(s + h / 2, y + h / 2 * k1)
            k3 = rate(s + h / 2, y + h / 2 * k2)
            k4 = rate(s + h, y + h * k3)
            y = y + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        return y
    low, high = 0.0, w * LENGTH**2 / BEND
    for _ in range(60):
        middle = (low + high) / 2
        if shoot(middle)[1] < 0:
            low = middle
        else:
            high = middle
    y = shoot((low + high) / 2)
    return np.array([y[2], y[3]])


# ---- this engine ------------------------------------------------------------------------------------------------------------

def seldinger(app, case, nodes, dt, scheme="newton"):
    still = case == "droop"
    text = runner.scene({
        "scene": {"gravity": [0.0, 0.0, -G], "duration_s": SWING, "dt_s": dt, "record_every": 1000000},
        "wire": {"length_m": LENGTH, "radius_m": RADIUS, "density": DENSITY, "bend_nm2": BEND, "twist_nm2": TWIST, "stretch_n": STRETCH, "nodes": nodes,
                 "place": runner.LEVEL},
        "integrator": {"scheme": "static"} if still else {"scheme": scheme, "beta": 0.25, "gamma": 0.5},
        "hold": [runner.HELD], "output": runner.QUIET})
    run = runner.run(app, text, accept=None)
    if run.code != 0:
        return None, math.inf
    return run.nodes()[0, [0, 2]], run.summary["wall_s"]


# ---- MuJoCo's cable ---------------------------------------------------------------------------------------------------------

def mujoco_cable(case, segments, dt, cap, damping=0.0):
    import mujoco

    # each ball joint represents h of wire, half of it on either side: the first is half a segment inside, and the piece behind
    # it is held
    h = LENGTH / (segments - 0.5)
    # capsules of a chain overlap by their caps: the mass is set by hand
    mass = DENSITY * math.pi * RADIUS**2 * h
    # about its axis a wire as thin has next to no inertia, and its twist would ask for steps of microseconds: 1 % of a piece's bending inertia helps
    armature = 0.01 * mass * h**2 / 3
    bodies = "".join(f"""<body pos="{h if k else -h / 2} 0 0">{f'<joint type="ball" damping="{damping}" armature="{armature}"/>' if k else ''}
<geom type="capsule" fromto="0 0 0 {h} 0 0" size="{RADIUS}" mass="{mass}"/><plugin instance="wire"/>""" for k in range(segments))
    xml = f"""<mujoco>
<extension><plugin plugin="mujoco.elasticity.cable"><instance name="wire"><config key="twist" value="{SHEAR}"/><config key="bend" value="{YOUNG}"/>
<config key="vmax" value="0"/></instance></plugin></extension>
<option timestep="{dt}" gravity="0 0 -{G}" integrator="implicitfast"><flag contact="disable"/></option>
<worldbody>{bodies}{"</body>" * segments}</worldbody></mujoco>"""
    model = mujoco.MjModel.from_xml_string(xml)
    data = mujoco.MjData(model)
    tip_body = model.nbody - 1
    limit = SWING if case == "swing" else 20.0
    start = time.perf_counter()
    steps = round(limit / dt)
    for k in range(steps):
        mujoco.mj_step(model, data)
        if k % 64 == 0:
            if not np.isfinite(data.qpos[-1]) or abs(data.qvel).max() > 1e6:
                return None, math.inf
            if time.perf_counter() - start > cap:
                raise TooLong
            if case == "droop" and k * dt > 0.2 and abs(data.qvel).max() < 1e-4:
                break
    wall = time.perf_counter() - start
    end = data.xpos[tip_body] + data.xmat[tip_body].reshape(3, 3) @ np.array([h, 0, 0])
    return (np.array([end[0], end[2]]), wall) if np.isfinite(end).all() else (None, math.inf)


# ---- PyElastica -------------------------------------------------------------------------------------------------------------

def pyelastica(case, elements, dt, cap):
    import elastica as ea

    class Simulator(ea.BaseSystemCollection, ea.Constraints, ea.Forcing, ea.Damping):
        pass

    def build():
        simulator = Simulator()
        rod = ea.CosseratRod.straight_rod(elements, np.zeros(3), np.array([1.0, 0, 0]), np.array([0, 0, 1.0]), LENGTH, RADIUS, DENSITY,
                                          youngs_modulus=YOUNG, shear_modulus=SHEAR)
        simulator.append(rod)
        simulator.constrain(rod).using(ea.OneEndFixedBC, constrained_position_idx=(0,), constrained_director_idx=(0,))
        simulator.add_forcing_to(rod).using(ea.GravityForces, acc_gravity=np.array([0, 0, -G]))
        if case == "droop":
            simulator.dampen(rod).using(ea.AnalyticalLinearDamper, damping_constant=10.0, time_step=dt)
        simulator.finalize()
        return simulator, rod

    stepper = ea.PositionVerlet()
    simulator, rod = build()
    t = stepper.step(simulator, np.float64(0.0), np.float64(dt))  # compiles
    simulator, rod = build()
    limit = SWING if case == "swing" else 3.0
    steps, t = round(limit / dt), np.float64(0.0)
    start = time.perf_counter()
    for k in range(steps):
        t = stepper.step(simulator, t, np.float64(dt))
        if k % 256 == 0:
            if not np.isfinite(rod.position_collection[0, -1]):
                return None, math.inf
            if time.perf_counter() - start > cap:
                raise TooLong
            if case == "droop" and k * dt > 0.2 and abs(rod.velocity_collection).max() < 1e-4:
                break
    wall = time.perf_counter() - start
    tip = rod.position_collection[:, -1]
    return (np.array([tip[0], tip[2]]), wall) if np.isfinite(tip).all() else (None, math.inf)


def main():
    parser = runner.parser(__doc__, "")
    parser.add_argument("--cap", type=float, default=60, help="seconds for one run")
    parser.add_argument("--quick", action="store_true", help="few settings: does it work?")
    options = parser.parse_args()
    options.app = str(pathlib.Path(options.app).absolute())
    options.csv = options.csv and str(pathlib.Path(options.csv).absolute())
    scratch = tempfile.TemporaryDirectory()
    os.chdir(scratch.name)  # MuJoCo leaves its log where it runs
    cap = 5 if options.quick else options.cap
    rows = []

    def record(case, code, setting, reference, run):
        try:
            tip, wall = run()
            if tip is not None and wall < 0.5:
                wall = min(wall, run()[1])
        except TooLong:
            tip, wall = None, math.inf
        except Exception as error:  # a peer that is not there, or not of this version
            print(f"{code}: {type(error).__name__}: {error}", file=sys.stderr)
            return
        error = float(np.linalg.norm(tip - reference)) / LENGTH if tip is not None else math.inf
        rows.append({"case": case, "code": code, "setting": setting, "tip_error": error, "wall_s": wall})
        print(f"{case:6} {code:12} {setting:28} tip error {error:.3g} L   {wall:.4g} s", flush=True)

    droop = heavy_elastica()
    fine, _ = seldinger(options.app, "swing", 401, 5e-5)
    coarse, _ = seldinger(options.app, "swing", 201, 1e-4)
    if fine is None:
        sys.exit(f"rod_peers.py: {options.app} does not run; build it, or name it with --app")
    print(f"droop {droop}, swing {fine}; reference of the swing moved by {np.linalg.norm(fine - coarse) / LENGTH:.2g} L in the last refinement")
    for case, reference in (("droop", droop), ("swing", fine)):
        for nodes in ((21, 51) if options.quick else (6, 11, 21, 51, 101)):
            for dt in ((1e-3,) if case == "droop" else (2e-3, 1e-3) if options.quick else (5e-3, 2e-3, 1e-3, 5e-4, 2e-4)):
                record(case, "seldinger", f"{nodes} nodes" + (f", {1e3 * dt:g} ms" if case == "swing" else ""), reference,
                       lambda: seldinger(options.app, case, nodes, dt))
        for segments in ((20,) if options.quick else (10, 20, 40, 80)):
            stable = (LENGTH / segments)**2 / 2 / math.sqrt(BEND / (DENSITY * math.pi * RADIUS**2))
            for dt in (stable / 2, stable / 32) if options.quick else (stable / 2, stable / 8, stable / 32):
                damping = 2e-7 * 20 / segments if case == "droop" else 0.0
                record(case, "MuJoCo cable", f"{segments} segments, {1e6 * dt:.3g} us", reference,
                       lambda: mujoco_cable(case, segments, dt, cap, damping))
        for elements in ((10,) if options.quick else (10, 20, 40)):
            dt = 0.1 * min(LENGTH / elements, RADIUS * 2) / math.sqrt(YOUNG / DENSITY)  # shear across the radius is what limits it
            record(case, "PyElastica", f"{elements} elements, {1e6 * dt:.3g} us", reference, lambda: pyelastica(case, elements, dt, cap))
    print("\ntime to reach a tip error [s]")
    for case in ("droop", "swing"):
        for code in ("seldinger", "MuJoCo cable", "PyElastica"):
            mine = [r for r in rows if r["case"] == case and r["code"] == code]
            cells = []
            for wanted in (1e-2, 3e-3, 1e-3, 3e-4):
                best = min((r["wall_s"] for r in mine if r["tip_error"] <= wanted), default=math.inf)
                cells.append(f"{wanted:g} L: {best:.3g}" if best < math.inf else f"{wanted:g} L: not reached")
            print(f"{case:6} {code:12} " + "   ".join(cells))
    runner.write_rows(options.csv, rows)


if __name__ == "__main__":
    main()
