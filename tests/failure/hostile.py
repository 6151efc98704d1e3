#!/usr/bin/env python3
"""Gives every file of a folder to the command that reads its kind, and prints what came of it as a table: exit code, seconds of processor
time, peak memory, the line. SECURITY.md's promise is what is looked at: exit 0 or 3 (2 of a scene), one line, 5 s, 1 GB; where one is broken it ends with 1."""

import argparse
import os
import pathlib
import resource
import subprocess
import sys
import tempfile

SECONDS, MEGABYTES = 5.0, 1024.0
MESHES = {".stl", ".obj", ".ply", ".vtp", ".vtk"}
SCENE = """[scene]
duration_s = 0.004
dt_s = 0.001
[wire]
length_m = 0.1
radius_m = 0.0004445
density = 7900.0
bend_nm2 = 1.0e-5
twist_nm2 = 8.0e-6
stretch_n = 1.0e4
"""


def run(app, words, folder, seconds):
    """(exit code or minus the signal, processor seconds, peak megabytes, stderr) of one command."""
    with open(folder / "err", "wb") as err, open(folder / "out", "wb") as out:
        child = subprocess.Popen([app, *words], stdout=out, stderr=err, preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds + 1)))
        _, status, used = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(status)
    return child.returncode, used.ru_utime + used.ru_stime, used.ru_maxrss / 1024, (folder / "err").read_text(errors="replace")


def words_for(path, app, folder):
    """What is called for this file: a mesh is looked at, a scene checked, a checkpoint put into a run folder that is resumed."""
    if path.suffix in MESHES:
        return ["vessel", str(path), "--units", "mm"]
    if path.suffix == ".toml":
        return ["check", str(path)]
    if path.suffix == ".bin":
        scene = folder / "scene.toml"
        scene.write_text(SCENE)
        subprocess.run([app, "run", str(scene), "-o", str(folder / "R"), "--quiet", "--overwrite"], check=True)
        (folder / "R/checkpoint.bin").write_bytes(path.read_bytes())
        return ["run", str(scene), "-o", str(folder / "R"), "--quiet", "--resume"]
    return None


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("app")
    parser.add_argument("folder", type=pathlib.Path)
    given = parser.parse_args()
    broken = 0
    print("| file | kB | exit | processor s | MB | what it says |\n|---|---|---|---|---|---|")
    for path in sorted(given.folder.iterdir()):
        with tempfile.TemporaryDirectory() as scratch:
            folder = pathlib.Path(scratch)
            words = words_for(path, given.app, folder)
            if words is None:
                continue
            code, seconds, megabytes, said = run(given.app, words, folder, 60)
        kept = code in (0, 2 if path.suffix == ".toml" else 3) and seconds <= 2 * SECONDS and megabytes <= MEGABYTES  # two cores
        kept = kept and (code == 0 or 1 <= len(said.strip().splitlines()) <= 2)      # and its advice
        broken += not kept
        line = (said.strip().splitlines() or [""])[0].replace(str(path), path.name).replace("|", "\\|")
        print(f"| {path.name} | {path.stat().st_size / 1000:.0f} | {code}{'' if kept else ' **broken**'} | {seconds:.2f} | {megabytes:.0f} | {line[:150]} |")
    return 1 if broken else 0


if __name__ == "__main__":
    sys.exit(main())
