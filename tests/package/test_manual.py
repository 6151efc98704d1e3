#!/usr/bin/env python3
"""test_manual.py SOURCE: the man page and the bash completion that packaging/manual.py makes of docs/options.md.

Every option of the page is in both, groff has nothing to say about the page, and a real bash completes commands, options and scenes.
"""
import gzip
import importlib.util
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path


def expect(condition, what):
    if not condition:
        sys.exit(f"test_manual: {what}")


def completed(script, prefix, *words):
    """What bash offers for the last of the words."""
    line = 'source "$1"; shift; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _seldinger; echo "${COMPREPLY[@]}"'
    done = subprocess.run(["bash", "-c", line, "bash", script, *words], capture_output=True, text=True, env={"PATH": f"{prefix}/bin:/usr/bin:/bin"})
    expect(done.returncode == 0 and not done.stderr, f"bash on {words}: {done.stderr}")
    return done.stdout.split()


def main():
    source = Path(sys.argv[1])
    spec = importlib.util.spec_from_file_location("manual", source / "packaging/manual.py")
    maker = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(maker)
    commands = maker.read((source / "docs/options.md").read_text(encoding="utf-8"))
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for out in ("a", "b"):
            subprocess.run([sys.executable, source / "packaging/manual.py", source / "docs/options.md", "1.2.3", folder / out], check=True)
        for file in ("seldinger.1.gz", "seldinger.bash"):
            expect((folder / "a" / file).read_bytes() == (folder / "b" / file).read_bytes(), f"{file} differs from one time to the next")
        page = gzip.decompress((folder / "a/seldinger.1.gz").read_bytes()).decode().replace("\\-", "-").replace("\\e", "\\")
        expect('"seldinger 1.2.3"' in page, "the page has not the version")
        script, prefix = folder / "a/seldinger.bash", folder / "prefix"
        (prefix / "bin").mkdir(parents=True)
        (prefix / "bin/seldinger").write_text("#!/bin/sh\n")
        (prefix / "bin/seldinger").chmod(0o755)
        shutil.copytree(source / "assets/scenes", prefix / "share/seldinger/scenes")
        options = 0
        for command, _, rows in commands:
            for option, meaning in rows:
                options += 1
                expect(f".B {option}\n{meaning}" in page, f"{command}: {option} is not in the man page")
                for word in re.findall(r"^--?[a-z][a-z-]*", option):
                    expect(word in completed(script, prefix, "seldinger", *command.split(), word), f"bash does not complete {command} {word}")
        expect(completed(script, prefix, "seldinger", "rep") == ["report"], "bash does not complete a command")
        expect(completed(script, prefix, "seldinger", "farm", "st") == ["status"], "bash does not complete a command below another")
        expect(completed(script, prefix, "seldinger", "run", "aortic-a") == ["aortic-arch"], "bash does not complete a scene")
        expect(completed(script, prefix, "seldinger", "report", "aort") == [], "bash offers scenes where a folder is expected")
        if shutil.which("groff"):
            done = subprocess.run(["groff", "-ww", "-man", "-Tutf8", "-z"], input=page.replace("-", "\\-"), capture_output=True, text=True)
            expect(done.returncode == 0 and not done.stderr, f"groff: {done.stderr[:2000]}")
    print(f"{len(commands)} commands, {options} options" + ("" if shutil.which("groff") else "; left out: groff is not installed"))


if __name__ == "__main__":
    main()
