#!/usr/bin/env python3
"""Contact and friction against independent solutions, where a run is too long for the tests. Rows go to a CSV.

    validate_contact.py [--app build/seldinger] [--csv bench/results/validation/contact.csv] [--only capstan,thick,stiff,insertion,cost]
                        [--vessel MESH.stl]

capstan    limp wire round a bend, 4 angles x 4 coefficients, against the elastic rod on a drum below
thick      limp 0.035 inch wire round tight bends: friction at the surface, its moment about the axis of bending
stiff      stiff wire round a drum: shear, lift-off and point reactions taken into account
insertion  wire pushed into and pulled out of a bend, against a discrete rod with hard contact and mobilised friction
cost       time per step with and without friction and rolling, experiment 2 from 10 to 24 cm, side by side; --vessel: the patient's
"""
import math
import sys

import runner

SCENES = "assets/scenes/reference"
STRING_ANGLES = [math.pi / 4, math.pi / 2, math.pi, 3 * math.pi / 2]
STRING_MU = [0.01, 0.1, 0.3, 0.48]
STIFF = [  # B [N m^2], R to the axis [m], back tension [N], mu, turn
    (1.0e-4, 0.05, 0.2, 0.3, math.pi / 2),
    (5.5e-5, 0.05, 1.0, 0.1, math.pi / 2),
    (5.5e-5, 0.03, 0.5, 0.2, math.pi),
]
INSERTION = [  # tip angle [rad], mu, sense (+1 push), force on the base [N]
    (0.8, 0.1, 1, 0.018721355515), (0.8, 0.1, -1, 0.002906038439), (0.8, 0.3, 1, 0.032947735678), (0.8, 0.3, -1, -0.014773599985),
    (1.2, 0.1, 1, 0.020785370627), (1.2, 0.1, -1, 0.003701532913), (1.2, 0.3, 1, 0.035652599609), (1.2, 0.3, -1, -0.0169404),
    (1.6, 0.1, 1, 0.0201211), (1.6, 0.1, -1, 0.00441641), (1.6, 0.3, 1, 0.0338997), (1.6, 0.3, -1, -0.0167818),
]


def ran(app, scene, **settings):
    """A key's dots are written as two underscores."""
    return runner.run(app, scene, settings={key.replace("__", "."): value for key, value in settings.items()})


def capstan_pull(stiffness, axis, wire, back, mu, wrap):
    """Elastic rod of radius `wire` drawn over a drum, its axis at `axis`, friction at its surface. By Kirchhoff's equations M = B/R is constant in
    contact, so that a shear r mu p carries the moment of friction. With rho = r/R and P = p R, per radian,

        T' = mu (1 - rho) P,      rho mu P' = T - P:      T ~ e^(lambda phi), rho mu lambda^2 + lambda = mu (1 - rho)

    lambda = mu (1 - rho)(1 - mu^2 rho ...), and a layer of length mu r that takes up the slack tail's shear. The tails lift off where
    their curvature, B kappa^2/2 = F (1 - cos t), is the drum's; at the taut end a point force Q makes it smaller by r mu Q / B.
    """
    rho = wire / axis
    t1 = math.acos(1 - stiffness / (2 * axis * axis * back))
    root, scale = math.sqrt(1 + 4 * mu * mu * rho * (1 - rho)), 2 * rho * mu
    slow, fast = (root - 1) / scale, (-root - 1) / scale
    tension, slope = back * math.cos(t1), (1 - rho) / rho * back * math.sin(t1)
    amount = (slope - fast * tension) / (slow - fast)
    t2, force = t1, back
    for _ in range(100):
        angle = wrap - t1 - t2
        a, c = amount * math.exp(slow * angle), (tension - amount) * math.exp(fast * angle)
        end, shear = a + c, rho / (1 - rho) * (slow * a + fast * c)
        low, high = 0.0, end
        for _ in range(100):
            point = (low + high) / 2
            force, t2 = math.hypot(end + mu * point, point - shear), math.atan2(point - shear, end + mu * point)
            if stiffness / axis - wire * mu * point > 2 * math.sqrt(stiffness * force) * math.sin(t2 / 2):
                low = point
            else:
                high = point
    return force


def capstan_exponent(stiffness, axis, wire, back, pull, mu, wrap):
    """ln of pull over back tension, of what the rod on the drum has; the difference in parts of mu wrap; 1 is right."""
    return 1 + math.log(pull / capstan_pull(stiffness, axis, wire, back, mu, wrap)) / (mu * wrap)


def pull_and_wrap(run, turn):
    """Mean pull over the second half, and the angle from its direction to that of the back tension, near `turn`."""
    forces = run.columns("trace", *(f"base_force_{c}_n" for c in "xyz"))
    x, y, z = -forces[len(forces) // 2:].mean(axis=0)  # what the wire does to the hand
    # the wire leaves the base along +x and ends along (cos turn, sin turn)
    return math.sqrt(x * x + y * y + z * z), turn - math.atan2(y, x)


def capstan(app):
    radius = 0.04 - 0.002 + 0.000178
    for turn in STRING_ANGLES:
        for mu in STRING_MU:
            back = 0.05
            length = 0.025 + 0.04 * turn + 0.045
            run = ran(app, f"{SCENES}/capstan.toml", vessel__angle_deg=math.degrees(turn), wire__length_m=length,
                      wire__nodes=round(length / 0.001) + 1, contact__mu_static=mu, contact__mu_sliding=mu,
                      load__0__force_n=[back * math.cos(turn), back * math.sin(turn), 0.0])
            pull, wrap = pull_and_wrap(run, turn)
            got = capstan_exponent(1e-7, radius, 0.000178, back, pull, mu, wrap)
            yield (f"capstan {math.degrees(turn):.0f} deg mu {mu}: exponent / (mu wrap), wrap {wrap:.4f} rad, ratio {pull / back:.5f}", 1, got, 0.03,
                   run.command)


def thick(app):
    wire, lumen, back, turn = 0.0004445, 0.002, 0.3, math.pi / 2
    for axis in (0.005, 0.01, 0.02, 0.04):
        for mu in (0.1, 0.3, 0.48):
            bend = axis + lumen - wire
            length = 0.031 + bend * turn
            edge = min(0.0005, axis / 20)
            run = ran(app, f"{SCENES}/capstan.toml", wire__length_m=length, wire__radius_m=wire, wire__density=7900.0,
                      wire__nodes=round(length / edge) + 1, vessel__bend_radius_m=bend, vessel__lead_in_m=0.02, vessel__lead_out_m=0.03,
                      contact__mu_static=mu, contact__mu_sliding=mu, load__0__force_n=[0.0, back, 0.0], load__0__ramp_s=0.05,
                      hold__0__velocity_m_s=[-0.01, 0.0, 0.0], scene__duration_s=0.4, vessel__youngs_pa=1e8)
            pull, wrap = pull_and_wrap(run, turn)
            without = 1 + math.log(pull / capstan_pull(1e-7, axis, 1e-3 * wire, back, mu, wrap)) / (mu * wrap)
            yield (f"0.035 inch round R {1e3 * axis:g} mm, mu {mu}: exponent / (mu wrap) over theory's (without the moment {without:.4f})", 1,
                   capstan_exponent(1e-7, axis, wire, back, pull, mu, wrap), 0.01, run.command)


def stiff(app):
    for stiffness, radius, back, mu, turn in STIFF:
        bend = radius - 0.000178 + 0.02
        length = 0.08 + bend * turn + 0.09
        run = ran(app, f"{SCENES}/capstan-stiff.toml", wire__bend_nm2=stiffness, wire__twist_nm2=stiffness, wire__length_m=length,
                  wire__nodes=round(length / 0.001) + 1, vessel__bend_radius_m=bend, vessel__angle_deg=math.degrees(turn),
                  contact__mu_static=mu, contact__mu_sliding=mu,
                  load__0__force_n=[back * math.cos(turn), back * math.sin(turn), 0.0])
        pull, wrap = pull_and_wrap(run, turn)
        yield (f"stiff capstan B {stiffness} R {radius} F1 {back} mu {mu} wrap {wrap:.4f}: pull [N]",
               capstan_pull(stiffness, radius, 0.000178, back, mu, wrap), pull, 0.03, run.command)


def insertion(app):
    travel = 0.006
    for angle, mu, sense, expected in INSERTION:
        run = ran(app, f"{SCENES}/bend-insertion.toml", wire__length_m=0.05 + 0.05 * angle, contact__mu_static=mu, contact__mu_sliding=mu,
                  hold__0__velocity_m_s=[sense * 0.01, 0.0, 0.0],
                  wire__place__from_m=0.012 - sense * travel)
        got = run.summary["base_force_n"][0]
        yield f"{'push into' if sense > 0 else 'pull out of'} a bend, {angle} rad in, mu {mu}: force on the base [N]", expected, got, 0.05, run.command


def cost(app, vessel):
    scene = "assets/scenes/patients/tha001-arch.toml" if vessel else "assets/scenes/experiment2.toml"
    extra = {"vessel__mesh": vessel} if vessel else {}

    def timed(friction, rolling=False):
        run = ran(app, scene, contact__friction=friction, contact__rolling=rolling, scene__duration_s=12.0, scene__record_every=1,
                  output__wire_every=0, output__contacts_every=0, **extra)
        return runner.median(row["step_ms"] for row in run.rows() if row["inserted_m"] >= 0.1), run.command

    rounds = runner.in_turn(5, none=lambda: timed("none"), friction=lambda: timed("stick-slip"), rolling=lambda: timed("stick-slip", True))
    medians = {name: runner.median(step for step, _ in found) for name, found in rounds.items()}
    for name in ("friction", "rolling"):
        yield (f"time per step with stick-slip{' and rolling' if name == 'rolling' else ''} over none ({medians['none']:.4f} ms)", 1,
               medians[name] / medians["none"], 0.15, rounds[name][0][1])


def main():
    parser = runner.parser(__doc__, "validation/contact.csv")
    parser.add_argument("--only", default="capstan,thick,stiff,insertion,cost")
    parser.add_argument("--vessel", help="patient mesh of assets/scenes/patients/tha001-arch.toml")
    options = parser.parse_args()
    suites = {"capstan": capstan, "thick": thick, "stiff": stiff, "insertion": insertion, "cost": lambda app: cost(app, options.vessel)}
    wanted, missed = options.only.split(","), 0
    table = runner.Table(options.csv, ["suite", "case", "expected", "got", "error", "tolerance", "command"], lambda row: row["suite"] not in wanted)
    for name in wanted:
        for case, expected, got, tolerance, command in suites[name](options.app):
            error = got / expected - 1
            ok = error <= tolerance if name == "cost" else abs(error) <= tolerance
            missed += not ok
            table.add([name, case, f"{expected:.6g}", f"{got:.6g}", f"{error:.5f}", tolerance, command], show=False)
            print(f"{'ok  ' if ok else 'MISS'} {case}: expected {expected:.6g}, got {got:.6g} ({100 * error:+.2f} %)", flush=True)
    sys.exit(missed > 0)


if __name__ == "__main__":
    main()
