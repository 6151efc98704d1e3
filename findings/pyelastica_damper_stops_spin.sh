#!/usr/bin/env bash
# PyElastica 1.0.0: `AnalyticalLinearDamper(damping_constant=1)` lets a wire's travel decay at 1/s and its spin at 2/r^2 a second.
#
# A straight wire of 0.1 m in free flight, moving sideways at 1 m/s and turning about its axis at 1 rad/s; no forces. The constant
# is in 1/s. One would expect both to decay as exp(-t), or spin by a rate that has to do with the constant and no length.
#
# Seen over one step of 1e-8 s: travel at 1.0 /s; spin at 2.0e6 /s for a radius of 1 mm and 2.2e7 /s for 0.3 mm, the radius of a
# guidewire, which is 2/r^2 with r in metres. The number depends on the unit of length. A torque at the hub does not reach the tip
# of a damped wire: the rotation is stopped within nanoseconds wherever it is not held.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/env"
"$folder/env/bin/pip" -q install pyelastica==1.0.0 numpy==2.4.6

cat >"$folder/spin.py" <<'PY'
import math
import sys

import elastica as ea
import numpy as np


class Flight(ea.BaseSystemCollection, ea.Damping):
    pass


def rates(radius, step=1e-8):
    flight = Flight()
    rod = ea.CosseratRod.straight_rod(10, np.zeros(3), np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, 0.0]), 0.1, radius,
                                      6450.0, youngs_modulus=60e9, shear_modulus=24e9)
    flight.append(rod)
    flight.dampen(rod).using(ea.AnalyticalLinearDamper, damping_constant=1.0, time_step=step)
    flight.finalize()
    rod.velocity_collection[0, :], rod.omega_collection[2, :] = 1.0, 1.0
    ea.PositionVerlet().step(flight, 0.0, step)
    return tuple(-math.log(v.mean()) / step for v in (rod.velocity_collection[0], rod.omega_collection[2]))


as_stated = True
for radius in (1e-3, 3e-4):
    travel, spin = rates(radius)
    print(f"radius {1e3 * radius} mm: travel decays at {travel:.3g} /s, spin at {spin:.3g} /s; 2/r^2 = {2 / radius**2:.3g}")
    as_stated = as_stated and abs(travel - 1) < 0.05 and abs(spin * radius**2 / 2 - 1) < 0.02
sys.exit(0 if as_stated else 1)
PY
cd "$folder" && env/bin/python spin.py
