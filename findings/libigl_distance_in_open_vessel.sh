#!/usr/bin/env bash
# libigl 2.6.3 and point-cloud-utils 0.34.0: in a vessel with open ends, the signed distance is not the distance to the wall.
#
# The vessel is a tube of radius 1 mm and length 10 mm without caps, as a vessel mesh with open inlets is. By default both
# libraries take the sign from the winding number, which is meant for open meshes. One would expect the magnitude to be the
# distance to the nearest triangle (0.995 mm on the axis), and only the sign to depend on the winding number.
#
# Seen on the axis, 5, 1, 0.5 and 0.1 mm inside the opening: -0.957, -0.699, -0.441, -0.094 mm (libigl), the same within 0.01 mm
# for point-cloud-utils; libigl's own point_mesh_squared_distance gives 0.995 mm at all four. The distance is multiplied by
# 1 - 2 w with the winding number w. With caps the magnitude is right (-0.995 mm at 5 mm).
# A wire on the axis would be taken to be 0.44 mm from the wall, where it is 0.995 mm from it: a contact that is not there.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/env"
"$folder/env/bin/pip" -q install --only-binary :all: libigl==2.6.3 point-cloud-utils==0.34.0 numpy==2.4.6 scipy==1.17.1

cat >"$folder/distance.py" <<'PY'
import sys

import igl
import numpy as np
import point_cloud_utils as pcu

around, along = 32, 40
angle = 2 * np.pi * np.arange(around) / around
points = [[np.cos(a), np.sin(a), 10 * k / along] for k in range(along + 1) for a in angle]
wall = []
for k in range(along):
    for j in range(around):
        a, b = k * around + j, k * around + (j + 1) % around
        wall += [[a, b, b + around], [a, b + around, a + around]]
last = along * around
low, high = len(points), len(points) + 1
caps = [[low, (j + 1) % around, j] for j in range(around)]
caps += [[high, last + j, last + (j + 1) % around] for j in range(around)]
points, wall = np.array(points), np.array(wall)
closed_points, closed = np.vstack([points, [[0, 0, 0], [0, 0, 10]]]), np.vstack([wall, caps])

z = np.array([5, 1, 0.5, 0.1])
axis = np.c_[0 * z, 0 * z, z]
by_igl = np.asarray(igl.signed_distance(axis, points, wall)[0])
by_pcu = pcu.signed_distance_to_mesh(axis, points, wall)[0]
plain = np.sqrt(igl.point_mesh_squared_distance(axis, points, wall)[0])
capped = np.asarray(igl.signed_distance(axis[:1], closed_points, closed)[0])
print("z", z, "libigl", by_igl.round(3), "point-cloud-utils", by_pcu.round(3), "plain", plain.round(3), "capped", capped.round(3))
as_stated = np.allclose(by_igl, [-0.957, -0.699, -0.441, -0.094], atol=0.005) and np.allclose(by_pcu, by_igl, atol=0.01)
as_stated &= np.allclose(plain, 0.995, atol=0.002) and np.allclose(capped, -0.995, atol=0.002)
sys.exit(0 if as_stated else 1)
PY
"$folder/env/bin/python" "$folder/distance.py"
