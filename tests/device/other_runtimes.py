#!/usr/bin/env python3
"""Runs of default scenes on other OpenCL drivers and with other work-groups.

    tests/device/other_runtimes.py rusticl APP SOURCE      Mesa's OpenCL on the CPU (llvmpipe), without double precision
    tests/device/other_runtimes.py groups APP SOURCE       PoCL with work-groups of 1, 64 and 128 items, and as if it had memory of its own

rusticl is a GPU driver's own way: C to SPIR-V by LLVM's translator, then Mesa's compilers. It needs Debian's mesa-opencl-icd. Exit code
77 where it is missing. It compiles at each launch (Mesa 22.3: 20 ms), so the runs end shortly after the first contact.
"""
import csv
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

SKIPPED = 77
# Durations [s]: up to some hundred evaluations after the first contact; the last two touch nothing yet
SCENES = {"experiment1": 1.56, "aortic-arch": 0.89, "stiff-iliac": 1.95, "navigate": 1.2, "experiment2": 0.2, "soft-arch": 0.1}
IN_CONTACT = ("experiment1", "aortic-arch", "stiff-iliac", "navigate")
PAIR = "experiment2-pair"  # its instruments touch each other: double precision only
SEPARATE = ("--set", "coaxial.model=separate")

# Float kernels know an axis point relative to the first node of its edge: 6e-8 of 10 mm, 0.6 nm, is the error of a gap. A stiff wire
# in an iliac artery sinks in by 20 um, a floppy one by 1 um: their forces err by 1e-4 to 1e-3 of the force of a contact. Tips follow
# those forces: in a straight artery by 0.1 um at most.
FORCE = 1e-3  # of the largest hand force
TIP_M = 1e-6

failures = 0


def check(true, what):
    global failures
    if not true:
        print(f"FAILED: {what}")
        failures += 1


class Bench:
    def __init__(self, app, source, folder):
        self.app, self.scenes, self.folder = app, pathlib.Path(source, "assets", "scenes"), pathlib.Path(folder)

    def call(self, *words, **more):
        return subprocess.run([self.app, *words], capture_output=True, text=True, env={**os.environ, **more})

    def run(self, scene, name, duration, *words, **more):
        out = self.folder / name
        done = self.call("run", str(self.scenes / f"{scene}.toml"), "-o", str(out), "--overwrite", "--error-estimate", "off", "--set",
                         f"scene.duration_s={duration}", *words, **more)
        return done, out

    def result(self, *words, **more):
        """Summary and last row of the trace."""
        done, out = self.run(*words, **more)
        if done.returncode != 0:
            sys.exit(f"FAILED: {' '.join(map(str, words))}: exit code {done.returncode}\n{done.stderr}")
        with open(out / "trace.csv", newline="") as text:
            rows = list(csv.DictReader(text))
        return json.loads((out / "summary.json").read_text()), {key: float(value) for key, value in rows[-1].items()}


def check_rusticl(bench):
    on = {"RUSTICL_ENABLE": "llvmpipe"}
    found = re.search(r"^(\d+): llvmpipe.*rusticl", bench.call("devices", **on).stdout, re.M)
    if not found:
        print("skipped: no rusticl with llvmpipe (Debian: mesa-opencl-icd)")
        sys.exit(SKIPPED)
    device = ("--device", found[1])
    single = ("--set", "contact.precision=float32")
    for scene, duration in SCENES.items():
        mesa, _ = bench.result(scene, "mesa", duration, *single, *device, **on)
        pocl, at_float = bench.result(scene, "float", duration, *single)
        double, at_double = bench.result(scene, "double", duration)
        tip = max(abs(at_float[f"tip_{axis}_m"] - at_double[f"tip_{axis}_m"]) for axis in "xyz")
        hand = abs(at_float["hand_force_n"] - at_double["hand_force_n"])
        largest = abs(double["hand_force_max_n"])
        print(f"{scene}: {mesa['contacts_max']} contacts; float32 on rusticl {mesa['state_hash']}, on PoCL {pocl['state_hash']}; "
              f"from float64: tip {tip:.1e} m, hand force {hand:.1e} of {largest:.1e} N")
        check(scene not in IN_CONTACT or double["contacts_max"] > 0, f"{scene}: no contact")
        check(mesa["state_hash"] == pocl["state_hash"], f"{scene}: rusticl and PoCL differ in float32")
        check(tip <= TIP_M, f"{scene}: the tip is {tip} m from that of float64")
        check(hand <= FORCE * largest, f"{scene}: the hand force is {hand} N from that of float64")
    done, _ = bench.run("experiment1", "none", 0.1, *device, **on)
    print(done.stderr.strip())
    check(done.returncode == 5 and 'contact.precision = "float32"' in done.stderr, "double precision: exit 5 and the key that helps")
    done, _ = bench.run(PAIR, "none", 0.1, *SEPARATE, *single, *device, **on)
    print(done.stderr.strip())
    check(done.returncode == 2 and "contact.precision" in done.stderr, "instruments: exit 2 and the key that helps")


def check_groups(bench):
    for scene, duration, more in (("experiment1", 2.5, ()), ("aortic-arch", 1.5, ()), (PAIR, 2.3, SEPARATE)):
        hashes = {}
        own = {"SEL_OWN_MEMORY": "1"}
        for group, memory in ((1, {}), (64, {}), (128, {}), (1, own), (64, own)):
            summary, last = bench.result(scene, "group", duration, *more, SEL_WORKGROUP=str(group), **memory)
            hashes[f"{group} {' '.join(memory)}"] = summary["state_hash"]
            check(summary["contacts_max"] > 0, f"{scene}: no contact")
            check(not more or last["instruments_force_per_length_max_n_per_m"] > 0, f"{scene}: no contact between instruments")
        print(scene, hashes)
        check(len(set(hashes.values())) == 1, f"{scene}: results depend on the size of work-groups, or on whose memory it is")


def main():
    what, app, source = sys.argv[1:]
    with tempfile.TemporaryDirectory() as folder:
        {"rusticl": check_rusticl, "groups": check_groups}[what](Bench(app, source, folder))
    return min(failures, 1)


if __name__ == "__main__":
    sys.exit(main())
