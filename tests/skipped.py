#!/usr/bin/env python3
"""skipped.py LOG: what a run of ctest has skipped, from its Testing/Temporary/LastTest.log: each entry, or part of one, with its reason.
Tests name in the reason the command that would enable them."""
import re
import sys


def reasons_of(output):
    """Lines of tests/support/main.cpp and of scripts (skipped: REASON), and of pytest -rs (SKIPPED [2] FILE:LINE: REASON)."""
    found = re.findall(r"^skipped: (.+)$|^SKIPPED \[\d+\] (?:\S*/)?(\S+?:(?:\d+:)? .+)$", output, re.MULTILINE)
    return list(dict.fromkeys(own or pytest for own, pytest in found))


def main():
    with open(sys.argv[1], errors="replace") as file:
        entries = re.findall(r"^\d+/\d+ Test: (\S+)$.*?^Output:\n-+\n(.*?)^<end of output>", file.read(), re.MULTILINE | re.DOTALL)
    lines = [f"  {name}: {reason}" for name, output in entries for reason in reasons_of(output)]
    if lines:
        print(f"dev: skipped: {len(lines)}", *lines, sep="\n")


if __name__ == "__main__":
    main()
