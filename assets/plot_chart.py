#!/usr/bin/env python3
"""Speed against accuracy, from what `seldinger chart` wrote.

    plot_chart.py DIR [-o DIR2] [--png] [--dpi 110]

Reads chart.csv and references.csv of DIR; writes chart.svg and chart.png (tip error of every scene) and chart-SCENE.svg and .png (every
observable of one scene) into DIR2 (default: DIR); with --png no .svg.
"""
import argparse
import csv
import math
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")  # no display needed
import matplotlib.pyplot as plt
from matplotlib.lines import Line2D

from plot_style import BLACK, BLUE, COLUMN, GREEN, ORANGE, PURPLE, RED, better, place_labels, save as save_whole, use_style

use_style()

# Four kinds of models, told apart by shape and colour; what else is varied stands in the labels and in chart.csv.
KINDS_OF_MODEL = {"newton": ("o", 24, BLUE, "steps solved by Newton"), "linearised": ("s", 20, ORANGE, "one linearised step"),
                  "baseline": ("^", 28, GREEN, "mass-spring, beam, explicit"), "published": ("*", 120, RED, "published method, as printed"),
                  "published best": ("*", 120, PURPLE, "published method, at its best"), "planned": ("d", 80, BLACK, "what `plan` chose")}
BASELINES = ("mass-spring", "soft mass-spring", "beam", "beam · lin", "explicit")
CLOCKS = {"wall": "wall time", "cpu": "processor time"}


def read_table(path):
    try:
        with open(path, newline="", encoding="utf-8") as stream:
            return list(csv.DictReader(stream))
    except OSError as error:
        sys.exit(f"plot_chart.py: {path}: {error.strerror}; give a folder that `seldinger chart` wrote")


def number(text):
    return float(text) if text else math.nan


def kind_of(row):
    """Key of KINDS_OF_MODEL."""
    if row["family"] in BASELINES:
        return "baseline"
    if row["family"] == "published best":
        return "published best"
    if row["published"] == "1":
        return "published"
    if row["family"] == "planned":
        return "planned"
    return "linearised" if "scheme=linearised" in row["settings"] else "newton"


class Panel:
    """One observable of one scene."""

    def __init__(self, rows, reference):
        self.word, self.unit = reference["observable"], reference["unit"]
        self.factor, self.shown_unit = (1e3, "mm") if self.unit == "m" else (1e3, "mN")
        self.uncertainty = number(reference["uncertainty"]) * self.factor
        self.reference = reference
        self.charted = reference["charted"] == "1"
        error = f"{self.word}_rms_{self.unit}"
        self.points = []
        for row in rows:
            cost, value = number(row[row["clock"] + "_s_per_s"]), number(row[error]) * self.factor
            if row["complete"] == "1" and value > 0 and cost > 0:
                self.points.append((cost, value, row))

    def limits(self):
        costs, errors = [p[0] for p in self.points], [p[1] for p in self.points]
        floor = self.uncertainty if self.uncertainty > 0 else min(errors)
        low = min(min(errors), floor)
        return (min(costs) / 6, max(costs) * 1.6), (low / 3, max(errors) * 2)

    def draw(self, axes):
        axes.set_xscale("log")
        axes.set_yscale("log")
        axes.set_ylabel(f"{'tip' if self.word == 'tip' else self.reference.get('axis_label', self.reference.get('says'))} error [{self.shown_unit}]")
        if not self.charted or not self.points:
            axes.set_xticks([])
            axes.set_yticks([])
            axes.minorticks_off()
            axes.text(0.5, 0.5, f"not charted: the reference\n{self.reference['convergence']}", transform=axes.transAxes,
                      ha="center", va="center", fontsize=8, color="0.4")
            return
        (left, right), (bottom, top) = self.limits()
        axes.set_xlim(left, right)
        axes.set_ylim(bottom, top)
        axes.grid(True, which="major")
        if left < 1 < right:
            axes.axvline(1, color="0.6", linewidth=0.8, linestyle=":")
        if self.uncertainty > 0:
            axes.axhspan(bottom, self.uncertainty, color="0.8", linewidth=0, zorder=0)
            axes.axhline(10 * self.uncertainty, color="0.75", linewidth=0.7, linestyle="--", zorder=0)
        self.draw_front(axes)
        for cost, error, row in self.points:
            self.draw_point(axes, cost, error, row)
        better(axes)

    def draw_point(self, axes, cost, error, row):
        marker, size, colour, _ = KINDS_OF_MODEL[kind_of(row)]
        resolved = row[f"{self.word}_resolved"] == "1" or self.uncertainty == 0
        held = row["outcome"] == "hold"
        axes.plot([number(row[row["clock"] + "_lowest"]), number(row[row["clock"] + "_highest"])], [error, error], color=colour, linewidth=0.7, alpha=0.6, zorder=2)
        axes.scatter([cost], [error], s=size, marker=marker, facecolors=colour if resolved else "white",
                     edgecolors=colour, linewidths=0.9, alpha=0.9 if held else 0.45, zorder=5 if row["published"] == "1" else 3)
        if not held:
            axes.scatter([cost], [error], s=14, marker="x", color="0.15", linewidths=0.8, zorder=6)

    def front(self):
        return sorted((p for p in self.points if p[2][f"{self.word}_front"] == "1"), key=lambda p: p[0])

    def draw_labels(self, axes):
        """The front's models, once the figure has its layout."""
        if self.charted and self.points:
            front = self.front()
            steps = [(b[0], a[1]) for a, b in zip(front, front[1:])]  # corners of the line, and places along it
            along = [(math.exp(math.log(a[0]) + t * math.log(b[0] / a[0])), a[1]) for a, b in zip(front, front[1:]) for t in (0.25, 0.5, 0.75)]
            down = [(b[0], math.exp(math.log(a[1]) + t * math.log(b[1] / a[1]))) for a, b in zip(front, front[1:]) for t in (0.25, 0.5, 0.75)]
            cue = axes.transData.inverted().transform(axes.transAxes.transform([(0.04 * k, 0.075) for k in range(6)]))  # "better"
            place_labels(axes, [(cost, error, row["model"]) for cost, error, row in front],
                         [p[:2] for p in self.points] + steps + along + down + [tuple(p) for p in cue])

    def draw_front(self, axes):
        front = self.front()
        if not front:
            return
        xs, ys = [], []
        for cost, error, _ in front:
            if ys:
                xs.append(cost)
                ys.append(ys[-1])
            xs.append(cost)
            ys.append(max(error, self.uncertainty) if self.uncertainty > 0 else error)
        axes.plot(xs, ys, color="0.25", linewidth=1.1, zorder=1)


def legend_entries(rows):
    def dot(colour, marker, label, size=5.5, **style):
        return Line2D([], [], color=colour, marker=marker, linestyle="", markersize=size, label=label, **style)

    kinds = {kind_of(row) for row in rows}
    entries = [dot(colour, marker, label, 10 if size > 100 else 5.5) for kind, (marker, size, colour, label) in KINDS_OF_MODEL.items() if kind in kinds]
    entries += [dot("0.15", "x", "did not hold"), dot(BLUE, "o", "below 10 × the reference's uncertainty", markerfacecolor="white"),
                Line2D([], [], color="0.25", linewidth=1.1, label="Pareto front"),
                Line2D([], [], color="0.8", linewidth=6, label="reference's uncertainty"),
                Line2D([], [], color="0.75", linewidth=0.7, linestyle="--", label="10 × that"),
                Line2D([], [], color="0.6", linewidth=0.8, linestyle=":", label="real time")]
    return entries


KINDS, DPI = ["svg", "png"], 110


def save(figure, folder, stem):
    for kind in KINDS:
        save_whole(figure, folder / f"{stem}.{kind}", dpi=DPI, metadata={"Date": None} if kind == "svg" else None)
    plt.close(figure)


def draw_legend(cell, rows):
    entries = legend_entries(rows)
    wide = cell.get_subplotspec().colspan.stop - cell.get_subplotspec().colspan.start
    legend = cell.legend(handles=entries, loc="center", ncol=wide, labelspacing=0.45)
    legend.set_in_layout(False)  # a long one would pull the rows apart


def grid_figure(count, columns):
    rows = math.ceil((count + 1) / columns)  # one cell for the legend, or a row of them
    apart = count % columns == 0
    heights = [1] * (rows - apart) + [0.45] * apart
    figure, axes = plt.subplots(rows, columns, figsize=(COLUMN * columns, 3.0 * sum(heights)), squeeze=False, height_ratios=heights)
    cells = list(axes.flat)
    for cell in cells[count:]:
        cell.axis("off")
    if apart:
        for cell in cells[count:]:
            cell.remove()
        cells[count:] = [figure.add_subplot(axes[0, 0].get_gridspec()[rows - 1, :])]
        cells[count].axis("off")
    return figure, cells


def draw_scene(folder, name, rows, references):
    figure, cells = grid_figure(len(references), 2)
    panels = [(Panel(rows, reference), cell) for cell, reference in zip(cells, references)]
    for panel, cell in panels:
        panel.draw(cell)
        cell.set_xlabel(f"{CLOCKS[rows[0]['clock']]} per simulated second [s]")
    draw_legend(cells[len(references)], rows)
    figure.suptitle(rows[0]["title"], fontsize=10)
    figure.tight_layout()
    for panel, cell in panels:
        panel.draw_labels(cell)
    save(figure, folder, f"chart-{name}")


def draw_overview(folder, scenes, references):
    figure, cells = grid_figure(len(scenes), 2)
    panels = []
    every = [row for rows in scenes.values() for row in rows]
    for cell, (name, rows) in zip(cells, scenes.items()):
        tip = [r for r in references[name] if r["observable"] == "tip"]
        if tip:
            panels.append((Panel(rows, tip[0]), cell))
            panels[-1][0].draw(cell)
        cell.set_title(name)
        cell.set_xlabel(f"{CLOCKS[rows[0]['clock']]} per simulated second [s]")
    draw_legend(cells[len(scenes)], every)
    figure.tight_layout()
    for panel, cell in panels:
        panel.draw_labels(cell)
    save(figure, folder, "chart")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("dir", metavar="DIR", help="folder of a chart", type=pathlib.Path)
    parser.add_argument("-o", "--output", metavar="DIR2", type=pathlib.Path, help="folder for the pictures (default: DIR)")
    parser.add_argument("--png", action="store_true", help="no .svg")
    parser.add_argument("--dpi", type=int, default=110)
    options = parser.parse_args()
    global KINDS, DPI
    KINDS, DPI = ["png"] if options.png else KINDS, options.dpi
    folder = options.output or options.dir
    folder.mkdir(parents=True, exist_ok=True)
    references, scenes = {}, {}
    for reference in read_table(options.dir / "references.csv"):
        references.setdefault(reference["scene"], []).append(reference)
    for row in read_table(options.dir / "chart.csv"):
        if row["scene"] in references:
            scenes.setdefault(row["scene"], []).append(row)
    if not scenes:
        sys.exit(f"plot_chart.py: {options.dir}: no scene is finished yet; run the chart again, it goes on")
    for name, rows in scenes.items():
        draw_scene(folder, name, rows, references[name])
    draw_overview(folder, scenes, references)


if __name__ == "__main__":
    main()
