#!/usr/bin/env python3
"""Puts pictures of one run side by side, their empty margins cut away, with the legend of the last one in the cell after it.

    film_strip.py out/iliac/frame_000009.png ... -o strip.png [--columns 3] [--scale 0.5]

For pictures that one call of `seldinger render --frames A:B` made, wider than high: they share camera and scales, and their legend is on
the right (engine/pictures/view/legend.cpp, lay_out_sheet). The legend is not scaled down, so that it can be read.
"""
import argparse
import sys

import numpy
from PIL import Image


def read(path):
    try:
        return numpy.asarray(Image.open(path).convert("RGB"))
    except OSError as error:
        sys.exit(f"film_strip.py: {path}: {error}; give pictures that `seldinger render` wrote")


def drawn(main):
    """Where something is drawn: the background depends on the row alone."""
    off = (abs(main.astype(int) - numpy.median(main, axis=1, keepdims=True)).max(axis=2) > 12)
    rows, columns = numpy.flatnonzero(off.any(axis=1)), numpy.flatnonzero(off.any(axis=0))
    return rows.min(), rows.max() + 1, columns.min(), columns.max() + 1


def main():
    options = argparse.ArgumentParser(description="pictures of one run side by side, with one legend")
    options.add_argument("pictures", nargs="+")
    options.add_argument("-o", dest="out", required=True, help="PNG to write")
    options.add_argument("--columns", type=int, default=3)
    options.add_argument("--scale", type=float, default=0.5, help="of the pictures; the legend stays as it is")
    asked = options.parse_args()
    sheets = [read(path) for path in asked.pictures]
    height, width, _ = sheets[0].shape
    if any(sheet.shape != sheets[0].shape for sheet in sheets) or width < 1.15 * height:
        sys.exit("film_strip.py: pictures of one size are needed, wider than high by 1.15 or more (seldinger render --size)")
    panel = round(290 * min(height / 720, width / 1000))
    mains = [sheet[:, : width - panel] for sheet in sheets]
    boxes = numpy.array([drawn(main) for main in mains])
    pad = round(0.02 * height)
    top, left = max(boxes[:, 0].min() - pad, 0), max(boxes[:, 2].min() - pad, 0)
    bottom, right = min(boxes[:, 1].max() + pad, height), min(boxes[:, 3].max() + pad, width - panel)
    size = (round((right - left) * asked.scale), round((bottom - top) * asked.scale))
    cells = [Image.fromarray(main[top:bottom, left:right]).resize(size, Image.LANCZOS) for main in mains]
    columns = min(asked.columns, len(cells) + 1)
    rows = -(-(len(cells) + 1) // columns)
    legend = Image.fromarray(sheets[-1][:, width - panel :])
    wide = max(size[0], panel)
    sheet = Image.new("RGB", (size[0] * (columns - 1) + wide, size[1] * rows), (255, 255, 255))
    for k, cell in enumerate(cells):
        sheet.paste(cell, (k % columns * size[0], k // columns * size[1]))
    legend = legend.crop((0, 0, panel, min(height, size[1])))
    place = (len(cells) % columns * size[0], len(cells) // columns * size[1])
    sheet.paste(legend.crop((panel - 1, 0, panel, legend.height)).resize((wide, size[1])), place)  # the ground, edge to edge
    sheet.paste(legend, place)
    sheet.save(asked.out, optimize=True)


if __name__ == "__main__":
    main()
