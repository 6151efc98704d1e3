#!/usr/bin/env python3
"""test_equations.py SOURCE: docs/theory.md has every equation that the code cites by number, and the code cites every one of the page.

A section "## D7 Name" shows its equation, marked (D7), and names the files that implement it; at least one of them cites the number.
"""
import re
import sys
from pathlib import Path

CODE = {".cl", ".cpp", ".h", ".py"}
NUMBER = re.compile(r"(?<![\w.])D(\d{1,2})([a-z]?)(?:[-–]D?(\d{1,2}))?(?!\w)")


def numbers(text):
    """Those that a text cites; D1-D3 are three. In code a D of anything else has no such digits behind it."""
    found = set()
    for first, letter, last in NUMBER.findall(text):
        found |= {f"D{k}" for k in range(int(first), int(last) + 1)} if last else {f"D{first}{letter}"}
    return found


def comments(text):
    """What a file says in words: D15 of a string or a name is no equation."""
    return "\n".join(re.findall(r"(?://|/\*|^ \*|#|\"\"\"|\(D)[^\n]*", text, re.MULTILINE))


def sections(page):
    parts = re.split(r"^## (D\d+[a-z]?) .*$", page, flags=re.MULTILINE)
    return dict(zip(parts[1::2], (re.split(r"^## ", text, flags=re.MULTILINE)[0] for text in parts[2::2])))


def main():
    root = Path(sys.argv[1])
    files = [file for room in ("engine", "kernels", "apps", "python") for file in sorted((root / room).rglob("*")) if file.suffix in CODE]
    cited = {file.relative_to(root).as_posix(): numbers(comments(file.read_text(encoding="utf-8"))) for file in files}
    page = sections((root / "docs/theory.md").read_text(encoding="utf-8"))
    complaints = []
    for name, of_file in cited.items():
        complaints += [f"{name}: cites {number}, which docs/theory.md does not have" for number in sorted(of_file - page.keys())]
    for number, text in page.items():
        if not re.search(rf"^    .*\({number}\)", text, re.MULTILINE):
            complaints.append(f"docs/theory.md: {number} shows no equation marked ({number})")
        named = re.findall(r"`((?:engine|kernels)/[\w/]+\.\w+)`", text.partition("*Files:*")[2])
        complaints += [f"docs/theory.md: {number} names {name}, which is not there" for name in named if not (root / name).is_file()]
        if not any(number in cited.get(name, ()) for name in named):
            complaints.append(f"docs/theory.md: {number} names no file that cites it; it has {named}")
    print("\n".join(complaints) if complaints else f"{len(page)} equations, cited by {sum(map(bool, cited.values()))} files")
    return 1 if complaints or not page else 0


if __name__ == "__main__":
    sys.exit(main())
