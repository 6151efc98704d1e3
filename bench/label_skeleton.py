#!/usr/bin/env python3
"""How far the skeleton of labels' masks is from their centreline_px, by scikit-image, in pixels.

    python3 bench/label_skeleton.py LABELS [--instrument K]

LABELS is a folder of `render --labels`; K the number of the instrument in the masks (default: the last, which is the innermost). Needs
numpy, scikit-image (with scipy) and Pillow. Three measures, each as mean, 95 % and worst:

- thinned: each pixel of skimage.morphology.skeletonize to the nearest point of the centreline. It has whole pixels only.
- middle: the same from the middles of the mask's runs of pixels across the instrument (along rows where it is steep, else columns).
- reached: each point of the centreline to the nearest pixel of the thinned skeleton; half the step between two pixels is in it.

Left out: a width and a pixel around both ends and around the border (a flat end's corners make spurs), and places where another part
of the line, in a loop or a sharp bend, is so near that their masks run together.
"""

import argparse
import json
import pathlib

import numpy as np
from PIL import Image
from scipy.spatial import KDTree
from skimage.morphology import skeletonize


def resample(line, step=0.1):
    s = np.r_[0, np.cumsum(np.hypot(*np.diff(line, axis=0).T))]
    at = np.linspace(0, s[-1], max(2, int(s[-1] / step) + 1))
    return np.c_[np.interp(at, s, line[:, 0]), np.interp(at, s, line[:, 1])], at


def nearest(points, others):
    """Index and distance of the nearest of `others`."""
    distance, index = KDTree(others).query(points)
    return index, distance


def run_middles(on, longest):
    """[n, 2] column, row of the middles of runs along the rows of `on`, without those of more pixels: they cross two parts of a bend."""
    edge = np.diff(np.pad(on.astype(int), ((0, 0), (1, 1))), axis=1)
    (row, first), (_, after) = np.nonzero(edge == 1), np.nonzero(edge == -1)
    return np.c_[(first + after - 1) / 2, row][after - first <= longest]


def lonely(line, at, reach):
    """Whether no other part of the line, which comes back in a bend or a crossing, is within reach of each point."""
    some, along = line[::5], at[::5]
    near = KDTree(some).query_ball_point(line, reach)
    return np.array([np.all(np.abs(along[k] - at[i]) <= 1.5 * np.maximum(1, np.hypot(*(some[k] - line[i]).T))) for i, k in enumerate(near)])


def measure(file, number):
    labels = json.loads(file.read_text())
    instrument = labels["instruments"][number - 1]
    if not instrument["centreline_px"]:
        return None
    mask = np.asarray(Image.open(file.with_name(file.stem + "_mask.png"))) == number
    line, at = resample(np.array(instrument["centreline_px"]))
    p, middle = np.array(labels["camera"]["projection"]), np.array([*np.mean(instrument["centreline_m"], 0), 1])
    width = 2 * instrument["radius_m"] * np.linalg.norm(p[0, :3]) / (p[2] @ middle)
    away = width + 1
    inside = np.all((line > away) & (line < np.array(mask.shape[::-1]) - 1 - away), axis=1)
    use = inside & (at > away) & (at < at[-1] - away) & lonely(line, at, width + 1.5)

    def kept(points):
        index, distance = nearest(points, line)
        return index[use[index]], distance[use[index]]

    rows, columns = np.nonzero(skeletonize(mask))
    skeleton = np.c_[columns, rows]
    if not len(skeleton) or not use.any():
        return None
    middles = []
    direction = np.abs(np.gradient(line, axis=0))
    longest = np.sqrt(2) * width + 1  # at 45 degrees
    for points, steep in ((run_middles(mask, longest), 1), (run_middles(mask.T, longest)[:, ::-1], 0)):
        index, distance = kept(points)
        middles.append(distance[direction[index, steep] >= direction[index, 1 - steep]])
    return width, kept(skeleton)[1], np.concatenate(middles), nearest(line[use], skeleton)[1]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("labels", type=pathlib.Path)
    parser.add_argument("--instrument", type=int)
    options = parser.parse_args()
    files = [f for f in sorted(options.labels.glob("*.json")) if f.with_name(f.stem + "_mask.png").exists()]
    if not files:
        raise SystemExit(f"{options.labels}: no labels in it; expected the folder of `seldinger render --labels`")
    number = options.instrument or len(json.loads(files[0].read_text())["instruments"])
    measured = [m for m in (measure(f, number) for f in files) if m]
    if not measured:
        raise SystemExit(f"{options.labels}: instrument {number} is in none of the pictures")
    print(f"{len(measured)} pictures, instrument {number}, {np.mean([m[0] for m in measured]):.2f} pixels wide")
    for k, name in enumerate(("thinned", "middle", "reached"), 1):
        d = np.concatenate([m[k] for m in measured])
        print(f"{name}: {len(d)} points, mean {d.mean():.2f}, 95 % {np.percentile(d, 95):.2f}, worst {d.max():.2f}, within half a pixel {np.mean(d <= 0.5):.3f}")


if __name__ == "__main__":
    main()
