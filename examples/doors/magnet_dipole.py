"""A magnetic tip beside another magnet, a dipole, by World.on_step; deflection against a beam's formula.

    python3 magnet_dipole.py

The field of a dipole n at the distance r e is  B = mu_0/4 pi (3 (n.e) e - n)/r^3;  a magnet m there feels the moment m x B and the force
mu_0/4 pi 3/r^4 ((m.e) n + (n.e) m + (m.n) e - 5 (m.e)(n.e) e). The dipole is in the plane of the wire, beside its tip and parallel to
it: both repel. A cantilever under F and M at its tip goes to  w = F L^3/3EI + M L^2/2EI,  turned by  F L^2/2EI + M L/EI.
"""

import numpy as np

import seldinger

LENGTH, BEND, NODES = 0.1, 5e-5, 201              # m, N m^2
STRENGTH, SOURCE, AWAY = 1e-3, 4.0, 0.06          # A m^2, A m^2, m
SCENE = {
    "scene": {"name": "dipole", "gravity": [0.0, 0.0, 0.0], "dt_s": 1.0},
    "integrator": {"scheme": "static", "tolerance": 1e-10},
    "wire": {"length_m": LENGTH, "radius_m": 2e-4, "density": 6500.0, "bend_nm2": BEND, "twist_nm2": BEND, "stretch_n": 1e5, "nodes": NODES},
    "hold": [{"at": "base", "position": True, "direction": True, "spin": True}],
}


def on_dipole(position, m, source, n):
    """Force and moment on dipoles m [points, 3] at the positions, of a dipole n at `source`."""
    away = position - source
    r = np.linalg.norm(away, axis=1, keepdims=True)
    e = away / r
    me, ne, mn = ((a * b).sum(1, keepdims=True) for a, b in ((m, e), (n, e), (m, n)))
    return 3e-7 / r**4 * (me * n + ne * m + mn * e - 5 * me * ne * e), 1e-7 / r**3 * np.cross(m, 3 * ne * e - n)


class Magnet(seldinger.Force):
    def __init__(self, at, strength, source, dipole):
        super().__init__(at)
        self.strength, self.source, self.dipole = strength, np.array(source), np.array([dipole])

    def forces(self, p):
        p.force, p.moment = on_dipole(p.position, self.strength * p.axis, self.source, self.dipole)


def deflection():
    """Of the tip, as computed and by formula [m]."""
    source, dipole, at = [LENGTH, 0.0, AWAY], [SOURCE, 0.0, 0.0], 0.5 * LENGTH / (NODES - 1)  # the middle of the last edge
    with seldinger.World(SCENE) as world:
        world.on_step(Magnet(at, STRENGTH, source, dipole))
        assert not world.settle().failed
        computed = world.output.tip[2]
    w = theta = 0.0
    length = LENGTH - at
    for _ in range(100):
        force, moment = on_dipole(np.array([[length, 0.0, w]]), STRENGTH * np.array([[np.cos(theta), 0.0, np.sin(theta)]]), np.array(source),
                                  np.array([dipole]))
        f, turning = force[0, 2], -moment[0, 1]  # towards +z
        w, theta = (f * length**3 / 3 + turning * length**2 / 2) / BEND, (f * length**2 / 2 + turning * length) / BEND
    return computed, w + at * theta


if __name__ == "__main__":
    computed, formula = deflection()
    print(f"tip {1e3 * computed:.4f} mm, by formula {1e3 * formula:.4f} mm, {100 * abs(computed / formula - 1):.3f} % apart")
