#!/usr/bin/env python3
"""Several instruments against independent solutions, each by `seldinger run`.

    validate_instruments.py [--app build/seldinger] [--reference ../shared/reference] [--csv bench/results/validation/instruments.csv]
                            [--only TEXT,TEXT] [--keep FOLDER] [--nodes 101]

overlap    two instruments that share an axis, in a plane and rotated: tips (arcs joined in closed form)
torsion    the same, free to twist: angles at the end of the overlap (Jacobi's elliptic functions)
dupont     Dupont's pair: curvature 10/m each, nu 0.3: angle at the tip for angles at the base, before and beyond the snap's length
crossing   two clamped wires, and two cantilevers, pressed across each other: force, deflection (extensible elastica)
support    a wire on two fixed wires, pressed down in its middle: deflection, force on each

Expected values are those of tests/coaxial/references.json, which the tests read too, and of 16_rod_rod.json of the reference folder. error is relative for forces and
deflections, of the length for tips, in degrees for angles.
"""
import json
import math
import pathlib
import sys
import tempfile

import numpy as np

import runner

COAXIAL = json.loads((runner.ROOT / "tests/coaxial/references.json").read_text())
STIFF = 1e3  # of what hardly twists, over what bends


class Runs:
    """Runs of scenes' texts: a run, or the last line of what it said where it failed."""

    def __init__(self, app, folder):
        self.scenes = runner.Scenes(app, folder, more=["--time-limit", "60"], accept=None)

    def __call__(self, name, text):
        run = self.scenes(name, text)
        return run if run.code == 0 else run.said.splitlines()[-1]


def force_sum(run):
    return sum(row["normal_n"] for row in run.rows("contacts"))


# ---- scenes -------------------------------------------------------------------------------------------------------------------


REST = {"scene": {"gravity": [0.0, 0.0, 0.0]}, "integrator": {"scheme": "static", "tolerance": 1e-8}}
SLOWLY = {"scene": {"gravity": [0.0, 0.0, 0.0], "dt_s": 0.02, "duration_s": 5.0}, "integrator": {"damping_mass_1_s": 20.0}}


def instrument(name, length, radius, bend, twist, stretch, nodes, **more):
    return {"name": name, "length_m": length, "radius_m": radius, "density": 1000.0, "bend_nm2": bend, "twist_nm2": twist, "stretch_n": stretch,
            "nodes": nodes, **more}


def coaxial_instrument(name, sections, twist_over_bend, radius, lumen, inserted, turn, inlet, nodes, slowly):
    """sections: [length, B, curvature] from the tip."""
    length, bend = sum(part[0] for part in sections), sections[-1][1]
    parts, at = [], 0.0
    for part, b, curvature in sections:
        parts.append({"from_tip_m": [at, min(length, at + part)], "bend_nm2": b, "twist_nm2": b * twist_over_bend, "rest_curvature_1_m": [curvature, 0.0]})
        at += part
    keys = [{"t_s": 0.0, "advance_m": inserted, "turn_rad": 0.0 if slowly else turn}, {"t_s": 4.0, "advance_m": inserted, "turn_rad": turn}]
    where = {"point": [0.0, 0.0, 0.0], "direction": [1.0, 0.0, 0.0]} if inlet else {}
    return runner.scene({
        "instrument": [instrument(name, length, radius, bend, bend * twist_over_bend, 1e6, max(3, round((nodes - 1) * length / inserted) + 1),
                                  lumen_radius_m=lumen)],
        "instrument.section": parts, "instrument.feed": {**where, "keys": keys}})


def coaxial(instruments, inserted, turn, twist_over_bend, nodes, slowly=False):
    """outer and inner, the inner's base turned by `turn` [rad] from the outer's; slowly: turned in four seconds, at rest in five, where several shapes are at rest."""
    return (runner.scene(SLOWLY if slowly else REST) +
            coaxial_instrument("outer", instruments[0], twist_over_bend[0], 0.001, 0.0007, inserted[0], 0.0, True, nodes, slowly) +
            coaxial_instrument("inner", instruments[1], twist_over_bend[1], 0.0005, 0.0, inserted[1], turn, False, nodes, slowly) +
            runner.scene({"coaxial": {"order": ["outer", "inner"], "model": "merged"}}))


def held_wire(name, wire, base, direction, ends, move, nodes=101):
    """The wire, and its holds."""
    b, ea, length, radius = wire[:4]
    moved = {"move": [[0.0, 0.0, 0.0, 0.0], [1.0, *move]]} if any(move) else {}
    return ([instrument(name, length, radius, b, b, ea, nodes, place={"base": base, "direction": direction})],
            [{"instrument": name, **runner.HELD, "at": end, **moved} for end in ends])


def touching(*parts):
    """Of wires with their holds."""
    return runner.scene(REST | {"instrument": sum((wires for wires, _ in parts), []), "hold": sum((holds for _, holds in parts), []),
                                "contact": {"instruments": True, "friction": "none", "stiffness": 1e9, "exponent": 1.0}})


# ---- cases --------------------------------------------------------------------------------------------------------------------


def rows_overlap(name, runs, nodes, tolerance):
    for row in COAXIAL[name]["rows"]:
        inserted, alpha = row["inserted"], row.get("alpha_deg", 0.0)
        run = runs("overlap", coaxial(COAXIAL[name]["instruments"], inserted, math.radians(alpha), (STIFF, STIFF), nodes))
        case = f"{name} {inserted[0]}/{inserted[1]}" + (f" {alpha:g} deg" if alpha else "")
        for who in ("outer", "inner"):
            yield case, f"tip of {who}", run, row[f"tip_{who}"], lambda r, w=who: plane(r.nodes(w)[0]), max(inserted), tolerance


def plane(point):
    """The run's axes as the reference has them: the outer's curvature towards +y (found by the sign of the first director)."""
    return np.array([point[0], SIGN * point[1], SIGN * point[2]]) if FIRST == "y" else np.array([point[0], SIGN * point[2], -SIGN * point[1]])


def error_of(got, expected, scale):
    got, expected = np.atleast_1d(got), np.atleast_1d(expected)
    return float(np.linalg.norm(got - expected) / scale)


FIRST, SIGN = "y", 1.0


def find_axes(runs):
    """To which side a natural curvature [k, 0] of a wire that enters along +x bends."""
    global FIRST, SIGN
    run = runs("axes", coaxial([[[0.04, 1e-4, 10.0]], [[0.04, 1e-5, 0.0]]], [0.03, 0.03], 0.0, (1, 1), 41))
    if isinstance(run, str):
        sys.exit(f"axes: {run}")
    tip = run.nodes("outer")[0]
    FIRST = "y" if abs(tip[1]) > abs(tip[2]) else "z"
    SIGN = math.copysign(1.0, tip[1] if FIRST == "y" else tip[2])


def rows_torsion(name, runs, nodes, tolerance):
    of, i = COAXIAL[name], COAXIAL["torsion"]
    outer = [[of["curved"], i["B1"], i["kappa1"]], [of["straight"] + 0.1, i["B1"], 0.0]]
    inner = [[of["beyond"] + of["curved"], i["B2"], i["kappa2"]], [of["straight"] + 0.1, i["B2"], 0.0]]
    inserted = [of["curved"] + of["straight"], of["curved"] + of["straight"] + of["beyond"]]
    for row in of["rows"]:
        run = runs("torsion", coaxial([outer, inner], inserted, math.radians(row["alpha_deg"]), (i["C1"] / i["B1"], i["C2"] / i["B2"]), nodes, of["snaps"]))
        for who in ("outer", "inner"):
            yield (f"{name} {row['alpha_deg']:g} deg", f"tip of {who}", run, row[f"tip_{who}"], lambda r, w=who: plane(r.nodes(w)[0]), max(inserted),
                   tolerance)


def rows_dupont(runs, nodes):
    for row in COAXIAL["lag"]["rows"]:
        length, base = row["overlap"], row["base_deg"]
        tube = [[length, 1e-3, 10.0], [0.05, 1e-3, 0.0]]
        run = runs("dupont", coaxial([tube, tube], [length, length], math.radians(base), (1 / 1.3, 1 / 1.3), nodes))
        yield f"dupont {1e3 * length:g} mm, base {base} deg", "angle at the tip", run, row["tip_deg"], relative_spin, 1.0, 2.0


def relative_spin(run):
    """[degrees] on the tip's edge."""
    return abs(math.degrees(run.columns("inner", "spin_rad")[0, 0] - run.columns("outer", "spin_rad")[0, 0]))


def rows_clamped(case, runs, tolerance):
    a, b = case["inputs"]["wire_a"], case["inputs"]["wire_b"]
    for expected in case["expected"]["table"]:
        one = held_wire("a", a, [-a[2] / 2, 0.0, 0.0], [1.0, 0.0, 0.0], ("base", "tip"), (0, 0, 0))
        two = held_wire("b", b, [0.0, -b[2] / 2, a[3] + b[3]], [0.0, 1.0, 0.0], ("base", "tip"), (0, 0, -expected["approach"]))
        run = runs("clamped", touching(one, two))
        name = f'crossing_clamped {1e3 * expected["approach"]:g} mm'
        yield name, "force", run, expected["contact_force"], force_sum, expected["contact_force"], tolerance
        yield (name, "deflection of a", run, expected["deflection_a"], lambda r: -r.nodes("a")[50, 2], a[2], 0.002)


def rows_cantilevers(case, runs, tolerance):
    a, b = case["inputs"]["wire_a"], case["inputs"]["wire_b"]
    for expected in case["expected"]["table"]:
        one = held_wire("a", a, [0.0, 0.0, 0.0], [1.0, 0.0, 0.0], ("base",), (0, 0, 0))
        two = held_wire("b", b, [a[4], -b[4], a[3] + b[3]], [0.0, 1.0, 0.0], ("base",), (0, 0, -expected["approach"]))
        run = runs("cantilevers", touching(one, two))
        name = f'crossing_cantilevers {1e3 * expected["approach"]:g} mm'
        yield name, "force", run, expected["contact_force"], force_sum, expected["contact_force"], tolerance


def rows_support(case, runs, tolerance):
    i = case["inputs"]
    z = i["r_wire"] + i["r_support"]
    for expected in case["expected"]["table"]:
        # its middle is moved and stays level: a wire that is free to slide and turn on frictionless supports falls between them
        wire, _ = held_wire("wire", [i["B"], i["EA"], i["L"], i["r_wire"]], [-i["L"] / 2, 0.0, z], [1.0, 0.0, 0.0], (), (0, 0, 0))
        middle = {"instrument": "wire", "at": i["L"] / 2, "position": True, "direction": True,
                  "move": [[0.0, 0.0, 0.0, 0.0], [1.0, 0.0, 0.0, -expected["midspan_deflection"]]]}
        supports = [held_wire(name, [0.1, 1e6, 0.02, i["r_support"]], [x, -0.01, 0.0], [0.0, 1.0, 0.0], ("base", "tip"), (0, 0, 0), 11)
                    for name, x in (("left", -i["half_span"]), ("right", i["half_span"]))]
        run = runs("support", touching((wire, []), *supports, ([], [middle])))
        name = f'three_point {expected["F"]:g} N'
        yield (name, "force on each", run, expected["contact_force_each"], lambda r: force_sum(r) / 2,
               expected["contact_force_each"], tolerance)


def all_rows(runs, reference, nodes):
    for name in ("j_wire_in_catheter", "rotated_rigid"):
        yield from rows_overlap(name, runs, nodes, 0.005)
    for name in ("torsion_short", "torsion_transmission", "torsion_snap"):
        yield from rows_torsion(name, runs, nodes, 0.005)
    yield from rows_dupont(runs, nodes)
    with open(reference / "16_rod_rod.json") as file:
        for case in json.load(file)["cases"]:
            rows = {"crossing_clamped": rows_clamped, "crossing_cantilevers": rows_cantilevers, "three_point": rows_support}.get(case["kind"])
            if rows:
                yield from rows(case, runs, 0.02)


def main():
    parser = runner.parser(__doc__, "validation/instruments.csv")
    parser.add_argument("--reference", type=pathlib.Path, default=runner.ROOT.parent / "shared/reference")
    parser.add_argument("--only")
    parser.add_argument("--keep")
    parser.add_argument("--nodes", type=int, default=101, help="over the outer instrument's inserted length")
    options = parser.parse_args()
    if not options.reference.is_dir():
        sys.exit(f"{options.reference}: not there; the expected values are read from it")
    runs = Runs(options.app, options.keep or tempfile.mkdtemp(prefix="instruments-"))
    find_axes(runs)
    bad, rows = 0, []
    for name, quantity, run, expected, read, scale, tolerance in all_rows(runs, options.reference, options.nodes):
        if options.only and not any(part in name for part in options.only.split(",")):
            continue
        got, error, within = "", run, "no"
        if not isinstance(run, str):
            got, off = read(run), error_of(read(run), expected, scale)
            got, error, within = np.round(got, 9), f"{off:.2e}", "yes" if off <= tolerance else "no"
        bad += within == "no"
        rows.append({"case": name, "quantity": quantity, "expected": np.round(expected, 9), "got": got, "error": error, "tolerance": tolerance, "within": within})
        print(*rows[-1].values(), sep="; ", flush=True)
    runner.write_rows(options.csv, rows)
    print(f"{len(rows)} rows, {bad} not within tolerance: {options.csv}")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
