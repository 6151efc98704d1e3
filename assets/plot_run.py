#!/usr/bin/env python3
"""Friction, rolling moment and force per length (number of contact samples in traces of earlier versions) of one or several runs
against inserted length.

    plot_run.py DIR [DIR2 ...] -o friction.png

Reads trace.csv of each folder that `seldinger run` wrote; a run that was interrupted is plotted as far as it got.
"""
import argparse
import csv
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")  # no display needed
import matplotlib.pyplot as plt

COLOURS = ["#1f4e79", "#c0504d", "#4f8a3c", "#7a5ba6", "#b8860b", "#3b8ea5"]


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


def tint(colour):
    """Half way to white."""
    return [0.5 + 0.5 * part for part in matplotlib.colors.to_rgb(colour)]


def axis_of(traces):
    """Inserted length where something is fed, else time."""
    if any(max(trace["inserted_m"]) > 0 for trace in traces):
        return "inserted length [cm]", lambda trace: [100 * v for v in trace["inserted_m"]]
    return "time [s]", lambda trace: trace["time_s"]


def plot(folders, labels, output):
    traces = [read_trace(folder) for folder in folders]
    load = "force_per_length_max_n_per_m"
    lowest = load if all(load in trace for trace in traces) else "contacts"
    x_label, x_of = axis_of(traces)
    figure, (friction, rolling, contacts) = plt.subplots(3, 1, sharex=True, figsize=(7.5, 8.5),
                                                         gridspec_kw={"height_ratios": [2, 1, 1]})
    for k, (label, trace) in enumerate(zip(labels, traces)):
        x, colour = x_of(trace), COLOURS[k % len(COLOURS)]
        prefix = f"{label}: " if len(traces) > 1 else ""
        # each run thinner than the one before: where two agree, both are seen
        style = {"color": colour, "linewidth": max(2.4 - 1.2 * k, 0.8) if len(traces) > 1 else 1.4, "clip_on": False}
        friction.plot(x, trace["friction_n"], label=f"{prefix}total", **style)
        friction.plot(x, trace["sliding_n"], color=tint(colour), linewidth=0.9, label=f"{prefix}sliding", zorder=2.5)
        rolling.plot(x, [1e6 * v for v in trace["rolling_nm"]], label=label, **style)
        contacts.plot(x, trace[lowest], label=label, **style)
    friction.set_ylabel("friction [N]")
    rolling.set_ylabel("rolling moment [µN m]")
    contacts.set_ylabel("largest force\nper length [N/m]" if lowest == load else "contact samples [-]")
    contacts.set_xlabel(x_label)
    for axes in (friction, rolling, contacts):
        axes.grid(True, color="0.88", linewidth=0.6)
        axes.margins(x=0)
        axes.set_ylim(bottom=0)  # all three are sums of magnitudes
        for side in ("top", "right"):
            axes.spines[side].set_visible(False)
    friction.legend(frameon=False, fontsize=9, loc="upper left")
    figure.align_ylabels()
    figure.tight_layout()
    figure.savefig(output, dpi=150)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("dirs", nargs="+", metavar="DIR", help="folders of runs")
    parser.add_argument("-o", "--output", default="friction.png", help="picture to write (png, pdf, svg)")
    parser.add_argument("--labels", nargs="+", help="names in the legend (default: the folders' names)")
    options = parser.parse_args()
    labels = options.labels or [pathlib.Path(d).resolve().name for d in options.dirs]
    if len(labels) != len(options.dirs):
        parser.error(f"{len(labels)} labels for {len(options.dirs)} folders")
    plot(options.dirs, labels, options.output)


if __name__ == "__main__":
    main()
