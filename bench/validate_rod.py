#!/usr/bin/env python3
"""Runs the rod's reference scenes at several node counts and writes expected, got, error and order of convergence.

    bench/validate_rod.py [--app build/seldinger] [--only TEXT] [--csv bench/results/validation/rod.csv]

Scenes and expected values: assets/scenes/reference (expected.json). Order in space: slope of log(error) against log(edge length) by
least squares over the edge counts (`order_edges` where given); below `floor` of the expected value the reference's own digits, stretch and rounding take over.
A threshold is measured from below: what a small load across does grows as a + b/(1 - x^pole/critical^pole), x = 0.90, 0.95 and 0.98 of the
expected one [Southwell32]; and it is bracketed: at 0.97 the wire stays, at 1.03 it leaves. Order in time: the swing's tip against a
trapezoid of 4,096 steps.
"""
import json
import math
import sys

import numpy as np

import runner

FOLDER = runner.ROOT / "assets" / "scenes" / "reference"
EDGES = [25, 50, 100, 200]
FLOOR = 1e-7
BELOW = (0.90, 0.95, 0.98)  # of the threshold


def frequency(result, mode, expected):
    """Peak of the windowed spectrum of the tip's motion near the expected frequency [Hz], freed of the trapezoid's own error."""
    trace = result.trace()
    t, z = trace["time_s"], trace["tip_z_m"]
    step = t[1] - t[0]
    windowed = (z - z.mean()) * np.hanning(len(z))
    omega = 2 * np.pi * expected * np.linspace(0.9, 1.1, 41)
    power = lambda w: abs(np.sum(windowed * np.exp(-1j * w * t)))
    for _ in range(8):  # narrows to 1e-7 of the frequency
        best = omega[np.argmax([power(w) for w in omega])]
        width = (omega[-1] - omega[0]) / 10
        omega = np.linspace(best - width / 2, best + width / 2, 11)
    return 2 / step * math.tan(best * step / 2) / (2 * np.pi)


def steepest(result):
    """Largest angle between the wire and the line of its ends [rad], between the edges by a parabola. An edge is its arc's mean tangent, which
    cuts the corner of a helix: the tangent in its middle is the mean less t'' h^2/24."""
    edges = np.diff(result.nodes(), axis=0)
    line = result.nodes()[-1] - result.nodes()[0]
    edges /= np.linalg.norm(edges, axis=1)[:, None]
    edges[1:-1] -= np.diff(edges, 2, axis=0) / 24
    angle = np.arccos(np.clip(edges @ line / np.linalg.norm(edges, axis=1) / np.linalg.norm(line), -1, 1))
    i = int(np.clip(np.argmax(angle), 1, len(angle) - 2))
    a, b, c = angle[i - 1:i + 2]
    return b + (a - c)**2 / (8 * (2 * b - a - c))


def measure(result, quantity, expected):
    tip = result.nodes()[0]
    if quantity == "tip":
        return tip
    if quantity == "tip_z":
        return tip[2]
    if quantity == "sag_over_span":
        return -tip[2] / tip[0]
    if quantity == "torque":
        return abs(result.summary["hand_torque_nm"])
    if quantity == "pull":
        return abs(result.summary["base_force_n"][0])
    if quantity == "steepest":
        return steepest(result)
    if quantity == "lag":
        return math.degrees(result.trace("wire")["spin_rad"][0])
    if quantity.startswith("frequency_"):
        return frequency(result, int(quantity[-1]), expected)
    raise ValueError(quantity)


def off_straight(result, scene):
    """How far the wire is from the line of its ends, or the ring from its plane [m]; the ring's tilt about its hold is none of it."""
    wire = result.trace("wire")
    if scene == "ring.toml":
        s, z = wire["s_m"], wire["z_m"]
        at = lambda part: np.interp(part * s[-1], s, z)
        return abs(at(0.5) - at(0.25) - at(0.75))
    return float(np.hypot(wire["y_m"], wire["z_m"]).max())


def threshold(run, case, settings):
    """Measured threshold over the expected one; and whether the wire stays at 0.97 and leaves at 1.03 of it."""
    vary = case["vary"]

    def at(part):
        result = run(case["scene"], {**settings, vary["key"]: vary["form"].format(repr(part * vary["critical"]))})
        return off_straight(result, case["scene"]), abs(result.summary["hand_torque_nm"])

    x, w = np.array(BELOW)**case["pole"], np.array([at(part)[0] for part in BELOW])
    critical = np.linalg.solve(np.column_stack([w, x, -np.ones(3)]), w * x)[0]**(1 / case["pole"])
    (off_below, torque_below), (off_above, torque_above) = at(0.97), at(1.03)
    leaves = off_above > 10 * off_below or torque_above < torque_below  # a ring may come to rest flat again, less two turns
    return critical, leaves


def snap(run, case, settings):
    """Angle of the base at which the tip whips round, to half a degree, by bisection [deg]; the base goes there in steps of 45 degrees."""
    low, high = 180.0, 315.0
    while high - low > 1:
        middle = (low + high) / 2
        result = run(case["scene"], {**settings, "hold.0.turn": [[0, 0], [1, math.radians(middle)]]})
        low, high = (low, middle) if measure(result, "lag", 0) > 180 else (middle, high)
    return (low + high) / 2


def order_of(edges, errors, scale):
    """Slope of log(error) against log(1/edges), or none where fewer than three errors are above the floor."""
    kept = [(n, e) for n, e in zip(edges, errors) if e > FLOOR * scale]
    if len(kept) < 3:
        return None
    n, e = np.log(np.array(kept)).T
    return -float(np.polyfit(n, e, 1)[0])


def text_of(value):
    return " ".join(f"{v:.8g}" for v in np.atleast_1d(value))


def run_case(run, case):
    """One row of the table per edge count."""
    edges = case.get("edges", EDGES)
    expected = np.array(case["expected"], dtype=float)
    scale = float(np.linalg.norm(expected))
    allowed = case.get("absolute", scale * case.get("relative", 0))
    got, errors, leaves = [], [], True
    counts = edges + case.get("order_edges", [])
    for n in counts:
        settings = {"wire.nodes": n + 1, **case.get("set", {})}
        if case["quantity"] == "threshold":
            part, left = threshold(run, case, settings)
            got.append(part * scale)
            leaves = leaves and left
        elif case["quantity"] == "snap":
            got.append(snap(run, case, settings))
        else:
            got.append(measure(run(case["scene"], settings), case["quantity"], scale))
        errors.append(float(np.linalg.norm(got[-1] - expected)))
    resolved = [k for k, n in enumerate(counts) if n in case.get("order_edges", edges) and n >= case.get("resolved", 0)]
    order = order_of([counts[k] for k in resolved], [errors[k] for k in resolved], scale) if case.get("order", True) else None
    judged = edges.index(case.get("judged", 100))
    met = errors[judged] <= allowed and leaves
    return [{"case": case["case"], "quantity": case["quantity"], "edges": n, "expected": text_of(expected), "got": text_of(g), "error": f"{e:.3g}",
             "relative_error": f"{e / scale:.3g}", "tolerance": f"{allowed:.3g}", "judged_at": edges[judged],
             "order": "" if order is None else f"{order:.2f}", "met": int(met), "source": case["source"]}
            for n, g, e in zip(counts, got, errors)]


def order_in_time(run):
    period = 0.0609494718531634  # of the swing [s]

    def tip(steps, trapezoid):
        settings = {"scene.dt_s": period / steps, "scene.record_every": steps // 16}
        if trapezoid:
            settings["integrator.beta"] = 0.25
        return run("swing.toml", settings).trace()["tip_z_m"]

    rows, fine = [], tip(4096, True)
    for name, trapezoid, counts, expected in (("backward Euler", False, (128, 256, 512), 1), ("trapezoid", True, (16, 32, 64), 2)):
        errors = [float(np.sqrt(np.mean((tip(steps, trapezoid) - fine)**2))) for steps in counts]
        order = order_of(counts, errors, 1e-4)
        for steps, error in zip(counts, errors):
            rows.append({"case": f"swing, {name}, {steps} steps a period", "quantity": "tip_rms", "edges": 25, "expected": 0, "got": "",
                         "error": f"{error:.3g}", "relative_error": f"{error / 1e-4:.3g}", "tolerance": "", "judged_at": "",
                         "order": f"{order:.2f}", "met": int(abs(order - expected) < 0.1), "source": ""})
    return rows


def main():
    parser = runner.parser(__doc__, "")
    parser.add_argument("--only", default="", help="cases whose name holds this")
    options = parser.parse_args()

    def run(scene, settings):
        return runner.run(options.app, FOLDER / scene, settings=settings)

    cases = [c for c in json.loads((FOLDER / "expected.json").read_text())["cases"] if options.only in c["case"]]
    rows = []
    for case in cases:
        found = run_case(run, case)
        rows += found
        at = next(row for row in found if row["edges"] == row["judged_at"])
        print(f"{case['case']:52} expected {at['expected']:36} error " + " ".join(f"{row['relative_error']:>9}" for row in found) +
              f"  order {at['order'] or '-':>5}  {'met' if at['met'] else 'MISSED'}", flush=True)
    if options.only in "swing":
        rows += order_in_time(run)
        for row in rows[-6:]:
            print(f"{row['case']:52} error {row['error']}  order {row['order']}")
    runner.write_rows(options.csv, rows)
    sys.exit(0 if all(row["met"] for row in rows) else 1)


if __name__ == "__main__":
    main()
