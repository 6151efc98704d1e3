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
import argparse
import csv
import json
import math
import os
import statistics
import struct
import subprocess
import sys
import tempfile

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


def minus(a, b):
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def along(p, s, d):
    return (p[0] + s * d[0], p[1] + s * d[1], p[2] + s * d[2])


def closest_on_segment(p, a, b):
    d = minus(b, a)
    t = dot(minus(p, a), d) / dot(d, d)
    return along(a, min(1.0, max(0.0, t)), d)


class Wall:
    """The triangles of a binary STL, with the nearest point of the surface."""

    def __init__(self, path, unit):
        with open(path, "rb") as file:
            data = file.read()
        count = struct.unpack_from("<I", data, 80)[0]
        self.facets = []
        for k in range(count):
            v = [unit * x for x in struct.unpack_from("<9f", data, 84 + 50 * k + 12)]
            corners = [tuple(v[3 * i:3 * i + 3]) for i in range(3)]
            normal = cross(minus(corners[1], corners[0]), minus(corners[2], corners[0]))
            size = math.sqrt(dot(normal, normal))
            if size == 0:
                continue
            centre = tuple(sum(c[i] for c in corners) / 3 for i in range(3))
            reach = max(math.dist(centre, c) for c in corners)
            self.facets.append((centre, reach, corners, tuple(x / size for x in normal)))
        # normals into the lumen: a closed surface whose normals point out has a positive volume
        volume = sum(dot(c[0], cross(c[1], c[2])) for _, _, c, _ in self.facets)
        if volume > 0:
            self.facets = [(centre, reach, c, (-n[0], -n[1], -n[2])) for centre, reach, c, n in self.facets]

    def nearest(self, p):
        """The nearest point of the wall, and the distance from it: positive inside."""
        best, at, side = math.inf, None, -math.inf
        for centre, reach, (a, b, c), normal in self.facets:
            if math.dist(p, centre) - reach > best + 1e-9:
                continue
            height = dot(minus(p, a), normal)
            q = along(p, -height, normal)
            if any(dot(cross(minus(v, u), minus(q, u)), cross(minus(b, a), minus(c, a))) < 0 for u, v in ((a, b), (b, c), (c, a))):
                q = min((closest_on_segment(p, u, v) for u, v in ((a, b), (b, c), (c, a))), key=lambda x: math.dist(p, x))
            d = math.dist(p, q)
            # on a shared edge the side is told by the facet that looks most along the way there
            looks = height / d if d > 0 else 1.0
            if d < best - 1e-9 or (d < best + 1e-9 and abs(looks) > abs(side)):
                best, at, side = min(best, d), q, looks
        return at, math.copysign(best, side)


def pushed(p, wall):
    """The point at least MARGIN from the wall."""
    for _ in range(20):
        q, clearance = wall.nearest(p)
        if clearance >= MARGIN - 1e-6:
            break
        d = minus(p, q) if clearance > 0 else minus(q, p)
        p = along(q, MARGIN / math.sqrt(dot(d, d)), d)
    return p


def push_inside(points, wall):
    """Points that lie in the wall go inside, the way there evened out; of the shaft between them the engine takes care."""
    inside = [pushed(p, wall) for p in points]
    moved = [i for i in range(1, len(points) - 1) if any(inside[k] != points[k] for k in (i - 1, i, i + 1))]
    for _ in range(10):
        even = {i: along(inside[i - 1], 0.5, minus(inside[i + 1], inside[i - 1])) for i in moved}
        for i, p in even.items():
            inside[i] = pushed(along(inside[i], 0.5, minus(p, inside[i])), wall)
    return inside


def polyline_length(points):
    return sum(math.dist(a, b) for a, b in zip(points, points[1:]))


def distance_to(points, p):
    return min(math.dist(p, closest_on_segment(p, a, b)) for a, b in zip(points, points[1:]))


def part_from_tip(points, length):
    """How many points at the end lie within `length` of the tip."""
    walked, count = 0.0, 1
    while count < len(points) and walked < length:
        walked += math.dist(points[-count], points[-count - 1])
        count += 1
    return count - 1


def section(length, bend, curvature=None):
    text = f"\n[[wire.section]]\nfrom_tip_m = [0.0, {length}]\nbend_nm2 = {bend}\ntwist_nm2 = {0.77 * bend}\n"
    return text + (f"rest_curvature_1_m = [{curvature[0]:.3f}, {curvature[1]:.3f}]\n" if curvature else "")


def scene_of(frame, placed, roll, gravity, mesh, share):
    length = share * polyline_length(placed)
    points = ", ".join(f"[{p[0]:.6f}, {p[1]:.6f}, {p[2]:.6f}]" for p in placed)
    if "angle" in frame["video"]:
        bend = (98 * math.cos(math.radians(roll)), 98 * math.sin(math.radians(roll)))
        tip = section(0.03, 6e-5) + section(0.012, 2e-5, bend) + section(0.003, 2e-5, (0, 0))
        stiffness = 5e-4
    else:
        tip, stiffness = "", 6e-5  # no wire is longer than its tip
    g = ", ".join(f"{9.81 * x:.4f}" for x in gravity)
    return f"""# {frame['video']} frame {frame['frame']}: the measured shape, let go
[scene]
name = "guide3d"
gravity = [{g}]
duration_s = 2.5
dt_s = 0.001
record_every = 1

[wire]
length_m = {length:.6f}
radius_m = {RADIUS}
density = 5000.0
bend_nm2 = {stiffness}
twist_nm2 = {0.77 * stiffness}
stretch_n = 1e4
nodes = {round(length / EDGE) + 1}
place = {{ shape = "points", points = [{points}] }}
rest = "straight"
{tip}
[integrator]
damping_mass_1_s = 20.0

[vessel]
mesh = "{mesh}"
units = "cm"
youngs_pa = 2.0e6
poisson = 0.45
thickness_m = 0.0015

[contact]
detection = "swept"
friction = "none"

[[hold]]
at = "base"
position = true
direction = true
spin = true

[output]
wire_every = 0
contacts_every = 0
"""


def let_go(app, text, folder):
    """Final axis, base to tip, the run's summary and its trace; None where the wire cannot be placed."""
    scene, out = os.path.join(folder, "scene.toml"), os.path.join(folder, "run")
    with open(scene, "w") as file:
        file.write(text)
    done = subprocess.run([app, "run", scene, "-o", out, "--overwrite", "--quiet"], capture_output=True, text=True)
    if done.returncode == 2 and "beyond the wall" in done.stderr:
        return None
    if done.returncode == 2 and "is longer than" in done.stderr:
        return TOO_LONG
    if done.returncode not in (0, 4):  # 4: stopped, with the last good state
        sys.exit(f"{scene}: exit {done.returncode}: {done.stderr.strip()}")
    tables = {}
    for name in ("wire", "trace"):
        with open(os.path.join(out, f"{name}.csv"), newline="") as file:
            tables[name] = [{k: float(v) for k, v in row.items()} for row in csv.DictReader(file)]
    with open(os.path.join(out, "summary.json")) as file:
        summary = json.load(file)
    axis = [(r["x_m"], r["y_m"], r["z_m"]) for r in reversed(tables["wire"])]
    return axis, summary, tables["trace"], done.returncode


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
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--app", default="build/seldinger")
    parser.add_argument("--phantom", default="../shared/phantom/guide3d")
    parser.add_argument("--csv", default="bench/results/validation/guide3d.csv")
    parser.add_argument("--rolls", type=int, default=4)
    parser.add_argument("--only", default="", help="videos or video:frame whose name begins so")
    parser.add_argument("--keep", help="writes the scenes here, too")
    options = parser.parse_args()
    if not os.path.isfile(os.path.join(options.phantom, "frames.json")):
        print(f"skipped: {options.phantom} is absent (the phantom's measurements are no part of this project; --phantom says where they are)")
        return
    with open(os.path.join(options.phantom, "frames.json")) as file:
        frames = json.load(file)["frames"]
    with open(os.path.join(options.phantom, "registration.json")) as file:
        gravity = {state: entry["gravity_direction"] for state, entry in json.load(file).items() if isinstance(entry, dict) and "gravity_direction" in entry}
    mesh = os.path.abspath(os.path.join(options.phantom, "mesh.stl"))
    wall = Wall(mesh, 0.01)
    os.makedirs(os.path.dirname(options.csv) or ".", exist_ok=True)
    best, without_tip, every = [], [], []
    with open(options.csv, "w", newline="") as file, tempfile.TemporaryDirectory() as folder:
        table = csv.DictWriter(file, COLUMNS)
        table.writeheader()
        for frame in frames:
            name = f"{frame['video']}:{frame['frame']}"
            if not name.startswith(options.only):
                continue
            measured = [tuple(p) for p in frame["points_m"] if p[1] <= INLET_Y]
            placed = push_inside(measured, wall)
            rolls = [360 * k // options.rolls for k in range(options.rolls)] if "angle" in frame["video"] else [0]
            rows = []
            for roll in rolls:
                for share in SHARES:
                    text = scene_of(frame, placed, roll, gravity["water" if frame["fluid"] else "air"], mesh, share)
                    run = let_go(options.app, text, folder)
                    if run != TOO_LONG:
                        break
                if options.keep:
                    os.makedirs(options.keep, exist_ok=True)
                    with open(os.path.join(options.keep, f"{frame['video']}-{frame['frame']}-{roll}.toml"), "w") as scene:
                        scene.write(text)
                if run in (None, TOO_LONG):
                    break
                rows.append(row_of(frame, roll, measured, placed, *run))
                table.writerow(rows[-1])
                file.flush()
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
