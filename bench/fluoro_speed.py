#!/usr/bin/env python3
"""Fluoroscopic pictures a second at 30,000 and 3,000,000 triangles, ours (bench/fluoro_speed.cpp) and gVirtualXRay's (PyPI gvxr) in turn.

Ours: the demo with its wire moving from picture to picture, body, contrast that flows, ten energies, noise and blur, as 12-bit grey
levels; with the arm still and with an arm that turns, so that the vessel is traced in every picture. gVirtualXRay: the same lumen and
wire standing still, `plain` at one energy without noise and blur, its fastest, and `full` at ten energies with both. The fine vessel is
the coarse one with every triangle cut into a hundred: the pictures are the same. Every picture is computed in memory; rounds take turns.

Needs gvxr and numpy, scipy (pip), the system's Python with vtk, and Debian's libxcb-res0 libxcb-ewmh2 libxcb-composite0.

    cmake -S . -B build -DSELDINGER_BENCH=ON ... && ninja -C build fluoro_speed seldinger
    python3 bench/fluoro_speed.py [--build build] [--rounds 3] [--csv FILE] [--out DIR]
"""

import os
import pathlib
import shutil
import time

import numpy as np

import runner
from validate_xray import BLOOD, IODINE, STEEL, cap, make_view, read_vtp, tube_mesh

SIZE, FIELD, ANGLES = 1024, 0.4, "LAO 30"
FIRST, LAST = 300, 349
SCENE = """
include = ["{demo}"]
[scene]
duration_s = 10.0
[contrast]
keys = [ {{t_s = 0.0, iodine_mg_ml = 0.0}}, {{t_s = 0.5, iodine_mg_ml = 40.0}}, {{t_s = 20.0, iodine_mg_ml = 40.0}} ]
[output]
wire_every = 20
"""
WRITE_VTP = """
import sys, vtk, numpy as np
from vtk.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray
data = np.load(sys.argv[1])
points, cells, mesh = vtk.vtkPoints(), vtk.vtkCellArray(), vtk.vtkPolyData()
points.SetData(numpy_to_vtk(data["points"], deep=1))
cells.SetCells(len(data["polys"]), numpy_to_vtkIdTypeArray(np.c_[np.full(len(data["polys"]), 3), data["polys"]].astype(np.int64).ravel(), deep=1))
mesh.SetPoints(points); mesh.SetPolys(cells)
writer = vtk.vtkXMLPolyDataWriter()
writer.SetFileName(sys.argv[2]); writer.SetInputData(mesh); writer.SetDataModeToBinary(); writer.Write()
"""


def subdivided(points, polys, parts):
    """Every triangle cut into parts**2; corners that neighbours share are one."""
    i, j = np.array([(i, j) for i in range(parts + 1) for j in range(parts + 1 - i)]).T
    place = {(a, b): k for k, (a, b) in enumerate(zip(i, j))}
    pattern = [(place[a, b], place[a + 1, b], place[a, b + 1]) for a, b in place if a + b < parts]
    pattern += [(place[a + 1, b], place[a + 1, b + 1], place[a, b + 1]) for a, b in place if a + b < parts - 1]
    a, b, c = (points[polys[:, k]][:, None, :] for k in range(3))
    fine = a + (i / parts)[None, :, None] * (b - a) + (j / parts)[None, :, None] * (c - a)
    cells = (np.arange(len(polys)) * len(i))[:, None, None] + np.array(pattern)[None]
    _, first, number = np.unique(np.round(fine.reshape(-1, 3) * 1e10).astype(np.int64), axis=0, return_index=True, return_inverse=True)
    return fine.reshape(-1, 3)[first], number.ravel()[cells.reshape(-1, 3)]


def prepare(app, out):
    """The two run folders: same wire, coarse and fine vessel."""
    coarse, fine = out / "coarse", out / "fine"
    out.mkdir(parents=True, exist_ok=True)
    scene = out / "speed.toml"
    scene.write_text(SCENE.format(demo=pathlib.Path("assets/scenes/aortic-arch.toml").resolve()))
    if not (coarse / "wire.pvd").exists():
        runner.run(app, scene, coarse)
    if not (fine / "vessel.vtp").exists():
        shutil.copytree(coarse, fine)
        vessel = read_vtp(coarse / "vessel.vtp")
        points, polys = subdivided(vessel["points"], vessel["polys"].reshape(-1, 3), 10)
        np.savez(out / "fine.npz", points=points, polys=polys)
        runner.call(["/usr/bin/python3", "-c", WRITE_VTP, out / "fine.npz", fine / "vessel.vtp"])
    return coarse, fine


class Theirs:
    """gVirtualXRay's window with one of the vessels and the wire of the first picture."""

    def __init__(self, folder, full):
        from gvxrPython3 import gvxr

        self.gvxr = gvxr
        gvxr.createWindow(-1, 0, "EGL", 4, 5)
        vessel = read_vtp(folder / "vessel.vtp")
        wire = read_vtp(sorted(folder.glob("wire_*.vtp"))[FIRST])
        points, polys = cap(vessel["points"], vessel["polys"].reshape(-1, 3)[:, ::-1])
        _, _, up, source, detector = make_view(30, 0, 1.2, 0.8, 0.5 * (points.min(0) + points.max(0)), [1, 0, 0], [0, 0, -1])
        gvxr.setSourcePosition(*map(float, source * 1e3), "mm")
        gvxr.usePointSource()
        gvxr.setDetectorPosition(*map(float, detector * 1e3), "mm")
        gvxr.setDetectorUpVector(*map(float, up))
        gvxr.setDetectorNumberOfPixels(SIZE, SIZE)
        gvxr.setDetectorPixelSize(FIELD / SIZE * 1e3, FIELD / SIZE * 1e3, "mm")
        self.triangles = len(polys)
        for name, (p, t), mu in (("lumen", (points, polys), BLOOD + 40 * IODINE), ("wire", tube_mesh(wire["points"], wire["radius"]), STEEL)):
            gvxr.makeTriangularMesh(name, (p * 1e3).astype(float).ravel().tolist(), t.astype(int).ravel().tolist(), "mm")
            if full:  # materials that every energy has a coefficient of
                gvxr.setCompound(name, "H2O" if name == "lumen" else "Fe")
                gvxr.setDensity(name, 1.06 if name == "lumen" else 7.9, "g/cm3")
            else:
                gvxr.setLinearAttenuationCoefficient(name, mu / 100, "cm-1")
            (gvxr.addPolygonMeshAsOuterSurface if name == "lumen" else gvxr.addPolygonMeshAsInnerSurface)(name)
        if full:
            gvxr.resetBeamSpectrum()
            for energy in range(30, 75, 5)[:9]:
                gvxr.addEnergyBinToSpectrum(float(energy), "keV", 1e4)
            gvxr.addEnergyBinToSpectrum(72.0, "keV", 1e4)
            gvxr.enablePoissonNoise()
            gvxr.setLSF([0.24, 0.52, 0.24])
        else:
            gvxr.setMonoChromatic(60.0, "keV", 1)

    def measure(self, count):
        """Median and worst wall time, mean processor time of a picture [ms], after the first."""
        self.gvxr.computeXRayImage()
        wall, before = [], os.times()
        for _ in range(count):
            start = time.perf_counter()
            self.gvxr.computeXRayImage()
            wall.append(1e3 * (time.perf_counter() - start))
        after = os.times()
        return sorted(wall)[count // 2], max(wall), 1e3 * (after.user + after.system - before.user - before.system) / count


def theirs_in_child(folder, full, count):
    """A process of its own for each, so that none carries the other's scene along."""
    import multiprocessing

    def work(pipe):
        machine = Theirs(folder, full)
        pipe.send((machine.triangles, *machine.measure(count)))

    here, there = multiprocessing.Pipe()
    child = multiprocessing.get_context("fork").Process(target=work, args=(there,))
    child.start()
    there.close()
    try:
        return here.recv()
    finally:
        child.join()


def ours(program, folder, last, extra):
    size, frames, ready, median, worst, processor, digest = runner.call([program, folder, ANGLES, SIZE, FIRST, last, *extra]).stdout.strip().split(",")
    return float(median), float(worst), float(processor), digest


def main():
    parser = runner.parser(__doc__, "2-core-epyc/fluoroscopy.csv", app=False)
    parser.add_argument("--build", default="build")
    parser.add_argument("--out", default="out/fluoro-speed")
    parser.add_argument("--rounds", type=int, default=3)
    args = parser.parse_args()
    calls, triangles = {}, {}
    for folder in prepare(f"{args.build}/seldinger", pathlib.Path(args.out)):
        for what, extra in (("still arm", []), ("turning arm", ["turn"])):
            calls[f"{folder.name}, seldinger, {what}"] = lambda f=folder, e=extra: ours(f"{args.build}/bench/fluoro_speed", f, LAST, e)
        for what, full in (("plain", False), ("full", True)):
            def theirs(folder=folder, full=full):
                triangles[folder.name], *got = theirs_in_child(folder, full, 10 if folder.name == "coarse" else 3)
                return tuple(got)
            calls[f"{folder.name}, gVirtualXRay, {what}"] = theirs
    results = runner.in_turn(args.rounds, **calls)
    table = runner.Table(args.csv, ["triangles", "program", "picture", "size", "ms_median", "ms_worst", "processor_ms", "pictures_per_s"])
    for name, found in results.items():
        folder, program, what = name.split(", ")
        median, worst, processor, *_ = min(found)
        table.add([triangles[folder], program, what, SIZE, f"{median:.1f}", f"{worst:.1f}", f"{processor:.1f}", f"{1e3 / median:.1f}"])


if __name__ == "__main__":
    main()
