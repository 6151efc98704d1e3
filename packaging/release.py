#!/usr/bin/env python3
"""release.py SOURCE [--address URL] [--no-sign]: dates the version of CMakeLists.txt, and commits and tags it.

The owner's one command for a release (CONTRIBUTING.md). CHANGELOG.md and CITATION.cff get today's date, pyproject.toml the project's address
where it still has the placeholder; tests/docs/test_release.py must agree. Nothing is changed where anything is refused.
"""
import argparse
import datetime
import re
import subprocess
import sys
from pathlib import Path

PLACEHOLDER = "https://forge" + ".invalid/seldinger"
CHANGED = ["CHANGELOG.md", "CITATION.cff", "pyproject.toml"]


def git(root, *words, check=True):
    done = subprocess.run(["git", "-C", root, *words], capture_output=True, text=True)
    if check and done.returncode:
        sys.exit(f"release: git {' '.join(words)}: {done.stderr.strip()}")
    return done


def replaced(root, file, pattern, text):
    path = root / file
    new, count = re.subn(pattern, text, path.read_text(encoding="utf-8"), count=1, flags=re.MULTILINE)
    if not count:
        raise ValueError(f"{file}: got nothing like {pattern}")
    path.write_text(new, encoding="utf-8")


def date_it(root, version, address):
    today = datetime.datetime.now(datetime.timezone.utc).date().isoformat()
    replaced(root, "CHANGELOG.md", rf"^## {re.escape(version)} - unreleased$", f"## {version} - {today}")
    replaced(root, "CITATION.cff", rf"^version: {re.escape(version)}.*$", f"version: {version}\ndate-released: {today}")
    if address:
        replaced(root, "pyproject.toml", r"^# A placeholder: .*\n(\[project.urls\]\nRepository = )\".*\"$", rf'\1"{address}"')
    done = subprocess.run([sys.executable, root / "tests/docs/test_release.py", root], capture_output=True, text=True)
    if done.returncode:
        raise ValueError(done.stdout.strip())


def main():
    parser = argparse.ArgumentParser(prog="./dev release", description=__doc__)
    parser.add_argument("source", type=Path)
    parser.add_argument("--address", help="of the project, https://HOST/PATH; at the first release")
    parser.add_argument("--no-sign", action="store_true", help="a tag without a signature")
    options = parser.parse_args()
    root = options.source.resolve()
    version = re.search(r"^project\(Seldinger VERSION (\d+\.\d+\.\d+)\b", (root / "CMakeLists.txt").read_text(), re.MULTILINE)[1]
    if git(root, "status", "--porcelain").stdout:
        sys.exit("release: the folder has changes that are not committed. Fix: commit or remove them")
    if git(root, "rev-parse", "-q", "--verify", f"refs/tags/v{version}", check=False).returncode == 0:
        sys.exit(f"release: there is a tag v{version} already. Fix: set the next version in CMakeLists.txt, CITATION.cff and CHANGELOG.md")
    if PLACEHOLDER not in (root / "pyproject.toml").read_text(encoding="utf-8"):
        options.address = None
    elif not options.address or not re.fullmatch(r"https://[\w-]+(\.[\w-]+)+/[\w./~-]+", options.address):
        sys.exit(f"release: --address: got {options.address}; expected the project's address, https://HOST/PATH: pyproject.toml has a placeholder")
    try:
        date_it(root, version, options.address)
    except ValueError as why:
        git(root, "checkout", "--", *CHANGED)
        sys.exit(f"release: {'; '.join(str(why).splitlines())}")
    git(root, "commit", "-q", "-a", "-m", f"Release {version}")
    tagged = git(root, "tag", "-a" if options.no_sign else "-s", f"v{version}", "-m", f"Seldinger {version}", check=False)
    if tagged.returncode:
        git(root, "reset", "-q", "--hard", "HEAD~1")
        sys.exit(f"release: git tag: {'; '.join(tagged.stderr.split(chr(10))).strip('; ')}. Fix: set user.signingkey, or give --no-sign")
    print(f"{version} is committed and tagged v{version}. To publish it: git push origin HEAD v{version}")


if __name__ == "__main__":
    main()
