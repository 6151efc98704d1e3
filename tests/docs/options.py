#!/usr/bin/env python3
"""options.py SELDINGER PAGE [--write]: docs/options.md is what `--help` of every command says; --write brings it up to date.

The texts have one source, the parser in apps/: this script asks the program, follows subcommands, and makes the tables.
"""
import re
import subprocess
import sys
from pathlib import Path

HEAD = """# Options of every command

Written by `tests/docs/options.py` from `--help`; `docs/options` in ctest holds the page to the program. What the commands do: [command-line.md](command-line.md).
"""
ANCHORS = {"chart": "speed-accuracy.md", "stability": "stability.md", "plan": "planner.md", "live": "live.md", "farm": "farm.md", "labels": "labels.md", "dataset": "labels.md#a-data-set-in-one-command",
           "instruments": "instruments.md", "init": "command-line.md#a-first-scene", "render": "command-line.md#what-a-picture-shows",
           "batch": "command-line.md#what-a-batch-does", "bench": "command-line.md#what-a-benchmark-measures", "run": "command-line.md#what-a-run-writes"}


def help_of(app, words):
    done = subprocess.run([app, *words, "--help"], capture_output=True, text=True, timeout=60)
    if done.returncode != 0:
        sys.exit(f"{app} {' '.join(words)} --help: exit {done.returncode}: {done.stderr.strip()}")
    return done.stdout


def parsed(text):
    """(first line, {heading: [(names, meaning)]}). Meanings begin in column 30; a longer name has its own on the next line."""
    lines = text.splitlines()
    parts, rows = {}, None
    for line, after in zip(lines[1:], [*lines[2:], ""]):
        if re.fullmatch(r"\w+:", line):
            rows = parts.setdefault(line[:-1], [])
        elif rows is not None and re.match(r"  \S", line):
            names, meaning = (line, "") if after.startswith(" " * 30) else (line[:30], line[30:])
            rows.append([names.strip(), meaning.strip()])
        elif rows and line.strip():
            rows[-1][1] = f"{rows[-1][1]} {line.strip()}".strip()
    return lines[0], parts


def row(names, meaning):
    names, _, others = names.partition(" Excludes: ")
    required = " REQUIRED" in names
    names = names.replace(" REQUIRED", "").replace(" TEXT", "")
    meaning = (meaning + "; required" if required and names.startswith("-") else meaning) + (f"; not with {', '.join(others.split())}" if others else "")
    return "| `{}` | {} |".format(names.replace("|", "\\|"), meaning.replace("|", "\\|").replace("<", "&lt;").replace("[", "\\["))


def rows_of(app, words, found):
    """{command: rows of its options}, for a command and those below it."""
    _, parts = parsed(help_of(app, words))
    found[" ".join(words)] = [row(*entry) for heading in ("Positionals", "Options") for entry in parts.get(heading, ()) if not entry[0].startswith("-h,")]
    for below, _ in parts.get("Subcommands", ()):
        rows_of(app, [*words, below], found)
    return found


def shared(rows):
    """{row: commands} of the options that at least three commands have with the same text: they stand once, in a table of their own."""
    commands = {}
    for name, its in rows.items():
        for one in its:
            if one.startswith("| `-"):
                commands.setdefault(one, []).append(f"`{name}`")
    return {one: names for one, names in commands.items() if len(names) >= 3}


def section(app, words, rows, several):
    """The section of one command, and those of the commands below it."""
    text, parts = parsed(help_of(app, words))
    name = " ".join(words)
    more = f" More: [{ANCHORS[name].partition('#')[0]}]({ANCHORS[name]})." if name in ANCHORS else ""
    lines = [f"## {name}", "", text[0].upper() + text[1:] + "." + more, ""]
    own = [one for one in rows[name] if one not in several]
    lines += ["| option | meaning |", "|---|---|", *own, ""] if own else []
    for below, _ in parts.get("Subcommands", ()):
        lines += section(app, [*words, below], rows, several)
    return lines


def main():
    app, page = sys.argv[1], Path(sys.argv[2])
    _, parts = parsed(help_of(app, []))
    commands = [name for name, _ in parts["Subcommands"]]
    rows = {}
    for name in commands:
        rows_of(app, [name], rows)
    several = shared(rows)
    table = ["## Several commands", "", "| option | meaning | commands |", "|---|---|---|", *(f"{one} {', '.join(names)} |" for one, names in several.items()), ""]
    text = HEAD + "\n" + "\n".join(table + [line for name in commands for line in section(app, [name], rows, several)]).rstrip("\n") + "\n"
    if "--write" in sys.argv:
        page.write_text(text, encoding="utf-8")
    if page.read_text(encoding="utf-8") == text:
        print(f"{len(commands)} commands, {text.count('| `')} options")
        return 0
    old = set(page.read_text(encoding="utf-8").splitlines())
    print(f"{page}: differs from --help: tests/docs/options.py {app} {page} --write")
    print("\n".join(f"  new: {line}" for line in text.splitlines() if line not in old))
    return 1


if __name__ == "__main__":
    sys.exit(main())
