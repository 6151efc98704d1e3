#!/usr/bin/env python3
"""Holds the tables of output columns in docs/readings.md and docs/study-tables.md against what the program writes, both ways.

    output_docs.py SELDINGER SOURCE_FOLDER

Every column of every table and every key of summary.json that small runs write must stand in a table under the heading of that
file, and every name that stands there must have been written by one of the runs. In the docs a word in capitals stands for any
word, as READING in error_estimate.READING.value.
"""
import csv
import json
import pathlib
import re
import subprocess
import sys
import tempfile

WIRE = """length_m = 0.2
radius_m = {radius}
density = 7900.0
bend_nm2 = 1e-5
twist_nm2 = 1e-5
stretch_n = 1e4
nodes = 41
"""
SCENE = "[scene]\nduration_s = {duration}\ndt_s = 0.002\n"
TUBE = '[vessel]\nshape = "tube"\nradius_m = 0.003\nlength_m = 0.03\ntriangles = 2000\n'
FEED = """point = [0.0, 0.0, 0.0]
direction = [1.0, 0.0, 0.1]
keys = [ {{t_s = 0.0, advance_m = {start}}}, {{t_s = 0.2, advance_m = {end}}} ]
"""

# pushed out of the far end of its tube: left_through; 100 steps: error_estimate
RIGID = (SCENE.format(duration=0.2) + "[wire]\n" + WIRE.format(radius=0.0004) + TUBE +
         "[feed]\n" + FEED.format(start=0.0, end=0.04))
DRIVEN = RIGID.replace("0.2\ndt_s", "0.02\ndt_s").split("keys = ")[0] + "hub_mass_kg = 0.05\nkeys = [ {t_s = 0.0, force_n = 0.1} ]\n"
TASK = RIGID + "[task]\ntarget = { point = [0.02, 0.0, 0.0], radius_m = 0.01 }\n"
ELASTIC = RIGID.replace("0.2\ndt_s", "0.02\ndt_s").replace("[vessel]\n", '[vessel]\nwall = "elastic"\n')
# the inner one is bent by nature and the outer one straight: they touch at once
COAXIAL = (SCENE.format(duration=0.02) + "record_every = 1\n" + '[[instrument]]\nname = "outer"\nlumen_radius_m = 0.0007\n' + WIRE.format(radius=0.001) +
           "[instrument.feed]\n" + FEED.format(start=0.01, end=0.02) + '[[instrument]]\nname = "inner"\n' +
           WIRE.format(radius=0.0005) + "[[instrument.section]]\nfrom_tip_m = [0.0, 0.03]\nrest_curvature_1_m = [30.0, 0.0]\n" +
           "[instrument.feed]\n" + FEED.format(start=0.02, end=0.03).split("\n", 2)[2] +
           '[coaxial]\norder = ["outer", "inner"]\nmodel = "separate"\n' + TUBE)
SWING = (SCENE.format(duration=0.05) + "[wire]\n" + WIRE.format(radius=0.0004) + "[[hold]]\nposition = true\ndirection = true\n")
SWEEP = '[vary]\n"wire.density" = [7000.0, 7900.0]\n'
EXIT_SWEEP = '[vary]\n"scene.duration_s" = [0.1, 0.2]\n'  # 20 and 40 mm in a tube of 30: one tip in a branch, one beyond its end


def documented(files):
    """Names in code font in the first cells of tables headed "column" or "key", by the section that they stand in."""
    sections = {}
    section, in_table = None, False
    for file in files:
        for line in file.read_text(encoding="utf-8").splitlines():
            if line.startswith("## "):
                section = line[3:].strip()
            if re.match(r"\| (column|key) \| unit \| is \|", line):
                in_table = True
            elif not line.startswith("|"):
                in_table = False
            elif in_table and not line.startswith("|---"):
                cells = line.strip("|").split("|")
                assert len(cells) == 3, f"{file.name}: three cells expected: {line}"
                names = re.findall(r"`([^`]+)`", cells[0])
                assert names, f"{file.name}: a name in code font expected: {line}"
                sections.setdefault(section, set()).update(names)
    return sections


def keys_of(value, path=""):
    if isinstance(value, dict):
        for key, inner in value.items():
            yield path + key
            yield from keys_of(inner, path + key + ".")
    elif isinstance(value, list):
        for inner in value:
            yield from keys_of(inner, path)


def stands_for(name, written):
    """Whether the documented `name`, in which words in capitals stand for any, names what was written."""
    parts = re.split(r"([A-Z][A-Z]+)", name)
    pattern = "".join(".+" if part.isupper() else re.escape(part) for part in parts)
    return re.fullmatch(pattern, written) is not None


def compare(section, names, written):
    complaints = [f"{section}: `{one}` is written and not documented" for one in sorted(written)
                  if not any(stands_for(name, one) for name in names)]
    complaints += [f"{section}: `{name}` is documented and not written" for name in sorted(names)
                   if not any(stands_for(name, one) for one in written)]
    return complaints


def main():
    app, source = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2])
    docs = documented([source / "docs/readings.md", source / "docs/study-tables.md"])
    written = {}

    def take(section, names):
        written.setdefault(section, set()).update(names)

    def header(file):
        with open(file, newline="", encoding="utf-8") as table:
            return next(csv.reader(table))

    with tempfile.TemporaryDirectory(prefix="seldinger_output_docs_") as name:
        folder = pathlib.Path(name)

        def run(*arguments):
            done = subprocess.run([str(app), *arguments, "--quiet"], cwd=folder, capture_output=True, text=True, timeout=300)
            if done.returncode == 5:
                print("no OpenCL device")
                sys.exit(77)
            assert done.returncode == 0, f"seldinger {' '.join(arguments)}: {done.returncode}: {done.stderr}"

        for stem, text in (("rigid", RIGID), ("elastic", ELASTIC), ("coaxial", COAXIAL), ("driven", DRIVEN), ("swing", SWING)):
            (folder / f"{stem}.toml").write_text(text, encoding="utf-8")
        (folder / "sweep.toml").write_text(SWEEP, encoding="utf-8")
        (folder / "exit_sweep.toml").write_text(EXIT_SWEEP, encoding="utf-8")
        (folder / "instrument_sweep.toml").write_text(SWEEP.replace("wire.", "instrument.0."), encoding="utf-8")
        for stem, extra in (("rigid", ["--error-estimate", "on"]), ("elastic", []), ("coaxial", ["--error-estimate", "on"]), ("driven", [])):
            run("run", f"{stem}.toml", "-o", stem, *extra)
            take("summary.json", keys_of(json.loads((folder / stem / "summary.json").read_text(encoding="utf-8"))))
            for file in sorted((folder / stem).glob("*.csv")):
                kind = "trace.csv" if file.name.startswith("trace") else file.name
                take(kind if kind in ("trace.csv", "contacts.csv") else "wire.csv", header(file))
        (folder / "task.toml").write_text(TASK, encoding="utf-8")
        run("run", "task.toml", "-o", "task")
        take("summary.json", keys_of(json.loads((folder / "task/summary.json").read_text(encoding="utf-8"))))
        run("batch", "task.toml", "--vary", "exit_sweep.toml", "-o", "batch", "--bands")
        take("results.csv", set(header(folder / "batch/results.csv")) - {"scene.duration_s"})
        run("batch", "coaxial.toml", "--vary", "instrument_sweep.toml", "-o", "instruments")
        take("results.csv", set(header(folder / "instruments/results.csv")) - {"instrument.0.density"})
        summary = set(keys_of(json.loads((folder / "batch/summary.json").read_text(encoding="utf-8"))))
        run("batch", "elastic.toml", "--vary", "sweep.toml", "-o", "walls", "--set", "scene.duration_s=0.2")  # pressed on the wall
        summary |= set(keys_of(json.loads((folder / "walls/summary.json").read_text(encoding="utf-8"))))
        take("results.csv", summary - written["summary.json"])  # what a batch's has beside a run's
        run("stability", "swing.toml", "--vary", "wire.density=7000,7900", "--methods", "default", "--quick", "-o", "stability")
        take("stability.csv", header(folder / "stability/stability.csv"))
        run("chart", "--quick", "--scenes", "swing.toml", "--run-limit", "0.2", "--reference-limit", "0.5", "-o", "chart")
        for table in ("chart.csv", "runs.csv", "references.csv"):
            take(table, header(folder / "chart" / table))

    complaints = [line for section in sorted(written) for line in compare(section, docs.get(section, set()), written[section])]
    complaints += [f"{section}: no run of this test writes it" for section in sorted(set(docs) - set(written))]
    print("\n".join(complaints) or f"{sum(map(len, written.values()))} columns and keys are documented, and no others")
    return 1 if complaints else 0


if __name__ == "__main__":
    sys.exit(main())
