#!/usr/bin/env python3
"""Several instruments against independent solutions, each by `seldinger run`.

    validate_instruments.py [--app build/seldinger] [--reference ../shared/reference] [--csv bench/results/validation/instruments.csv]
                            [--only TEXT,TEXT] [--keep FOLDER] [--nodes 101]

overlap    two instruments that share an axis, in a plane and rotated: tips (arcs joined in closed form)
torsion    the same, free to twist: angles at the end of the overlap (Jacobi's elliptic functions)
dupont     Dupont's pair: curvature 10/m each, nu 0.3: angle at the tip for angles at the base, before and beyond the snap's length
crossing   two clamped wires, and two cantilevers, pressed across each other: force, deflection (extensible elastica)
support    a wire on two fixed wires, pressed down in its middle: deflection, force on each

Expected values and tolerances are those of reference/15_coaxial.json and 16_rod_rod.json; Dupont's angles are repeated here. error is relative for forces and
deflections, of the length for tips, in degrees for angles.
"""
import argparse
import csv
import json
import math
import os
import subprocess
import sys
import tempfile

import numpy as np

DUPONT = {0.060: [(45, 36.733), (90, 76.851), (150, 142.002)], 0.120: [(45, 21.973), (90, 47.120), (150, 99.931)]}
STIFF = 1e3  # of what hardly twists, over what bends


class Run:
    def __init__(self, folder):
        with open(os.path.join(folder, "summary.json")) as file:
            self.summary = json.load(file)
        self.folder = folder

    def column(self, name, *columns):
        with open(os.path.join(self.folder, f"{name}.csv"), newline="") as file:
            return np.array([[float(row[k]) for k in columns] for row in csv.DictReader(file)])

    def nodes(self, name):
        return self.column(name, "x_m", "y_m", "z_m")

    def forces(self):
        with open(os.path.join(self.folder, "contacts.csv"), newline="") as file:
            return [(row["body_a"], row["body_b"], float(row["normal_n"])) for row in csv.DictReader(file)]


class Runner:
    def __init__(self, app, folder):
        self.app, self.folder, self.runs = os.path.abspath(app), folder, 0

    def __call__(self, name, text):
        self.runs += 1
        scene = os.path.join(self.folder, f"{name}-{self.runs}.toml")
        with open(scene, "w") as file:
            file.write(text)
        out = scene[:-5]
        done = subprocess.run(["timeout", "60", self.app, "run", scene, "-o", out, "--overwrite", "--quiet", "--time-limit", "120"], capture_output=True, text=True)
        if done.returncode != 0:
            return done.stderr.strip().splitlines()[-1]
        return Run(out)


# ---- scenes -------------------------------------------------------------------------------------------------------------------


def head(gravity=0.0):
    return f'[scene]\ngravity = [0.0, 0.0, {-gravity}]\n[integrator]\nscheme = "static"\ntolerance = 1e-8\n'


def coaxial_instrument(name, sections, twist_over_bend, radius, lumen, inserted, turn, inlet, nodes, slowly):
    """sections: [length, B, curvature] from the tip."""
    length = sum(part[0] for part in sections)
    bend = sections[-1][1]
    text = (f'[[instrument]]\nname = "{name}"\nlength_m = {length:.17g}\nradius_m = {radius}\nlumen_radius_m = {lumen}\ndensity = 1000.0\n'
            f'bend_nm2 = {bend}\ntwist_nm2 = {bend * twist_over_bend:.17g}\nstretch_n = 1e6\nnodes = {max(3, round((nodes - 1) * length / inserted) + 1)}\n')
    at = 0.0
    for part, b, curvature in sections:
        text += (f'[[instrument.section]]\nfrom_tip_m = [{at:.17g}, {min(length, at + part):.17g}]\nbend_nm2 = {b}\ntwist_nm2 = {b * twist_over_bend:.17g}\n'
                 f'rest_curvature_1_m = [{curvature:.17g}, 0.0]\n')
        at += part
    where = "point = [0.0, 0.0, 0.0]\ndirection = [1.0, 0.0, 0.0]\n" if inlet else ""
    return text + f"[instrument.feed]\n{where}keys = [ {{t_s = 0.0, advance_m = {inserted:.17g}, turn_rad = {0.0 if slowly else turn:.17g}}}, {{t_s = 4.0, advance_m = {inserted:.17g}, turn_rad = {turn:.17g}}} ]\n"


def coaxial(instruments, inserted, turn, twist_over_bend, nodes, slowly=False):
    """outer and inner, the inner's base turned by `turn` [rad] from the outer's; slowly: turned in four seconds, at rest in five, where several shapes are at rest."""
    text = head()
    if slowly:
        text = "[scene]\ngravity = [0.0, 0.0, 0.0]\ndt_s = 0.02\nduration_s = 5.0\n[integrator]\ndamping_mass_1_s = 20.0\n"
    text += coaxial_instrument("outer", instruments[0], twist_over_bend[0], 0.001, 0.0007, inserted[0], 0.0, True, nodes, slowly)
    text += coaxial_instrument("inner", instruments[1], twist_over_bend[1], 0.0005, 0.0, inserted[1], turn, False, nodes, slowly)
    return text + '[coaxial]\norder = ["outer", "inner"]\nmodel = "merged"\n'


def held_wire(name, wire, base, direction, ends, move, nodes=101):
    b, ea, length, radius = wire[:4]
    text = (f'[[instrument]]\nname = "{name}"\nlength_m = {length}\nradius_m = {radius}\ndensity = 1000.0\nbend_nm2 = {b}\ntwist_nm2 = {b}\n'
            f"stretch_n = {ea}\nnodes = {nodes}\nplace = {{base = {base}, direction = {direction}}}\n")
    holds = ""
    for end in ends:
        holds += f'[[hold]]\ninstrument = "{name}"\nat = "{end}"\nposition = true\ndirection = true\nspin = true\n'
        if any(move):
            holds += f"move = [[0.0, 0.0, 0.0, 0.0], [1.0, {move[0]}, {move[1]}, {move[2]}]]\n"
    return text, holds


def touching(stiffness=1e9):
    return f'[contact]\ninstruments = true\nfriction = "none"\nstiffness = {stiffness}\nexponent = 1.0\n'


# ---- cases --------------------------------------------------------------------------------------------------------------------


def rows_overlap(case, runner, nodes, tolerance):
    inputs = case["inputs"]
    for deployment in inputs["deployments"]:
        inserted = deployment["inserted"]
        for alpha in inputs.get("alpha_deg", [0.0]):
            expected = next(row for row in case["expected"]["table"]
                            if row["inserted [outer, inner]"] == inserted and row.get("alpha_deg", 0.0) == alpha)
            text = coaxial(inputs["instruments"], inserted, math.radians(alpha), (STIFF, STIFF), nodes)
            run = runner("overlap", text)
            name = f'{case["id"].split("/")[1]} {inserted[0]}/{inserted[1]}' + (f" {alpha:g} deg" if alpha else "")
            for who in ("outer", "inner"):
                yield name, f"tip of {who}", run, expected[f"tip_{who}"], lambda r, w=who: plane(r.nodes(w)[0]), max(inserted), tolerance


def plane(point):
    """The run's axes as the reference has them: the outer's curvature towards +y (found by the sign of the first director)."""
    return np.array([point[0], SIGN * point[1], SIGN * point[2]]) if FIRST == "y" else np.array([point[0], SIGN * point[2], -SIGN * point[1]])


def error_of(got, expected, scale):
    got, expected = np.atleast_1d(got), np.atleast_1d(expected)
    return float(np.linalg.norm(got - expected) / scale)


FIRST, SIGN = "y", 1.0


def find_axes(runner):
    """To which side a natural curvature [k, 0] of a wire that enters along +x bends."""
    global FIRST, SIGN
    run = runner("axes", coaxial([[[0.04, 1e-4, 10.0]], [[0.04, 1e-5, 0.0]]], [0.03, 0.03], 0.0, (1, 1), 41))
    if isinstance(run, str):
        sys.exit(f"axes: {run}")
    tip = run.nodes("outer")[0]
    FIRST = "y" if abs(tip[1]) > abs(tip[2]) else "z"
    SIGN = math.copysign(1.0, tip[1] if FIRST == "y" else tip[2])


def rows_torsion(case, runner, nodes, tolerance):
    i = case["inputs"]
    outer = [[i["L"], i["B1"], i["kappa1"]], [i["L0"] + 0.1, i["B1"], 0.0]]
    inner = [[i["L_inner_beyond"] + i["L"], i["B2"], i["kappa2"]], [i["L0"] + 0.1, i["B2"], 0.0]]
    inserted = [i["L"] + i["L0"], i["L"] + i["L0"] + i["L_inner_beyond"]]
    for expected in case["expected"]["table"]:
        text = coaxial([outer, inner], inserted, math.radians(expected["alpha_deg"]), (i["C1"] / i["B1"], i["C2"] / i["B2"]), nodes, case["expected"]["snaps"])
        run = runner("torsion", text)
        name = f'{case["id"].split("/")[1]} {expected["alpha_deg"]:g} deg'
        yield name, "tip of outer", run, expected["tip_outer"], lambda r: plane(r.nodes("outer")[0]), max(inserted), tolerance
        yield name, "tip of inner", run, expected["tip_inner"], lambda r: plane(r.nodes("inner")[0]), max(inserted), tolerance


def rows_dupont(runner, nodes):
    for length, pairs in DUPONT.items():
        for base, tip in pairs:
            tube = [[length, 1e-3, 10.0], [0.05, 1e-3, 0.0]]
            run = runner("dupont", coaxial([tube, tube], [length, length], math.radians(base), (1 / 1.3, 1 / 1.3), nodes))
            yield f"dupont {1e3 * length:g} mm, base {base} deg", "angle at the tip", run, tip, relative_spin, 1.0, 2.0


def relative_spin(run):
    """[degrees] on the tip's edge."""
    return abs(math.degrees(run.column("inner", "spin_rad")[0, 0] - run.column("outer", "spin_rad")[0, 0]))


def rows_clamped(case, runner, tolerance):
    a, b = case["inputs"]["wire_a"], case["inputs"]["wire_b"]
    for expected in case["expected"]["table"]:
        one, hold_one = held_wire("a", a, [-a[2] / 2, 0.0, 0.0], [1.0, 0.0, 0.0], ("base", "tip"), (0, 0, 0))
        two, hold_two = held_wire("b", b, [0.0, -b[2] / 2, a[3] + b[3]], [0.0, 1.0, 0.0], ("base", "tip"), (0, 0, -expected["approach"]))
        run = runner("clamped", head() + one + two + touching() + hold_one + hold_two)
        name = f'crossing_clamped {1e3 * expected["approach"]:g} mm'
        yield name, "force", run, expected["contact_force"], lambda r: sum(f[2] for f in r.forces()), expected["contact_force"], tolerance
        yield (name, "deflection of a", run, expected["deflection_a"], lambda r: -r.nodes("a")[50, 2], a[2], 0.002)


def rows_cantilevers(case, runner, tolerance):
    a, b = case["inputs"]["wire_a"], case["inputs"]["wire_b"]
    for expected in case["expected"]["table"]:
        one, hold_one = held_wire("a", a, [0.0, 0.0, 0.0], [1.0, 0.0, 0.0], ("base",), (0, 0, 0))
        two, hold_two = held_wire("b", b, [a[4], -b[4], a[3] + b[3]], [0.0, 1.0, 0.0], ("base",), (0, 0, -expected["approach"]))
        run = runner("cantilevers", head() + one + two + touching() + hold_one + hold_two)
        name = f'crossing_cantilevers {1e3 * expected["approach"]:g} mm'
        yield name, "force", run, expected["contact_force"], lambda r: sum(f[2] for f in r.forces()), expected["contact_force"], tolerance


def rows_support(case, runner, tolerance):
    i = case["inputs"]
    z = i["r_wire"] + i["r_support"]
    for expected in case["expected"]["table"]:
        text = head() + touching()
        wire, _ = held_wire("wire", [i["B"], i["EA"], i["L"], i["r_wire"]], [-i["L"] / 2, 0.0, z], [1.0, 0.0, 0.0], (), (0, 0, 0))
        text += wire
        holds = ""
        for name, x in (("left", -i["half_span"]), ("right", i["half_span"])):
            support, hold = held_wire(name, [0.1, 1e6, 0.02, i["r_support"]], [x, -0.01, 0.0], [0.0, 1.0, 0.0], ("base", "tip"), (0, 0, 0), 11)
            text, holds = text + support, holds + hold
        # its middle is moved and stays level: a wire that is free to slide and turn on frictionless supports falls between them
        text += holds + f'[[hold]]\ninstrument = "wire"\nat = {i["L"] / 2}\nposition = true\ndirection = true\n'
        text += f'move = [[0.0, 0.0, 0.0, 0.0], [1.0, 0.0, 0.0, {-expected["midspan_deflection"]}]]\n'
        run = runner("support", text)
        name = f'three_point {expected["F"]:g} N'
        yield (name, "force on each", run, expected["contact_force_each"], lambda r: sum(f[2] for f in r.forces()) / 2,
               expected["contact_force_each"], tolerance)


def all_rows(runner, reference, nodes):
    with open(os.path.join(reference, "15_coaxial.json")) as file:
        for case in json.load(file)["cases"]:
            if case["kind"] in ("planar_overlap", "rotated_rigid"):
                yield from rows_overlap(case, runner, nodes, 0.005)
            if case["kind"] == "torsion":
                yield from rows_torsion(case, runner, nodes, 0.005)
    yield from rows_dupont(runner, nodes)
    with open(os.path.join(reference, "16_rod_rod.json")) as file:
        for case in json.load(file)["cases"]:
            rows = {"crossing_clamped": rows_clamped, "crossing_cantilevers": rows_cantilevers, "three_point": rows_support}.get(case["kind"])
            if rows:
                yield from rows(case, runner, 0.02)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--app", default="build/seldinger")
    parser.add_argument("--reference", default="../shared/reference")
    parser.add_argument("--csv", default="bench/results/validation/instruments.csv")
    parser.add_argument("--only")
    parser.add_argument("--keep")
    parser.add_argument("--nodes", type=int, default=101, help="over the outer instrument's inserted length")
    options = parser.parse_args()
    if not os.path.isdir(options.reference):
        sys.exit(f"{options.reference}: not there; the expected values are read from it")
    folder = options.keep or tempfile.mkdtemp(prefix="instruments-")
    os.makedirs(folder, exist_ok=True)
    runner = Runner(options.app, folder)
    find_axes(runner)
    bad = 0
    table = [["case", "quantity", "expected", "got", "error", "tolerance", "within"]]
    for name, quantity, run, expected, read, scale, tolerance in all_rows(runner, options.reference, options.nodes):
        if options.only and not any(part in name for part in options.only.split(",")):
            continue
        if isinstance(run, str):
            table.append([name, quantity, np.round(expected, 9), "", run, tolerance, "no"])
        else:
            got = read(run)
            error = error_of(got, expected, scale)
            table.append([name, quantity, np.round(expected, 9), np.round(got, 9), f"{error:.2e}", tolerance, "yes" if error <= tolerance else "no"])
        bad += table[-1][-1] == "no"
        print(*table[-1], sep="; ", flush=True)
    os.makedirs(os.path.dirname(options.csv) or ".", exist_ok=True)
    with open(options.csv, "w", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows(table)
    print(f"{len(table) - 1} rows, {bad} not within tolerance: {options.csv}")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
