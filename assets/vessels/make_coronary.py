#!/usr/bin/env python3
"""A tortuous vessel of coronary size, open at both ends, from a formula: no patient, no licence, the same bits everywhere.

    make_coronary.py coronary.ply

Axis: straight for 8 mm along x, then two sine waves at right angles whose amplitudes grow from zero over the first wave; tightest
bend 7 mm. Lumen radius 1.75 mm, tapering to 0.9 mm. Binary PLY in millimetres, normals into the lumen.
"""
import math
import struct
import sys

LEAD, LENGTH = 8.0, 78.0          # [mm] along x
RINGS, AROUND = 110, 22
RADIUS_IN, RADIUS_OUT = 1.75, 0.9  # [mm]


def smooth(u):
    u = min(max(u, 0.0), 1.0)
    return u * u * u * (10 - 15 * u + 6 * u * u)


def axis(x):
    t = max(x - LEAD, 0.0)
    grow = smooth(t / 30.0)
    return [x, 4.0 * grow * math.sin(2 * math.pi * t / 33.0), 3.5 * grow * math.sin(2 * math.pi * t / 47.0)]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def unit(a):
    norm = math.sqrt(sum(v * v for v in a))
    return [v / norm for v in a]


def rings():
    side = [0.0, 0.0, 1.0]
    for k in range(RINGS + 1):
        x = LENGTH * k / RINGS
        ahead, behind = axis(x + 1e-4), axis(x - 1e-4)
        tangent = unit([a - b for a, b in zip(ahead, behind)])
        along = sum(s * t for s, t in zip(side, tangent))
        side = unit([s - along * t for s, t in zip(side, tangent)])  # carried along without twist
        other = cross(tangent, side)
        radius = RADIUS_IN + (RADIUS_OUT - RADIUS_IN) * smooth((x - LEAD) / (LENGTH - LEAD))
        centre = axis(x)
        for j in range(AROUND):
            a = 2 * math.pi * (j + 0.5 * (k % 2)) / AROUND
            yield [c + radius * (math.cos(a) * s + math.sin(a) * o) for c, s, o in zip(centre, side, other)]


def triangles():
    for k in range(RINGS):
        for j in range(AROUND):
            a, b = k * AROUND + j, k * AROUND + (j + 1) % AROUND
            c, d = a + AROUND, b + AROUND
            # rings are turned by half a step against each other, so that triangles are near to isosceles
            if k % 2 == 0:
                yield a, c, b
                yield b, c, d
            else:
                yield a, c, d
                yield a, d, b


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    points, faces = list(rings()), list(triangles())
    with open(sys.argv[1], "wb") as out:
        out.write((f"ply\nformat binary_little_endian 1.0\ncomment made by make_coronary.py, millimetres\n"
                   f"element vertex {len(points)}\nproperty float x\nproperty float y\nproperty float z\n"
                   f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n").encode())
        for p in points:
            out.write(struct.pack("<3f", *p))
        for f in faces:
            out.write(struct.pack("<B3i", 3, *f))


if __name__ == "__main__":
    main()
