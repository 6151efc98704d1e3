#!/usr/bin/env python3
"""Compares two benchmarks, stage by stage: old -> new and the ratio of the times (below 1: faster).

    compare.py OLD NEW [--worse 1.1]

OLD and NEW are folders that `seldinger bench -o DIR` wrote, or single CSV files of the same kind (bench_scenes.py's too: the last row of
each scene counts). Rows are matched by what they measure; what only one side has is named at the end. Exit code 1 when something
became slower than --worse times (default: never), 2 when there is nothing to compare.
"""
import argparse
import csv
import pathlib
import sys

KEYS = ["scene", "options", "kernel", "precision", "lane", "items", "triangles", "query"]
ORIGIN = ["date", "commit", "compiler", "device", "driver"]


def better_when_small(name):
    """True: a time; False: a rate; None: neither, only shown when it differs."""
    if name.endswith(("_ms", "_us", "_s", "_ns")) and "_per_" not in name:
        return True
    if "_per_s" in name and not name.startswith(("lowest", "highest")):
        return False
    return None


def read_rows(path):
    try:
        with open(path, newline="", encoding="utf-8") as stream:
            return list(csv.DictReader(stream))
    except OSError as error:
        sys.exit(f"compare.py: {path}: {error.strerror}")


def key_of(row):
    return tuple((name, row[name]) for name in KEYS if row.get(name) not in (None, "")
                 and not (name == "triangles" and "scene" in row and "steps_per_s" in row))


def label(key):
    return " ".join(value.rsplit("/", 1)[-1] for _, value in key) or "device"


def number(text):
    try:
        return float(text)
    except (TypeError, ValueError):
        return None


def compare(old_rows, new_rows, worse, name):
    old, new = {key_of(r): r for r in old_rows}, {key_of(r): r for r in new_rows}
    slower = 0
    rows = 0
    for side, table in (("old", old), ("new", new)):
        row = next(iter(table.values()), {})
        print(f"{name} {side}: " + ", ".join(row.get(k, "") for k in ORIGIN if row.get(k)))
    for key in old:
        if key not in new:
            continue
        for column in old[key]:
            small = better_when_small(column)
            a, b = number(old[key][column]), number(new[key].get(column))
            if small is None or a is None or b is None or (a == 0 and b == 0):
                continue
            ratio = (b / a if small else a / b) if a and b else float("inf")
            mark = "  slower" if ratio > (worse or 1.05) else "  faster" if ratio < 1 / 1.05 else ""
            slower += worse is not None and ratio > worse
            rows += 1
            print(f"  {label(key):48} {column:26} {a:12.5g} -> {b:12.5g}   time x {ratio:.3f}{mark}")
        if old[key].get("state_hash") != new[key].get("state_hash"):
            print(f"  {label(key):48} state_hash {old[key].get('state_hash')} -> {new[key].get('state_hash')}: not the same result")
    for key in old.keys() ^ new.keys():
        print(f"  {label(key):48} only in {'old' if key in old else 'new'}")
    return rows, slower


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("old", type=pathlib.Path)
    parser.add_argument("new", type=pathlib.Path)
    parser.add_argument("--worse", type=float, help="exit 1 when a time grew by more than this factor")
    options = parser.parse_args()
    if options.old.is_dir() != options.new.is_dir():
        sys.exit("compare.py: give two folders or two files")
    pairs = [(options.old, options.new)]
    if options.old.is_dir():
        names = [n for n in ("device.csv", "kernels.csv", "scenes.csv") if (options.old / n).exists() and (options.new / n).exists()]
        pairs = [(options.old / n, options.new / n) for n in names]
    rows = slower = 0
    for old, new in pairs:
        some, worse = compare(read_rows(old), read_rows(new), options.worse, new.stem)
        rows += some
        slower += worse
    if rows == 0:
        print("compare.py: nothing that both have", file=sys.stderr)
        sys.exit(2)
    if slower:
        print(f"{slower} slower than x {options.worse}")
        sys.exit(1)


if __name__ == "__main__":
    main()
