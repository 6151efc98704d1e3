#!/usr/bin/env python3
"""An abdominal aorta with both renal arteries, from a formula: no patient, no licence. Needs python3-vtk9.

    make_renal.py renal.ply

Aorta: lumen radius 9 mm, 120 mm along z (to the head), a slight double bend. Renal arteries: radius 2.8 mm, 45 mm long, leaving at 70
degrees downwards from the axis to the left (+x) and, 8 mm lower, to the right; both bend to the back (+y). About 18,000 triangles, millimetres,
normals into the lumen, flat open ends.
"""
import math
import sys

import numpy as np
import vtk
from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy

STEP, FILLET = 0.8, 2.5  # [mm]


def aorta(u):
    z = -60 + 120 * u
    return np.array([2.5 * math.sin(math.pi * u * 2), 2.0 * math.sin(math.pi * u), z]), 9.0


def renal(side, height):
    down = math.radians(20)
    def at(u):
        s = 45 * u
        return np.array([side * s * math.cos(down), 14 * u * u, height - s * math.sin(down)]), 2.8 + 0.6 * (1 - u) ** 4
    return at


TUBES = [(aorta, 200), (renal(1, 12.0), 90), (renal(-1, 4.0), 90)]


def distance(points, tube, count):
    """To the wall of one tube: |p - axis| - radius, least over the axis' segments' ends and middles."""
    best = np.full(len(points), 1e9)
    for k in range(count + 1):
        centre, radius = tube(-0.08 + 1.16 * k / count if tube is aorta else 1.16 * k / count)
        best = np.minimum(best, np.linalg.norm(points - centre, axis=1) - radius)
    return best


def field(points):
    value = distance(points, *TUBES[0])
    for tube in TUBES[1:]:
        other = distance(points, *tube)
        value = np.minimum(value, other) - np.maximum(0, FILLET - np.abs(value - other)) ** 2 / (4 * FILLET)
    return value


def end(tube, u, back):
    point, _ = tube(u)
    before, _ = tube(u - back)
    return point, (point - before) / np.linalg.norm(point - before)


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    low, high = np.array([-54.0, -16.0, -66.0]), np.array([54.0, 28.0, 66.0])
    size = np.ceil((high - low) / STEP).astype(int) + 1
    grid = np.stack(np.meshgrid(*[low[k] + STEP * np.arange(size[k]) for k in range(3)], indexing="ij"), -1)
    values = field(grid.reshape(-1, 3)).reshape(size)
    image = vtk.vtkImageData()
    image.SetDimensions(*[int(n) for n in size])
    image.SetSpacing(STEP, STEP, STEP)
    image.SetOrigin(*low)
    image.GetPointData().SetScalars(numpy_to_vtk(values.ravel(order="F"), deep=True))
    surface = vtk.vtkFlyingEdges3D()
    surface.SetInputData(image)
    surface.SetValue(0, 0.0)
    port = surface
    for tube, u, back in [(aorta, 0.0, -0.02), (aorta, 1.0, 0.02), (TUBES[1][0], 1.0, 0.02), (TUBES[2][0], 1.0, 0.02)]:
        point, outward = end(tube, u, back)
        plane = vtk.vtkPlane()
        plane.SetOrigin(*point)
        plane.SetNormal(*(-outward))
        cut = vtk.vtkClipPolyData()
        cut.SetInputConnection(port.GetOutputPort())
        cut.SetClipFunction(plane)
        port = cut
    chain = [vtk.vtkCleanPolyData(), vtk.vtkTriangleFilter(), vtk.vtkWindowedSincPolyDataFilter(), vtk.vtkQuadricDecimation(),
             vtk.vtkPolyDataConnectivityFilter(), vtk.vtkCleanPolyData(), vtk.vtkPolyDataNormals()]
    chain[2].SetNumberOfIterations(20)
    chain[2].BoundarySmoothingOff()
    chain[3].SetTargetReduction(0.6)
    chain[4].SetExtractionModeToLargestRegion()
    chain[6].ConsistencyOn()
    chain[6].AutoOrientNormalsOff()
    chain[6].SplittingOff()
    for stage in chain:
        stage.SetInputConnection(port.GetOutputPort())
        port = stage
    port.Update()
    mesh = port.GetOutput()
    write(sys.argv[1], vtk_to_numpy(mesh.GetPoints().GetData()), vtk_to_numpy(mesh.GetPolys().GetData()).reshape(-1, 4)[:, 1:])


def write(path, points, faces):
    """Binary PLY; faces turned so that normals point into the lumen."""
    a, b, c = (points[faces[:, k]] for k in range(3))
    normal, middle = np.cross(b - a, c - a), (a + b + c) / 3
    gradient = field(middle + 1e-3 * normal / np.linalg.norm(normal, axis=1)[:, None]) - field(middle)
    if gradient.mean() > 0:
        faces = faces[:, ::-1]
    with open(path, "wb") as out:
        out.write((f"ply\nformat binary_little_endian 1.0\ncomment made by make_renal.py, millimetres\nelement vertex {len(points)}\n"
                   f"property float x\nproperty float y\nproperty float z\nelement face {len(faces)}\n"
                   f"property list uchar int vertex_indices\nend_header\n").encode())
        out.write(points.astype("<f4").tobytes())
        record = np.zeros(len(faces), dtype=[("n", "u1"), ("v", "<i4", 3)])
        record["n"], record["v"] = 3, faces
        out.write(record.tobytes())
    print(f"{path}: {len(points)} vertices, {len(faces)} triangles")


if __name__ == "__main__":
    main()
