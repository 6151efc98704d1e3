"""A pull-wire in a channel beside the axis, by World.on_step: constant curvature, and less towards the tip with friction in the channel.

    python3 pull_wire.py

The wire is fixed at the tip and pulled at the base with the tension T. In the channel, `offset` from the axis, its push on the walls and the
compression of the catheter balance; what is left at each section is the moment T offset: the catheter bends to the curvature T offset/EI.
With friction mu the tension falls as exp(-mu theta), theta the angle turned from the base (capstan), and the tip turns by
ln(1 + mu T offset L/EI)/mu.
"""

import numpy as np

import seldinger

LENGTH, BEND, OFFSET, NODES = 0.1, 2e-4, 1e-3, 101  # m, N m^2, m
SCENE = {
    "scene": {"name": "pull-wire", "gravity": [0.0, 0.0, 0.0], "dt_s": 1.0},
    "integrator": {"scheme": "static", "tolerance": 1e-9},
    "wire": {"length_m": LENGTH, "radius_m": 1.5e-3, "density": 1100.0, "bend_nm2": BEND, "twist_nm2": BEND, "stretch_n": 1e5, "nodes": NODES},
    "hold": [{"at": "base", "position": True, "direction": True, "spin": True}],
}


class PullWire(seldinger.Force):
    def __init__(self, tension, offset, mu):
        super().__init__(at="edges")
        self.tension, self.offset, self.mu = tension, offset, mu  # N, m

    def forces(self, p):
        side = np.cross(p.axis, p.director)                                   # the wire runs beside the axis, along the director
        turned = np.arccos(np.clip((p.axis[1:] * p.axis[:-1]).sum(1), -1, 1))  # between edges, tip first
        angle = turned[::-1].cumsum()[::-1] - 0.5 * turned                    # from the base to each node between two edges
        moment = self.offset * self.tension * np.exp(-self.mu * angle)        # of the catheter there
        p.moment = np.diff(moment, prepend=0.0, append=moment[-1])[:, None] * side


def tip_angle(tension=3.0, mu=0.0):
    """How far the tip has turned, as computed, by formula [rad], and how much the curvature varies [-]."""
    with seldinger.World(SCENE) as world:
        world.on_step(PullWire(tension, OFFSET, mu))
        assert not world.settle().failed
        edges = np.diff(world.output.nodes, axis=0)
    ways = edges / np.linalg.norm(edges, axis=1)[:, None]
    turned = np.arccos(np.clip((ways[1:] * ways[:-1]).sum(1), -1, 1))
    bend = tension * OFFSET * LENGTH / BEND
    return turned.sum(), np.log1p(mu * bend) / mu if mu else bend, np.ptp(turned) / turned.mean()


if __name__ == "__main__":
    for friction in (0.0, 0.3):
        found, formula, spread = tip_angle(mu=friction)
        print(f"mu {friction}: tip turned by {np.degrees(found):.2f} deg, by formula {np.degrees(formula):.2f} deg; curvature varies by {100 * spread:.1f} %")
