#!/usr/bin/env python3
"""Gives every key of docs/scene-file.md every kind of wrong value, and looks at what `check` and `run` make of it: exit 0 or 2 or 3, one
line, 5 s of processor time, 1 GB; what `check` takes `run` ends (0, 4, 75) within its time limit. Ends with 1 where that is broken.
SHARE 1/n takes every n-th case."""

import argparse
import copy
import os
import pathlib
import re
import resource
import subprocess
import sys
import tempfile
from collections import Counter

SECONDS, MEGABYTES, PATIENCE = 5.0, 1024.0, 60


class Raw(str):
    """TOML as it may be written."""


def text_of(value):
    if isinstance(value, Raw):
        return str(value)
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return f'"{value}"'
    if isinstance(value, list):
        return "[" + ", ".join(map(text_of, value)) + "]"
    if isinstance(value, dict):
        return "{" + ", ".join(f"{k} = {text_of(v)}" for k, v in value.items()) + "}"
    return repr(value)


def toml(scene):
    out = ""
    for name, table in scene.items():
        for head, rows in [(f"[{name}]", [table])] if isinstance(table, dict) else [(f"[[{name}]]", table)]:
            for row in rows:
                out += head + "\n" + "".join(f"{key} = {text_of(value)}\n" for key, value in row.items())
    return out


def scenes():
    """Table of the page -> scenes in which its keys mean something, and the way to that table."""
    scene = dict(duration_s=0.004, dt_s=0.001, record_every=2)
    wire = dict(length_m=0.1, radius_m=0.0004445, density=7900.0, bend_nm2=1e-5, twist_nm2=8e-6, stretch_n=1e4, nodes=21)
    tube = dict(shape="tube", radius_m=0.005, length_m=0.1, triangles=2000)
    keys = [dict(t_s=0.0, advance_m=0.004, turn_rad=0.0), dict(t_s=1.0, advance_m=0.084, turn_rad=1.0)]
    fed = dict(scene=scene, wire=wire, vessel=tube, contact=dict(detection="capsule"),
               feed=dict(point=[0.0, 0.0, -0.0035], direction=[1.0, 0.0, -0.2], keys=keys))
    free = dict(scene=scene, wire=wire, hold=[dict(at="base", position=True, direction=True, spin=True)])
    elastic = dict(fed, vessel=dict(tube, wall="elastic"))

    def instrument(name, radius, feed, **more):
        return dict(wire, name=name, radius_m=radius, feed=feed, **more)

    def nest(model):
        outer = dict(point=[0.0, 0.0, 0.0], direction=[1.0, 0.0, 0.0], keys=[dict(t_s=0.0, advance_m=0.01), dict(t_s=0.1, advance_m=0.03)])
        inner = dict(keys=[dict(t_s=0.0, advance_m=0.02), dict(t_s=0.1, advance_m=0.06)])
        pair = [instrument("a", 0.001, outer, lumen_radius_m=0.0007), instrument("b", 0.0005, inner)]
        return dict(scene=scene, instrument=pair, coaxial=dict(order=["a", "b"], model=model), vessel=dict(tube, radius_m=0.003))

    def placed(**place):
        return dict(free, wire=dict(wire, place=place))

    arc = dict(shape="arc", radius_m=0.005, bend_radius_m=0.03, angle_deg=90.0, triangles=2000)
    return {
        "scene": [(fed, ["scene"]), (free, ["scene"])],
        "wire": [(fed, ["wire"]), (free, ["wire"])],
        "wire.section": [(dict(fed, wire=dict(wire, section=[dict(from_tip_m=[0.0, 0.01])])), ["wire", "section", 0])],
        "wire.place": [(placed(shape="straight"), ["wire", "place"]), (placed(shape="arc", bend_radius_m=0.1), ["wire", "place"]),
                       (placed(shape="points", points=[[0.0, 0.0, 0.0], [0.1, 0.0, 0.0]]), ["wire", "place"])],
        "instrument": [(nest("merged"), ["instrument", 0]), (nest("separate"), ["instrument", 1])],
        "coaxial": [(nest("merged"), ["coaxial"]), (nest("separate"), ["coaxial"])],
        "integrator": [(dict(fed, integrator=dict(scheme="newton")), ["integrator"])],
        "vessel": [(fed, ["vessel"]), (dict(fed, vessel=arc), ["vessel"]), (elastic, ["vessel"]),
                   (dict(free, vessel=dict(shape="plane", size_m=1.0)), ["vessel"])],
        "contact": [(fed, ["contact"]), (dict(fed, contact=dict(detection="layer", normal="lankarani-nikravesh")), ["contact"])],
        "feed": [(fed, ["feed"]), (nest("merged"), ["instrument", 1, "feed"])],
        "feed.keys": [(fed, ["feed", "keys", 1])],
        "hold": [(free, ["hold", 0])],
        "load": [(dict(free, load=[dict(at="tip", force_n=[0.0, 0.0, -0.001])]), ["load", 0])],
        "link": [(dict(free, link=[dict(at=0.05, anchor=[0.05, 0.0, 0.0], stiffness_n_m=0.5)]), ["link", 0])],
        "force": [(dict(free, force=[dict(plugin="force_plugin.so", pull_n=[0.0, 0.0, 0.001])]), ["force", 0])],
        "wall_load": [(dict(elastic, wall_load=[dict(at=[0.0, 0.0, 0.005], force_n=[0.0, 0.0, 0.05])]), ["wall_load", 0])],
        "task": [(dict(fed, task=dict(text="t")), ["task"])],
        "task.target": [(dict(fed, task=dict(target=dict(point=[0.05, 0.0, 0.0]))), ["task", "target"])],
        "carm": [(dict(fed, carm=dict(sid_m=1.1, sod_m=0.76)), ["carm"])],
        "carm.keys": [(dict(fed, carm=dict(keys=[dict(t_s=0.0), dict(t_s=1.0, lao_deg=10.0)])), ["carm", "keys", 1])],
        "contrast": [(dict(fed, contrast=dict(keys=[dict(t_s=1.0, iodine_mg_ml=0.0)])), ["contrast"])],
        "contrast.keys": [(dict(fed, contrast=dict(keys=[dict(t_s=1.0, iodine_mg_ml=0.0)])), ["contrast", "keys", 0])],
        "output": [(dict(fed, output=dict(wire_every=2)), ["output"])],
    }


VALUES = ['"x"', '""', "-1", "0", "1", "3", "0.3", "1e308", "1e17", "9999.0", "-1e308", "1e-308", "1e-29", "1e-12", "nan", "inf", "-inf", "[]",
          "{}", "[[]]", "[{}]", "true", "false", "9223372036854775807", "1979-05-27", '"../../../etc/passwd"', '"/dev/zero"', '"a\\u0000b"',
          "[nan, nan, nan]", "[9e3, 9e3, 9e3]", "[0.0, 0.0, 0.0]", "[1e-300, 0.0, 0.0]", "[1, 2]", "[[0.0, 0.0, 0.0, 0.0]]", '[["a"]]',
          "[[0.0, 1e4, 1e4, 1e4]]", '["a", "a"]', "[" + "0.0," * 1000000 + "]", '"' + "a" * 1000000 + '"', "[" + "{t_s = 0.0}," * 100000 + "]",
          "[" + "[0.0, 0.0, 0.0, 0.0]," * 100000 + "]"]


def listed_keys(page):
    """Table -> its keys, as the page has them."""
    table, keys = None, {}
    for line in page.splitlines():
        if heading := re.match(r"^##+ (.*)$", line):
            table = heading.group(1) if re.match(r"^[a-z_.]+$", heading.group(1)) else None
        elif table and (row := re.match(r"^\| `([a-z_0-9]+)` \|", line)):
            keys.setdefault(table, []).append(row.group(1))
    return keys


def changed(scene, way, key, value):
    scene = copy.deepcopy(scene)
    table = scene
    for step in way:
        table = table[step]
    table[key] = Raw(value)
    return scene


def broken(app, words, folder, allowed):
    """(exit code, what is broken, stderr) of one command."""
    with open(folder / "err", "wb") as err:
        child = subprocess.Popen([app, *words], cwd=folder, stdout=subprocess.DEVNULL, stderr=err,
                                 preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (PATIENCE, PATIENCE + 1)))
        _, status, used = os.wait4(child.pid, 0)
    child.returncode = code = os.waitstatus_to_exitcode(status)
    said = (folder / "err").read_text(errors="replace").strip().splitlines()
    wrong = [f"exit {code}"] * (code not in allowed) + ["slow"] * (used.ru_utime + used.ru_stime > 2 * SECONDS)  # two cores
    wrong += ["memory"] * (used.ru_maxrss / 1024 > MEGABYTES) + [f"{len(said)} lines"] * (len(said) > 1 or (code != 0 and not said))
    return code, wrong, said[0][:300] if said else ""


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("app", type=pathlib.Path)
    parser.add_argument("--share", default="1/1")
    parser.add_argument("--tables", default="", help="some, by commas")
    given = parser.parse_args()
    app, every = given.app.resolve(), int(given.share.split("/")[1])
    page = pathlib.Path(__file__).resolve().parents[2] / "docs/scene-file.md"
    listed, bases = listed_keys(page.read_text()), scenes()
    if set(listed) != set(bases):
        print("tables of the page without a scene here, or the other way round:", sorted(set(listed) ^ set(bases)))
        return 1
    chosen = given.tables.split(",") if given.tables else list(bases)
    cases = [(t, way, base, key, v) for t in chosen for base, way in bases[t] for key in listed[t] for v in VALUES][::every]
    os.environ["SELDINGER_PLUGINS"] = str(app.parent / "tests")
    counts, failures = Counter(), 0
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch)
        for table, way, base, key, value in cases:
            (folder / "k.toml").write_text(toml(changed(base, way, key, value)))
            code, wrong, said = broken(app, ["check", "k.toml"], folder, (0, 2, 3))
            counts["check", code] += 1
            if code == 0 and not wrong:
                code, wrong, said = broken(app, ["run", "k.toml", "-o", "K", "--quiet", "--overwrite", "--time-limit", "3"], folder, (0, 2, 3, 4, 75))
                counts["run", code] += 1
            if wrong:
                failures += 1
                print(f"{table}.{key} = {value[:40]}: {', '.join(wrong)}: {said}", flush=True)
    print(f"{len(cases)} cases, {failures} broken;", ", ".join(f"{what} {code}: {n}" for (what, code), n in sorted(counts.items())))
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
