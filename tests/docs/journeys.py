#!/usr/bin/env python3
"""Three new users do what the documents say, in an empty folder, with nothing else.

    journeys.py student|robotics|farm --app build/seldinger --source . --build build [--compiler c++] [--keep DIR]

The commands and files are taken out of the documents as they stand: a line that is indented by four and begins with a program's name is
a command; a fenced block is a file where the text before it, or its own page, names one. What is changed is in SHORTER, for time alone.
Prints each command with its seconds, then their number and minutes. Exit 77 where something that the page asks for is not installed.
"""
import argparse
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time

# the documents' numbers are for results; the same commands do on less
SHORTER = {"n = 1000": "n = 6", "--tasks 400": "--tasks 3", "output.wire_every=10": "output.wire_every=2000", "--tasks 50": "--tasks 2",
           "1024x1024": "256x256"}
PROGRAMS = ("seldinger", "cp", "/usr/bin/python3", "cmake", "head")


def shorter(text):
    for long, short in SHORTER.items():
        text = text.replace(long, short)
    return text


def section(text, title):
    """A page's part under the heading that contains `title`."""
    parts = re.split(r"^## ", text, flags=re.M)
    found = [part for part in parts if title in part.split("\n")[0]]
    if len(found) != 1:
        sys.exit(f"journeys.py: {len(found)} headings with '{title}'")
    return found[0]


def steps_of(text):
    """Commands and files of a page in their order: ("run", command) or ("write", name, text)."""
    named = None
    block = None
    for line in text.split("\n"):
        if block is not None:
            if line.startswith("```"):
                yield "write", named, "\n".join(block) + "\n"
                block = None
            else:
                block.append(line)
        elif line.startswith("```"):
            block = []
        elif line.startswith("    ") and line[4:].split(" ")[0] in PROGRAMS:
            yield "run", line[4:].split("  #")[0].rstrip()
        elif names := re.findall(r"`([\w-]+\.(?:toml|py))`[,:]", line):
            named = names[0]


class Journey:
    def __init__(self, options, folder):
        self.options, self.folder = options, folder
        self.commands, self.begun = 0, time.monotonic()
        (folder / "bin").mkdir()
        (folder / "bin" / "seldinger").symlink_to(options.app)

    def run(self, command):
        begun = time.monotonic()
        paths = {"PATH": f"{self.folder / 'bin'}:{os.environ['PATH']}", "MPLBACKEND": "Agg"}
        done = subprocess.run(command, shell=True, cwd=self.folder, env=os.environ | paths, capture_output=True, text=True)
        self.commands += 1
        print(f"{time.monotonic() - begun:6.1f} s  {command}", flush=True)
        if done.returncode:
            sys.exit(f"journeys.py: exit {done.returncode}:\n{done.stdout[-2000:]}{done.stderr[-2000:]}")
        return done.stdout

    def follow(self, text, leave_out=()):
        for kind, *what in steps_of(shorter(text)):
            if kind == "write" and what[0]:
                (self.folder / what[0]).write_text(what[1])
            elif kind == "run" and not any(word in what[0] for word in leave_out):
                self.run(what[0])

    def expect(self, *names):
        for name in names:
            if not (self.folder / name).is_file() or (self.folder / name).stat().st_size == 0:
                sys.exit(f"journeys.py: {name} was not written")

    def finish(self):
        print(f"{self.commands} commands, {(time.monotonic() - self.begun) / 60:.2f} minutes")


def page(options, name):
    return (options.source / name).read_text(encoding="utf-8")


def need(*modules, programs=()):
    missing = [m for m in modules if subprocess.run(["/usr/bin/python3", "-c", f"import {m}"], capture_output=True).returncode]
    missing += [p for p in programs if not shutil.which(p)]
    if missing:
        print(f"not installed: {', '.join(missing)}")
        sys.exit(77)


def student(journey, options):
    """An STL to a figure: docs/tutorial.md."""
    need("numpy", "matplotlib")
    journey.follow(page(options, "docs/tutorial.md"))
    journey.expect("first.toml", "first-ways-in.png", "arch-run/picture.png", "arch-run/summary.json", "figure.pdf", "figure.png")


def robotics(journey, options):
    """Ten lines of C++ and five of CMake: README.md."""
    text = page(options, "README.md")
    for name, language in (("main.cpp", "cpp"), ("CMakeLists.txt", "cmake")):
        (journey.folder / name).write_text(re.search(rf"```{language}\n(.*?)```", text, re.S).group(1))
    journey.run(f"cmake --install {options.build} --prefix installed")
    journey.run(f"cmake -S . -B build -DCMAKE_CXX_COMPILER={options.compiler} -DCMAKE_PREFIX_PATH=$PWD/installed -DCMAKE_BUILD_TYPE=Release")
    journey.run("cmake --build build")
    said = journey.run("build/my_program")
    if not re.fullmatch(r"-?[\d.]+ mN\n", said):
        sys.exit(f"journeys.py: the program said {said!r}")


def farm(journey, options):
    """A sweep to a table and a run to a film, on one machine: docs/tutorial.md and -sweep.md for the files, docs/farm.md for the commands."""
    need("numpy", "matplotlib", programs=("ffmpeg",))
    for name, text in [(s[1], s[2]) for s in steps_of(page(options, "docs/tutorial.md")) if s[0] == "write"]:
        if name == "arch.toml":
            (journey.folder / name).write_text(text)
    journey.run("seldinger vessel aortic-arch -o mesh")
    journey.run("cp mesh/vessel.stl .")
    sweep = page(options, "docs/tutorial-sweep.md")
    journey.follow(sweep.split("## 4.")[0])
    # "Without Slurm leave out ..."
    alone = re.sub(r" --backend slurm --submit| --sbatch=\S+", "", section(page(options, "docs/farm.md"), "From an empty Debian cluster"))
    journey.follow(alone)
    journey.expect("sweep-run/results.csv", "sweep.png", "table/results.csv", "arch.mp4")


def main():
    journeys = {"student": student, "robotics": robotics, "farm": farm}
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("which", choices=journeys)
    parser.add_argument("--app", type=lambda p: pathlib.Path(p).resolve(), required=True)
    parser.add_argument("--source", type=lambda p: pathlib.Path(p).resolve(), required=True)
    parser.add_argument("--build", type=lambda p: pathlib.Path(p).resolve(), required=True)
    parser.add_argument("--compiler", default="c++")
    parser.add_argument("--keep", type=pathlib.Path, help="work in this folder, which must be empty, and leave it")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        folder = (options.keep or pathlib.Path(scratch)).resolve()
        folder.mkdir(parents=True, exist_ok=True)
        journey = Journey(options, folder)
        journeys[options.which](journey, options)
        journey.finish()


if __name__ == "__main__":
    main()
