#!/usr/bin/env python3
"""Lets a measured guidewire go in a measured vessel: how far it ends from where it was. One row per frame and roll of the tip goes to a CSV.

    guide3d.py [--app build/seldinger] [--phantom ../shared/phantom/guide3d] [--csv bench/results/validation/guide3d.csv]
               [--rolls 4] [--only 0-bca-angle-4] [--keep FOLDER]

The phantom's folder is no part of this project; where it is absent the script says so and ends. Its README says what the shapes are worth:
the wall is known to 1.5 ... 2 mm, the wire to 0.2 ... 2 mm, stiffness, friction, forces and the roll of the tip are not known at all.
A wire that starts where it was measured is a check of equilibrium, not a prediction of the shape; nothing below 3 mm says anything.

Each wire begins where it was measured (beyond the 20 mm at the inlet that are not to be used), pushed into the lumen where the measured
points lie in the wall, and is let go without friction for 2.5 s of damped motion. Distances are from the measured points to the axis of the
simulated wire. Bending stiffness: 5e-4 N m^2; the angled wire 6e-5 over its last 3 cm, 2e-5 with 98 1/m over the last 12 mm, straight over the
last 3 mm; the straight wire 6e-5, since no more than its tip of 15 cm is inside. All are estimates. A straight tip has no roll.
"""
import json
import math
import pathlib
import statistics
import sys
import tempfile

import numpy as np

import runner

INLET_Y = 0.229        # [m] nearer to the inlet the shape is not to be used
RADIUS = 0.000445      # [m] of both wires
MARGIN = 0.0007        # [m] from the axis to the wall, at least, at the start
EDGE = 0.002           # [m]
TIP = 0.03             # [m] the part that is left out of the second mean
SHARES = (0.999, 0.99, 0.98, 0.97)  # of the measured length that the wire has: its edges are chords, and cut corners
TOO_LONG = "too long"
USABLE_MM = 3.0        # what the measurement can tell
COLUMNS = ["video", "frame", "roll_deg", "start_mean_mm", "mean_mm", "max_mm", "mean_without_tip_mm", "max_without_tip_mm", "wire_mm", "steps",
           "newton_mean", "newton_max", "halved_steps", "overlap_max_um", "moved", "exit"]


def closest_on_segments(p, a, b):
    d = b - a
    t = np.clip(np.sum((p - a) * d, axis=-1) / np.sum(d * d, axis=-1), 0, 1)
    return a + t[..., None] * d


class Wall:
    """The triangles of a binary STL, with the nearest point of the surface."""

    def __init__(self, path, unit):
        data = pathlib.Path(path).read_bytes()[84:]
        corners = unit * np.frombuffer(data, [("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])["corners"].astype(float)
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        size = np.linalg.norm(normal, axis=1)
        self.corners, self.normal = corners[size > 0], normal[size > 0] / size[size > 0, None]
        # normals into the lumen: a closed surface whose normals point out has a positive volume
        if np.sum(self.corners[:, 0] * np.cross(self.corners[:, 1], self.corners[:, 2])) > 0:
            self.normal = -self.normal
        self.next = np.roll(self.corners, -1, axis=1)  # the other end of the edge from each corner
        self.inward = np.cross(normal[size > 0, None], self.next - self.corners)

    def nearest(self, p):
        """The nearest point of the wall, and the distance from it: positive inside."""
        height = np.sum((p - self.corners[:, 0]) * self.normal, axis=1)
        at = p - height[:, None] * self.normal
        edges = closest_on_segments(p, self.corners, self.next)
        nearest = np.argmin(np.linalg.norm(p - edges, axis=2), axis=1)
        beside = np.any(np.sum(self.inward * (at[:, None] - self.corners), axis=2) < 0, axis=1)
        at[beside] = edges[np.arange(len(edges)), nearest][beside]
        d = np.linalg.norm(p - at, axis=1)
        # on a shared edge the side is told by the facet that looks most along the way there
        looks = np.divide(height, d, out=np.ones_like(d), where=d > 0)
        near = np.flatnonzero(d < d.min() + 1e-9)
        side = near[np.argmax(np.abs(looks[near]))]
        return at[side], math.copysign(d.min(), looks[side])


def pushed(p, wall):
    """The point at least MARGIN from the wall."""
    for _ in range(20):
        q, clearance = wall.nearest(p)
        if clearance >= MARGIN - 1e-6:
            break
        d = p - q if clearance > 0 else q - p
        p = q + MARGIN / np.linalg.norm(d) * d
    return p


def push_inside(points, wall):
    """Points that lie in the wall go inside, the way there evened out; of the shaft between them the engine takes care."""
    inside = np.array([pushed(p, wall) for p in points])
    different = np.any(inside != points, axis=1)
    moved = [i for i in range(1, len(points) - 1) if different[i - 1:i + 2].any()]
    for _ in range(10):
        even = [0.5 * (inside[i - 1] + inside[i + 1]) for i in moved]
        for i, p in zip(moved, even):
            inside[i] = pushed(0.5 * (inside[i] + p), wall)
    return inside


def polyline_length(points):
    return sum(math.dist(a, b) for a, b in zip(points, points[1:]))


def distance_to(points, p):
    points = np.array(points)
    return np.linalg.norm(p - closest_on_segments(p, points[:-1], points[1:]), axis=1).min()


def part_from_tip(points, length):
    """How many points at the end lie within `length` of the tip."""
    walked, count = 0.0, 1
    while count < len(points) and walked < length:
        walked += math.dist(points[-count], points[-count - 1])
        count += 1
    return count - 1


def section(length, bend, curvature=None):
    return {"from_tip_m": [0.0, length], "bend_nm2": bend, "twist_nm2": 0.77 * bend} | ({"rest_curvature_1_m": curvature} if curvature else {})


def scene_of(frame, placed, roll, gravity, mesh, share):
    length = share * polyline_length(placed)
    stiffness, tip = 6e-5, []  # no straight wire is longer than its tip
    if "angle" in frame["video"]:
        bend = [98 * math.cos(math.radians(roll)), 98 * math.sin(math.radians(roll))]
        stiffness, tip = 5e-4, [section(0.03, 6e-5), section(0.012, 2e-5, bend), section(0.003, 2e-5, [0.0, 0.0])]
    return runner.scene({
        "scene": {"name": f"{frame['video']} frame {frame['frame']}: the measured shape, let go", "gravity": [9.81 * x for x in gravity], "duration_s": 2.5,
                  "dt_s": 0.001, "record_every": 1},
        "wire": {"length_m": round(length, 6), "radius_m": RADIUS, "density": 5000.0, "bend_nm2": stiffness, "twist_nm2": 0.77 * stiffness, "stretch_n": 1e4,
                 "nodes": round(length / EDGE) + 1, "place": {"shape": "points", "points": [[round(c, 6) for c in p] for p in placed]}, "rest": "straight"},
        "wire.section": tip,
        "integrator": {"damping_mass_1_s": 20.0},
        "vessel": {"mesh": mesh, "units": "cm", "youngs_pa": 2.0e6, "poisson": 0.45, "thickness_m": 0.0015},
        "contact": {"detection": "swept", "friction": "none"},
        "hold": [runner.HELD], "output": runner.QUIET})


def let_go(app, text, folder):
    """Final axis, base to tip, the run's summary and its trace; None where the wire cannot be placed."""
    run = runner.run(app, text, folder, accept=None)
    if run.code == 2 and "beyond the wall" in run.said:
        return None
    if run.code == 2 and "is longer than" in run.said:
        return TOO_LONG
    if run.code not in (0, 4):  # 4: stopped, with the last good state
        sys.exit(f"{run.command}: exit {run.code}: {run.said}")
    axis = [(r["x_m"], r["y_m"], r["z_m"]) for r in reversed(run.rows("wire"))]
    return axis, run.summary, run.rows(), run.code


def row_of(frame, roll, measured, placed, axis, summary, trace, code):
    away, tip = [1e3 * distance_to(axis, p) for p in measured], part_from_tip(measured, TIP)
    newton = [row["newton"] for row in trace]
    start = statistics.mean(1e3 * distance_to(placed, p) for p in measured)
    return {"video": frame["video"], "frame": frame["frame"], "roll_deg": roll, "start_mean_mm": f"{start:.2f}",
            "mean_mm": f"{statistics.mean(away):.2f}", "max_mm": f"{max(away):.2f}",
            "mean_without_tip_mm": f"{statistics.mean(away[:-tip]):.2f}", "max_without_tip_mm": f"{max(away[:-tip]):.2f}",
            "wire_mm": f"{1e3 * polyline_length(placed):.1f}", "steps": summary["steps"], "newton_mean": f"{statistics.mean(newton):.2f}",
            "newton_max": summary["newton_max"], "halved_steps": summary["halved_steps"],
            "overlap_max_um": f"{1e6 * summary['overlap_max_m']:.1f}", "moved": int("start" in summary["model"]), "exit": code}


def distribution(name, values):
    values = sorted(values)
    under = sum(v < USABLE_MM for v in values)
    print(f"{name}: median {statistics.median(values):.2f} mm, mean {statistics.mean(values):.2f}, {values[0]:.2f} to {values[-1]:.2f}; "
          f"{under} of {len(values)} under {USABLE_MM:g} mm")


def main():
    parser = runner.parser(__doc__, "validation/guide3d.csv")
    parser.add_argument("--phantom", type=pathlib.Path, default="../shared/phantom/guide3d")
    parser.add_argument("--rolls", type=int, default=4)
    parser.add_argument("--only", default="", help="videos or video:frame whose name begins so")
    parser.add_argument("--keep", help="keeps the scenes and runs here")
    options = parser.parse_args()
    if not (options.phantom / "frames.json").is_file():
        print(f"skipped: {options.phantom} is absent (the phantom's measurements are no part of this project; --phantom says where they are)")
        return
    frames = json.loads((options.phantom / "frames.json").read_text())["frames"]
    states = json.loads((options.phantom / "registration.json").read_text())
    gravity = {state: entry["gravity_direction"] for state, entry in states.items() if isinstance(entry, dict) and "gravity_direction" in entry}
    mesh = str((options.phantom / "mesh.stl").resolve())
    wall = Wall(mesh, 0.01)
    best, without_tip, every = [], [], []
    table = runner.Table(options.csv, COLUMNS)
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(options.keep or scratch)
        for frame in frames:
            name = f"{frame['video']}:{frame['frame']}"
            if not name.startswith(options.only):
                continue
            measured = np.array([p for p in frame["points_m"] if p[1] <= INLET_Y])
            placed = push_inside(measured, wall)
            rolls = [360 * k // options.rolls for k in range(options.rolls)] if "angle" in frame["video"] else [0]
            rows = []
            for roll in rolls:
                for share in SHARES:
                    text = scene_of(frame, placed, roll, gravity["water" if frame["fluid"] else "air"], mesh, share)
                    run = let_go(options.app, text, folder / f"{frame['video']}-{frame['frame']}-{roll}")
                    if run != TOO_LONG:
                        break
                if run in (None, TOO_LONG):
                    break
                rows.append(row_of(frame, roll, measured, placed, *run))
                table.add(rows[-1], show=False)
                print(*(f"{k} {v}" for k, v in rows[-1].items()), sep="  ", flush=True)
            if not rows:
                print(f"{name}: not placed, measured too far beyond the wall", flush=True)
                continue
            every += [float(row["mean_mm"]) for row in rows]
            chosen = min(rows, key=lambda row: float(row["mean_mm"]))
            best.append(float(chosen["mean_mm"]))
            without_tip.append(float(chosen["mean_without_tip_mm"]))
    if best:
        distribution(f"{len(best)} frames, each at its best roll", best)
        distribution("the same without the last 3 cm", without_tip)
        distribution("all rolls", every)


if __name__ == "__main__":
    main()
