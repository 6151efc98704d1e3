#!/usr/bin/env python3
"""What the hand feels of three wires that are pushed up the aorta: force over insertion. three_wires.py [PICTURE.png]"""

import sys

import matplotlib

matplotlib.use("Agg")
from matplotlib import pyplot

import seldinger

COLOURS = ("#0072B2", "#E69F00", "#009E73")  # a colour-blind reader tells them apart

figure, axes = pyplot.subplots(figsize=(3.5, 2.6), layout="constrained")
for colour, wire in zip(COLOURS, ("terumo-angled-035", "bentson-035", "amplatz-super-stiff-035")):
    scene = {"scene": {"gravity": [0.0, 0.0, -9.81], "dt_s": 1 / 240}, "wire": {"preset": wire, "length_m": 0.45},
             "vessel": {"shape": "aortic-arch"}, "feed": {"inlet": "auto", "keys": [{"t_s": 0.0, "advance_m": 0.0, "turn_rad": 0.0}]}}
    with seldinger.World(scene) as world:
        inserted, force = [], []
        for millimetres in range(1, 301):
            if world.step([1e-3 * millimetres, 0.0], n=10).failed:
                break
            inserted.append(100 * world.output.inserted)
            force.append(1e3 * world.output.hand_force)
        axes.plot(inserted, force, color=colour, label=wire)
axes.set(xlabel="inserted length [cm]", ylabel="hand force [mN]", xlim=(0, 30))
axes.set_ylim(bottom=0)
axes.legend(frameon=False, fontsize=8)
figure.savefig(sys.argv[1] if len(sys.argv) > 1 else "three-wires.png", dpi=200)
