#!/usr/bin/env python3
"""Success of train_navigate.py on other starts than those learnt from, over processor time: median and range of the seeds.

bench/plot_learning.py [bench/results/learning] [-o docs/learning.png]      files TARGET-SEED.csv
"""

import sys
from collections import defaultdict
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import numpy as np
from matplotlib import pyplot

import runner

sys.path.insert(0, str(runner.ROOT / "assets"))
import plot_style


def curves(folder):
    """@return target: [(processor minutes, success)] of its seeds"""
    found = defaultdict(list)
    for path in sorted(folder.glob("*-[0-9].csv")):
        found[path.stem[:-2]].append(np.array([(float(r["cpu_s"]) / 60, float(r["success"])) for r in runner.read_rows(path)]))
    return found


def main():
    parser = runner.parser(__doc__, app=False)
    parser.add_argument("folder", nargs="?", type=Path, default=Path("bench/results/learning"))
    parser.add_argument("-o", dest="out", default="docs/learning.png")
    options = parser.parse_args()
    plot_style.use_style()
    figure, axes = pyplot.subplots(figsize=(2 * plot_style.COLUMN, 2.2), layout="constrained")
    for colour, (target, seeds) in zip((plot_style.BLUE, plot_style.RED), sorted(curves(options.folder).items())):
        minutes = np.linspace(0, max(s[-1, 0] for s in seeds), 200)
        # a policy is as good as when it was last evaluated, that of a run that has ended too
        success = np.array([100 * s[np.searchsorted(s[:, 0], minutes, side="right").clip(1) - 1, 1] for s in seeds])
        axes.fill_between(minutes, success.min(axis=0), success.max(axis=0), color=colour, alpha=0.15, linewidth=0)
        axes.plot(minutes, np.median(success, axis=0), color=colour, label=f"{target}, {len(seeds)} seeds")
    axes.axhline(80, color="0.6", linewidth=0.6, linestyle=":")
    axes.set(xlabel="processor time [min]", ylabel="success on other starts [%]", ylim=(-3, 103), xlim=(0, None))
    axes.legend(loc="lower right")
    figure.savefig(options.out, dpi=150)


if __name__ == "__main__":
    main()
