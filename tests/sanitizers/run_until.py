#!/usr/bin/env python3
"""Runs the tests of a build folder until a time is up, and says which were not reached: run_until.py BUILD SECONDS [--jobs N] [--first K].
Where not all of them fit, the first one is another for each K (continuous integration: the number of commits), so that all get their turn.
Ends with 1 where a test failed, with 0 otherwise, however few were run."""

import argparse
import concurrent.futures
import json
import os
import re
import signal
import subprocess
import sys
import time

STRIDE = 37  # prime to the number of tests or nearly so: the next commit begins far from this one


def names_of(build, chosen):
    listed = subprocess.run(["ctest", "--test-dir", build, "--show-only=json-v1", "-R", chosen], capture_output=True, text=True, check=True)
    return [test["name"] for test in json.loads(listed.stdout)["tests"]]


def run_one(build, name, end, show):
    """Whether one test passed; None where the time is up before it begins, or before its end: it is given up then."""
    begun = time.monotonic()
    if begun >= end:
        return name, None
    command = ["ctest", "--test-dir", build, "--output-on-failure", "-R", f"^{re.escape(name)}$"]
    child = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace", start_new_session=True)
    try:
        said = child.communicate(timeout=end - begun)[0]
    except subprocess.TimeoutExpired:
        os.killpg(child.pid, signal.SIGKILL)  # and what it has started
        child.communicate()
        return name, None
    if child.returncode != 0:
        show(f"{name} failed after {time.monotonic() - begun:.0f} s\n{said[-10000:]}")
    return name, child.returncode == 0


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("build")
    parser.add_argument("seconds", type=float)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--tests", default="/test_", help="a regular expression: of the tests these")
    given = parser.parse_args()
    names = names_of(given.build, given.tests)
    if not names:
        print(f"{sys.argv[0]}: {given.build}: no test is called like {given.tests}", file=sys.stderr)
        return 2
    start = given.first * STRIDE % len(names)
    end = time.monotonic() + given.seconds
    with concurrent.futures.ThreadPoolExecutor(given.jobs) as pool:
        say = lambda text: print(text, flush=True)
        results = list(pool.map(lambda name: run_one(given.build, name, end, say), names[start:] + names[:start]))
    failed = [name for name, passed in results if passed is False]
    left = sorted(name for name, passed in results if passed is None)
    print(f"{len(results) - len(left)} of {len(results)} tests run in time, {len(failed)} failed{': ' if failed else ''}{' '.join(failed)}")
    if left:
        print("not run, for want of time: " + " ".join(left))
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
