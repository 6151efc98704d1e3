#!/usr/bin/env python3
"""compare_hashes.py FILE FILE ...: state hashes of the same scenes by several builds, each file as `./dev hashes` writes it.

Files are called ARCHITECTURE-COMPILER.txt. Builds of one architecture must agree (exit 1); where architectures differ, it is told:
docs/determinism.md has what is promised.
"""
import re
import sys
from pathlib import Path


def read(path):
    lines = path.read_text(encoding="utf-8").splitlines()
    rows = [re.fullmatch(r"([0-9a-f]{16}) (\S+)", line) for line in lines]
    if not rows or not all(rows):
        sys.exit(f"{path}: got {len(lines)} lines; expected a state hash and a scene in each, at least one. Fix: ./dev hashes {path}")
    return {row[2]: row[1] for row in rows}


def main():
    files = [Path(name) for name in sys.argv[1:]]
    if len(files) < 2:
        sys.exit("usage: compare_hashes.py FILE FILE ...")
    builds = {file.stem: read(file) for file in files}
    if len(builds) != len(files):
        sys.exit(f"compare_hashes.py: got {len(files)} files with {len(builds)} names; expected a name for each build")
    scenes = {name: set(rows) for name, rows in builds.items()}
    if len(set(map(frozenset, scenes.values()))) != 1:
        sys.exit(f"compare_hashes.py: the builds ran other scenes: {scenes}")
    failed = False
    for scene in sorted(next(iter(scenes.values()))):
        by_hash = {}
        for name, rows in builds.items():
            by_hash.setdefault(rows[scene], []).append(name)
        same_architecture = [{name.partition("-")[0] for name in names} for names in by_hash.values()]
        differs = len(set().union(*same_architecture)) < sum(map(len, same_architecture))
        failed |= differs
        word = "same" if len(by_hash) == 1 else "DIFFERENT" if differs else "different between architectures"
        print(f"{scene}: {word}: " + "; ".join(f"{value} {', '.join(sorted(names))}" for value, names in sorted(by_hash.items())))
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
