#!/usr/bin/env python3
"""Restitution asked for and got, of a wire that falls flat: every normal law, scheme and step. Rows go to a CSV.

    restitution.py [--app build/seldinger] [--csv bench/results/validation/restitution.csv] [--laws a,b] [--schemes a,b] [--table]

A step is given as a part of t_c, the time that the contact lasts by the law itself; of the hard laws, by Hunt-Crossley's with e = 1.
Contact begins somewhere within a step, so that coarse steps are run from two gaps, and the worst is what counts. Restitution got is the
root of what is left of the kinetic energy (the wire stays straight). --table prints the CSV as the tables of bench/results/restitution.md.

First order in h, a scheme integrates not x' = v, v' = a(x, v) = -x^n (1 + b v) but (modified equations [Hairer06, chapter IX])
    backward Euler   x' = v + h/2 a,  v' = a + h/2 (a_x v + a_v a)
    linearised       the same, v' + h n x^(n-1) b v^2: one Newton step from where nothing has moved misses that depth and rate grow together
    trapezoid        x' = v,          v' = a - h/2 a_v a      the rate of deepening is the mean over the step, the force that of its end
    conserve         x' = v,          v' = a + h/2 a_x v      contact is taken at the end of the step, its rate as the mean
of which the restitution e(h) = e(0) - c h/t_c is found by integrating them: column `theory`.
"""
import math

import runner

SCENE = "assets/scenes/reference/bounce.toml"
SPEED, RADIUS, DENSITY, LENGTH = 0.05, 0.0004445, 7900.0, 0.02
YOUNGS, POISSON, THICKNESS, EXPONENT = 1e6, 0.45, 1e-3, 1.5
BARRIER = 0.021 * RADIUS
ASKED = [0.1, 0.3, 0.5, 0.7, 0.9]
PARTS = [10, 20, 50, 100, 200, 500, 1000]
SCHEMES = {
    "backward Euler": [],
    "trapezoid": ["integrator.beta=0.25", "integrator.gamma=0.5"],
    "conserve": ["integrator.conserve=true"],
    "linearised": ["integrator.scheme=linearised"],
}
DAMPED = ["hunt-crossley", "lankarani-nikravesh"]
HARD = ["impulse", "augmented", "constraint", "barrier"]
HARD_SCHEMES = ["backward Euler", "trapezoid"]


def exact_damping(e):
    """beta with ln((1 + beta)/(1 - beta e)) = beta (1 + e)"""
    low, high = 1e-12, (1 - 1e-15) / e
    for _ in range(200):
        beta = (low + high) / 2
        if math.log1p(beta) - math.log1p(-beta * e) - beta * (1 + e) < 0:
            low = beta
        else:
            high = beta
    return low


def damping(law, e):
    return 0.75 * (1 - e * e) if law == "lankarani-nikravesh" else exact_damping(e)


def modified(scheme, beta, h):
    """Right side of the modified equations, lengths in (m v^2/k)^(1/(n+1)), speeds in v."""
    def rates(x, v):
        x = max(x, 0.0)
        force = x**EXPONENT
        a, ax, av = -force * (1 + beta * v), -EXPONENT * math.sqrt(x) * (1 + beta * v), -force * beta
        if scheme == "trapezoid":
            return v, a - h / 2 * av * a
        if scheme == "conserve":
            return v, a + h / 2 * ax * v
        missed = EXPONENT * math.sqrt(x) * beta * v * v if scheme == "linearised" else 0.0
        return v + h / 2 * a, a + h / 2 * (ax * v + av * a) + h * missed
    return rates


def bounce(scheme, beta, h):
    """Restitution and duration by the modified equations; h = 0: of the law."""
    rates = modified(scheme, beta, h)
    x, v, t, dt = 0.0, 1.0, 0.0, 2e-4
    while True:
        k1 = rates(x, v)
        k2 = rates(x + dt / 2 * k1[0], v + dt / 2 * k1[1])
        k3 = rates(x + dt / 2 * k2[0], v + dt / 2 * k2[1])
        k4 = rates(x + dt * k3[0], v + dt * k3[1])
        x1 = x + dt / 6 * (k1[0] + 2 * k2[0] + 2 * k3[0] + k4[0])
        v1 = v + dt / 6 * (k1[1] + 2 * k2[1] + 2 * k3[1] + k4[1])
        if x1 <= 0 and v1 < 0:
            part = x / (x - x1)
            return -(v + part * (v1 - v)), t + part * dt
        x, v, t = x1, v1, t + dt


def theory(scheme, beta):
    """c of e(h) = e(0) - c h/t_c"""
    e0, duration = bounce(scheme, beta, 0.0)
    small = 1e-4
    return (bounce(scheme, beta, -small)[0] - bounce(scheme, beta, small)[0]) / (2 * small) * duration


def contact_time(beta):
    modulus = YOUNGS * (1 - POISSON) / ((1 + POISSON) * (1 - 2 * POISSON) * THICKNESS)
    stiffness = 4 / 3 * modulus * math.sqrt(2 * RADIUS)
    mass = DENSITY * math.pi * RADIUS**2
    return bounce("law", beta, 0.0)[1] * (mass * SPEED**2 / stiffness) ** (1 / (EXPONENT + 1)) / SPEED


def run(app, law, scheme, asked, dt, gap, most_steps):
    """Restitution got; None: still in contact at the end."""
    sets = [f"contact.normal={law}", f"contact.restitution={asked}", f"scene.dt_s={dt!r}", f"scene.duration_s={most_steps * dt!r}",
            f"wire.place.base=[-0.01, 0.0, {RADIUS + gap!r}]", *SCHEMES[scheme]]
    done = runner.run(app, SCENE, settings=sets, accept=None)
    if done.code != 0:
        return None, f"exit {done.code}"
    touched = False
    for row in done.rows():
        if touched and row["contacts"] == 0:
            return math.sqrt(row["kinetic_j"] / (0.5 * DENSITY * math.pi * RADIUS**2 * LENGTH * SPEED**2)), ""
        touched = touched or row["contacts"] > 0
    return None, "still in contact"


def measure(app, law, scheme, asked, part, duration):
    """The worst of two gaps where steps are coarse. A barrier acts from BARRIER off the wall."""
    expected = bounce("law", damping(law, asked), 0.0)[0] if law in DAMPED else asked if law == "impulse" else 0.0
    dt = duration / part
    clear = BARRIER if law == "barrier" else 0.0
    worst, note = None, ""
    for phase in ([0.25, 0.75] if part <= 50 else [0.5]):
        got, said = run(app, law, scheme, asked, dt, clear + (1 + phase) * SPEED * dt, 3 * part + 40 + round(clear / SPEED / dt))
        if got is None:
            note = said
        elif worst is None or abs(got - expected) > abs(worst - expected):
            worst = got
    return expected, worst, note


def cases(laws, schemes):
    for law in laws:
        for scheme in schemes if law in DAMPED else [s for s in HARD_SCHEMES if s in schemes]:
            for asked in ASKED if law in DAMPED + ["impulse"] else [0.5]:
                yield law, scheme, asked


def print_tables(path):
    rows = runner.read_rows(path)
    parts = sorted({int(row["t_c/dt"]) for row in rows})
    print("| law | scheme | " + " | ".join(f"t_c/{p}" for p in parts) + " | c: theory; got |")
    print("|---|---|" + "---|" * (len(parts) + 1))
    for law, scheme in dict.fromkeys((row["law"], row["scheme"]) for row in rows):
        mine = [row for row in rows if row["law"] == law and row["scheme"] == scheme]
        cells = []
        for part in parts:
            errors = [row["error"] for row in mine if int(row["t_c/dt"]) == part]
            cells.append("–" if not all(errors) else f"{max((float(e) for e in errors), key=abs):+.4f}")
        slopes = [(row["theory"], row["c"]) for row in mine if int(row["t_c/dt"]) == parts[-1] and row["theory"]]
        said = ", ".join(f"{float(t):.2f}" for t, _ in slopes) + "; " + ", ".join(f"{float(c):.2f}" for _, c in slopes) if slopes else ""
        print(f"| `{law}` | {scheme} | " + " | ".join(cells) + f" | {said} |")


def main():
    parser = runner.parser(__doc__, "validation/restitution.csv")
    parser.add_argument("--laws", default=",".join(DAMPED + HARD))
    parser.add_argument("--schemes", default=",".join(SCHEMES))
    parser.add_argument("--table", action="store_true")
    options = parser.parse_args()
    if options.table:
        return print_tables(options.csv)
    laws, schemes = options.laws.split(","), options.schemes.split(",")
    table = runner.Table(options.csv, ["law", "scheme", "asked", "t_c/dt", "expected", "got", "error", "c", "theory", "note"],
                         lambda row: row["law"] not in laws or row["scheme"] not in schemes)
    for law, scheme, asked in cases(laws, schemes):
        beta = damping(law, asked) if law in DAMPED else 0.0
        duration = contact_time(beta)
        c = f"{theory(scheme, beta):.3f}" if law in DAMPED else ""
        for part in PARTS:
            expected, got, note = measure(options.app, law, scheme, asked, part, duration)
            numbers = ["", "", ""] if got is None else [f"{got:.6f}", f"{got - expected:.6f}", f"{(expected - got) * part:.3f}"]
            table.add([law, scheme, asked, part, f"{expected:.6f}", *numbers, c, note])


if __name__ == "__main__":
    main()
