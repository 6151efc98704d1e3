"""A spring from the tip of a cantilever to a point, by World.on_step; tip against closed form.

    python3 spring_to_a_point.py

For small deflections the wire is a spring of 3 EI/L^3 at its tip. With a spring k to a point `a` away, the tip goes to a k/(k + 3 EI/L^3).
"""

import numpy as np

import seldinger

LENGTH, BEND = 0.2, 1e-3  # m, N m^2
SCENE = {
    "scene": {"name": "cantilever", "gravity": [0.0, 0.0, 0.0], "dt_s": 1.0},
    "integrator": {"scheme": "static", "tolerance": 1e-9},
    "wire": {"length_m": LENGTH, "radius_m": 5e-4, "density": 6500.0, "bend_nm2": BEND, "twist_nm2": BEND, "stretch_n": 1e5, "nodes": 81},
    "hold": [{"at": "base", "position": True, "direction": True, "spin": True}],
}


class Spring(seldinger.Force):
    def __init__(self, anchor, stiffness):
        super().__init__(at=0.0)  # the tip
        self.anchor, self.stiffness = np.array(anchor), stiffness

    def forces(self, p):
        p.force = self.stiffness * (self.anchor - p.position)

    def tangents(self, p):  # d(force)/d(position); without it the engine takes differences
        p.tangent[:, :3, :3] = -self.stiffness * np.eye(3)

    def energy(self, p):
        return 0.5 * self.stiffness * ((self.anchor - p.position) ** 2).sum()


def deflection(stiffness=0.3, away=2e-3):
    """Deflection of the tip as computed, and by the formula [m]."""
    with seldinger.World(SCENE) as world:
        world.on_step(Spring([LENGTH, 0.0, away], stiffness))
        assert not world.settle().failed
        return world.output.tip[2], away * stiffness / (stiffness + 3 * BEND / LENGTH**3)


if __name__ == "__main__":
    computed, exact = deflection()
    print(f"tip {1e3 * computed:.5f} mm, by formula {1e3 * exact:.5f} mm, {100 * abs(computed / exact - 1):.3f} % apart")
