"""A magnetic tip in a uniform field, by World.on_step; shape against the exact elastica.

    python3 magnetic_tip.py

A magnet of moment M along the wire feels M x B and no force in a uniform field B. Behind it the wire bends to a circle: with B at the angle
`alpha` to the straight wire and the magnet's centre at the length l, the tip's angle obeys  theta = (M B l/EI) sin(alpha - theta).
"""

import numpy as np

import seldinger

LENGTH, BEND, NODES = 0.1, 5e-5, 201  # m, N m^2
CENTRE = 0.5 * LENGTH / (NODES - 1)  # of the magnet, from the tip: the middle of the last edge
SCENE = {
    "scene": {"name": "magnet", "gravity": [0.0, 0.0, 0.0], "dt_s": 1.0},
    "integrator": {"scheme": "static", "tolerance": 1e-9},
    "wire": {"length_m": LENGTH, "radius_m": 2e-4, "density": 6500.0, "bend_nm2": BEND, "twist_nm2": BEND, "stretch_n": 1e5, "nodes": NODES},
    "hold": [{"at": "base", "position": True, "direction": True, "spin": True}],
}


class Magnet(seldinger.Force):
    def __init__(self, at, moment, field):
        super().__init__(at)
        self.moment, self.field = moment, np.array(field, float)  # A m^2, T

    def forces(self, p):
        p.moment = np.cross(self.moment * p.axis, self.field)

    def tangents(self, p):  # the axis turns by phi x axis: d(axis x B)/d(phi) = axis B^T - (axis.B) 1
        across = p.axis[:, :, None] * self.field
        p.tangent[:, 3:, 3:] = self.moment * (across - (p.axis @ self.field)[:, None, None] * np.eye(3))

    def energy(self, p):
        return -self.moment * (p.axis @ self.field).sum()


def tip(torque_share=2.0, alpha=np.radians(120)):
    """Tip as computed and exact, [2, 3] m. `torque_share`: M B L/EI."""
    strength = torque_share * BEND / LENGTH
    with seldinger.World(SCENE) as world:
        world.on_step(Magnet(CENTRE, strength, [np.cos(alpha), 0.0, np.sin(alpha)]))
        assert not world.settle().failed
        computed = world.output.tip
    bent = LENGTH - CENTRE
    theta = 0.5 * alpha
    for _ in range(50):
        share = strength * bent / BEND
        theta -= (theta - share * np.sin(alpha - theta)) / (1 + share * np.cos(alpha - theta))
    radius = bent / theta
    exact = [radius * np.sin(theta) + CENTRE * np.cos(theta), 0.0, radius * (1 - np.cos(theta)) + CENTRE * np.sin(theta)]
    return np.array([computed, exact])


if __name__ == "__main__":
    computed, exact = tip()
    print(f"tip {1e3 * computed.round(6)} mm, exact {1e3 * exact.round(6)} mm, {100 * np.linalg.norm(computed - exact) / LENGTH:.4f} % of the length apart")
