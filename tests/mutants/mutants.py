#!/usr/bin/env python3
"""Breaks one line at a time and asks the tests by meaning whether they notice.

    ninja -C build all_tests && tests/mutants/mutants.py run                # the drawn list, in its order
    tests/mutants/mutants.py run --by-hand                                  # tests/mutants/by_hand.txt
    tests/mutants/mutants.py run --again --entries 'rod/test_handover'      # those that survived, against these entries
    tests/mutants/mutants.py table                                          # what is known, as Markdown
    tests/mutants/mutants.py list                                           # what is drawn, with what it breaks

Golden rows and tests of the command are left out: they say "changed", not "wrong". The source tree is never written to. A mutant is a
copy of one file below build/mutants, compiled alone and linked before the engine's library; so nothing has to be restored, and nothing
can be left behind. The other files of its unity group are compiled alone once, because a call inside a group may have been inlined.
Results are kept in build/mutants/results.json: what is there is not run again. The same seed and the same files draw the same list; to
go on with a list that other sources drew: `git worktree add /tmp/then COMMIT`, then `run --seed N --drawn-in /tmp/then`.

Entries run in an order: the mutated file's room first, short ones first; the first failure ends a mutant. An entry that uses ten times
the processor time that it takes otherwise, and 20 s, counts as a failure ("times out"). An entry that fails counts only if it passes
without the mutant. Headers and kernels are not drawn: each would compile a room anew.
"""
import argparse, json, os, random, re, resource, shlex, shutil, subprocess, sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
ROOMS = {"rod": ["engine/bodies/rod/*.cpp", "engine/bodies/nodes/*.cpp"], "solve": ["engine/physics/solve/*.cpp", "engine/physics/newton/*.cpp"], "contact": ["engine/physics/contact/*.cpp", "engine/physics/contact/*/*.cpp"], "wall": ["engine/elastic/*/*.cpp"],
         "step": ["engine/physics/stages/*.cpp", "engine/physics/world/sub_steps.cpp", "engine/physics/world/merged*.cpp", "engine/physics/world/*rod.cpp"]}
# rooms of tests in the order in which they may know; what is in no list has nothing to do with it
TESTS = {"rod": "rod nodes coaxial solve step scene run contact failure", "solve": "solve rod step coaxial contact scene run failure wall",
         "contact": "contact vessel coaxial step solve failure scene run", "wall": "wall surface contact failure solve step run record",
         "step": "step coaxial solve scene run failure contact session", "": "io scene run view batch plan lab"}
LEFT_OUT = re.compile(r"^(golden|apps|docs|package|device|bench)/|checkpoint_mutants|test_limits|test_touching_wires")

# ---------------------------------------------------------------------------------------------------------------- what can break
NAME = r"[A-Za-z_][\w.]*(?:\[[^\[\]]*\]|\([^()]*\))?"
SWAPS = {"std::min(": "std::max(", "std::max(": "std::min(", "std::cos(": "std::sin(", "std::sin(": "std::cos(",
         "minCoeff": "maxCoeff", "maxCoeff": "minCoeff"}
NOT_BROKEN = re.compile(r'^\s*(#|//|using |template|namespace|struct |class |case |throw |\}|friend |public:|private:)|SEL_ASSERT|SEL_TIMED|static_assert|'
                        r'"|operator|reserve\(|fmt::|Error\(|noexcept|override|\bauto&? \[|//\.|->save|restore\(')


def code_of(line):
    return line.split("//")[0].rstrip()


def breaks(line, draw):
    """[(kind, start, end, replacement)] of a line of code; factors are drawn."""
    code, found = code_of(line), []
    def each(kind, pattern, make, group=0):
        for m in re.finditer(pattern, code):
            found.append((kind, m.start(group), m.end(group), make(m) if callable(make) else make))
    factor = lambda: draw.choice(["0.3", "0.5", "2", "10"])
    each("sign", r" \+ ", " - ")
    each("sign", r" - ", " + ")
    each("sign", r" \+= ", " -= ")
    each("sign", r" -= ", " += ")
    each("sign", r"(?:(?<=[(=,?:] )|(?<=\()|(?<=return ))-(?=[A-Za-z_(])", "")
    each("factor", r"(?<![\w.])(?!0\.0*\b)(\d+\.\d*(?:e-?\d+)?|\d+e-\d+)(?![\w.])", lambda m: f"({factor()} * {m[0]})")
    each("factor", r" [+-]= (?!.*, (?:\+\+|--))([^;]+);", lambda m: f"{factor()} * ({m[1]})", 1)
    each("factor", r"\breturn ([^;{}?&|<>]*[*/][^;{}?&|<>]*);", lambda m: f"{factor()} * ({m[1]})", 1)
    each("factor", r"\bdouble \w+ = (?!0[;.])(?!.*, \w+ = )([^;{}?&|]*);", lambda m: f"{factor()} * ({m[1]})", 1)
    for m in re.finditer(rf"(?<=\w\()({NAME}), ({NAME})(?=[,)])", code):
        if m[1] != m[2]: found.append(("swap", m.start(), m.end(), f"{m[2]}, {m[1]}"))
    for m in re.finditer(rf"(?<=, )({NAME}), ({NAME})(?=[,)])", code):
        if m[1] != m[2]: found.append(("swap", m.start(), m.end(), f"{m[2]}, {m[1]}"))
    each("term", rf" [+-] {NAME}(?: [*/] {NAME})*(?=[;,)]| [+-] )", "")
    each("term", r"^(\s+)(?!return\b|if\b|for\b|else\b|const\b|auto\b)[\w.\[\]()>:-]+(?: [+*/-]?= [^;]*|\([^;{}]*\));$", lambda m: m[1] + ";")
    each("term", r"^(\s+)if \(.*\) (?:return[^;]*|continue|break);$", lambda m: m[1] + ";")
    each("off by one", r" [+-] 1\b(?!\.)", "")
    each("off by one", r"(?<=\bint \w) = 0;", " = 1;")
    each("off by one", r"(?<=for \(int \w = )\d+;", lambda m: f"{int(m[0][:-1]) + 1};")
    each("off by one", r"(?<=[;(] )(\w+ <=? [^;]+)(?=; (?:\+\+|--))", lambda m: m[0] + " - 1")
    each("off by one", r"\[(\w+)\]", lambda m: f"{m[1]} + 1" if not m[1].isdigit() else str((int(m[1]) + 1) % 2), 1)
    for old, new in ((" < ", " <= "), (" <= ", " < "), (" > ", " >= "), (" >= ", " > "), (" == ", " != "), (" != ", " == "), (" && ", " || "),
                     (" || ", " && ")):
        each("compare", re.escape(old), new)
    for old, new in SWAPS.items():
        each("min, max, cos, sin", re.escape(old), new)
    return found


def draw_list(seed, root):
    """All that can break, in the order of the draw: a kind, then any of its places; one for each line."""
    draw, places = random.Random(seed), {}
    for room, patterns in ROOMS.items():
        for file in sorted({f for p in patterns for f in root.glob(p)}):
            for number, line in enumerate(file.read_text().splitlines(), 1):
                if NOT_BROKEN.search(line): continue
                for kind, start, end, new in breaks(line, draw):
                    places.setdefault(kind, []).append(dict(file=str(file.relative_to(root)), line=number, kind=kind, room=room, before=line.strip(),
                                                            after=(line[:start] + new + line[end:]).strip(), text=line[:start] + new + line[end:]))
    seen, kinds = set(), sorted(places)
    while any(places.values()):
        kind = draw.choice(kinds)
        if not places[kind]: continue
        place = places[kind].pop(draw.randrange(len(places[kind])))
        if (place["file"], place["line"]) in seen or place["before"] == place["after"]: continue
        seen.add((place["file"], place["line"]))
        yield place


def here(mutant):
    """A mutant drawn in other sources, in the sources of now: the same line, the nearest one if there are several. None if it is gone."""
    lines = (ROOT / mutant["file"]).read_text().splitlines() if (ROOT / mutant["file"]).exists() else []
    same = [i + 1 for i, line in enumerate(lines) if line.strip() == mutant["before"]]
    return dict(mutant, line=min(same, key=lambda at: abs(at - mutant["line"]))) if same else None


def by_hand():
    """FILE | BEFORE | AFTER, both parts of one line of the file."""
    for row in (ROOT / "tests/mutants/by_hand.txt").read_text().splitlines():
        if not row.strip() or row.startswith("#"): continue
        file, before, after = (part.strip() for part in row.split(" | "))
        lines = (ROOT / file).read_text().splitlines()
        where = [i for i, line in enumerate(lines) if before in line]
        if len(where) != 1:
            sys.exit(f"tests/mutants/by_hand.txt: got {len(where)} lines of {file} with `{before}`; expected one. Fix: bring the row up to date.")
        line = lines[where[0]]
        room = {"nodes": "rod", "world": "step", "stages": "step"}.get(Path(file).parent.name, Path(file).parent.name)
        yield dict(file=file, line=where[0] + 1, kind="by hand", room=room if room in TESTS else "", before=line.strip(),
                   after=line.replace(before, after).strip(), text=line.replace(before, after))


# ---------------------------------------------------------------------------------------------------------------- building and running
class Build:
    def __init__(self, folder):
        self.folder, self.made = folder, folder / "mutants"
        self.newest_header = max(f.stat().st_mtime for f in ROOT.glob("engine/**/*.h"))
        self.made.mkdir(exist_ok=True)
        self.sources = {}  # file: (its command, files of its group)
        for entry in json.loads(self.ninja("-t", "compdb")):
            source = Path(entry["file"])
            if "c++" not in entry["command"] or not source.is_relative_to(ROOT): continue
            inside = [source]
            if source.suffix == ".cxx": inside = [Path(p) for p in re.findall(r'#include "(.*)"', source.read_text())]
            for file in inside: self.sources[str(file.relative_to(ROOT))] = (entry["command"], inside)
        self.costs, costs = {}, folder / "Testing/Temporary/CTestCostData.txt"
        for row in costs.read_text().splitlines() if costs.exists() else []:
            if len(row.split()) == 3: self.costs[row.split()[0]] = float(row.split()[2])
        self.tests = {}
        for test in json.loads(subprocess.run(["ctest", "--test-dir", folder, "--show-only=json-v1"], check=True, capture_output=True).stdout)["tests"]:
            command = test.get("command", [""])
            if Path(command[0]).name in ("seldinger_quick_tests", "seldinger_tests") and not LEFT_OUT.search(test["name"]):
                self.tests[test["name"]] = Path(command[0]).name
        self.links = {program: self.link_command(program) for program in ("seldinger_quick_tests", "seldinger_tests")}
        self.passes = {}  # entry: whether it passes without a mutant

    def ninja(self, *arguments):
        return subprocess.run(["ninja", "-C", self.folder, "--quiet", *arguments], check=True, capture_output=True, text=True).stdout

    def link_command(self, program):
        words = shlex.split(self.ninja("-t", "commands", program).strip().splitlines()[-1].removeprefix(": && ").removesuffix(" && :"))
        output = words.index("-o")
        first = next(i for i, word in enumerate(words) if word.endswith(".o"))
        return words[:first], [self.part(word) for word in words[first:output] + words[output + 2:]]

    def part(self, word):
        """A copy of what is linked: the folder may be built again meanwhile."""
        source = self.folder / word
        if word.startswith(("-", "/")) or not source.exists(): return word
        copy = self.made / "parts" / word
        copy.parent.mkdir(parents=True, exist_ok=True)
        if not copy.exists() or copy.stat().st_mtime != source.stat().st_mtime: shutil.copy2(source, copy)
        return str(copy)

    def compile(self, source, text, target):
        command, _ = self.sources[source]
        words = shlex.split(command[command.index("/c++") - command[:command.index("/c++")][::-1].index(" "):])
        for option in ("-MT", "-MF", "-o", "-c"):
            del words[words.index(option):words.index(option) + 2]
        target.parent.mkdir(parents=True, exist_ok=True)
        copy = target.parent / Path(source).name
        copy.write_text(text)
        words = [w for w in words if w not in ("-MD", "-g1")] + ["-w", "-g0", f"-ffile-prefix-map={copy}={source}", "-c", str(copy), "-o", str(target)]
        return subprocess.run(words, cwd=self.folder, capture_output=True, text=True)

    def alone(self, file):
        """The object of an unchanged file, compiled alone: anew if it or any header of the engine is newer."""
        target = self.made / "alone" / file.replace("/", "_") / "x.o"
        source = ROOT / file
        if not target.exists() or target.stat().st_mtime < max(source.stat().st_mtime, self.newest_header):
            done = self.compile(file, source.read_text(), target)
            if done.returncode: sys.exit(f"{file}: does not compile alone\n{done.stderr}")
        return target

    def link(self, program, objects, target):
        head, tail = self.links[program]
        subprocess.run([*head, "-fuse-ld=lld", *map(str, objects), *tail, "-o", str(target)], cwd=self.folder, check=True, capture_output=True)

    def entry(self, program, name, limit):
        """0 passes, 77 is skipped, anything else fails, and that it has used up its time."""
        environment = dict(os.environ, SELDINGER_VESSEL_CACHE="off")
        environment.setdefault("POCL_CACHE_DIR", str(self.folder / "pocl-cache"))
        limits = lambda: resource.setrlimit(resource.RLIMIT_CPU, (int(limit), int(limit) + 1))
        try:
            done = subprocess.run([program, f"--source-file=*/{name}.cpp", "--no-intro", "--abort-after=1"], cwd=self.folder / "tests", env=environment,
                                  capture_output=True, preexec_fn=limits, timeout=60 + 10 * limit)
        except subprocess.TimeoutExpired:  # waits for what never comes
            return 1, True
        return done.returncode, done.returncode in (-24, -9)

    def order(self, room, entries, without):
        rooms = TESTS[room].split()
        chosen = [t for t in self.tests if re.search(entries, t)] if entries else [t for t in self.tests if t.split("/")[0] in rooms]
        if without: chosen = [t for t in chosen if not re.search(without, t)]
        rank = lambda t: rooms.index(t.split("/")[0]) if t.split("/")[0] in rooms else len(rooms)
        cost = lambda t: self.costs.get(t, 1)
        # the own room's short ones, others' short ones, then the long ones
        return sorted(chosen, key=lambda t: ((cost(t) > 1) + (cost(t) > 4), rank(t), cost(t)))

    def run(self, mutant, arguments, ran):
        """What becomes of it: (fate, entry). Entries in `ran` have not noticed it; it is added to."""
        place = self.made / f"one-{os.getpid()}"  # several may run
        lines = (ROOT / mutant["file"]).read_text().split("\n")
        lines[mutant["line"] - 1] = mutant["text"]
        done = self.compile(mutant["file"], "\n".join(lines), place / "x.o")
        if done.returncode: return "does not compile", ""
        group = [str(f.relative_to(ROOT)) for f in self.sources[mutant["file"]][1]]
        if (place / "x.o").read_bytes() == self.alone(mutant["file"]).read_bytes(): return "same code", ""
        objects = [place / "x.o"] + [self.alone(f) for f in group if f != mutant["file"]]
        linked = {}
        for name in self.order(mutant["room"], arguments.entries, arguments.without):
            if self.costs.get(name, 1) > arguments.longest or (name in ran and not arguments.entries): continue  # named ones may be new
            program = self.tests[name]
            if program not in linked:
                linked[program] = place / program
                self.link(program, objects, linked[program])
            code, timed_out = self.entry(linked[program], name, 20 + 10 * self.costs.get(name, 1))
            if code in (0, 77) or not self.passes_alone(name):
                ran.append(name)
                continue
            return "times out" if timed_out else "caught", name
        return "survived", ""

    def passes_alone(self, name):
        if name not in self.passes:
            self.passes[name] = self.entry(self.folder / "tests" / self.tests[name], name, 60 + 10 * self.costs.get(name, 1))[0] in (0, 77)
            if not self.passes[name]: print(f"  {name} fails without a mutant: it does not count", flush=True)
        return self.passes[name]


# ---------------------------------------------------------------------------------------------------------------- commands
def key(mutant):
    return f"{mutant['file']}:{mutant['line']}: {mutant['before']} -> {mutant['after']}"


def reasons():
    """By hand: FILE | BEFORE | AFTER | why no test can see it."""
    file = ROOT / "tests/mutants/equivalent.txt"
    rows = [row.split(" | ") for row in file.read_text().splitlines() if row.count(" | ") >= 3] if file.exists() else []
    return {(row[0].strip(), row[1].strip(), row[2].strip()): " | ".join(row[3:]).strip() for row in rows}


def chosen(arguments):
    if arguments.by_hand: yield from by_hand()
    else: yield from filter(None, map(here, draw_list(arguments.seed, arguments.drawn_in.resolve())))


def run(arguments, build):
    kept = build.made / f"results{'-by-hand' if arguments.by_hand else ''}.json"
    results = json.loads(kept.read_text()) if kept.exists() else {}
    count, equivalent = 0, reasons()
    for mutant in chosen(arguments):
        if count == arguments.count: break
        known = results.get(key(mutant))
        if arguments.again and not known: break
        named = (mutant["file"], mutant["before"], mutant["after"]) in equivalent
        if not known or (arguments.again and known["fate"] == "survived" and not named):
            begun = resource.getrusage(resource.RUSAGE_CHILDREN)
            ran = known["ran"] if known else []
            fate, entry = build.run(mutant, arguments, ran)
            children = resource.getrusage(resource.RUSAGE_CHILDREN)
            seconds = children.ru_utime + children.ru_stime - begun.ru_utime - begun.ru_stime
            before = known["before"] if known else f"{fate} {entry}".strip()
            results[key(mutant)] = known = dict(fate=fate, entry=entry, before=before, cpu=seconds, ran=ran)
            if kept.exists(): results |= {k: v for k, v in json.loads(kept.read_text()).items() if k != key(mutant)}  # another may be running
            kept.with_suffix(".tmp").write_text(json.dumps(results, indent=1))
            kept.with_suffix(".tmp").replace(kept)
            print(f"{mutant['file']}:{mutant['line']}  {mutant['kind']}\n  - {mutant['before']}\n  + {mutant['after']}\n  {fate} {entry} ({seconds:.0f} s)", flush=True)
        count += known["fate"] not in ("does not compile", "same code")


def table(arguments, build):
    results = json.loads((build.made / f"results{'-by-hand' if arguments.by_hand else ''}.json").read_text())
    why, rows, fates = reasons(), [], {}
    print("| # | file | before → after | without the new tests | now |\n|---|---|---|---|---|")
    count = 0
    for mutant in chosen(arguments):
        known = results.get(key(mutant))
        if count == arguments.count or not known: break
        if known["fate"] in ("does not compile", "same code"): continue
        count += 1
        equivalent = why.get((mutant["file"], mutant["before"], mutant["after"]))
        now = f"equivalent: {equivalent}" if known["fate"] == "survived" and equivalent else f"{known['fate']} {known['entry']}".strip()
        fates.setdefault("before", []).append(re.match(r"survived|times out|caught|not run", known["before"])[0])
        fates.setdefault("now", []).append("equivalent" if now.startswith("equivalent") else known["fate"])
        cell = lambda text: text.replace("|", "\\|")
        print(f"| {count} | {mutant['file']}:{mutant['line']} | `{cell(mutant['before'])}` → `{cell(mutant['after'])}` | {known['before']} | {now} |")
    for when, list_of in fates.items():
        print(f"\n{when}: " + ", ".join(f"{list_of.count(f)} {f}" for f in sorted(set(list_of))))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("action", choices=["run", "table", "list"])
    parser.add_argument("--by-hand", action="store_true", help="those of tests/mutants/by_hand.txt")
    parser.add_argument("--seed", type=int, default=41)
    parser.add_argument("--drawn-in", type=Path, default=ROOT, metavar="FOLDER",
                        help="draw in these sources, an older commit's for example; break the same lines here")
    parser.add_argument("--count", type=int, default=60, help="mutants that compile and differ")
    parser.add_argument("--again", action="store_true", help="run those that survived once more")
    parser.add_argument("--entries", default="", help="regular expression: only these test entries")
    parser.add_argument("--without", default="", help="regular expression: not these")
    parser.add_argument("--longest", type=float, default=20, help="no entry that takes longer than these seconds")
    parser.add_argument("--build", type=Path, default=ROOT / "build")
    arguments = parser.parse_args()
    if arguments.action == "list":
        for _, mutant in zip(range(arguments.count), chosen(arguments)): print(f"{mutant['kind']:20} {key(mutant)}")
        return
    build = Build(arguments.build)
    try:
        (run if arguments.action == "run" else table)(arguments, build)
    finally:
        shutil.rmtree(build.made / f"one-{os.getpid()}", ignore_errors=True)


if __name__ == "__main__":
    main()
