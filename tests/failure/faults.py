#!/usr/bin/env python3
"""Faults x commands: what is done to a run or a batch, and whether it goes on to the bits of one that was left alone.

faults.py SELDINGER [--long] [--seed N] [--only WORDS]: prints the table, each row on stderr as it ends, so that a long one that is stopped has told
what it knew; exit 1 where something was not survived. Survived: no end by a signal that
was not sent, an error of one line, nothing half written left after the next run, and the same hash once resumed.
"""
import argparse, os, random, resource, shutil, signal, subprocess, sys, tempfile, time
from pathlib import Path

HERE = Path(__file__).resolve().parent
SCENE = ('[scene]\nname = "faults"\nduration_s = 0.4\ndt_s = 0.001\nrecord_every = 5\n' + (HERE.parent / "scenes/tube.toml").read_text() + """\
keys = [ {t_s = 0.0, advance_m = 0.004, turn_rad = 0.0}, {t_s = 1.0, advance_m = 0.084, turn_rad = 1.0} ]
[output]
wire_every = 20
contacts_every = 20
""")
SWEEP = '[vary]\n"contact.mu_sliding" = [0.05, 0.1, 0.15]\n'
CODES = {0, 2, 3, 4, 5, 75, 130}


class Bench:
    def __init__(self, app, folder, rng):
        self.app, self.folder, self.rng = app, folder, rng
        (folder / "s.toml").write_text(SCENE)
        (folder / "v.toml").write_text(SWEEP)
        self.commands = {"run": ["run", "s.toml"], "batch": ["batch", "s.toml", "--vary", "v.toml"]}
        self.truth, self.seconds = {}, {}
        for name in self.commands:
            for again in range(2):  # the first one builds kernels
                start = time.monotonic()
                done = self.call(name, "whole-" + name, "--overwrite")
                self.seconds[name] = time.monotonic() - start
            assert done.returncode == 0, done.stderr
            self.truth[name] = self.result(name, "whole-" + name)

    def words(self, name, dir, *more):
        return [self.app, *self.commands[name], "-o", dir, "--quiet", *more]

    def call(self, name, dir, *more, env=None, limit=None):
        return subprocess.run(self.words(name, dir, *more), cwd=self.folder, env={**os.environ, **(env or {})}, preexec_fn=limit,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=300)

    def result(self, name, dir):
        import json
        if name == "run":
            return json.loads((self.folder / dir / "summary.json").read_text())["state_hash"]
        return (self.folder / dir / "results.csv").read_text()

    def clean(self, done):
        return done.returncode in CODES and done.stderr.count("\n") <= 2

    def goes_on(self, name, dir):
        """Resumed, it ends with the bits of a run in one piece, and nothing half written is left."""
        done = self.call(name, dir, "--resume")
        left = list((self.folder / dir).glob("*.tmp"))
        return done.returncode == 0 and not left and self.result(name, dir) == self.truth[name]

    def fresh(self, label):
        dir = "d-" + label
        shutil.rmtree(self.folder / dir, ignore_errors=True)
        return dir

    def signalled(self, name, which, env=None):
        dir = self.fresh(name)
        child = subprocess.Popen(self.words(name, dir), cwd=self.folder, env={**os.environ, **(env or {})},
                                 stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        time.sleep(self.rng.uniform(0, 1.1 * self.seconds[name]))
        child.send_signal(which)
        try:
            _, err = child.communicate(timeout=60)
        except subprocess.TimeoutExpired:
            child.kill()
            return False
        ok = child.returncode in ({0, -9} if which == signal.SIGKILL else {0, 75 if which == signal.SIGTERM else 130, 128 + which, -which})
        survived = ok and err.count("\n") <= 1 and self.goes_on(name, dir)
        if not survived: print(f"{name}, {which.name}: exit {child.returncode}, stderr {err!r}", file=sys.stderr)
        return survived

    def full(self, name, n, shim):
        dir = self.fresh(name)
        done = self.call(name, dir, env={"LD_PRELOAD": str(shim), "FAULT_DIR": str(self.folder / dir), "FAULT_WRITE": str(n)})
        return done, done.returncode in (0, 3) and self.clean(done) and self.goes_on(name, dir)

    def clock_jumps(self, name, shim, every):
        """The wall clock alone goes an hour back and forth: nobody looks at it, the run ends. The steady one: a time limit may end it."""
        dir = self.fresh(name)
        wall = self.call(name, dir, env={"LD_PRELOAD": str(shim), "FAULT_JUMP_EVERY": str(every)})
        ok = wall.returncode == 0 and self.clean(wall) and self.result(name, dir) == self.truth[name]
        dir = self.fresh(name)
        steady = self.call(name, dir, "--time-limit", "600", env={"LD_PRELOAD": str(shim), "FAULT_JUMP_EVERY": str(every), "FAULT_JUMP_ALL": "1"})
        return ok and steady.returncode in (0, 75) and self.clean(steady) and self.goes_on(name, dir)

    def loses_device(self, name, n, shim):
        """Every command to the device fails from the n-th on: exit 5, unless the run was over before."""
        dir = self.fresh(name)
        done = self.call(name, dir, env={"LD_PRELOAD": str(shim), "FAULT_DEVICE": str(n)})
        said = done.returncode == 0 or "CL_DEVICE_NOT_AVAILABLE" in done.stderr
        return done.returncode in (0, 5) and said and self.clean(done) and self.goes_on(name, dir)

    def limited(self, name, what, value):
        dir = self.fresh(name)
        done = self.call(name, dir, limit=lambda: resource.setrlimit(what, (value, value)))
        return self.clean(done) and self.goes_on(name, dir)

    def two(self, name):
        dir = self.fresh(name)
        pair = [subprocess.Popen(self.words(name, dir), cwd=self.folder, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
                for _ in range(2)]
        codes = sorted(one.wait(timeout=300) for one in pair)
        for one in pair: one.stderr.close()
        return codes[0] == 0 and codes[1] in (2, 3) and self.result(name, dir) == self.truth[name]

    def no_cache(self, name):
        (self.folder / "file").write_text("")
        dir = self.fresh(name)
        done = self.call(name, dir, env={"POCL_CACHE_DIR": str(self.folder / "file/cache")})
        return done.returncode == 0 and self.result(name, dir) == self.truth[name]


def main():
    options = argparse.ArgumentParser()
    options.add_argument("app")
    options.add_argument("--long", action="store_true")
    options.add_argument("--seed", type=int, default=1)
    options.add_argument("--only", default="", help="rows that have these words in them")
    given = options.parse_args()
    folder = Path(tempfile.mkdtemp(prefix="seldinger-faults-"))
    table, begun = [], time.monotonic()

    def note(*row):
        table.append(row)
        print(f"{time.monotonic() - begun:.0f} s: {row[1]}, {row[0]}: {row[3]} of {row[2]}", file=sys.stderr, flush=True)

    try:
        shims = {name: folder / f"{name}.so" for name in ("fail_write", "jump_clock", "lose_device")}
        compiler = shutil.which("cc") or shutil.which("gcc")
        if not compiler:
            print("no C compiler for the shim")
            return 77
        for name, shim in shims.items():
            subprocess.run([compiler, "-shared", "-fPIC", "-O1", "-o", shim, HERE.parent / f"support/{name}.c", "-ldl"], check=True)
        shim = shims["fail_write"]
        bench = Bench(os.path.abspath(given.app), folder, random.Random(given.seed))
        mega = 1 << 20
        slow_end = {"LD_PRELOAD": str(shim), "FAULT_EXIT_MS": "60"}  # a driver that takes its time to close
        for name in bench.commands:
            share = 1 if name == "run" else 3
            kills, others = (500 // share, 100 // share) if given.long else (30 // share, 6 // share)
            rows = [("kill -9 at a random moment, resumed", [lambda: bench.signalled(name, signal.SIGKILL)] * kills),
                    ("SIGTERM at a random moment, resumed", [lambda: bench.signalled(name, signal.SIGTERM)] * others),
                    ("SIGINT at a random moment, resumed", [lambda: bench.signalled(name, signal.SIGINT)] * others),
                    ("SIGTERM, and a process slow to end", [lambda: bench.signalled(name, signal.SIGTERM, slow_end)] * others),
                    # of three the system's loader opens none for a library, and there is no program
                    ("descriptors: 4 ... 64", [lambda n=n: bench.limited(name, resource.RLIMIT_NOFILE, n)
                                               for n in (range(4, 65) if given.long else (4, 6, 8, 10, 14, 20))]),
                    ("address space: 64 MB ... 4 GB", [lambda n=n: bench.limited(name, resource.RLIMIT_AS, n * mega)
                                                      for n in ((64, 128, 192, 256, 384, 512, 768, 1024, 2048, 4096) if given.long
                                                                else (128, 512, 2048))]),
                    ("two at once in one folder", [lambda: bench.two(name)] * (20 if given.long else 2)),
                    ("clocks that jump by an hour", [lambda n=n: bench.clock_jumps(name, shims["jump_clock"], n)
                                                     for n in ((1, 2, 3, 5, 10, 20, 50, 100, 200, 500) if given.long else (3, 50))]),
                    ("device gone from its n-th command on", [lambda n=n: bench.loses_device(name, n, shims["lose_device"])
                                                              for n in (range(1, 20000, 199) if given.long else (1, 40, 400, 1500, 4000, 8000))]),
                    ("kernel cache not writable", [lambda: bench.no_cache(name)])]
            for what, tries in rows:
                if given.only in what: note(what, name, len(tries), sum(bool(one()) for one in tries))
            what = "disk full from the n-th write on, every n" + ("" if given.long else " of 7")
            if given.only not in what: continue
            tried = survived = 0
            n, step = 1, 1 if given.long else 7
            while True:  # until a run no longer notices
                done, ok = bench.full(name, n, shim)
                tried, survived, n = tried + 1, survived + ok, n + step
                if done.returncode == 0: break
            note(what, name, tried, survived)
    finally:
        shutil.rmtree(folder, ignore_errors=True)
    print("| fault | command | tried | survived |\n|---|---|---|---|")
    for what, name, tried, survived in table:
        print(f"| {what} | `{name}` | {tried} | {survived} |")
    return 1 if any(tried != survived for _, _, tried, survived in table) else 0


if __name__ == "__main__":
    sys.exit(main())
