#!/usr/bin/env python3
"""Is `seldinger plan` honest, and is what it chooses cheap? 24 short scenes: vessel, wire, path and tolerance vary.

    bench/validate_plan.py [--app build/seldinger] [--vessels ../shared/vessels] [-o out/validate-plan] [--only NAME …] [--budget S]
                           [--csv bench/results/planned.csv] [--table]

Each scene is planned; then `seldinger chart --planned` runs what was planned beside the chart's models, against a reference that the
chart refines by itself (twice the nodes and half the step at each level, where `plan` has 1.5 times the nodes). `true error` is the
planned model's error against that reference, `cheapest` the cheapest charted model that meets the tolerance, `ratio` the cost of the
planned one over it (1 or less: nothing charted is cheaper). Costs are processor time, medians of three. Models that take twice as long as
the planned one are stopped: they cannot be cheaper. The planned scene is run by `seldinger run` too.

Scenes that are done are not done again; a scene that was interrupted goes on. --table prints the rows as Markdown.
"""
import json
import pathlib
import sys

import runner

HERE = runner.ROOT
COLUMNS = ["scene", "tolerance_mm", "force_tolerance", "status", "chosen", "nodes", "dt_ms", "expected_mm", "low_mm", "high_mm", "true_mm", "known_to_mm",
           "expected_force", "true_force", "within", "cost", "cheapest", "cheapest_cost", "ratio", "pilots", "plan_s", "run_exit"]

NITINOL = dict(length=0.3, radius=0.000178, density=6450.0, bend=5.5e-5, twist=4.2e-5, stretch=6966.0)
FLOPPY = dict(length=0.12, radius=0.000178, density=6450.0, bend=3.0e-5, twist=2.3e-5, stretch=6966.0, tip=(0.03, 3.0e-6, 2.3e-6))
STIFF = dict(length=0.2, radius=0.0004445, density=7900.0, bend=5.0e-4, twist=3.8e-4, stretch=1.0e4, tip=(0.05, 1.0e-5, 8.0e-6))
LIMP = dict(length=0.2, radius=0.0004445, density=7900.0, bend=1.0e-5, twist=8.0e-6, stretch=1.0e4)
HOOK = dict(length=0.15, radius=0.000178, density=6450.0, bend=2.0e-5, twist=1.5e-5, stretch=6966.0, tip=(0.02, 1.0e-5, 7.5e-6), curvature=66.7)
STRING = dict(length=0.23, radius=0.0005, density=6450.0, bend=1.0e-7, twist=1.0e-7, stretch=6966.0)

LEVEL = 'place = { shape = "straight", base = [0.0, 0.0, 0.0], direction = [1.0, 0.0, 0.0], normal = [0.0, 0.0, 1.0] }'
ALONG = 'place = { shape = "centreline", from_m = 0.0 }'
CLAMP = '[[hold]]\nat = "base"\nposition = true\ndirection = true\nspin = true\n'


def wire(w, nodes=101, place=""):
    text = (f'[wire]\nlength_m = {w["length"]}\nradius_m = {w["radius"]}\ndensity = {w["density"]}\nbend_nm2 = {w["bend"]}\n'
            f'twist_nm2 = {w["twist"]}\nstretch_n = {w["stretch"]}\nnodes = {nodes}\n{place}\n')
    if "tip" in w:
        length, bend, twist = w["tip"]
        text += f'[[wire.section]]\nfrom_tip_m = [0.0, {length}]\nbend_nm2 = {bend}\ntwist_nm2 = {twist}\n'
        if "curvature" in w:
            text += f'rest_curvature_1_m = [{w["curvature"]}, 0.0]\n'
    return text


def tube(radius, length, triangles=4000):
    return f'[vessel]\nyoungs_pa = 1e6\nshape = "tube"\nradius_m = {radius}\nlength_m = {length}\naxis = [1.0, 0.0, 0.0]\ntriangles = {triangles}\n'


def arc(radius, bend, angle, lead_in=0.02, lead_out=0.04, triangles=8000):
    return (f'[vessel]\nyoungs_pa = 1e6\nshape = "arc"\nradius_m = {radius}\nbend_radius_m = {bend}\nangle_deg = {angle}\nlead_in_m = {lead_in}\nlead_out_m = {lead_out}\n'
            f'origin = [0.0, 0.0, 0.0]\naxis = [1.0, 0.0, 0.0]\nnormal = [0.0, 0.0, 1.0]\ntriangles = {triangles}\n')


def mesh(path, units):
    return f'[vessel]\nyoungs_pa = 1e6\nmesh = "{path}"\nunits = "{units}"\n'


def contact(more=""):
    return f'[contact]\ndetection = "swept"\nmu_static = 0.12\nmu_sliding = 0.10\n{more}\n'


def keys(*rows):
    return "keys = [ " + ", ".join(f"{{t_s = {t}, advance_m = {a}, turn_rad = {r}}}" for t, a, r in rows) + " ]\n"


def feed(*rows, point=None, direction=None):
    where = f"point = {point}\ndirection = {direction}\n" if point else 'inlet = "auto"\n'
    return "[feed]\n" + where + keys(*rows)


def scene(name, duration, *parts):
    start = "settled" if name == "turned-hook" else "placed"  # a hook that is let go rings for longer than the scene lasts
    return f'[scene]\nname = "{name}"\ngravity = [0.0, 0.0, -9.81]\nduration_s = {duration}\ndt_s = 0.001\nstart = "{start}"\n' + "".join(parts)


def scenes(vessels):
    """(name, tolerance [mm], force tolerance or "", text)"""
    coronary = HERE / "assets" / "vessels" / "coronary.ply"
    slanted = dict(point="[0.0, 0.0, -0.0035]", direction="[1.0, 0.0, -0.2]")
    table = [
        ("swing", 1.0, "", 0.4, wire(NITINOL, place=LEVEL), CLAMP),
        ("swing-soft", 0.3, "", 0.34, wire({**LIMP, "length": 0.1}, place=LEVEL), CLAMP),
        ("tip-load", 0.1, "", 0.4, wire({**NITINOL, "length": 0.1}, place=LEVEL), "[integrator]\ndamping_mass_1_s = 40.0\n", CLAMP,
         '[[load]]\nat = "tip"\nforce_n = [0.0, 0.002, -0.008]\nramp_s = 0.2\n'),
        ("turned-hook", 0.5, "", 0.34, wire({**HOOK, "length": 0.08}, place=LEVEL), "[integrator]\ndamping_mass_1_s = 20.0\n",
         CLAMP.rstrip() + "\nturn = [[0.0, 0.0], [0.34, 3.0]]\n"),
        ("drop-on-plane", 4.0, "", 0.4, wire({**NITINOL, "length": 0.2}, place=LEVEL),
         '[vessel]\nyoungs_pa = 1e6\nshape = "plane"\norigin = [0.1, 0.0, -0.02]\nnormal = [0.0, 0.0, 1.0]\nsize_m = 0.6\ntriangles = 2000\n', contact(), CLAMP),
        ("tube", 0.2, "", 0.5, wire(LIMP), tube(0.005, 0.12), contact(), feed((0, 0.004, 0), (0.5, 0.054, 0.5), **slanted)),
        ("tube-fine", 0.05, "", 0.4, wire(LIMP), tube(0.005, 0.12), contact(), feed((0, 0.004, 0), (0.5, 0.054, 0.5), **slanted)),
        ("tube-narrow", 0.1, "20%", 0.4, wire(FLOPPY), tube(0.002, 0.1),
         contact("rolling = true"), feed((0, 0.01, 0), (0.4, 0.05, 2.0), point="[0.0, 0.0, -0.001]", direction="[1.0, 0.05, -0.05]")),
        ("tube-heavy", 0.5, "", 0.5, wire({**LIMP, "bend": 3.0e-6, "twist": 3.0e-6}), tube(0.010, 0.2), contact(),
         feed((0, 0.03, 0), (0.5, 0.08, 0), point="[0.0, 0.0, 0.0]", direction="[1.0, 0.0, 0.0]")),
        ("bend", 0.2, "", 0.5, wire(FLOPPY), arc(0.002, 0.03, 90), contact(), feed((0, 0.015, 0), (0.5, 0.065, 0))),
        ("bend-coarse", 1.0, "", 0.5, wire(FLOPPY), arc(0.002, 0.03, 90), contact(), feed((0, 0.015, 0), (0.5, 0.065, 0))),
        ("bend-force", 0.2, "20%", 0.5, wire(FLOPPY), arc(0.002, 0.03, 90), contact(), feed((0, 0.015, 0), (0.5, 0.065, 0))),
        ("u-turn", 0.2, "", 0.5, wire({**STIFF, "tip": (0.1, 2.0e-5, 1.5e-5)}), arc(0.004, 0.04, 180), contact(), feed((0, 0.015, 0), (0.5, 0.085, 0))),
        ("siphon", 0.2, "", 0.5, wire(FLOPPY), arc(0.0018, 0.006, 180), contact(), feed((0, 0.012, 0), (0.5, 0.042, 0))),
        ("siphon-fine", 0.05, "", 0.34, wire(FLOPPY), arc(0.0018, 0.010, 120), contact(), feed((0, 0.012, 0), (0.34, 0.036, 0))),
        ("hook-turned", 0.5, "", 0.5, wire(HOOK), arc(0.003, 0.03, 90), contact("rolling = true"), feed((0, 0.012, 0), (0.3, 0.042, 0), (0.5, 0.042, 1.5))),
        ("push-pull", 0.2, "", 0.6, wire(FLOPPY), arc(0.002, 0.02, 120), contact(), feed((0, 0.015, 0), (0.3, 0.045, 0), (0.45, 0.035, 0), (0.6, 0.05, 0))),
        ("capstan", 0.5, "", 0.3, wire(STRING, place=ALONG), arc(0.002, 0.04, 180, 0.03, 0.09, 12000), contact(),
         '[[hold]]\nat = "base"\nposition = true\nvelocity_m_s = [-0.01, 0.0, 0.0]\n[[load]]\nat = "tip"\nforce_n = [-0.2, 0.0, 0.0]\nramp_s = 0.2\n'),
        ("coronary", 0.2, "", 0.5, wire(FLOPPY), mesh(coronary, "mm"), contact(), feed((0, 0.0, 0), (0.5, 0.03, 0), point="[0.001, 0.0, 0.0]", direction="[1.0, 0.0, 0.0]")),
        ("coronary-turned", 0.5, "", 0.5, wire({**FLOPPY, "tip": (0.03, 8.0e-6, 6.0e-6)}), mesh(coronary, "mm"), contact("rolling = true"),
         feed((0, 0.0, 0), (0.5, 0.025, 1.0), point="[0.001, 0.0, 0.0]", direction="[1.0, 0.0, 0.0]")),
        ("arch", 1.0, "", 0.5, wire(STIFF), '[vessel]\nyoungs_pa = 1e6\nshape = "aortic-arch"\ntriangles = 12000\n', contact(), feed((0, 0.03, 0), (0.5, 0.13, 0))),
        ("arch-hook", 0.3, "", 0.4, wire({**STIFF, "tip": (0.03, 1.0e-5, 8.0e-6), "curvature": 60.0}), '[vessel]\nyoungs_pa = 1e6\nshape = "aortic-arch"\ntriangles = 12000\n',
         contact("rolling = true"), feed((0, 0.0, 0), (0.4, 0.06, 0.5))),
    ]
    if vessels.is_dir():
        table += [
            ("iliac", 0.5, "", 0.5, wire(STIFF), mesh(vessels / "seqseg-aortoiliac/demo.vtp", "cm"), contact(),
             feed((0, 0.0, 0), (0.5, 0.06, 0), point="[-0.0142, -0.0116, 0.1195]", direction="[0.35, 0.25, -0.91]")),
            ("root-coronary", 1.0, "", 0.5, wire({**FLOPPY, "tip": (0.02, 4.0e-6, 4.0e-6)}), mesh(vessels / "tha016-root-coronary/marfan_ao.obj", "mm"), contact(),
             feed((0, 0.0, 0), (0.5, 0.05, 0), point="[-0.02613, 0.04388, 0.0212]", direction="[-0.91, -0.40, 0.12]")),
        ]
    return [(name, tolerance, force, scene(name, duration, *parts)) for name, tolerance, force, duration, *parts in table]


def number(text):
    return float(text) if text else float("nan")


def charted(folder, tolerance, force, budget):
    """The planned row, the cheapest row that meets the goals, and how well the reference is known [m]."""
    rows = runner.read_rows(folder / "chart.csv")
    references = {r["observable"]: r for r in runner.read_rows(folder / "references.csv")}
    force_scale = number(references["hand_force"]["scale"]) if "hand_force" in references else 1.0
    if force:
        force = force * max(1e-3, force_scale)

    def meets(row):
        if row["complete"] != "1" or row["outcome"] not in (("hold",) if force else ("hold", "jitter")):
            return False
        return number(row["shape_rms_m"]) <= tolerance and (not force or number(row["hand_force_rms_n"]) <= force)

    planned = next(r for r in rows if r["family"] == "planned")
    good = sorted((r for r in rows if meets(r) and r["family"] != "planned"), key=lambda r: number(r["cpu_s_per_s"]))
    return planned, meets(planned), good[0] if good else None, references["shape"], max(1e-3, force_scale)


def validate(app, out, name, tolerance, force, text, budget):
    folder = out / name
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "scene.toml").write_text(text)
    row = dict.fromkeys(COLUMNS, "") | {"scene": name, "tolerance_mm": tolerance, "force_tolerance": force}
    goals = ["--tolerance", f"{tolerance}mm"] + (["--force-tolerance", force] if force else [])
    done = runner.call([app, "plan", folder / "scene.toml", *goals, "--budget", budget, "--json", "-o", folder / "planned.toml"], (0, 4, 6))
    plan = json.loads(done.stdout)
    row |= {"status": plan["status"], "pilots": plan["pilots"], "plan_s": f"{plan['wall_s']:.1f}"}
    if plan["status"] != "planned":
        print(f"{name}: {plan['status']}: {plan.get('message', '')}", flush=True)
        return row
    chosen = plan["chosen"]
    row |= {"chosen": chosen["model"], "nodes": chosen["nodes"], "dt_ms": f"{1e3 * chosen['dt_s']:.4g}", "expected_mm": f"{1e3 * chosen['error_m']:.3g}",
            "low_mm": f"{1e3 * chosen['error_low_m']:.3g}", "high_mm": f"{1e3 * chosen['error_high_m']:.3g}",
            "expected_force": f"{chosen['force_error']:.3g}" if force else ""}
    row["run_exit"] = runner.run(app, folder / "planned.toml", folder / "run", accept=None).code
    duration = float(text.split("duration_s = ")[1].split("\n")[0])
    limit = max(0.02, 2 * chosen["seconds_per_second"] * duration)
    runner.call([app, "chart", "--processor-time", "--scenes", folder / "scene.toml", "--planned", folder / "planned.toml", "--run-limit", f"{limit:.4f}",
          "--reference-limit", budget, "-o", folder / "chart", "--quiet"])
    share = float(force.rstrip("%")) / 100 if force else 0
    planned, within, cheapest, reference, force_scale = charted(folder / "chart", 1e-3 * tolerance, share, budget)
    cost = number(planned["cpu_s_per_s"])
    row |= {"true_mm": f"{1e3 * number(planned['shape_rms_m']):.3g}", "known_to_mm": f"{1e3 * number(reference['uncertainty']):.2g}",
            "true_force": f"{number(planned['hand_force_rms_n']) / force_scale:.3g}" if force else "", "within": int(within), "cost": f"{cost:.3g}"}
    if cheapest:
        row |= {"cheapest": cheapest["model"], "cheapest_cost": f"{number(cheapest['cpu_s_per_s']):.3g}", "ratio": f"{cost / number(cheapest['cpu_s_per_s']):.2f}"}
    else:
        row["ratio"] = "1.00"  # nothing charted meets it at up to twice the cost
    print(f"{name}: {row['chosen']}: expected {row['expected_mm']} mm, true {row['true_mm']} (known to {row['known_to_mm']}), asked {tolerance}; "
          f"cost {row['cost']}, ratio {row['ratio']} to {row['cheapest']}", flush=True)
    return row


def print_table(rows):
    print("| scene | tolerance [mm] | chosen | expected [mm] (band) | true [mm] | cost [s/s] | cheapest charted | ratio |\n|---|---|---|---|---|---|---|---|")
    for r in rows:
        if r["status"] != "planned":
            print(f"| {r['scene']} | {r['tolerance_mm']} | {r['status']} | | | | | |")
            continue
        force = f", force {r['force_tolerance']}" if r["force_tolerance"] else ""
        forces = f"; force {100 * float(r['true_force']):.2g} %" if r["true_force"] else ""
        print(f"| {r['scene']} | {r['tolerance_mm']}{force} | {r['chosen']} | {r['expected_mm']} ({r['low_mm']}–{r['high_mm']}) | {r['true_mm']}{forces}"
              f"{'' if r['within'] == '1' else ' **outside**'} | {r['cost']} | {r['cheapest'] or 'none'} | {r['ratio']} |")


def main():
    parser = runner.parser(__doc__, "planned.csv")
    parser.add_argument("--vessels", type=pathlib.Path, default=HERE.parent / "shared" / "vessels", help="folder of the patient meshes; without it two scenes fewer")
    parser.add_argument("-o", "--output", type=pathlib.Path, default=HERE / "out" / "validate-plan")
    parser.add_argument("--only", nargs="+", default=[], metavar="NAME", help="these scenes, again if they are done")
    parser.add_argument("--budget", type=float, default=30, metavar="S", help="of each plan, and of each reference")
    parser.add_argument("--table", action="store_true", help="print the rows that are there as Markdown, run nothing")
    options = parser.parse_args()
    rows = {r["scene"]: r for r in runner.read_rows(options.csv)}
    if options.table:
        return print_table(rows.values())
    for name, tolerance, force, text in scenes(options.vessels.resolve()):
        if name not in options.only if options.only else name in rows:
            continue
        try:
            rows[name] = validate(options.app, options.output.resolve(), name, tolerance, force, text, options.budget)
        except SystemExit as error:  # of one command
            print(f"{name}: {error}", file=sys.stderr, flush=True)
            continue
        runner.write_rows(options.csv, list(rows.values()), COLUMNS)
    planned = [r for r in rows.values() if r["status"] == "planned"]
    within = sum(str(r["within"]) == "1" for r in planned)
    ratios = sorted(float(r["ratio"]) for r in planned)
    if planned:
        print(f"{len(planned)} of {len(rows)} planned; {within} within the tolerance; cost ratio at most {ratios[-1]}, median {ratios[len(ratios) // 2]}")


if __name__ == "__main__":
    main()
