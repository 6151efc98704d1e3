#!/usr/bin/env python3
"""test_skipped.py: tests/skipped.py finds what doctest, scripts and pytest say, of each entry, once; and says nothing of a run that skipped nothing."""
import subprocess
import sys
import tempfile
from pathlib import Path

SKIPPED = Path(__file__).resolve().parent.parent / "skipped.py"


def block(number, name, output):
    return (f'{number}/3 Testing: {name}\n{number}/3 Test: {name}\nCommand: "x"\nDirectory: /\n"{name}" start time: Nov 28\nOutput:\n'
            f"{'-' * 58}\n{output}<end of output>\nTest time =   0.01 sec\n{'-' * 58}\nTest Passed.\n\n")


def said(*blocks):
    with tempfile.NamedTemporaryFile("w") as log:
        log.write("".join(blocks))
        log.flush()
        return subprocess.run([sys.executable, SKIPPED, log.name], check=True, capture_output=True, text=True).stdout.splitlines()


def main():
    whole = block(1, "core/test_a", "[doctest] Status: SUCCESS!\n")
    script = block(2, "web/page", "skipped: no chromium: apt-get install chromium\n")
    pytest = block(3, "python", "..s\nSKIPPED [2] python/tests/test_gym.py:6: no gymnasium: pip install gymnasium\n3 passed, 2 skipped\n")
    assert said(whole) == []
    assert said(whole, script, pytest) == ["dev: skipped: 2", "  web/page: no chromium: apt-get install chromium",
                                           "  python: test_gym.py:6: no gymnasium: pip install gymnasium"], said(whole, script, pytest)


if __name__ == "__main__":
    main()
