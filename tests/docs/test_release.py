#!/usr/bin/env python3
"""test_release.py SOURCE [--app PROGRAM]: one version in all places, the changelog's form, and the placeholder for the project's address.

CMakeLists.txt has the version. CHANGELOG.md says whether it is released: then CITATION.cff has the same date and no placeholder is left.
"""
import argparse
import datetime
import re
import subprocess
import sys
import tomllib
from pathlib import Path

HEADINGS = ["Added", "Changed", "Fixed", "Removed"]
LINE = 160                                                            # characters; two lines are no limit without one
NAMES_VERSIONS = {"CMakeLists.txt", "CITATION.cff", "CHANGELOG.md"}   # the others ask CMakeLists.txt
PLACEHOLDER = "forge" + ".invalid"                                    # RFC 2606: a name that never leads anywhere
HAS_ADDRESS = {"pyproject.toml"}                                      # the others read it there, or name the file
LONGEST = 60                                                          # lines of the newest version, which somebody is to read
TEXT = {"", ".cff", ".cmake", ".cpp", ".def", ".h", ".html", ".in", ".js", ".json", ".md", ".py", ".pyi", ".sh", ".toml", ".txt", ".yml"}
ASIDE = re.compile(r"\.git|\..*cache|build.*|out|results")            # folders of measured rows and of what is built


def texts(folder, root):
    """(path from the root, text) of each file that people write."""
    for entry in sorted(folder.iterdir()):
        if entry.is_symlink() or ASIDE.fullmatch(entry.name):
            continue
        if entry.is_dir():
            yield from texts(entry, root)
        elif entry.suffix in TEXT:
            yield entry.relative_to(root).as_posix(), entry.read_text(encoding="utf-8", errors="replace")


def read_changelog(text):
    """([(version, date or None)], complaints)"""
    versions, sections, entry_lines, complaints = [], [], 0, []
    newest = re.split(r"^## ", text, flags=re.MULTILINE)[1:2]
    if newest and (lines := newest[0].rstrip().count("\n") + 1) > LONGEST:
        complaints.append(f"CHANGELOG.md: the newest version has {lines} lines; expected at most {LONGEST}. Fix: say what a user needs to know")
    for number, line in enumerate(text.splitlines(), 1):
        complain = lambda what: complaints.append(f"CHANGELOG.md:{number}: {what}")
        if len(line) > LINE:
            complain(f"{len(line)} characters; expected at most {LINE}")
        if line.startswith("## "):
            heading = re.fullmatch(r"## (\d+\.\d+\.\d+) - (unreleased|\d{4}-\d\d-\d\d)", line)
            if not heading:
                complain(f'got "{line}"; expected "## X.Y.Z - unreleased" or "## X.Y.Z - YYYY-MM-DD"')
                continue
            if versions and not sections:
                complain(f"{versions[-1][0]} has no section")
            date = None if heading[2] == "unreleased" else datetime.date.fromisoformat(heading[2])
            versions.append((heading[1], date))
            sections, entry_lines = [], 0
        elif line.startswith("#") and number > 1:
            name = line.removeprefix("### ")
            if name not in HEADINGS or name in sections or sections and HEADINGS.index(name) < HEADINGS.index(sections[-1]):
                complain(f'got "{line}"; expected "### " and {", ".join(HEADINGS)}, each once and in this order')
            sections += [name] if name in HEADINGS else []
            entry_lines = 0
        elif versions and line:
            entry_lines = 1 if line.startswith("- ") else entry_lines + 1 if line.startswith("  ") and entry_lines else 9
            if not sections or entry_lines > 2:
                complain("expected an entry of at most two lines, in a section. Fix: shorten it, or make two of it")
    if versions and not sections:
        complaints.append(f"CHANGELOG.md: {versions[-1][0]} has no section")
    if sum(date is None for _, date in versions) > 1:
        complaints.append("CHANGELOG.md: several versions are unreleased; expected one, the next")
    numbers = [tuple(map(int, version.split("."))) for version, _ in versions]
    if not numbers or numbers != sorted(set(numbers), reverse=True):
        complaints.append("CHANGELOG.md: expected each version once, the newest first")
    return versions, complaints


def check_version(root, files, version, date, app):
    citation = dict(re.findall(r"^(version|date-released): *([^ #\n]+)", files["CITATION.cff"], re.MULTILINE))
    if citation.get("version") != version:
        yield f"CITATION.cff: version {citation.get('version')}; CMakeLists.txt has {version}"
    if citation.get("date-released") != (date and date.isoformat()):
        yield f"CITATION.cff: date-released {citation.get('date-released')}; CHANGELOG.md has {date or 'unreleased'}"
    package = tomllib.loads(files["pyproject.toml"])
    source = package["tool"]["scikit-build"]["metadata"]["version"]
    found = re.search(source["regex"], (root / source["input"]).read_text())
    if "version" not in package["project"]["dynamic"] or not found or found["value"] != version:
        yield f"pyproject.toml: its regex finds {found and found['value']}; CMakeLists.txt has {version}"
    listed = {c.rpartition(" :: ")[2] for c in package["project"]["classifiers"] if re.search(r":: Python :: 3\.\d+$", c)}
    low, high = map(int, re.fullmatch(r">=3\.(\d+),<3\.(\d+)", package["project"]["requires-python"]).groups())
    if listed != {f"3.{minor}" for minor in range(low, high)}:
        yield f"pyproject.toml: classifiers have Python {sorted(listed)}; requires-python has 3.{low} to 3.{high - 1}"
    if app:
        answer = subprocess.run([app, "--version"], capture_output=True, text=True, check=True).stdout.strip()
        if answer != f"seldinger {version}":
            yield f'{app} --version: got "{answer}"; expected "seldinger {version}"'


def check_elsewhere(files, versions):
    """No other file has a number of ours, which the next release would leave behind."""
    ours = re.compile(r"(?<![\w.])v?(?:" + "|".join(re.escape(version) for version, _ in versions) + r")(?![\w]|\.\d)")
    for path, text in files.items():
        for number, line in enumerate(text.splitlines(), 1):
            if path not in NAMES_VERSIONS and (match := ours.search(line)):
                yield f"{path}:{number}: names version {match[0]}. Fix: take it from CMakeLists.txt, or leave the number out"


def check_address(files, released):
    if "`Repository` in [pyproject.toml](pyproject.toml)" not in files["SECURITY.md"]:
        yield "SECURITY.md: expected `Repository` in [pyproject.toml](pyproject.toml), the address for private reports"
    left = {path: text.count(PLACEHOLDER) for path, text in files.items() if PLACEHOLDER in text}
    if left and left != dict.fromkeys(HAS_ADDRESS, 1):
        yield f"the placeholder {PLACEHOLDER} is in {left}; expected once, in {sorted(HAS_ADDRESS)}, or nowhere"
    if left and released:
        yield f"a version is released, and {sorted(left)} still have the placeholder {PLACEHOLDER}"


def check_tags(root, versions):
    """A version with a tag is released. No git, or no repository (an archive): nothing to compare with."""
    try:
        tags = subprocess.run(["git", "-C", root, "tag", "--list", "v*"], capture_output=True, text=True).stdout.split()
    except OSError:
        return
    dated = {f"v{version}" for version, date in versions if date}
    for tag in tags:
        if tag not in dated:
            yield f"CHANGELOG.md: there is a tag {tag}; expected its version with a date"


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("source", type=Path)
    parser.add_argument("--app")
    options = parser.parse_args()
    files = dict(texts(options.source, options.source))
    version = re.search(r"^project\(Seldinger VERSION (\d+\.\d+\.\d+)\b", files["CMakeLists.txt"], re.MULTILINE)[1]
    versions, complaints = read_changelog(files["CHANGELOG.md"])
    if versions:
        if versions[0][0] != version:
            complaints.append(f"CHANGELOG.md: newest version {versions[0][0]}; CMakeLists.txt has {version}")
        released = any(date for _, date in versions)
        complaints += [*check_version(options.source, files, version, versions[0][1], options.app), *check_elsewhere(files, versions),
                       *check_address(files, released), *check_tags(options.source, versions)]
    print("\n".join(complaints) if complaints else f"{version}: {len(files)} files agree")
    return 1 if complaints else 0


if __name__ == "__main__":
    sys.exit(main())
