#!/usr/bin/env python3
"""Names x commands: what lies in the way of a command that writes or removes, and what its folder may be called.

names_matrix.py SELDINGER [--long] [--share K/N] [--only WORDS]: in the place of each file and folder that a command makes lies a link to
somebody's file, to somebody's folder or to nothing, a second name of somebody's file, a pipe, a device; and its folder has a name with
blanks, line breaks, %, colons, quotes or bytes that are no UTF-8. A cell is lost where something outside of the folder differs
afterwards, a pipe or a device is gone, what somebody keeps to himself stands in what was written, the command ends by a signal or does
not end, or says more than a line and its advice. A folder with an odd name must do as a plain one does, or be refused whole.
Prints the table, and every cell that was lost; exit 1 where one was. Without --long the slow commands are left out.
"""
import argparse, filecmp, os, re, shutil, signal, stat, subprocess, sys, tempfile
from pathlib import Path

from faults import SCENE, SWEEP

SECONDS = 60
LINES = 4  # of a farm of two tasks: each, what came of both, and advice
SECRET = b"a-secret-of-somebody-else"
CODES = {0, 2, 3, 4, 5, 75}
OBSTACLES = ["link to a file", "link to a folder", "link to nothing", "hard link", "pipe", "device"]
NAMES = {"blanks": b"a  b ", "line break": b"a\nb", "percent": b"100%d%j", "colon": b"run-10:00", "scheme": b"tcp:h", "quotes": b"a'b\"c",
         "no UTF-8": b"\xff\xfe\xe4", "hash": b"#a", "backslash": b"a\\b", "dash": b"-x"}
SHORT = SCENE.replace("duration_s = 0.4", "duration_s = 0.02")
# names that a command uses on the way, beside those that it leaves
PASSING = {"run": [".lock", "trace.csv"], "batch": [".lock"], "farm": ["parts.json.lock", "parts/1-of-2.lock",
           "parts/1-of-2.bin.lock"], "film": ["film.mp4.part"], "picture": ["p.png.part"],
           "plan": ["plan.toml.lock", "plan.pilots"], "live": ["live.record.lock"]}


class Command:
    """Words with {D} for the folder; `before` makes the folder that it begins with."""
    def __init__(self, name, words, passing="", before=None, slow=False, reads=False, env=None, program=None):
        self.name, self.words, self.before, self.slow, self.reads = name, words, before, slow, reads
        self.passing, self.env, self.program = PASSING.get(passing, []), env or {}, program


def commands(bench):
    cli = lambda *words: bench.call([bench.app, *words])
    def run(d): cli("run", "s.toml", "-o", d, "--quiet")
    def stopped(d): cli("run", "s.toml", "-o", d, "--quiet", "--time-limit", "1e-6")
    def batch(d): cli("batch", "s.toml", "--vary", "v.toml", "-o", d, "--quiet")
    def half(d): cli("batch", "s.toml", "--vary", "v.toml", "-o", d, "--quiet", "--time-limit", "1e-6")
    def planned(d): cli("farm", "s.toml", "--vary", "v.toml", "-o", d, "--tasks", "2", "--dry-run")
    def farmed(d): cli("farm", "s.toml", "--vary", "v.toml", "-o", d, "--tasks", "2", "--quiet")
    def pictured(d): cli("farm", "R", "--frames", "0:1", "--size", "64x64", "-o", d, "--quiet")
    def runs(d): shutil.copytree(b"R", d)
    C = Command
    every = [
        C("run", ["run", "s.toml", "-o", "{D}", "--quiet"], "run"),
        C("run --overwrite", ["run", "s.toml", "-o", "{D}", "--quiet", "--overwrite"], "run", run),
        C("run --resume", ["run", "s.toml", "-o", "{D}", "--quiet", "--resume"], "run", stopped),
        C("batch", ["batch", "s.toml", "--vary", "v.toml", "-o", "{D}", "--quiet"], "batch"),
        C("batch --overwrite", ["batch", "s.toml", "--vary", "v.toml", "-o", "{D}", "--quiet", "--overwrite"], "batch", batch),
        C("batch --resume", ["batch", "s.toml", "--vary", "v.toml", "-o", "{D}", "--quiet", "--resume"], "batch", half),
        C("farm", ["farm", "s.toml", "--vary", "v.toml", "-o", "{D}", "--tasks", "2", "--quiet"], "farm"),
        C("batch --part", ["batch", "s.toml", "--vary", "v.toml", "-o", "{D}", "--part", "1/2", "--quiet"], "farm", planned),
        C("farm status", ["farm", "status", "{D}"], "farm", farmed),
        C("farm merge", ["farm", "merge", "{D}"], "farm", farmed),
        C("farm, slurm", ["farm", "s.toml", "--vary", "v.toml", "-o", "{D}", "--tasks", "2", "--backend", "slurm"], "farm"),
        C("report", ["report", "{D}"], before=runs, reads=True),
        C("vessel -o", ["vessel", "R/vessel.vtp", "--units", "m", "-o", "{D}"]),
        C("kernel cache", ["check", "tube.toml"], program=["run", "tube.toml", "-o", "cache-run", "--overwrite", "--quiet"],
          env={"POCL_CACHE_DIR": "{D}"}, before=lambda d: bench.cache(d), slow=True),
        C("plot_run.py", [], program=["{python}", "{assets}/plot_run.py", "R", "-o", "{D}/p.png"], slow=True),
        C("live --record", ["live", "tube.toml", "--record", "{D}/live.record", "--duration", "0.05", "--port", "0", "--udp", "0", "--quiet"], "live"),
        C("plan", ["plan", "s.toml", "--tolerance", "1mm", "--budget", "2", "-o", "{D}/plan.toml", "--quiet"], "plan", slow=True),
        C("stability", ["stability", "longer.toml", "--vary", "wire.density=7000", "--quick", "--cell-budget", "0.5", "-o", "{D}", "--quiet"], "run", slow=True),
    ]
    if not bench.draws: return every
    return every + [
        C("farm of frames", ["farm", "R", "--frames", "0:1", "--size", "64x64", "-o", "{D}", "--quiet"], "farm"),
        C("farm merge --video", ["farm", "merge", "{D}", "--video", "{D}/film.mp4"], "film", pictured, reads=True),
        C("render -o", ["render", "R", "--size", "64x64", "-o", "{D}/p.png"], "picture"),
        C("render, of the folder", ["render", "{D}", "--size", "64x64", "--frames", "0:1"], before=runs, reads=True),
        C("render --video", ["render", "R", "--size", "64x64", "--frames", "0:1", "--video", "{D}/film.mp4"], "film"),
        C("render --gltf --usd", ["render", "R", "--gltf", "{D}/m.glb", "--usd", "{D}/m.usda"]),
        C("fluoro -o", ["render", "R", "--view", "fluoro", "--size", "32x32", "-o", "{D}/p.png"], "picture"),
        C("fluoro --video --raw --dicom", ["render", "R", "--view", "fluoro", "--size", "32x32", "--video", "{D}/film.mp4", "--raw", "{D}/x.npy",
                                           "--dicom", "{D}/x.dcm"], "film"),
        C("init", ["init", "R/vessel.vtp", "--units", "m", "-o", "{D}/scene.toml", "--overwrite"]),
    ]


class Bench:
    def __init__(self, app, assets, folder):
        self.app, self.assets, self.folder = app, assets, folder
        os.chdir(folder)
        Path("s.toml").write_text(re.sub(r"\[vessel\].*?(?=\[feed\])", "", SHORT, flags=re.S).replace("[contact]\ndetection = \"capsule\"\n", "").split("[feed]")[0]
                                  + '[[hold]]\nat = "base"\nposition = true\ndirection = true\nspin = true\n[output]\nwire_every = 10\n')
        Path("longer.toml").write_text(Path("s.toml").read_text().replace("duration_s = 0.02", "duration_s = 0.04"))  # the longest step is 0.033 s
        Path("tube.toml").write_text(SHORT)
        Path("v.toml").write_text('[vary]\n"wire.density" = [6000.0, 7000.0]\n')
        made = self.call([app, "run", "tube.toml", "-o", "R", "--quiet"])
        assert made.returncode == 0, made.stderr
        self.draws = shutil.which("ffmpeg") and self.call([app, "render", "R", "--size", "64x64", "-o", "try.png"]).returncode == 0
        self.may_make_devices = self.tries_a_device()

    def tries_a_device(self):
        try:
            os.mknod("device", 0o600 | stat.S_IFCHR, os.makedev(1, 3))
            return True
        except OSError:
            return False

    def call(self, words, env=None):
        return subprocess.run(words, env={**os.environ, **(env or {})}, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                              timeout=SECONDS)

    def cache(self, d):
        """A cache of PoCL's with things of somebody's in it."""
        given = os.environ.get("POCL_CACHE_DIR", "/nowhere")
        shutil.copytree(given, os.fsdecode(d)) if Path(given).is_dir() else os.mkdir(d)
        for name in ("plugin.so", "AA/model.bc", "lib/notes.so"):
            os.makedirs(os.path.dirname(os.path.join(os.fsdecode(d), name)), exist_ok=True)
            Path(os.fsdecode(d), name).write_bytes(b"no ELF")

    def go(self, command, d):
        spell = lambda w: w.replace("{D}", os.fsdecode(d)).replace("{python}", sys.executable).replace("{assets}", str(self.assets))
        words = [spell(w) for w in (command.program or command.words)]
        if not words[0].startswith("/"): words = [self.app, *words]
        try:
            return self.call([os.fsencode(w) for w in words], {k: spell(v) for k, v in command.env.items()})
        except subprocess.TimeoutExpired:
            return None

    def begin(self, command, d):
        shutil.rmtree(d, ignore_errors=True)
        if not command.before:
            os.mkdir(d)
            return
        template = b"begin-" + re.sub(r"\W", "_", command.name).encode()
        if not os.path.isdir(template): command.before(template)
        shutil.copytree(template, d, symlinks=True)


def listing(top):
    """Every file below, as its path, kind and bytes."""
    found = {}
    for folder, folders, files in os.walk(os.fsencode(top)):
        for name in folders + files:
            path = os.path.join(folder, name)
            kind = stat.S_IFMT(os.lstat(path).st_mode)
            rest = Path(os.fsdecode(path)).read_bytes() if kind == stat.S_IFREG else os.readlink(path) if kind == stat.S_IFLNK else b""
            found[os.path.relpath(path, os.fsencode(top))] = kind, rest
    return found


def make_victims(names):
    """Somebody's files: under every name that the command might take for its own, in two depths."""
    shutil.rmtree("victims", ignore_errors=True)
    os.mkdir("victims")
    Path("victims/file").write_bytes(SECRET)
    trees = ("tree", "tree/000000")
    for inner in trees: os.makedirs(f"victims/{inner}/deeper", exist_ok=True)
    for inner in trees:
        Path(f"victims/{inner}/deeper/notes").write_bytes(SECRET)
        for name in names:
            path = Path(f"victims/{inner}", Path(name).name)
            if not path.exists(): path.write_bytes(SECRET)


def put(kind, path):
    """@return whether it could be put there"""
    if os.path.lexists(path):
        shutil.rmtree(path) if os.path.isdir(path) and not os.path.islink(path) else os.unlink(path)
    if not os.path.isdir(os.path.dirname(path)): os.makedirs(os.path.dirname(path))
    here = os.getcwd()
    if kind == "link to a file": os.symlink(f"{here}/victims/file", path)
    if kind == "link to a folder": os.symlink(f"{here}/victims/tree", path)
    if kind == "link to nothing": os.symlink(f"{here}/victims/none", path)
    if kind == "hard link": os.link("victims/file", path)
    if kind == "pipe": os.mkfifo(path)
    if kind == "device": os.mknod(path, 0o600 | stat.S_IFCHR, os.makedev(1, 3))


def said_well(done):
    return done is not None and done.returncode in CODES and done.stderr.count(b"\n") <= LINES


def try_obstacle(bench, command, kind, name):
    """@return what was lost, or nothing"""
    bench.begin(command, b"D")
    make_victims(command.made)
    path = os.path.join("D", name)
    put(kind, path)
    kept, what = listing("victims"), stat.S_IFMT(os.lstat(path).st_mode)
    done = bench.go(command, b"D")
    if listing("victims") != kept: return "somebody's files differ"
    if kind in ("pipe", "device") and (not os.path.lexists(path) or stat.S_IFMT(os.lstat(path).st_mode) != what): return f"the {kind} is gone"
    if not said_well(done): return "no answer" if done is None else f"exit {done.returncode}: {done.stderr[-300:]!r}"
    for path, (form, rest) in listing("D").items():
        # a second name of a file is that file: a reader of one is a reader of both
        if form == stat.S_IFREG and SECRET in rest and kind != "hard link": return f"{path!r} tells what somebody keeps to himself"
    return None


# what differs from one run to the next
TIMES = re.compile(rb"log/|checkpoint|parts/.*\.bin|summary|\.json$|\.html$|trace\.csv$|\.record$|\.lock|job\.sh|\.glb$|\.dcm$|scene\.toml$|\.usda$|\.png$|\.mp4$|\.pilots|cells\.csv|maps\.json|stability|plan")


def try_name(bench, command, name):
    around = {n for n in os.listdir(b".")}
    bench.begin(command, name)
    before = listing(name)
    done = bench.go(command, name)
    after = listing(name)
    if not said_well(done): return "no answer" if done is None else f"exit {done.returncode}: {done.stderr[-300:]!r}"
    if {n for n in os.listdir(b".")} - around - {name, b"cache-run"} - {b"begin-" + re.sub(r"\W", "_", command.name).encode()}: return "something is made beside it"
    if done.returncode != command.code:
        return None if done.returncode in (2, 3) and after == before else f"exit {done.returncode}, plain {command.code}: {done.stderr[-300:]!r}"
    plain = {n for n in command.plain if b".pilots" not in n}  # as many as there was time for
    after = {n: what for n, what in after.items() if b".pilots" not in n}
    if set(after) != plain: return f"other files: {sorted(set(after) ^ set(command.plain))[:4]}"
    differ = [n for n in after if not TIMES.search(n) and after[n] != command.plain[n]]
    return f"differ: {differ[:4]}" if differ else None


def main():
    options = argparse.ArgumentParser()
    options.add_argument("app")
    options.add_argument("--assets", type=Path, default=Path(__file__).resolve().parents[2] / "assets")
    options.add_argument("--long", action="store_true", help="the slow commands too")
    options.add_argument("--share", default="1/1", help="every N-th cell, from K on")
    options.add_argument("--only", default="", help="commands that have these words in their names")
    given = options.parse_args()
    app, assets = os.path.abspath(given.app), given.assets.resolve()
    first, every = map(int, given.share.split("/"))
    folder = tempfile.mkdtemp(prefix="seldinger-names-")
    os.umask(0o077)
    table, lost, at = {}, [], 0
    try:
        bench = Bench(app, assets, folder)
        for command in commands(bench):
            if given.only not in command.name or command.slow and not given.long: continue
            bench.begin(command, b"D")
            done = bench.go(command, b"D")
            assert done is not None and done.returncode in (0, 4, 5), (command.name, done)
            command.code, command.plain = done.returncode, listing("D")
            command.made = sorted({os.fsdecode(n) for n in command.plain if not n.startswith(b"AA") or b"." in n} | set(command.passing))
            cells = [(kind, lambda kind=kind, n=n: try_obstacle(bench, command, kind, n), n) for n in command.made for kind in OBSTACLES
                     if kind != "device" or bench.may_make_devices]
            cells += [(kind, lambda n=n: try_name(bench, command, n), "") for kind, n in NAMES.items()]
            for kind, cell, name in cells:
                at += 1
                if at % every != first % every: continue
                said = cell()
                tried, well = table.get((command.name, kind), (0, 0))
                table[command.name, kind] = tried + 1, well + (said is None)
                if said: lost.append(f"{command.name}, {kind} {name}: {said}")
                if said: print("lost:", lost[-1], file=sys.stderr, flush=True)
            row = [t for (name, _), t in table.items() if name == command.name]
            print(f"{command.name}: {sum(t[1] for t in row)} of {sum(t[0] for t in row)}", file=sys.stderr, flush=True)
    finally:
        os.chdir("/")
        shutil.rmtree(folder, ignore_errors=True)
    kinds = OBSTACLES + list(NAMES)
    print("| command | " + " | ".join(kinds) + " |\n|---" * 1 + "|---" * len(kinds) + "|")
    for name in dict.fromkeys(name for name, _ in table):
        row = [table.get((name, kind)) for kind in kinds]
        print(f"| `{name}` | " + " | ".join("" if t is None else f"{t[0]}" if t[0] == t[1] else f"**{t[1]} of {t[0]}**" for t in row) + " |")
    tried = sum(t for t, _ in table.values())
    print(f"\n{tried} cells, {len(lost)} lost")
    return 1 if lost or tried == 0 else 0


if __name__ == "__main__":
    sys.exit(main())
