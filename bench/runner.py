"""What the scripts of this folder share: run a scene, read what the run wrote, take processor time, options, tables. No script itself."""
import argparse
import csv
import json
import pathlib
import re
import resource
import shlex
import statistics
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
RESULTS = ROOT / "bench" / "results"


def parser(doc, csv=None, app=True):
    """With --app, and with --csv where there is a default for it ("": no table)."""
    made = argparse.ArgumentParser(description=doc, formatter_class=argparse.RawDescriptionHelpFormatter)
    if app:
        made.add_argument("--app", default=str(ROOT / "build" / "seldinger"), help="the program (default: build/seldinger)")
    if csv is not None:
        made.add_argument("--csv", type=pathlib.Path, default=RESULTS / csv if csv else None, help="the table (default: %(default)s)")
    return made


def split_extra(words):
    """A command's own words, and what stands behind `--` for the program."""
    at = words.index("--") if "--" in words else len(words)
    return words[:at], words[at + 1:]


def toml(value):
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(map(toml, value)) + "]"
    return str(value).lower() if isinstance(value, bool) else value if isinstance(value, str) else repr(value)


def sets(settings):
    """--set words of a dict, or of texts key=value."""
    texts = [f"{key}={toml(value)}" for key, value in settings.items()] if isinstance(settings, dict) else settings
    return [word for text in texts for word in ("--set", text)]


def scene(tables):
    """The text of a scene, of {name: {key: value}}; a list of dicts is an array of tables, in the order that is given."""
    def written(value):
        if isinstance(value, dict):
            return "{ " + ", ".join(f"{key} = {written(one)}" for key, one in value.items()) + " }"
        if isinstance(value, (list, tuple)):
            return "[" + ", ".join(map(written, value)) + "]"
        return json.dumps(value) if isinstance(value, (str, bool)) else repr(int(value) if isinstance(value, int) else float(value))

    text = ""
    for name, table in tables.items():
        several = isinstance(table, list)
        for one in table if several else [table]:
            text += f"[[{name}]]\n" if several else f"[{name}]\n"
            text += "".join(f"{key} = {written(value)}\n" for key, value in one.items())
    return text


HELD = {"at": "base", "position": True, "direction": True, "spin": True}
QUIET = {"wire_every": 0, "contacts_every": 0}
LEVEL = {"shape": "straight", "base": [0.0, 0.0, 0.0], "direction": [1.0, 0.0, 0.0], "normal": [0.0, 0.0, 1.0]}


def children_seconds():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def call(command, accept=(0,)):
    """A finished process with its processor `seconds` and `wall`; ends the script where the exit status is none of `accept` (None: any)."""
    command = [str(word) for word in command]
    before, start = children_seconds(), time.perf_counter()
    done = subprocess.run(command, capture_output=True, text=True)
    done.seconds, done.wall = children_seconds() - before, time.perf_counter() - start
    if accept is not None and done.returncode not in accept:
        sys.exit(f"{' '.join(command)}: exit {done.returncode}: {done.stderr.strip()}")
    return done


class Run:
    """What one run said, and what it left in its folder."""

    def __init__(self, folder, done, scratch=None):
        self.folder, self.scratch = pathlib.Path(folder), scratch  # which goes with the run
        self.code, self.said, self.seconds = done.returncode, done.stderr.strip(), done.seconds

    @property
    def summary(self):
        return json.loads((self.folder / "summary.json").read_text())

    def rows(self, name="trace"):
        """Of NAME.csv, numbers as numbers."""
        with open(self.folder / f"{name}.csv", newline="") as file:
            return [{key: number(value) for key, value in row.items()} for row in csv.DictReader(file)]

    def columns(self, name, *columns):
        import numpy as np
        rows = self.rows(name)
        return np.array([[row[key] for key in columns] for row in rows])

    def trace(self, name="trace"):
        import numpy as np
        return np.genfromtxt(self.folder / f"{name}.csv", delimiter=",", names=True)

    def nodes(self, name="wire"):
        return self.columns(name, "x_m", "y_m", "z_m")


def number(text):
    try:
        return float(text)
    except ValueError:
        return text


def run(app, scene, folder=None, settings=(), more=(), accept=(0,), estimate=None):
    """Runs a scene: a file, or the text of one, which is written beside the folder. Without a folder the run has one until it is let go."""
    scratch = None if folder else tempfile.TemporaryDirectory(prefix="seldinger-")
    folder = pathlib.Path(folder or scratch.name + "/run")
    if "\n" in str(scene):
        folder.parent.mkdir(parents=True, exist_ok=True)
        folder.with_name(folder.name + ".toml").write_text(scene, encoding="utf-8")
        scene = folder.with_name(folder.name + ".toml")
    words = [] if estimate is None else ["--error-estimate", estimate]
    made = Run(folder, call([app, "run", scene, "-o", folder, "--overwrite", "--quiet", *words, *sets(settings), *more], accept), scratch)
    made.command = shlex.join(["run", str(scene), *sets(settings), *map(str, more)])  # which repeats it
    return made


class Scenes:
    """Runs texts of scenes, numbered, in one folder."""

    def __init__(self, app, folder, **how):
        self.app, self.folder, self.how, self.runs = app, pathlib.Path(folder), how, 0

    def __call__(self, name, text):
        self.runs += 1
        return run(self.app, text, self.folder / f"{name}-{self.runs}", **self.how)


def in_turn(rounds, **calls):
    """What each of the calls gives, round by round, so that other work on the machine hits all alike: {name: [result of each round]}."""
    results = {name: [] for name in calls}
    for _ in range(rounds):
        for name, what in calls.items():
            results[name].append(what())
    return results


def own_seconds():
    """Processor seconds of this process, all threads."""
    used = resource.getrusage(resource.RUSAGE_SELF)
    return used.ru_utime + used.ru_stime


def memory_mb(process="self"):
    """That a process has in memory."""
    return int(pathlib.Path(f"/proc/{process}/statm").read_text().split()[1]) * resource.getpagesize() / 1e6


def median(values):
    return statistics.median(values)


def read_rows(path, keep=lambda row: True):
    """Of a table that may not be there."""
    if not path or not pathlib.Path(path).exists():
        return []
    with open(path, newline="", encoding="utf-8") as file:
        return [row for row in csv.DictReader(file) if keep(row)]


def write_rows(path, rows, columns=None):
    """A whole table at once, or nothing where there is no path."""
    if not path or not rows:
        return
    path = pathlib.Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    new = path.with_name(path.name + ".new")
    with open(new, "w", newline="", encoding="utf-8") as file:
        table = csv.DictWriter(file, columns or list(rows[0]), lineterminator="\n", restval="")
        table.writeheader()
        table.writerows(rows)
    new.replace(path)


class Table:
    """A table that is written anew with each row; rows of an older one stay where `keep` says so. Rows are dicts, or lists in the columns' order."""

    def __init__(self, path, columns, keep=lambda row: False):
        self.path, self.columns, self.rows = path, columns, read_rows(path, keep)
        if self.rows and list(self.rows[0]) != columns:
            sys.exit(f"{path}: got the columns {', '.join(self.rows[0])}; expected {', '.join(columns)}. Fix: move the table away.")

    def add(self, row, show=True):
        row = row if isinstance(row, dict) else dict(zip(self.columns, row, strict=True))
        self.rows.append(row)
        if show:
            print(*row.values(), sep="  ", flush=True)
        write_rows(self.path, self.rows, self.columns)


def vtp_arrays(path, *names, width=3):
    """Arrays of doubles from a .vtp with raw appended data."""
    import numpy as np
    content = pathlib.Path(path).read_bytes()
    head, raw = content.split(b'<AppendedData encoding="raw">', 1)
    raw, arrays = raw[raw.index(b"_") + 1:], []
    for name in names:
        offset = int(re.search(rb'Float64" Name="' + name.encode() + rb'"[^>]*offset="(\d+)"', head).group(1))
        size = int.from_bytes(raw[offset:offset + 8], "little")
        values = np.frombuffer(raw[offset + 8:offset + 8 + size], dtype="<f8")
        arrays.append(values.reshape(-1, width) if width > 1 else values)
    return arrays
