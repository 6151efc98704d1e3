#!/usr/bin/env python3
"""How many of the compiler's edges were reached in a reader: edges.py FILES [LEFT-OUT] < OUTPUT. The output is that of a fuzz target with
-runs=0 -print_coverage=1 over its corpus; FILES is a regular expression on paths below engine/, LEFT-OUT one on the names of functions
in them that do not read. Exception paths and the sanitizers' own branches are edges too."""
import re
import sys


def main():
    files, left_out = re.compile(sys.argv[1]), re.compile(sys.argv[2] if len(sys.argv) > 2 else '__cxx_global_var_init')
    reached = there = 0
    for line in sys.stdin:
        found = re.match(r'(?:UN)?COVERED_FUNC: hits: \d+ edges: (\d+)/(\d+) (.*) \S*/engine/(\S+):\d+$', line)
        if found and files.search(found[4]) and not left_out.search(found[3]):
            reached, there = reached + int(found[1]), there + int(found[2])
    print(f'{reached} of {there}')


if __name__ == '__main__':
    main()
