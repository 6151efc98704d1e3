#!/usr/bin/env python3
"""Overhand knots against the theory of loose ones and against what holds in any knot, each by `seldinger run`.

    bench/knots.py [--app build/seldinger] [--csv bench/results/validation/knots.csv] [--only loose,tight,friction] [--keep FOLDER]

loose      no friction, ends pulled by T = B/(2 R^2), R/r = 25, 50, 100. The strands press on each other in the braid by
           P = sigma B/R^2 sqrt(R/r) in all, sigma = 0.492 for R/r -> infinity (matched asymptotic expansions, Audoly, Clauvelin, Neukirch,
           PRL 99 (2007) 164301; Clauvelin, Audoly, Neukirch, JMPS 57 (2009) 1623: h^2 T/B = eps^4/2 +- mu sigma eps^3, eps = sqrt(r/R)).
           sigma of three knots is continued to eps = 0 by a parabola: what is left is of eps^3, 1e-3 to 1e-2. The ends come nearer by 1.0872
           and 1.0585 times 2 pi R (reference/16_rod_rod: an energy minimised by other means).
balance    without friction H = n.t + B kappa^2/2, less the energy that contact stores per length, is the same all along a wire: the pull
           at its ends. Largest and smallest H over T.
tight      drawn together until 9.7 diameters are left, edges of a radius and of half a one: H, and what is left over the 10.1
           diameters of the ideal open trefoil (Pieranski, Przybyl, Stasiak, EPJ E 6 (2001) 123) at the distance to which
           the law lets the axes come. A knot of a wire that bends cannot be shorter than the ideal one.
friction   mu = 0.1, drawn together until R/r = 50: along the braid, where it slides, the pull falls by mu P: (T - H at the apex)/(mu P) is 1.
"""
import pathlib
import sys
import tempfile

import numpy as np

import runner

RADIUS = 0.18e-3
IDEAL = 10.1  # diameters


class Wire:
    """[N m^2], [N]"""

    def __init__(self, bend, stretch):
        self.bend, self.stretch = bend, stretch


STIFF, SOFT = Wire(5e-5, 7000.0), Wire(1e-7, 100.0)


def path_of(loop, tail):
    """A polynomial of the knot, as wide as the loop that it is to have, with straight tails [m]."""
    end, points = 2.15, 500
    t = end * (2 * np.arange(points + 1) / points - 1)
    path = 0.45 * loop * np.stack([t * (t**2 - 3), t**2 * (t**2 - 4), 0.3 * t * (t**4 - 10)], axis=1)

    def beyond(a, b):
        return a + tail * (a - b) / np.linalg.norm(a - b)
    return np.vstack([beyond(path[0], path[1]), path, beyond(path[-1], path[-2])])


def scene(wire, path, length, edge, mu, damping, ends, times, contact=""):
    """@param edge [radii]  @param times  step, duration [s]"""
    nodes = round(length / (edge * RADIUS)) + 1
    points = ",".join(f"[{x:.9g},{y:.9g},{z:.9g}]" for x, y, z in path)
    return (f"[scene]\ngravity = [0.0, 0.0, 0.0]\ndt_s = {times[0]}\nduration_s = {times[1]}\n[integrator]\ndamping_mass_1_s = {damping}\n"
            f'[[instrument]]\nname = "wire"\nlength_m = {length:.12g}\nradius_m = {RADIUS}\ndensity = 6450.0\nbend_nm2 = {wire.bend}\n'
            f"twist_nm2 = {0.77 * wire.bend}\nstretch_n = {wire.stretch}\nnodes = {nodes}\nmu_static = {mu}\nmu_sliding = {mu}\n"
            f'place = {{shape = "points", points = [{points}]}}\n{ends}[contact]\ninstruments = true\nfriction = "{"stick-slip" if mu else "none"}"\n{contact}')


def length_of(path, loop):
    """Of the wire, whose edges cut corners [m]."""
    return float(np.linalg.norm(np.diff(path, axis=0), axis=1).sum()) - loop / 15


LINEAR = "stiffness = 1e9\nexponent = 1.0\n"


def loose(ratio):
    loop = ratio * RADIUS
    path = path_of(loop, 2.9 * loop)
    pull = STIFF.bend / (2 * loop**2)
    ends = "".join(f'[[load]]\ninstrument = "wire"\nat = "{at}"\nforce_n = [{side * pull}, 0.0, 0.0]\n' for at, side in (("base", -1), ("tip", 1)))
    length = length_of(path, loop)
    slow = ratio / 50  # times of a knot go with R^2: damping and duration follow
    return scene(STIFF, path, length, 4 if ratio > 50 else 2, 0.0, 1000 / slow**2, ends, (2e-4 * slow**2, 0.1 * slow**3 if slow > 1 else 0.1), LINEAR), length


def drawn(wire, loop, tail, left, speed, edge, mu, damping, rest, contact=""):
    """Ends drawn apart until `left` more length than their distance is there, then held for `rest` [s]."""
    path = path_of(loop * RADIUS, tail)
    length = length_of(path, loop * RADIUS)
    span = path[-1] - path[0]
    way = length - np.linalg.norm(span) - left
    time, ends = way / speed, ""
    for at, side in (("base", -0.5), ("tip", 0.5)):
        x, y, z = side * way * span / np.linalg.norm(span)
        ends += f'[[hold]]\ninstrument = "wire"\nat = "{at}"\nposition = true\nmove = [[0.0, 0.0, 0.0, 0.0], [{time:.9g}, {x:.9g}, {y:.9g}, {z:.9g}]]\n'
    return scene(wire, path, length, edge, mu, damping, ends, (1e-3, time + rest), contact), length


class Knot:
    """What a run ended with."""

    def __init__(self, app, folder, name, made, wire):
        text, self.length = made
        run = runner.run(app, text, folder / name, estimate="off")
        self.axis = run.nodes()
        self.pressed, self.stuck = run.columns("contacts", "normal_n", "stuck").sum(axis=0)
        rest = self.length / (len(self.axis) - 1)
        edges = np.diff(self.axis, axis=0)
        along = np.linalg.norm(edges, axis=1)
        self.stretched = float(along.sum())
        stretch = along / rest - 1
        axial = wire.stretch * stretch * (1 + 0.5 * stretch)
        turned = np.arccos(np.clip(np.einsum("ij,ij->i", edges[1:], edges[:-1]) / (along[1:] * along[:-1]), -1, 1))
        self.balance = 0.5 * (axial[1:] + axial[:-1]) + 0.5 * wire.bend * (turned / rest) ** 2
        self.pull = axial[0]
        middle = len(self.balance) // 2
        self.apex = float(np.median(self.balance[middle - 8:middle + 9]))

    def left(self):
        """How much longer the wire is, as it is stretched, than its ends are apart [m]."""
        return self.stretched - float(np.linalg.norm(self.axis[0] - self.axis[-1]))

    def nearest(self):
        """Of two places of the axis farther apart along it than a small loop is long [m]."""
        fine = np.vstack([self.axis[:-1] + share * np.diff(self.axis, axis=0) for share in (0.0, 0.25, 0.5, 0.75)])
        place = np.concatenate([np.arange(len(self.axis) - 1) + share for share in (0.0, 0.25, 0.5, 0.75)]) * self.length / (len(self.axis) - 1)
        apart = np.linalg.norm(fine[:, None] - fine[None], axis=2)
        return float(apart[np.abs(place[:, None] - place[None]) > 5 * RADIUS].min())


def rows_loose(app, folder):
    found = []
    for ratio, expected in ((25, None), (50, 1.0872), (100, 1.0585)):
        knot = Knot(app, folder, f"loose-{ratio}", loose(ratio), STIFF)
        loop, eps = ratio * RADIUS, np.sqrt(1 / ratio)
        found.append((eps, knot.pressed * loop**2 / STIFF.bend * eps))
        yield f"loose, R/r = {ratio}", "sigma", "", found[-1][1], "", ""
        if expected:
            yield f"loose, R/r = {ratio}", "shortening over 2 pi R", expected, knot.left() / (2 * np.pi * loop), "rel", 0.005
        pull = STIFF.bend / (2 * loop**2)
        yield f"loose, R/r = {ratio}", "H over T, smallest", 1.0, knot.balance.min() / pull, "rel", 0.01
        yield f"loose, R/r = {ratio}", "H over T, largest", 1.0, knot.balance.max() / pull, "rel", 0.03
    eps, sigma = np.array(found).T
    yield "loose, R/r to infinity", "sigma", 0.492, np.polyfit(eps, sigma, 2)[2], "rel", 0.03


def rows_tight(app, folder):
    for edge in (1.0, 0.5):
        knot = Knot(app, folder, f"tight-{edge:g}", drawn(SOFT, 10, 0.006, 9.7 * 2 * RADIUS, 0.05, edge, 0.0, 200.0, 0.1), SOFT)
        name = f"tight, edges of {edge:g} r"
        yield name, "H over T, smallest", 1.0, knot.balance.min() / knot.pull, "rel", 0.03
        yield name, "H over T, largest", 1.0, knot.balance.max() / knot.pull, "rel", 0.12
        yield name, "pull [N]", "", knot.pull, "", ""
        yield name, "nearest axes over 2 r", "", knot.nearest() / (2 * RADIUS), "", ""
        yield name, "left over ideal", 1.0, knot.left() / (IDEAL * knot.nearest()), "above", 0.25


def rows_friction(app, folder):
    mu = 0.1
    knot = Knot(app, folder, "friction", drawn(STIFF, 60, 0.05, 0.061, 0.03, 3.0, mu, 300.0, 0.0, LINEAR), STIFF)
    loop = np.sqrt(STIFF.bend / (2 * knot.apex))
    yield "drawn together, mu 0.1", "R/r", "", loop / RADIUS, "", ""
    yield "drawn together, mu 0.1", "contacts that stick", "", int(knot.stuck), "", ""
    yield "drawn together, mu 0.1", "(T - H at the apex)/(mu P)", 1.0, (knot.pull - knot.apex) / (mu * knot.pressed), "rel", 0.03


def main():
    parser = runner.parser(__doc__, "validation/knots.csv")
    parser.add_argument("--only", default="loose,tight,friction")
    parser.add_argument("--keep")
    options = parser.parse_args()
    folder = pathlib.Path(options.keep or tempfile.mkdtemp(prefix="knots-"))
    bad, table = 0, []
    for name, rows in (("loose", rows_loose), ("tight", rows_tight), ("friction", rows_friction)):
        if name not in options.only.split(","):
            continue
        for case, quantity, expected, got, how, tolerance in rows(options.app, folder):
            off = got / expected - 1 if how else 0
            within = "" if not how else "yes" if (0 if how == "above" else -tolerance) <= off <= tolerance else "no"
            bad += within == "no"
            table.append({"case": case, "quantity": quantity, "expected": expected, "got": f"{got:.5g}", "tolerance": tolerance, "within": within})
            print(*table[-1].values(), sep="; ", flush=True)
    runner.write_rows(options.csv, table)
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
