#!/usr/bin/env python3
"""Stability maps, from what `seldinger stability` wrote.

    plot_stability.py DIR|FILE.csv [-o DIR2] [--maps NAME,NAME] [--methods NAME;NAME] [--name STEM]

Reads stability.csv; writes STEM.png (default stability.png) into DIR2 (default: beside the table): one row of small maps for each map,
one column for each method, all of a row on the same axes. A cell is a run; its colour and its letter say how it went.
"""
import argparse
import csv
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")  # no display needed
import matplotlib.pyplot as plt
from matplotlib.patches import Patch, Rectangle

from plot_style import ORANGE, PURPLE, RED, SMALL, YELLOW, save, use_style

# The letter says what the colour does. From harmless to hopeless.
OUTCOMES = {"hold": ("#bfe3f5", "·", "holds"), "unfinished": ("#ffffff", "?", "not finished"), "jitter": (YELLOW, "J", "jitter"),
            "overlap": (ORANGE, "O", "overlap"), "escape": (PURPLE, "E", "escape"), "gave-up": ("#999999", "G", "gave up"),
            "blow-up": (RED, "B", "blow-up")}
AXES = {"stiffness": "wall stiffness / nominal", "speed": "feed speed [cm/s]", "triangles": "triangle leg / wire radius",
        "bending": "bending stiffness [N m²]", "friction": "sliding friction", "axial": "stretching stiffness [N]",
        "spacing": "edge / bend radius", "damage": "share of spoilt triangles", "approach": "approach speed [m/s]",
        "carina": "tip off the middle / lumen", "whip": "tip curvature [1/m]", "buckling": "tube / wire radius",
        "ratio": "shaft / tip stiffness", "stenosis": "throat / wire radius", "septum": "septum / wire radius",
        "offset": "distance from origin [m]", "strokes": "strokes per second", "fold": "turning per edge [°]",
        "twist": "turning per edge [rad]", "alternating": "side load [N]",
        "soft-wall": "modulus / nominal", "snug": "bending stiffness / nominal", "coaxial": "wire / catheter stiffness",
        "coaxial-merged": "wire / catheter stiffness", "channel": "lumen / wire radius"}
SCALE = {"speed": 100.0}
NAMES = 0.3  # width of the column with the maps' names, of a panel's


def meaning(methods):
    """What a reader who has the picture alone has to know of these methods."""
    if not any("published" in method for method in methods):
        return ""
    return "published: the adaptive-layer contact method of a published training simulator, as printed (docs/published-method.md)"


def read_table(path):
    file = path / "stability.csv" if path.is_dir() else path
    try:
        with open(file, newline="", encoding="utf-8") as stream:
            rows = list(csv.DictReader(stream))
    except OSError as error:
        sys.exit(f"plot_stability.py: {file}: {error.strerror}; give a folder that `seldinger stability` wrote")
    if not rows or not {"map", "method", "dt_s", "value", "outcome"} <= set(rows[0]):
        sys.exit(f"plot_stability.py: {file}: no cells of a stability map in it; give a folder that `seldinger stability` wrote")
    cells = {}
    for row in rows:  # the last of a cell's rows stands
        cells[row["map"], row["method"], float(row["value"]), float(row["dt_s"])] = row["outcome"]
    far = {(row["map"], row["method"], float(row["value"]), float(row["dt_s"])) for row in rows if int(row.get("wall_far_steps") or 0) > 0}
    return cells, far


def ordered(items):
    return list(dict.fromkeys(items))


def short(number):
    if number != 0 and not 1e-2 <= abs(number) < 1e4:
        mantissa, exponent = f"{number:.0e}".split("e")
        return f"{mantissa}e{int(exponent)}"
    return f"{number:.2g}" if abs(number) < 100 else f"{number:.0f}"


def draw_panel(axes, cells, far, name, method, values, steps):
    there = False
    for x, value in enumerate(values):
        for y, step in enumerate(steps):
            outcome = cells.get((name, method, value, step))
            if outcome is None:
                continue
            there = True
            colour, letter, _ = OUTCOMES[outcome]
            axes.add_patch(Rectangle((x - 0.5, y - 0.5), 1, 1, facecolor=colour, edgecolor="white", linewidth=0.8))
            if (name, method, value, step) in far:
                letter += "~"
            axes.text(x, y, letter, ha="center", va="center", fontsize=SMALL, color="#222222")
    axes.set_xlim(-0.5, len(values) - 0.5)
    axes.set_ylim(-0.5, len(steps) - 0.5)
    if not there:
        axes.text((len(values) - 1) / 2, (len(steps) - 1) / 2, "not run", ha="center", va="center", fontsize=7, color="#888888")
    axes.set_xticks(range(len(values)), [short(v * SCALE.get(name, 1)) for v in values], rotation=90, fontsize=SMALL)
    axes.set_yticks(range(len(steps)), [f"{1e3 * s:.3g}" for s in steps], fontsize=SMALL)
    axes.tick_params(length=0)
    for side in axes.spines.values():
        side.set_visible(False)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("table", type=pathlib.Path, metavar="DIR|FILE.csv")
    parser.add_argument("-o", type=pathlib.Path, metavar="DIR2", help="where the picture goes (default: beside the table)")
    parser.add_argument("--maps", help="only these, separated by commas")
    parser.add_argument("--methods", help="only these, in this order, separated by semicolons")
    parser.add_argument("--name", default="stability", metavar="STEM")
    options = parser.parse_args()
    cells, far = read_table(options.table)
    maps = options.maps.split(",") if options.maps else ordered(key[0] for key in cells)
    methods = options.methods.split(";") if options.methods else ordered(key[1] for key in cells)
    for wanted, known, what in ((maps, {k[0] for k in cells}, "map"), (methods, {k[1] for k in cells}, "method")):
        for name in wanted:
            if name not in known:
                sys.exit(f"plot_stability.py: no {what} \"{name}\" in {options.table}; there are: {'; '.join(sorted(known))}")

    use_style()
    figure, grid = plt.subplots(len(maps), 1 + len(methods), squeeze=False, width_ratios=[NAMES] + [1] * len(methods),
                                figsize=(max(5.0, 1.4 + 1.75 * len(methods)), 1.0 + 1.75 * len(maps)))
    for row, name in enumerate(maps):
        values = sorted({key[2] for key in cells if key[0] == name})
        steps = sorted({key[3] for key in cells if key[0] == name})
        grid[row][0].set_axis_off()
        grid[row][0].text(0.0, 0.5, name, fontweight="bold", rotation=90, va="center", ha="center", transform=grid[row][0].transAxes)
        for column, method in enumerate(methods):
            axes = grid[row][column + 1]
            draw_panel(axes, cells, far, name, method, values, steps)
            axes.set_xlabel(AXES.get(name, name), fontsize=7)
            if column == 0:
                axes.set_ylabel("step [ms]", fontsize=7)
            else:
                axes.set_yticks([])
            if row == 0:
                axes.set_title(method, fontsize=8)
    seen = set(cells[key] for key in cells if key[0] in maps and key[1] in methods)
    legend = [Patch(facecolor=colour, edgecolor="#888888", label=f"{letter}  {words}")
              for outcome, (colour, letter, words) in OUTCOMES.items() if outcome in seen]
    if any(key[0] in maps and key[1] in methods for key in far):
        legend.append(Patch(facecolor="white", edgecolor="#888888", label="~  wall moved by over 20 % of the lumen radius"))
    figure.legend(handles=legend, loc="upper center", ncols=len(legend), fontsize=7, frameon=False)
    said = meaning(methods)
    figure.text(0.01, 0.05 / figure.get_figheight(), said, fontsize=SMALL, color="0.3", va="bottom")
    figure.tight_layout(rect=(0, 0.2 / figure.get_figheight() if said else 0, 1, 1 - 0.3 / figure.get_figheight()))
    out = options.o or (options.table if options.table.is_dir() else options.table.parent)
    out.mkdir(parents=True, exist_ok=True)
    save(figure, out / f"{options.name}.png", dpi=130)


if __name__ == "__main__":
    main()
