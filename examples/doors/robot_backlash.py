"""A robot's drive with mass, compliance and backlash, by Control.push; lost motion against its formula.

    python3 robot_backlash.py

The hub is a mass (`feed.hub_mass_kg`) that the motor pushes through a spring of stiffness K with the play `GAP`: no force as long as the motor
is within half of it. When the motor turns round, the hub stays until the play is taken up and the spring has reversed, which has borne the
hub's dry friction F and damping c: at a steady speed v the motion that is lost is  GAP + 2 (F + c v)/K.
"""

import numpy as np

import seldinger

MASS, DAMPING, FRICTION = 0.05, 0.5, 0.2  # kg, N s/m, N
STIFFNESS, GAP, SPEED = 2000.0, 1e-3, 0.01  # N/m, m, m/s
SCENE = {
    "scene": {"name": "drive", "gravity": [0.0, 0.0, 0.0], "duration_s": 10.0, "dt_s": 1e-3},
    "wire": {"length_m": 0.3, "radius_m": 4e-4, "density": 6500.0, "bend_nm2": 1e-4, "twist_nm2": 1e-4, "stretch_n": 1e4},
    "vessel": {"shape": "tube", "radius_m": 5e-3, "length_m": 0.3},
    "contact": {"mu_static": 0.0, "mu_sliding": 0.0},
    "feed": {"point": [0.0, 0.0, 0.0], "direction": [1.0, 0.0, 0.0], "hub_mass_kg": MASS, "hub_damping_n_s_m": DAMPING,
             "hub_friction_n": FRICTION, "keys": [{"t_s": 0.0, "force_n": 0.0, "advance_m": 0.05}]},
}


class Drive:
    """A motor that goes where it is told at a given speed, with play and a spring to the hub."""

    def __init__(self, world):
        self.world, self.motor, self.start = world, 0.0, world.output.inserted

    def step(self, command):
        way = SPEED * self.world.dt
        self.motor += np.clip(command - self.motor, -way, way)
        apart = self.motor - (self.world.output.inserted - self.start)
        stretch = apart - np.clip(apart, -GAP / 2, GAP / 2)
        spring = STIFFNESS if stretch else 0.0  # as the hub goes on, within the step
        return self.world.step(seldinger.Control().push(0, STIFFNESS * stretch, 0.0, spring))


def lost_motion(way=0.01):
    """How much less the hub comes back than the motor, as it is pushed in and drawn half of the way back, and by formula [m]."""
    with seldinger.World(SCENE) as world:
        drive, ahead = Drive(world), []
        for command in (way, way / 2):
            while abs(drive.motor - command) > 1e-9:
                assert not drive.step(command).failed
            ahead.append(drive.motor - (world.output.inserted - drive.start))
        return ahead[0] - ahead[1], GAP + 2 * (FRICTION + DAMPING * SPEED) / STIFFNESS


if __name__ == "__main__":
    found, formula = lost_motion()
    print(f"lost motion {1e3 * found:.3f} mm, by formula {1e3 * formula:.3f} mm")
