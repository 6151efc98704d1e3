#!/usr/bin/env python3
"""test_workflow.py SOURCE: the workflow for the day of publication, and the comparison of state hashes that it ends with.

Looked at by yamllint (Debian) and check-jsonschema (PyPI), where they are installed, and by rules of its own: both compilers on both
architectures, every command of ./dev and every script exists, a name in ${{ }} is given. Exit 77 without Python's yaml (python3-yaml).
"""
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

FILE = ".github/workflows/ci.yml"


def expect(condition, what):
    if not condition:
        sys.exit(f"test_workflow: {what}")


def look_with_linters(path):
    looked = []
    rules = "{extends: default, rules: {line-length: {max: 160}}}"
    for words in (["yamllint", "--strict", "-d", rules, path], ["check-jsonschema", "--builtin-schema", "vendor.github-workflows", path]):
        if not shutil.which(words[0]):
            continue
        done = subprocess.run(words, capture_output=True, text=True)
        expect(done.returncode == 0, f"{words[0]}: {done.stdout}{done.stderr}")
        looked.append(words[0])
    return looked


def combinations(strategy):
    """The cells of a matrix, with what `include` adds to them."""
    matrix = dict(strategy["matrix"])
    added = matrix.pop("include", [])
    cells = [{}]
    for key, values in matrix.items():
        cells = [{**cell, key: value} for cell in cells for value in values]
    for extra in added:
        met = [cell for cell in cells if all(cell[key] == value for key, value in extra.items() if key in matrix)]
        expect(met, f"{FILE}: include {extra} fits no cell")
        for cell in met:
            cell.update(extra)
    return cells


def check_jobs(source, jobs):
    dev = (source / "dev").read_text()
    known = set(re.findall(r"^    ([a-z-]+)\) ", dev[dev.rindex('case "${1:-}" in'):], re.MULTILINE))
    for name, job in jobs.items():
        expect(job.get("timeout-minutes"), f"{FILE}: {name} has no limit of time")
        for needed in [job["needs"]] if isinstance(job.get("needs"), str) else job.get("needs", []):
            expect(needed in jobs, f"{FILE}: {name} needs {needed}, which is no job")
        for step in job["steps"]:
            expect(("run" in step) != ("uses" in step), f"{FILE}: {name}: got a step {step}; expected run or uses")
            expect("uses" not in step or re.fullmatch(r"actions/[a-z-]+@v\d+", step["uses"]), f"{FILE}: {name} uses {step.get('uses')}")
            for command in re.findall(r"\./dev ([a-z-]+)", step.get("run", "")):
                expect(command in known, f"{FILE}: {name}: ./dev has no {command}")
            for script in re.findall(r"\S+\.py\b", step.get("run", "")):
                expect((source / script).is_file(), f"{FILE}: {name}: {script} is not there")
        cells = combinations(job["strategy"]) if "strategy" in job else [{}]
        for given in re.findall(r"\$\{\{ *(.*?) *\}\}", str(job)):
            expect(given.startswith("matrix.") and all(given[7:] in cell for cell in cells), f"{FILE}: {name}: ${{{{ {given} }}}} is not given everywhere")
    cells = combinations(jobs["build"]["strategy"])
    expect({(c["architecture"], c["compiler"], c["cxx"]) for c in cells} ==
           {(a, *c) for a in ("x86_64", "arm64") for c in (("gcc", "g++"), ("clang", "clang++"))}, f"{FILE}: the builds are {cells}")
    expect(all(("arm" in c["runner"]) == (c["architecture"] == "arm64") for c in cells), f"{FILE}: an architecture has the other's runner: {cells}")


def check_comparison(source):
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)

        def compare(**hashes):
            for stem, text in hashes.items():
                (folder / f"{stem.replace('_', '-')}.txt").write_text(text)
            files = [folder / f"{stem.replace('_', '-')}.txt" for stem in hashes]
            done = subprocess.run([sys.executable, source / "tests/golden/compare_hashes.py", *files], capture_output=True, text=True)
            return done.returncode, done.stdout + done.stderr

        one, other = "0123456789abcdef arch\n", "0123456789abcde0 arch\n"
        expect(compare(x_gcc=one, x_clang=one, arm_gcc=one)[0] == 0, "equal hashes are refused")
        code, said = compare(x_gcc=one, x_clang=other, arm_gcc=one)
        expect(code == 1 and "arch: DIFFERENT: " in said and "x-clang" in said, f"compilers that differ: exit {code}: {said}")
        code, said = compare(x_gcc=one, x_clang=one, arm_gcc=other)
        expect(code == 0 and "different between architectures" in said, f"architectures that differ: exit {code}: {said}")
        for broken in ("", "no hash\n"):
            expect(compare(x_gcc=one, x_clang=broken)[0] == 1, f"a file with {broken!r} is taken for hashes")
        expect(compare(x_gcc=one, x_clang=one + "0123456789abcdef swing\n")[0] == 1, "a scene that one build has not run goes unseen")


def main():
    source = Path(sys.argv[1]).resolve()
    check_comparison(source)
    try:
        import yaml
    except ImportError:
        print("skipped: Python's yaml is not installed; apt-get install python3-yaml")
        return 77
    with open(source / FILE, encoding="utf-8") as file:
        workflow = yaml.safe_load(file)
    check_jobs(source, workflow["jobs"])
    looked = look_with_linters(source / FILE)
    print(f"{len(workflow['jobs'])} jobs" + ("".join(f"; {name} has nothing to say" for name in looked) or "; left out: yamllint, check-jsonschema are not installed"))
    return 0


if __name__ == "__main__":
    sys.exit(main())
