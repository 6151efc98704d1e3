"""Beck's column: a cantilever under a force that follows its tip, by World.on_step; flutter load against 20.05 EI/L^2.

    python3 becks_column.py

The force has no potential: the straight column never buckles, but above the flutter load its swinging grows. The square of the rate of growth
is a line over the load, and 0 at the flutter load [Beck 1952]. Newmark's trapezoid neither damps nor excites.
"""

import numpy as np

import seldinger

LENGTH, BEND, RADIUS, DENSITY = 1.0, 1.0, 5e-3, 7800.0  # m, N m^2, m, kg/m^3
UNIT = LENGTH**2 * np.sqrt(DENSITY * np.pi * RADIUS**2 / BEND)  # of time [s]: the first mode swings with 3.5 radians in it
SCENE = {
    "scene": {"name": "column", "gravity": [0.0, 0.0, 0.0], "duration_s": 1.0, "dt_s": 0.01 * UNIT},
    "integrator": {"beta": 0.25, "gamma": 0.5, "tolerance": 1e-10},
    "wire": {"length_m": LENGTH, "radius_m": RADIUS, "density": DENSITY, "bend_nm2": BEND, "twist_nm2": BEND, "stretch_n": 1e6, "nodes": 41,
             "velocity_m_s": [0.0, 0.0, 1e-6 * LENGTH / UNIT]},
    "hold": [{"at": "base", "position": True, "direction": True, "spin": True}],
}


class Follower(seldinger.Force):
    def __init__(self, load):
        super().__init__(at=0.0)
        self.load = load

    def forces(self, p):
        p.force = -self.load * p.axis

    def tangents(self, p):  # the axis turns by phi x axis
        x, y, z = p.axis[0]
        p.tangent[0, :3, 3:] = self.load * np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])


def growth(share, time=4.0):
    """Rate of growth under share EI/L^2 [1/UNIT], from the tip's swing: y' = a y + b y'' of three times in a row, with -b = exp(2 rate dt)."""
    with seldinger.World(SCENE) as world:
        world.on_step(Follower(share * BEND / LENGTH**2))
        swing = []
        for _ in range(round(time * UNIT / world.dt)):
            assert not world.step().failed
            swing.append(world.output.tip[2])
        step = world.dt / UNIT
    late = np.array(swing[len(swing) // 2:])
    (_, b), *_ = np.linalg.lstsq(np.stack([late[1:-1], late[:-2]], 1), late[2:], rcond=None)
    return np.log(-b) / (2 * step)


def flutter_load(shares=(20.8, 21.2, 21.6)):
    """Where the square of the rate of growth is 0, by a line through it at these loads [EI/L^2]."""
    slope, at_zero = np.polyfit(shares, [growth(share) ** 2 for share in shares], 1)
    return -at_zero / slope


if __name__ == "__main__":
    load = flutter_load()
    print(f"flutter load {load:.3f} EI/L^2, Beck's 20.05: {100 * abs(load / 20.05 - 1):.2f} % apart")
