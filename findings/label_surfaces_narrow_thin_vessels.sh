#!/usr/bin/env bash
# pyvista 0.49.1 (VTK 9.7.2) and PyMCubes 0.1.6: smoothed surfaces of one label map differ, and thin vessels become narrow.
#
# The label map is a straight vessel. Its reference radius is that of the circle with the area of its voxels in a cross section.
# Surfaces: pyvista's `contour_labels` (smoothing is on by default), PyMCubes' `smooth` with "constrained" and with "gaussian",
# both with their defaults and marching cubes at 0. One would expect the mean radius within 5 % for vessels of 3 voxels across or
# more, and some smoothing of the steps.
#
# Seen, mean radius of the surface, in voxels:
#   reference   contour_labels   constrained   gaussian
#     1.69        1.01 (-41 %)    1.47 (-13 %)   no surface
#     2.03        1.69 (-17 %)    1.93  (-5 %)   no surface
#     3.04        2.77  (-9 %)    2.93  (-4 %)   no surface
#     3.95        3.74  (-5 %)    3.87  (-2 %)   2.01 (-49 %)
# Without smoothing, contour_labels gives 1.74 for the first. A vessel of 3 mm in voxels of 1 mm becomes too narrow for
# instruments that fit, or disappears, depending on the library that made its surface.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/env"
"$folder/env/bin/pip" -q install --only-binary :all: pyvista==0.49.1 vtk==9.7.2 PyMCubes==0.1.6 numpy==2.4.6 scipy==1.17.1

cat >"$folder/surfaces.py" <<'PY'
import sys

import mcubes
import numpy as np
import pyvista as pv


def mean_radius(mesh):
    if mesh.n_points == 0:
        return None
    ring = mesh.slice("x", origin=(24.3, 0, 0)).points
    away = ring - ring.mean(0)
    return float(np.hypot(away[:, 1], away[:, 2]).mean())


def by_mcubes(labels, method):
    points, triangles = mcubes.marching_cubes(mcubes.smooth(labels, method=method), 0)
    return pv.PolyData() if len(triangles) == 0 else pv.PolyData.from_regular_faces(points, triangles.astype(int))


rows = {1.5: (1.007, 1.47, None), 2: (1.692, 1.928, None), 3: (2.769, 2.928, None), 4: (3.741, 3.873, 2.006)}
as_stated = True
for radius, expected in rows.items():
    half = int(np.ceil(radius)) + 3
    y = np.arange(-half, half + 1)
    labels = np.zeros((48, y.size, y.size), np.uint8)
    labels[4:-4] = y[:, None] ** 2 + y**2 <= radius**2
    reference = np.sqrt(labels[20].sum() / np.pi)
    image = pv.ImageData(dimensions=labels.shape)
    image["labels"] = labels.flatten(order="F")
    plain = mean_radius(image.contour_labels(scalars="labels", smoothing=False).triangulate())
    seen = [mean_radius(image.contour_labels(scalars="labels").triangulate())]
    seen += [mean_radius(by_mcubes(labels, method)) for method in ("constrained", "gaussian")]
    words = ", ".join("no surface" if r is None else f"{r:.2f}" for r in seen)
    print(f"reference {reference:.2f}, not smoothed {plain:.2f}, smoothed: {words}")
    as_stated &= abs(plain / reference - 1) < 0.03
    for got, wanted in zip(seen, expected):
        as_stated &= got is None if wanted is None else got is not None and abs(got - wanted) < 0.03
sys.exit(0 if as_stated else 1)
PY
"$folder/env/bin/python" "$folder/surfaces.py"
