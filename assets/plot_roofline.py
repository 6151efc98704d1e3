#!/usr/bin/env python3
"""The roofline of a device, from what `seldinger bench -o DIR` wrote.

    plot_roofline.py DIR [-o DIR2]

Reads device.csv and kernels.csv of DIR; writes roofline.svg and roofline.png into DIR2 (default: DIR): one panel a precision, the measured
roofs of the widest lane (multiply-adds in vectors, and one by one; memory and cache), and every kernel at its largest load.
"""
import argparse
import csv
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")  # no display needed
import matplotlib.pyplot as plt

from plot_style import BLUE, ORANGE, save, use_style

use_style()
COLOURS = {"light": ORANGE, "heavy": BLUE}
NAMES = {"light": "caller's thread", "heavy": "whole device"}


def read_table(path):
    try:
        with open(path, newline="", encoding="utf-8") as stream:
            rows = list(csv.DictReader(stream))
    except OSError as error:
        sys.exit(f"plot_roofline.py: {path}: {error.strerror}; give a folder that `seldinger bench -o DIR` wrote")
    if not rows:
        sys.exit(f"plot_roofline.py: {path}: no rows")
    return rows


def draw_panel(axes, precision, lanes, kernels):
    word = "float" if precision == "float32" else "double"
    intensities = [10 ** (k / 20) for k in range(-40, 61)]
    for lane in lanes:
        peak = float(lane[f"gflop_per_s_{word}"])
        if peak == 0:
            axes.text(0.5, 0.5, "the device has no double precision", ha="center", transform=axes.transAxes)
            return
        colour, name = COLOURS[lane["lane"]], NAMES[lane["lane"]]
        cached, memory = float(lane["cached_gb_per_s"]), float(lane["gb_per_s"])
        scalar = float(lane[f"gflop_per_s_{word}_scalar"])
        axes.plot(intensities, [min(peak, cached * x) for x in intensities], color=colour, lw=1.6,
                  label=f"{name}: {peak:.0f} GFLOP/s, {cached:.0f} GB/s from cache")
        axes.plot(intensities, [min(peak, memory * x) for x in intensities], color=colour, lw=1, ls="--", label=f"  from memory: {memory:.0f} GB/s")
        axes.plot(intensities, [min(scalar, cached * x) for x in intensities], color=colour, lw=1, ls=":", label=f"  one number at a time: {scalar:.0f} GFLOP/s")
    mine = [k for k in kernels if k["precision"] == precision]
    last = {}
    for row in mine:  # the largest load of each lane
        key = (row["kernel"], row["lane"])
        if key not in last or int(row["items"]) >= int(last[key]["items"]):
            last[key] = row
    shown = []
    for (kernel, lane), row in sorted(last.items()):
        x, y = float(row["flop_per_byte"]), float(row["gflop_per_s"])
        if x <= 0 or y <= 0:
            continue
        axes.plot(x, y, "o", color=COLOURS[lane], ms=5)
        if lane == lanes[-1]["lane"]:
            shown.append([y, x, kernel])
    # names to the right of their dots, apart from each other
    shown.sort()
    below = 0
    for y, x, kernel in shown:
        at = max(y, below * 1.38)
        below = at
        axes.annotate(kernel, (x, y), xytext=(60, at), textcoords="data", fontsize=8, va="center",
                      arrowprops={"arrowstyle": "-", "color": "#999999", "lw": 0.5, "shrinkA": 0, "shrinkB": 3})
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlim(0.01, 1000)
    axes.set_title(f"{precision} kernels", fontsize=10)
    axes.set_xlabel("operations per byte read or written")
    axes.grid(True, which="major", color="#dddddd", lw=0.5)
    axes.legend(fontsize=7, loc="upper left", frameon=False)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("dir", type=pathlib.Path)
    parser.add_argument("-o", type=pathlib.Path, dest="out")
    options = parser.parse_args()
    lanes, kernels = read_table(options.dir / "device.csv"), read_table(options.dir / "kernels.csv")
    figure, panels = plt.subplots(1, 2, figsize=(13, 5.6), sharey=True)
    for axes, precision in zip(panels, ("float64", "float32")):
        draw_panel(axes, precision, lanes, kernels)
    panels[0].set_ylabel("GFLOP/s")
    low = min(float(k["gflop_per_s"]) for k in kernels if float(k["gflop_per_s"]) > 0)
    high = max(float(lane["gflop_per_s_float"]) for lane in lanes)
    panels[0].set_ylim(low / 3, high * 20)
    figure.suptitle(f"{lanes[0]['device']}  ·  {lanes[0]['driver']}  ·  commit {lanes[0]['commit']}", fontsize=9)
    figure.tight_layout()
    out = options.out or options.dir
    for suffix in ("svg", "png"):
        save(figure, out / f"roofline.{suffix}", dpi=110, metadata={"Date": None} if suffix == "svg" else None)


if __name__ == "__main__":
    main()
