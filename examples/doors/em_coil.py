"""An electromagnetic position sensor in the tip: its own rate, its own noise, and a record that is saved with the world.

    python3 em_coil.py

A sensor is a `Force` without force: it measures in `accept`, at the end of a step, and what it measures is its state. `output.sensors` has the
last sample; a run of the command or of C++ writes a row of sensor_NAME.csv for each.
"""

import numpy as np

import seldinger


class Coil(seldinger.Force):
    def __init__(self, rate=40.0, noise=5e-4, seed=0):
        super().__init__(at=0.0, state=[0.0] * 5, name="coil", record=["time_s", "x_m", "y_m", "z_m"])
        self.rate, self.noise, self.seed = rate, noise, seed  # Hz, m

    def forces(self, p):
        pass

    def tangents(self, p):
        pass

    def accept(self, p):
        sample = np.floor(p.time * self.rate + 1e-6)
        if sample > p.state[4]:
            random = np.random.default_rng([self.seed, int(sample)])  # by number: the same after restore()
            p.state[:] = [p.time, *(p.position[0] + random.normal(0.0, self.noise, 3)), sample]


def record(duration=1.0, **settings):
    """Samples [n, 4], and where the tip was then [n, 3]."""
    with seldinger.World("swing") as world:
        world.on_step(Coil(**settings))
        samples, tips = [], []
        for _ in range(round(duration / world.dt)):
            assert not world.step().failed
            now = list(world.output.sensors["coil"].values())
            if now[0] > 0 and (not samples or now != samples[-1]):
                samples.append(now)
                tips.append(world.output.tip)
    return np.array(samples), np.array(tips)


if __name__ == "__main__":
    samples, tips = record()
    error = samples[:, 1:] - tips
    print(f"{len(samples)} samples in a second, noise {1e3 * error.std():.3f} mm, mean error {1e3 * np.abs(error.mean(0)).max():.3f} mm")
