# One style for all plots: sizes that are readable at the width of a printed column, colours that a colour-blind reader tells apart,
# and labels that do not lie on each other.
import os
import sys
import tempfile
from pathlib import Path

import matplotlib

# [Okabe, Ito 2008, "Color universal design"]
BLUE, ORANGE, RED, GREEN, PURPLE, SKY, YELLOW, BLACK = "#0072B2", "#E69F00", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#F0E442", "#111111"
COLUMN = 3.5  # inches; two columns of a journal's page are 7
SMALL, NORMAL = 6.5, 8  # points


def use_style():
    matplotlib.rcParams.update({
        "font.size": NORMAL, "axes.titlesize": NORMAL + 1, "axes.labelsize": NORMAL, "xtick.labelsize": 7, "ytick.labelsize": 7,
        "legend.fontsize": 7, "legend.frameon": False, "axes.spines.top": False, "axes.spines.right": False, "axes.axisbelow": True,
        "grid.color": "0.9", "grid.linewidth": 0.6, "lines.linewidth": 1.2,
        "axes.prop_cycle": matplotlib.cycler(color=[BLUE, ORANGE, GREEN, RED, PURPLE, SKY, BLACK]),
        "svg.fonttype": "none",  # text stays text: small files that can be searched
        "svg.hashsalt": "seldinger"})


def save(figure, path, **how):
    """Whole or not at all, under its name: a link in the place of the picture is replaced, and what it leads to left alone. A pipe or
    a device stays, as the command's own files have it."""
    path = Path(path)
    if path.exists() and not (path.is_file() or path.is_symlink()):
        print(f"{path}: is a folder, or a pipe or a device, which would be lost; give another file", file=sys.stderr)
        raise SystemExit(3)
    with tempfile.TemporaryDirectory(dir=path.parent or ".", prefix=".plot-") as own:  # made for this picture alone
        part = Path(own) / f"picture{path.suffix}"
        figure.savefig(part, **how)
        os.replace(part, path)


def better(axes, where="left and down"):
    """Says in the lower left corner which way is better."""
    axes.annotate("better", (0.015, 0.015), xycoords="axes fraction", xytext=(13, 10), textcoords="offset points", fontsize=SMALL, color="0.4",
                  arrowprops={"arrowstyle": "-|>", "color": "0.4", "linewidth": 0.7, "shrinkA": 0, "shrinkB": 0})


def place_labels(axes, labels, points, size=SMALL):
    """Writes each (x, y, text) where it covers neither another label nor one of `points` nor the edge, with a line to its point where that
    is not beside it; what finds no place within half an inch is left out. @return texts that found no place
    """
    figure = axes.figure
    renderer = figure.canvas.get_renderer()
    inside = axes.get_window_extent(renderer)
    scale = figure.dpi / 72
    taken = [(x - 3 * scale, y - 3 * scale, x + 3 * scale, y + 3 * scale) for x, y in axes.transData.transform(points)]
    left_out = []
    for x, y, text in labels:
        px, py = axes.transData.transform((x, y))
        probe = axes.text(x, y, text, fontsize=size)
        box = probe.get_window_extent(renderer)
        probe.remove()
        wide, high = box.width, box.height
        best = None
        for far in (5, 11, 18, 27, 36):
            reach = far * scale
            for dx, dy in ((-1, -1), (1, 1), (-1, 1), (1, -1), (1, 0), (-1, 0), (0, -1), (0, 1), (-1, -.5), (1, .5), (-1, .5), (1, -.5)):
                left = px + dx * reach - (wide if dx < 0 else wide / 2 if dx == 0 else 0)
                low = py + dy * reach - (high if dy < 0 else high / 2 if dy == 0 else 0)
                corner = (left, low, left + wide, low + high)
                free = all(corner[2] < t[0] or corner[0] > t[2] or corner[3] < t[1] or corner[1] > t[3] for t in taken)
                if free and corner[0] > inside.x0 and corner[1] > inside.y0 and corner[2] < inside.x1 and corner[3] < inside.y1:
                    best = corner, far
                    break
            if best:
                break
        if not best:
            left_out.append(text)
            continue
        (left, low, right, high_), far = best
        taken.append((left - scale, low - scale, right + scale, high_ + scale))
        arrow = {"arrowstyle": "-", "color": "0.55", "linewidth": 0.5, "shrinkA": 0, "shrinkB": 2} if far > 5 else None
        at = axes.transData.inverted().transform((left, low))
        axes.annotate(text, (x, y), xytext=at, textcoords="data", fontsize=size, color="0.15", ha="left", va="bottom", arrowprops=arrow, zorder=7)
    return left_out
