#!/usr/bin/env python3
"""What the hand feels of three wires that are pushed up the aorta: force over insertion. three_wires.py [PICTURE.png]"""

import sys

import matplotlib

matplotlib.use("Agg")
from matplotlib import pyplot

import seldinger

for wire in ("terumo-angled-035", "bentson-035", "amplatz-super-stiff-035"):
    with seldinger.World("navigate", wire__preset=wire) as world:
        inserted, force = [], []
        for millimetres in range(1, 301):
            if world.step([1e-3 * millimetres, 0.0], n=10).failed:
                break
            inserted.append(1e3 * world.output.inserted)
            force.append(world.output.hand_force)
        pyplot.plot(inserted, force, label=wire)
pyplot.xlabel("inserted [mm]")
pyplot.ylabel("hand force [N]")
pyplot.legend()
pyplot.savefig(sys.argv[1] if len(sys.argv) > 1 else "three-wires.png", dpi=100)
