#!/usr/bin/env python3
"""Friction over inserted length in both published experiments: as printed, at its best, with our detection, and the default.

    python3 bench/plot_published.py SCENES [--app build/seldinger] [-o docs/charts/published.png]

SCENES: the folder with experiment1.toml and experiment2.toml. What the published figures are described as: no friction before first
touch (3 cm; near zero on the arch), then a straight line of slope 0.0493 N/m in the cylinder, and on the arch growth with a jump where the
tip meets the arch.
"""
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

import runner

sys.path.insert(0, str(runner.ROOT / "assets"))
from plot_style import BLUE, COLUMN, GREEN, ORANGE, PURPLE, RED, use_style  # noqa: E402  (beside the scripts for users)

PUBLISHED = ["integrator.scheme=linearised", "contact.detection=layer", "contact.normal=lankarani-nikravesh", "contact.friction=sign"]
UNDAMPED = PUBLISHED + ["contact.restitution=1"]
FRAME = ["scene.dt_s=0.016666666666666666"]
SOFT = ["contact.stiffness=1e4", "contact.exponent=1", "integrator.damping_mass_1_s=100"]
SWEPT = ["contact.detection=swept"]
RUNS = {  # scene -> until [s], curves: label, colour, texts
    "experiment1": (12, [("as printed, 1 ms", RED, PUBLISHED), ("at its best, 0.5 ms", PURPLE, UNDAMPED + ["scene.dt_s=0.0005"]),
                         ("at its best, 16.7 ms", ORANGE, UNDAMPED + SOFT + FRAME), ("default, 1 ms", BLUE, [])]),
    "experiment2": (12, [("as printed, 1 ms", RED, PUBLISHED + ["wire.nodes=101"]),
                         ("at its best, 1 ms", PURPLE, UNDAMPED + ["wire.nodes=101"]),
                         ("its step and laws on exact triangles, 1 ms", GREEN, UNDAMPED + SWEPT + ["wire.nodes=101"]),
                         ("default, 1 ms", BLUE, ["wire.nodes=101"])]),
}


def curve(app, scene, until, settings):
    dt = next((float(s.split("=")[1]) for s in settings if s.startswith("scene.dt_s")), 1e-3)
    rows = runner.run(app, scene, settings=settings + [f"scene.duration_s={round(until / dt) * dt!r}", "scene.record_every=1"], accept=None).rows()
    return [100 * r["inserted_m"] for r in rows], [1e3 * r["friction_n"] for r in rows]


def main():
    parser = runner.parser(__doc__)
    parser.add_argument("scenes", type=pathlib.Path)
    parser.add_argument("-o", default=runner.ROOT / "docs/charts/published.png")
    options = parser.parse_args()
    use_style()
    figure, panels = plt.subplots(1, 2, figsize=(2 * COLUMN, 3.4), layout="constrained")
    for axes, (name, (until, curves)) in zip(panels, RUNS.items()):
        for label, colour, settings in curves:
            x, y = curve(options.app, options.scenes / f"{name}.toml", until, settings)
            ended = x[-1] < 2 * until - 0.1
            axes.plot(x, y, color=colour, linewidth=0.8, label=label + (" (ended by the energy it makes)" if ended else ""))
            if ended:
                axes.plot(x[-1:], [min(y[-1], 11)], "x", color=colour)
        axes.set_xlabel("inserted length [cm]")
        axes.set_ylabel("friction [mN]")
        axes.set_title({"experiment1": "experiment 1: cylinder", "experiment2": "experiment 2: a patient's arch"}[name], pad=42)
        axes.set_ylim(0, {"experiment1": 12, "experiment2": 6}[name])
        axes.legend(loc="lower left", bbox_to_anchor=(0, 1), fontsize=6.5, labelspacing=0.2)  # on no curve
    panels[0].plot([8, 24], [0.0493 * 10 * (8 - 3.45), 0.0493 * 10 * (24 - 3.45)], color="0.5", linestyle=":", linewidth=1)
    panels[0].text(17.5, 5.0, "slope 0.0493 N/m", fontsize=7, color="0.4")
    figure.savefig(options.o, dpi=200)


if __name__ == "__main__":
    main()
