"""Drag of blood that flows across a wire, by World.on_step; deflection against closed form.

    python3 blood_drag.py

The wire reaches from the wall of a vessel of radius R = L to its axis. The flow has the profile v(s) = V (2 s/L - (s/L)^2), s from the wall. A
cylinder across a slow flow feels, per length, 4 pi eta/(ln(L/r) + 0.193) times the speed between both [Batchelor 1970]; along its axis half
of that. For small deflections the tip goes to  c V L^4/(9 EI).
"""

import numpy as np

import seldinger

LENGTH, RADIUS, BEND = 0.01, 1e-4, 1e-8      # m, m, N m^2
VISCOSITY, SPEED = 3.5e-3, 0.2               # of blood [Pa s], V [m/s]
ACROSS = 4 * np.pi * VISCOSITY / (np.log(LENGTH / RADIUS) + 0.193)  # N s/m per m
SCENE = {
    "scene": {"name": "drag", "gravity": [0.0, 0.0, 0.0], "dt_s": 1.0},
    "integrator": {"scheme": "static", "tolerance": 1e-12},
    "wire": {"length_m": LENGTH, "radius_m": RADIUS, "density": 6500.0, "bend_nm2": BEND, "twist_nm2": BEND, "stretch_n": 1e3, "nodes": 81},
    "hold": [{"at": "base", "position": True, "direction": True, "spin": True}],
}


def flow(position):
    """Velocity of the blood [points, 3]; the wire lies along +x, with its base at the wall."""
    s = np.clip(position[:, 0] / LENGTH, 0.0, 2.0)
    return SPEED * (2 * s - s**2)[:, None] * np.array([0.0, 0.0, 1.0])


class Drag(seldinger.Force):
    def __init__(self):
        super().__init__(at="nodes", together=True)  # of several wires all at once

    def forces(self, p):
        past = flow(p.position) - p.velocity
        along = (past * p.axis).sum(1)[:, None] * p.axis
        p.force = ACROSS * p.length[:, None] * (past - 0.5 * along)

    def tangents(self, p):
        p.damping[:, :3, :3] = -ACROSS * p.length[:, None, None] * (np.eye(3) - 0.5 * p.axis[:, :, None] * p.axis[:, None, :])


def deflection():
    """Of the tip, as computed and by formula [m]."""
    with seldinger.World(SCENE) as world:
        world.on_step(Drag())
        assert not world.settle().failed
        return world.output.tip[2], ACROSS * SPEED * LENGTH**4 / (9 * BEND)


if __name__ == "__main__":
    computed, formula = deflection()
    print(f"tip {1e3 * computed:.4f} mm, by formula {1e3 * formula:.4f} mm, {100 * abs(computed / formula - 1):.2f} % apart")
