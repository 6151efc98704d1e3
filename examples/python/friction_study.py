#!/usr/bin/env python3
"""How far friction decides what the hand feels, of two wires: a batch, looked at with pandas. friction_study.py [PICTURE.png]"""

import sys

import matplotlib

matplotlib.use("Agg")
from matplotlib import pyplot
import pandas

import seldinger

vary = {"wire.mu_sliding": [0.02, 0.05, 0.08, 0.11, 0.14], "wire.bend_nm2": [2.9e-4, 5.8e-4]}
keys = [{"t_s": 0.0, "advance_m": 0.0, "turn_rad": 0.0}, {"t_s": 10.0, "advance_m": 0.3, "turn_rad": 0.0}]
table = pandas.DataFrame(seldinger.batch("navigate", vary, wire__mu_static=0.15, feed__keys=keys))
mean = table.groupby(["wire.bend_nm2", "wire.mu_sliding"])[["friction_max_n", "normal_n", "overlap_max_m"]].mean()
print(mean.to_string())
for stiffness, rows in mean.groupby(level=0):
    pyplot.plot(rows.index.get_level_values(1), rows["friction_max_n"], marker="o", label=f"{1e4 * stiffness:g} N cm^2")
pyplot.xlabel("coefficient of sliding friction")
pyplot.ylabel("largest friction of the wall [N]")
pyplot.ylim(bottom=0)
pyplot.legend(title="bending stiffness of the shaft")
pyplot.savefig(sys.argv[1] if len(sys.argv) > 1 else "friction-study.png", dpi=100)
