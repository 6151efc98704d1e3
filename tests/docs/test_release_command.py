#!/usr/bin/env python3
"""test_release_command.py SOURCE: what `./dev release` does, in a copy of the source with a repository of its own.

Exit 77, which ctest shows as Skipped, where the source is no repository of git's.
"""
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ADDRESS = "https://code.example.org/people/seldinger"


def expect(condition, what):
    if not condition:
        sys.exit(f"test_release_command: {what}")


def main():
    source = Path(sys.argv[1]).resolve()
    listed = subprocess.run(["git", "-C", source, "ls-files", "-z", "--cached", "--others", "--exclude-standard"], capture_output=True, text=True)
    if listed.returncode:
        print("skipped: no repository")
        return 77
    with tempfile.TemporaryDirectory() as name:
        root = Path(name) / "copy"
        for file in filter(None, listed.stdout.split("\0")):
            if (source / file).is_file() and not file.startswith(("assets/", "bench/results/", "docs/images/")):
                (root / file).parent.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(source / file, root / file)
        who = {f"GIT_{role}_{what}": value for role in ("AUTHOR", "COMMITTER") for what, value in (("NAME", "Owner"), ("EMAIL", "owner@example.org"))}
        environment = {"PATH": os.environ["PATH"], "HOME": name, "GIT_CONFIG_NOSYSTEM": "1", **who}

        def git(*words):
            return subprocess.run(["git", "-C", root, *words], capture_output=True, text=True, check=True, env=environment).stdout

        def release(*options):
            return subprocess.run([sys.executable, root / "packaging/release.py", root, *options], capture_output=True, text=True, env=environment)

        def refused(why, *options):
            before, done = git("rev-parse", "HEAD"), release(*options)
            expect(done.returncode == 1 and why in done.stderr and done.stderr.count("\n") == 1, f"{options}: expected a line with '{why}'; got {done.stderr}")
            expect(git("rev-parse", "HEAD") == before and not git("tag"), f"{options}: refused, and yet something was committed or tagged")

        git("init", "-q")
        git("add", "-A")
        git("commit", "-q", "-m", "Source")
        version = re.search(r"^project\(Seldinger VERSION ([0-9.]+)", (root / "CMakeLists.txt").read_text(), re.MULTILINE)[1]
        (root / "new.txt").write_text("not committed\n")
        refused("not committed", "--no-sign", "--address", ADDRESS)
        (root / "new.txt").unlink()
        if "forge" + ".invalid" in (root / "pyproject.toml").read_text():
            refused("--address", "--no-sign")
            refused("--address", "--no-sign", "--address", "somewhere")
        (root / "CITATION.cff").write_text((root / "CITATION.cff").read_text().replace(f"version: {version}", "version: 9.9.9"))
        git("commit", "-q", "-a", "-m", "Another version in CITATION.cff")
        refused("CITATION.cff", "--no-sign", "--address", ADDRESS)
        git("reset", "-q", "--hard", "HEAD~1")
        refused("git tag", "--address", ADDRESS)  # nobody has a key here
        done = release("--no-sign", "--address", ADDRESS)
        expect(done.returncode == 0, f"release: {done.stderr}")
        expect(git("tag").split() == [f"v{version}"] and not git("status", "--porcelain"), "expected one tag and nothing left over")
        expect(git("log", "-1", "--format=%s").strip() == f"Release {version}", "the commit has another subject")
        expect(set(git("diff", "--name-only", "HEAD~1").split()) == {"CHANGELOG.md", "CITATION.cff", "pyproject.toml"}, "other files were changed")
        again = release("--no-sign")
        expect(again.returncode == 1 and f"tag v{version} already" in again.stderr, f"a second release: {again.stderr}")
        print(f"{version} tagged in a copy")
    return 0


if __name__ == "__main__":
    sys.exit(main())
