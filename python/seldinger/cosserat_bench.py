"""Adapter for cosseratbench 0.3: `pip install cosseratbench seldinger; cosseratbench run --solver seldinger`.

A scenario becomes a scene: an instrument for each rod, holds for its ends, a vessel for its obstacle. Every node starts where
the scenario has it: it is held there in the settling at t = 0, and let go at the first step.
"""

from __future__ import annotations

import math
import tempfile
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from cosseratbench.scenario import Cylinder, End, EndCondition, Plane, Rod, Scenario
from cosseratbench.solver import Capability, Diverged
from cosseratbench.trajectory import Trajectory

import seldinger

_STEP_OF_SWING = 0.01  # a step of a dynamic scenario times the slowest frequency: the period is off by its square/12, 1e-5
_STEP_TO_REST = 0.05   # the same where the equilibrium alone counts, in steps of first order
_STEP_OF_FALL = 0.1    # with contact: a step in units of the time in which a rod falls by its radius
_WIDEST = 2.99         # a vessel of a scene may be 3 m across
_SAG = 0.01            # most distance of a cylinder's facets from it, in radii of the thinnest rod


def _steps(scenario: Scenario, n_frames: int, scale: float) -> tuple[float, int]:
    """The time step [s], and the number of steps of a frame."""
    interval = scenario.duration / (n_frames - 1)
    most = (_STEP_TO_REST if scenario.quasi_static else _STEP_OF_SWING) / scenario.slowest_frequency()
    gravity = float(np.linalg.norm(scenario.gravity))
    if gravity > 0 and (scenario.obstacles or _rods_touch(scenario)):
        most = min(most, _STEP_OF_FALL * math.sqrt(min(rod.radius for rod in scenario.rods) / gravity))
    count = math.ceil(interval / (scale * most))
    return interval / count, count


def _rods_touch(scenario: Scenario) -> bool:
    return scenario.self_contact or len(scenario.rods) > 1


def _damping(scenario: Scenario) -> float:
    """Critical for the slowest mode [1/s]."""
    return 2.0 * scenario.slowest_frequency() if scenario.quasi_static else 0.0


def _friction(scenario: Scenario) -> list[float]:
    """Coefficient of each rod, against whatever it touches: a scene has one for each."""
    walls = {float(obstacle.friction) for obstacle in scenario.obstacles}
    own = {float(rod.friction) for rod in scenario.rods}
    if len(walls) > 1 or (_rods_touch(scenario) and (len(own) > 1 or any(mu > min(own) for mu in walls))):
        raise NotImplementedError("friction that differs between what a rod touches: Seldinger has one coefficient a rod")
    return [max(float(rod.friction), *walls) if walls else float(rod.friction) for rod in scenario.rods]


def _held_end(rod: Rod, end: End, nodes: np.ndarray) -> dict[str, Any] | None:
    """The [[hold]] of an end; None where it is free."""
    condition, motion = rod.condition(end), rod.motion(end)
    if condition is EndCondition.FREE:
        return None
    clamped = condition is EndCondition.CLAMPED
    hold: dict[str, Any] = {"at": "base" if end is End.START else "tip", "position": True, "direction": clamped, "spin": clamped}
    if motion is None:
        return hold
    displacement, rotation = np.asarray(motion.displacement, float), np.asarray(motion.rotation, float)
    if motion.slides_along is not None:
        along = np.abs(motion.axis)
        if along.max() < 1 - 1e-9:
            raise NotImplementedError("a clamp that slides along a direction other than x, y or z")
        hold["position"] = [axis for axis, part in zip("xyz", along) if part < 0.5]
        displacement = np.where(along > 0.5, 0.0, displacement)
    tangent = nodes[1] - nodes[0] if end is End.START else nodes[-1] - nodes[-2]
    tangent = tangent / np.linalg.norm(tangent)
    turn = rotation @ tangent
    if np.linalg.norm(rotation - np.outer(turn, tangent), axis=1).max() > 1e-3 * max(np.abs(turn).max(), 1e-9):
        raise NotImplementedError("a clamp that tilts: Seldinger's clamps turn about the rod's own axis")
    if displacement.any():
        hold["move"] = np.column_stack([motion.times, displacement])
    if turn.any():
        hold["turn"] = np.column_stack([motion.times, turn])
    return hold


def _facets(cylinder: Cylinder, rods: tuple[Rod, ...]) -> tuple[int, int]:
    """Facets around a cylinder and along it: near enough to it, and about as long as wide."""
    around = max(16, math.ceil(math.pi / math.acos(1 - _SAG * min(rod.radius for rod in rods) / cylinder.radius)))
    return around, max(1, round(cylinder.length / (2 * math.pi * cylinder.radius / around)))


def _across(axis: np.ndarray) -> np.ndarray:
    across = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
    return across / np.linalg.norm(across)


def _outer_middle(scenario: Scenario) -> np.ndarray:
    """Middle of the wall around all, with the rods near its upper end: what falls has the rest."""
    points = np.concatenate([np.asarray(rod.centerline) for rod in scenario.rods])
    down = np.asarray(scenario.gravity) / max(float(np.linalg.norm(scenario.gravity)), 1e-300)
    return (points.min(0) + points.max(0)) / 2 + down * (_WIDEST - float(np.ptp(points, axis=0).max())) * 0.4


def _cylinder_mesh(cylinder: Cylinder, around: int, along: int) -> tuple[np.ndarray, np.ndarray]:
    """Vertices and triangles of its closed surface. Facets lie as far outside at their edges as inside in their middle."""
    axis = cylinder.unit_axis
    u = _across(axis)
    radius = 2 * cylinder.radius / (1 + math.cos(math.pi / around))
    angle = 2 * np.pi * np.arange(around) / around
    ring = radius * (np.outer(np.cos(angle), u) + np.outer(np.sin(angle), np.cross(axis, u)))
    heights = cylinder.length * (np.arange(along + 1) / along - 0.5)
    ends = [np.asarray(cylinder.center) + h * axis for h in heights[[0, -1]]]
    vertices = np.concatenate([ring + np.asarray(cylinder.center) + h * axis for h in heights] + [np.array(ends)])
    i, j = np.arange(around), (np.arange(around) + 1) % around
    low, high = len(vertices) - 2, len(vertices) - 1
    triangles = [np.column_stack([np.full(around, low), j, i]),
                 np.column_stack([np.full(around, high), along * around + i, along * around + j])]
    for k in range(along):
        a, b = k * around, (k + 1) * around
        triangles += [np.column_stack([a + i, a + j, b + j]), np.column_stack([a + i, b + j, b + i])]
    return vertices, np.concatenate(triangles)


def _vessel(scenario: Scenario, folder: Path) -> dict[str, Any]:
    """The [vessel] of the obstacle. A cylinder is an obstacle within a wall as wide as a vessel may be."""
    if len(scenario.obstacles) > 1:
        raise NotImplementedError("several obstacles: Seldinger has one vessel in a scene")
    obstacle = scenario.obstacles[0]
    points = np.concatenate([np.asarray(rod.centerline) for rod in scenario.rods])
    middle = (points.min(0) + points.max(0)) / 2
    if isinstance(obstacle, Plane):
        normal = obstacle.unit_normal
        size = 10 * max([float(np.ptp(points, axis=0).max()), *(rod.length for rod in scenario.rods)])
        return {"shape": "plane", "size_m": size, "origin": middle - normal * (normal @ (middle - np.asarray(obstacle.point))),
                "normal": normal, "triangles": 2}
    facets, axis, middle = _facets(obstacle, scenario.rods), obstacle.unit_axis, np.asarray(obstacle.center)
    surface = replace(obstacle, center=tuple(_outer_middle(scenario)), radius=_WIDEST / 2, length=_WIDEST)
    lines, offset = [], 1
    for vertices, triangles in (_cylinder_mesh(surface, *facets), _cylinder_mesh(obstacle, *facets)):
        lines += ["v {!r} {!r} {!r}".format(*map(float, v)) for v in vertices]
        lines += ["f {} {} {}".format(*(t + offset)) for t in triangles]
        offset += len(vertices)
    (folder / "obstacle.obj").write_text("\n".join(lines) + "\n")
    # a vessel has an axis with the distance to the wall: a half turn about the cylinder
    beside, angle = min(0.09, obstacle.radius), np.linspace(0, np.pi, 17)[:, None]
    line = middle + (obstacle.radius + beside) * _about(axis, _across(axis), angle)
    (folder / "axis.vtk").write_text("\n".join([
        "# vtk DataFile Version 3.0", "axis", "ASCII", "DATASET POLYDATA", "POINTS 17 double",
        *("{!r} {!r} {!r}".format(*map(float, p)) for p in line), "LINES 1 18", "17 " + " ".join(map(str, range(17))),
        "POINT_DATA 17", "SCALARS Radius double 1", "LOOKUP_TABLE default", *[repr(beside)] * 17]) + "\n")
    return {"mesh": str(folder / "obstacle.obj"), "units": "m", "centreline": str(folder / "axis.vtk"), "centreline_units": "m"}


def _rod_tables(scenario: Scenario, k: int, n_elements: int, dt: float) -> tuple[dict, list[dict], list[dict]]:
    """[[instrument]], [[hold]] and [[load]] of rod k; its first point is the base."""
    rod, name = scenario.rods[k], f"rod{k}"
    nodes, material = rod.nodes(n_elements), rod.material
    instrument = {
        "name": name, "length_m": rod.length, "nodes": n_elements + 1, "radius_m": rod.radius, "density": material.density,
        "bend_nm2": material.youngs_modulus * rod.second_moment_of_area,
        "twist_nm2": material.shear_modulus * 2 * rod.second_moment_of_area,
        "stretch_n": material.youngs_modulus * rod.area,
        "mu_static": _friction(scenario)[k], "mu_sliding": _friction(scenario)[k],
        "place": {"shape": "points", "stretch": "as-placed", "points": nodes},
    }
    ends = {0: _held_end(rod, End.START, nodes), n_elements: _held_end(rod, End.END, nodes)}
    # the scene shares out the length of the points evenly: by how much the start of each node differs from that
    arc = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(nodes, axis=0), axis=1))])
    even = np.linspace(0.0, arc[-1], n_elements + 1)
    shift = nodes - np.stack([np.interp(even, arc, nodes[:, c]) for c in range(3)], axis=1)
    holds = []
    for i in range(n_elements + 1):
        end = ends.get(i)
        free = [axis for axis in "xyz" if end is None or (end["position"] is not True and axis not in end["position"])]
        at = "base" if i == 0 else "tip" if i == n_elements else rod.length * (1 - i / n_elements)
        if end is not None:
            holds.append(end)
        if free:
            holds.append({"at": at, "position": True if len(free) == 3 else free, "until_s": 1e-3 * dt,
                          "move": [[0.0, *(s if axis in free else 0.0 for s, axis in zip(shift[i], "xyz"))]]})
    loads = [{"at": "base" if load.at is End.START else "tip", "force_n": load.force} for load in rod.loads]
    return instrument, [{"instrument": name, **hold} for hold in holds], [{"instrument": name, **load} for load in loads]


def _about(axis: np.ndarray, v: np.ndarray, angle: np.ndarray) -> np.ndarray:
    """v turned about the unit vectors `axis`, to which it is perpendicular."""
    return np.cos(angle) * v + np.sin(angle) * np.cross(axis, v)


class _Frames:
    """Nodes and directors of one rod. The scene's first director is another material line than the scenario's: the angle between
    them, found at the start, stays."""

    def __init__(self, rod: Rod, n_elements: int, output: seldinger.InstrumentOutput) -> None:
        self.angle = np.zeros(n_elements)
        self.positions: list[np.ndarray] = []
        self.directors: list[np.ndarray] = []
        nodes, tangents, found = self._read(output)
        wanted = rod.directors(n_elements)
        self.angle = np.arctan2((np.cross(found, wanted) * tangents).sum(1), (found * wanted).sum(1))
        self.take(output)

    def _read(self, output: seldinger.InstrumentOutput) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        nodes = output.nodes[::-1].copy()
        tangents = np.diff(nodes, axis=0)
        tangents /= np.linalg.norm(tangents, axis=1, keepdims=True)
        d = output.director[-2::-1]
        d = d - (d * tangents).sum(1)[:, None] * tangents
        return nodes, tangents, _about(tangents, d / np.linalg.norm(d, axis=1)[:, None], self.angle[:, None])

    def take(self, output: seldinger.InstrumentOutput) -> None:
        nodes, _, directors = self._read(output)
        self.positions.append(nodes)
        self.directors.append(directors)


class SeldingerSolver:
    """Seldinger's rods stretch, bend and twist; their cross-sections stay at right angles to the axis, so they do not shear."""

    name = "seldinger"
    backend_version = seldinger.__version__
    capabilities = frozenset({Capability.STRETCH, Capability.ROD_CONTACT, Capability.ROD_FRICTION, Capability.CYLINDER_CONTACT,
                              Capability.PLANE_CONTACT})

    def __init__(self, time_step_scale: float = 1.0) -> None:
        self.time_step_scale = float(time_step_scale)

    def settings(self, scenario: Scenario, *, n_elements: int, n_frames: int) -> dict[str, Any]:
        """The numerical choices for a scenario."""
        cylinders = [_facets(o, scenario.rods) for o in scenario.obstacles if isinstance(o, Cylinder)]
        return {
            "integrator": "backward Euler" if scenario.quasi_static else "energy-momentum",
            "time_step": _steps(scenario, n_frames, self.time_step_scale)[0],
            "damping_rate": _damping(scenario),
            **({"cylinder_triangles": sum(2 * around * (along + 1) for around, along in cylinders)} if cylinders else {}),
        }

    def run(self, scenario: Scenario, *, n_elements: int, n_frames: int) -> Trajectory:
        dt, steps = _steps(scenario, n_frames, self.time_step_scale)
        tables = [_rod_tables(scenario, k, n_elements, dt) for k in range(len(scenario.rods))]
        scene: dict[str, Any] = {
            "scene": {"gravity": scenario.gravity, "duration_s": scenario.duration, "dt_s": dt},
            "integrator": {"damping_mass_1_s": _damping(scenario)} if scenario.quasi_static else {"conserve": True},
            "contact": {"instruments": _rods_touch(scenario)},
            "instrument": [instrument for instrument, _, _ in tables],
            "hold": [hold for _, holds, _ in tables for hold in holds],
            "load": [load for _, _, loads in tables for load in loads],
        }
        with tempfile.TemporaryDirectory() as folder:
            if scenario.obstacles:
                scene["vessel"] = _vessel(scenario, Path(folder))
            world = seldinger.World(scene)
        outer = _outer_middle(scenario) if any(isinstance(o, Cylinder) for o in scenario.obstacles) else None
        with world:
            if world.settle().failed:
                raise Diverged("no start: the rods cannot be held where the scenario has them", time=0.0)
            rods = [_Frames(rod, n_elements, own) for rod, own in zip(scenario.rods, world.output.instruments)]
            for _ in range(n_frames - 1):
                report = world.step(n=steps)
                if report.failed:
                    raise Diverged(f"step {world.output.step}: {report.message}", time=world.time)
                for rod, own in zip(rods, world.output.instruments):
                    rod.take(own)
                if outer is None:
                    continue
                if max(np.linalg.norm(rod.positions[-1] - outer, axis=1).max() for rod in rods) > 0.49 * _WIDEST:
                    raise NotImplementedError(f"a rod that falls for {world.time:.2g} s: a vessel may be 3 m across")
        return Trajectory(np.linspace(0.0, scenario.duration, n_frames), tuple(np.stack(rod.positions) for rod in rods),
                          tuple(np.stack(rod.directors) for rod in rods))
