#!/usr/bin/env bash
# swcgeom 0.21.6: the volume of a straight vessel grows with the number of its centreline points.
#
# The vessel is an SWC tree: 10 mm long, radius 1 mm everywhere, n segments of equal length. `get_volume` documents its model: a
# sphere at each node, a frustum between two nodes. The union of these is a cylinder with two hemispherical ends, so one would
# expect 10 pi + 4 pi / 3 = 35.60 mm3, whatever n is. Half a percent would be no surprise.
#
# Seen: n = 1, 2, 5: 35.60. n = 10: 48.7. n = 20: 114.8. n = 40: 277.9. The value is right where the points
# are two radii apart (n = 5) and too large where they are one radius apart (n = 10) or less.
# Centrelines of vessels have points that are closer than a radius, so lumen or contrast volumes from them are many times too
# large, and finer sampling makes them larger.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/env"
"$folder/env/bin/pip" -q install --only-binary :all: swcgeom==0.21.6 sdflit==0.2.8 numpy==2.4.6

cat >"$folder/volume.py" <<'PY'
import math
import sys

from swcgeom import Tree
from swcgeom.analysis import get_volume

path = sys.argv[1] + "/vessel.swc"
expected = 10 * math.pi + 4 * math.pi / 3
ratios = {}
for segments in (1, 5, 10, 20, 40):
    with open(path, "w") as f:
        for i in range(segments + 1):
            f.write(f"{i + 1} 3 0 0 {10 * i / segments:.4f} 1 {i if i else -1}\n")
    tree = Tree.from_swc(path)
    assert abs(tree.length() - 10) < 1e-3
    volume = get_volume(tree)
    ratios[segments] = volume / expected
    print(f"{segments} segments: {volume:.2f} mm3, expected {expected:.2f}")
as_stated = abs(ratios[1] - 1) < 0.005 and abs(ratios[5] - 1) < 0.005
as_stated &= 1.3 < ratios[10] < 1.45 and 3 < ratios[20] < 3.5 and ratios[40] > 7
sys.exit(0 if as_stated else 1)
PY
"$folder/env/bin/python" "$folder/volume.py" "$folder"
