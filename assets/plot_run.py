#!/usr/bin/env python3
"""Hand force, friction, force per length and length in contact of one or several runs against inserted length.

    plot_run.py DIR [DIR2 ...] -o run.png

Reads trace.csv of each folder that `seldinger run` wrote; a run that was interrupted is plotted as far as it got. Lines are running
medians; the band about each holds 10 to 90 % of the same rows. What is zero throughout has no panel.
"""
import argparse
import csv
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")  # no display needed
import matplotlib.pyplot as plt
import numpy

from plot_style import COLUMN, SMALL, save, use_style

# column of trace.csv, what stands beside its axis, factor
PANELS = [("hand_force_n", "hand force\n[mN]", 1e3), ("friction_n", "friction\n[mN]", 1e3),
          ("force_per_length_max_n_per_m", "largest force\nper length [N/m]", 1), ("contact_extent_m", "length in\ncontact [mm]", 1e3)]
STYLES = ["-", "--", "-.", ":"]


def read_trace(folder):
    """Columns of trace.csv by name; an empty field becomes NaN, a last row that was cut off is left out."""
    path = pathlib.Path(folder) / "trace.csv"
    try:
        with open(path, newline="", encoding="utf-8") as stream:
            rows = list(csv.reader(stream))
    except OSError as error:
        sys.exit(f"plot_run.py: {path}: {error.strerror}; give a folder that `seldinger run` wrote")
    if not rows or "inserted_m" not in rows[0]:
        sys.exit(f"plot_run.py: {path}: has no column inserted_m; is it the trace of a run?")
    head = rows[0]
    whole = [row for row in rows[1:] if len(row) == len(head)]
    if not whole:
        sys.exit(f"plot_run.py: {path}: holds no row yet")
    return {name: [float(row[k]) if row[k] else float("nan") for row in whole] for k, name in enumerate(head)}


def axis_of(traces):
    """Inserted length where something is fed, else time."""
    if any(max(trace["inserted_m"]) > 0 for trace in traces):
        return "inserted length [cm]", lambda trace: 100 * numpy.array(trace["inserted_m"])
    return "time [s]", lambda trace: numpy.array(trace["time_s"])


def running(values, wide):
    """10 %, median and 90 % of `wide` values about each."""
    half = wide // 2
    around = numpy.lib.stride_tricks.sliding_window_view(numpy.pad(values, half, mode="edge"), 2 * half + 1)
    return numpy.nanquantile(around, (0.1, 0.5, 0.9), axis=1)


def shown(traces):
    """The panels that have something to show in one of the runs."""
    has = [panel for panel in PANELS if any(numpy.any(numpy.nan_to_num(trace.get(panel[0], [0])) != 0) for trace in traces)]
    return has or PANELS[:1]


def plot(folders, labels, output):
    traces = [read_trace(folder) for folder in folders]
    panels = shown(traces)
    x_label, x_of = axis_of(traces)
    use_style()
    colours = matplotlib.rcParams["axes.prop_cycle"].by_key()["color"]
    figure, all_axes = plt.subplots(len(panels), 1, sharex=True, squeeze=False, layout="constrained",
                                    figsize=(2 * COLUMN, 0.7 + 1.5 * len(panels)))
    for axes, (column, name, factor) in zip(all_axes[:, 0], panels):
        lowest = 0.0
        for k, (label, trace) in enumerate(zip(labels, traces)):
            if column not in trace:
                continue
            x, values = x_of(trace), factor * numpy.array(trace[column])
            low, median, high = running(values, max(3, len(x) // 100))
            # colours repeat after seven, dashes tell those apart, and lines that lie on each other
            style = {"color": colours[k % len(colours)], "linestyle": STYLES[k % len(STYLES)]}
            axes.plot(x, median, label=label, **style)
            lowest = min(lowest, numpy.nanmin(low))
            axes.fill_between(x, low, high, color=style["color"], alpha=0.25, linewidth=0)
        axes.set_ylabel(name)
        axes.grid(True)
        axes.margins(x=0)
        if lowest > -0.02 * axes.get_ylim()[1]:  # only a hand that draws needs room below zero
            axes.set_ylim(bottom=0)
    all_axes[-1, 0].set_xlabel(x_label)
    all_axes[0, 0].set_title("median and 10 to 90 % of a hundredth of the run", loc="left", fontsize=SMALL, color="0.35")
    if len(traces) > 1:
        all_axes[0, 0].legend(loc="upper left", ncols=min(len(traces), 4))
    figure.align_ylabels()
    save(figure, output, dpi=200)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("dirs", nargs="+", metavar="DIR", help="folders of runs")
    parser.add_argument("-o", "--output", default="run.png", help="picture to write (png, pdf, svg)")
    parser.add_argument("--labels", nargs="+", help="names in the legend (default: the folders' names)")
    options = parser.parse_args()
    labels = options.labels or [pathlib.Path(d).resolve().name for d in options.dirs]
    if len(labels) != len(options.dirs):
        parser.error(f"{len(labels)} labels for {len(options.dirs)} folders")
    plot(options.dirs, labels, options.output)


if __name__ == "__main__":
    main()
