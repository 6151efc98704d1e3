#!/usr/bin/env python3
"""What compilers for GPUs make of the kernels, without a GPU.

    tests/device/kernel_shape.py spirv                 every program as SPIR-V, in both precisions; spirv-val accepts it
    tests/device/kernel_shape.py shape                 no kernel needs more than tests/device/kernel_shapes.csv says
    tests/device/kernel_shape.py shape --write         writes that file anew
    tests/device/kernel_shape.py table [--csv FILE]    the file as a table

SPIR-V needs Debian's clang-15, llvm-spirv-15 and spirv-tools. Shapes for AMD (gfx906) need clang-15 and libclc-15, those for NVIDIA
(sm_80) also ptxas, which the PyPI wheel nvidia-cuda-nvcc-cu12 brings (--ptxas PATH, or in PATH). Exit code 77 where tools are missing:
ctest shows the entry as skipped. A table of another version of a compiler is not compared with.

Registers are those of a work-item (at most 256 on gfx906, 255 on sm_80). Scratch: bytes of memory that a work-item uses in place of
registers, spills included. Waves: groups of 64 work-items that a SIMD of gfx906 holds at once, at most 10.
"""
import argparse
import csv
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
KERNELS = ROOT / "kernels"
SHAPES = pathlib.Path(__file__).with_name("kernel_shapes.csv")
CLC = pathlib.Path("/usr/lib/clc")
SKIPPED = 77
PRECISIONS = {"fp64": [], "fp32": ["-DSEL_FLOAT32"]}
MEASURED = ("registers", "scratch", "spills", "code", "waves")
COLUMNS = ("target", "compiler", "kernel", "precision", *MEASURED)


def run(*words):
    return subprocess.run([str(word) for word in words], capture_output=True, text=True)


def skip(reason):
    print(f"skipped: {reason}")
    sys.exit(SKIPPED)


def need(*programs):
    missing = [program for program in programs if not shutil.which(program)]
    if missing:
        skip(f"not installed: {', '.join(missing)}")


def clang(target, source, out, *flags):
    # warnings are not asked for: unused functions of the shared headers are many
    return run("clang-15", "-w", "-x", "cl", "-cl-std=CL1.2", "-target", target, "-Xclang", "-finclude-default-header", "-I", KERNELS,
               *flags, source, "-o", out)


def reason_of(done):
    lines = (done.stderr + done.stdout).strip().splitlines()
    return " ".join(lines[:2])[:300] if lines else f"exit code {done.returncode}"


def check_spirv():
    """The way of OpenCL drivers that are built on Mesa or Intel's compiler. Groups of one item have code of their own."""
    need("clang-15", "llvm-spirv-15", "spirv-val")
    failures = 0
    with tempfile.TemporaryDirectory() as name:
        bitcode, words = pathlib.Path(name, "k.bc"), pathlib.Path(name, "k.spv")
        for source in sorted(KERNELS.rglob("*.cl")):
            for precision, flags in PRECISIONS.items():
                for group in (1, 64):
                    done = clang("spir64", source, bitcode, "-O0", "-emit-llvm", "-c", f"-DSEL_WORKGROUP={group}", *flags)
                    for step in (("llvm-spirv-15", bitcode, "-o", words), ("spirv-val", words)):
                        done = done if done.returncode else run(*step)
                    what = f"{source.relative_to(ROOT)} {precision}, groups of {group}"
                    print(f"{what}: {'valid' if done.returncode == 0 else reason_of(done)}")
                    failures += done.returncode != 0
    return failures


def of_amd(source, flags, folder):
    out = folder / "k.s"
    done = clang("amdgcn-amd-amdhsa", source, out, "-O3", "-mcpu=gfx906", "-nogpulib", "-Xclang", "-mlink-builtin-bitcode", "-Xclang",
                 CLC / "amdgcn--amdhsa.bc", "-S", *flags)
    if done.returncode:
        sys.exit(f"{source}: {reason_of(done)}")
    keys = {"registers": "NumVgprs", "scratch": "ScratchSize", "code": "codeLenInByte", "waves": "Occupancy"}
    kernels = set(re.findall(r"\.amdhsa_kernel (\w+)", out.read_text()))
    for part in re.split(r"(?m)^(?=\w+: +; @)", out.read_text()):
        name = re.match(r"(\w+):", part)
        if name and name[1] in kernels:
            yield name[1], {k: int(re.search(rf"; {key}\s*[:=] *(\d+)", part)[1]) for k, key in keys.items()}


def of_nvidia(source, flags, folder, ptxas):
    out = folder / "k.ptx"
    done = clang("nvptx64-nvidia-nvcl", source, out, "-O3", "-Xclang", "-target-cpu", "-Xclang", "sm_80", "-Xclang",
                 "-mlink-builtin-bitcode", "-Xclang", CLC / "nvptx64--nvidiacl.bc", "-S", *flags)
    done = done if done.returncode else run(ptxas, "-arch=sm_80", "-v", "-o", "/dev/null", out)
    if done.returncode:
        sys.exit(f"{source}: {reason_of(done)}")
    for part in re.split(r"(?=Compiling entry function)", done.stdout + done.stderr)[1:]:
        found = re.search(r"'(\w+)'.*?(\d+) bytes stack frame, (\d+) bytes spill stores.*?Used (\d+) registers", part, re.S)
        yield found[1], {"registers": int(found[4]), "scratch": int(found[2]), "spills": int(found[3])}


def compilers(ptxas):
    """Target and version of each compiler that is installed."""
    need("clang-15")
    if not CLC.is_dir():
        skip("not installed: libclc-15")
    found = {"gfx906": re.search(r"version ([\d.]+)", run("clang-15", "--version").stdout)[1]}
    if ptxas and shutil.which(ptxas):
        found["sm_80"] = re.search(r"V([\d.]+)", run(ptxas, "--version").stdout)[1]
    else:
        print("sm_80 is left out: no ptxas")
    return found


def measure(versions, ptxas):
    rows = []
    with tempfile.TemporaryDirectory() as name:
        for source in sorted(KERNELS.rglob("*.cl")):
            for precision, flags in PRECISIONS.items():
                flags = ["-DSEL_WORKGROUP=64", *flags]
                for target, version in versions.items():
                    makers = {"gfx906": lambda: of_amd(source, flags, pathlib.Path(name)),
                              "sm_80": lambda: of_nvidia(source, flags, pathlib.Path(name), ptxas)}
                    for kernel, numbers in makers[target]():
                        rows.append({"target": target, "compiler": version, "kernel": kernel, "precision": precision, **numbers})
    return sorted(rows, key=key_of)


def key_of(row):
    return row["target"], row["kernel"], row["precision"]


def read_shapes(path=SHAPES):
    with open(path, newline="") as text:
        return {key_of(row): row for row in csv.DictReader(text)}


def excess(row, allowed):
    """What of a kernel is larger than the table has it; waves: smaller. Code may grow by 2 %: a line more is no new shape."""
    for name in MEASURED:
        if name not in row:
            continue
        most = int(allowed[name])
        if name == "waves" and row[name] < most or name == "code" and row[name] > 1.02 * most:
            yield f"{name} {row[name]}, was {most}"
        elif name not in ("waves", "code") and row[name] > most:
            yield f"{name} {row[name]}, was {most}"


def check_shapes(versions, ptxas):
    table, failures = read_shapes(), 0
    told = {row["target"]: row["compiler"] for row in table.values()}
    for target in [target for target in versions if told.get(target) != versions[target]]:
        print(f"{target} is left out: the table is of compiler {told.get(target)}, here is {versions[target]}")
        del versions[target]
    if not versions:
        skip("no compiler that the table is of")
    rows = measure(versions, ptxas)
    for row in rows:
        name = " ".join(key_of(row))
        if key_of(row) not in table:
            print(f"{name}: is not in {SHAPES.name}")
            failures += 1
            continue
        worse = list(excess(row, table[key_of(row)]))
        better = [name for name in MEASURED if name in row and name != "waves" and row[name] < 0.9 * int(table[key_of(row)][name])]
        if worse or better:
            print(f"{name}: {'; '.join(worse) or 'smaller now'}")
        failures += bool(worse)
    here = {key_of(row) for row in rows}
    for key in [key for key in table if key[0] in versions and key not in here]:
        print(f"{' '.join(key)}: in {SHAPES.name}, but there is no such kernel")
        failures += 1
    if failures:
        print(f"Fix: make the kernels smaller, or say in the commit why not and run {pathlib.Path(__file__).name} shape --write")
    return failures


def write_shapes(rows):
    with open(SHAPES, "w", newline="") as out:
        table = csv.DictWriter(out, COLUMNS, lineterminator="\n")
        table.writeheader()
        table.writerows(rows)


def print_table(path):
    table = read_shapes(path)
    print("| kernel | gfx906, fp64 / fp32: registers | scratch [bytes] | code [kB] | waves | sm_80, fp64 / fp32: registers | stack [bytes] | spills [bytes] |")
    print("|---|---|---|---|---|---|---|---|")
    for kernel in sorted({key[1] for key in table}):
        def both(target, name, per=1):
            cells = [table.get((target, kernel, precision), {}).get(name) for precision in PRECISIONS]
            return " / ".join("–" if cell in (None, "") else f"{int(cell) / per:,.0f}" for cell in cells)
        print(f"| `{kernel}` | {both('gfx906', 'registers')} | {both('gfx906', 'scratch')} | {both('gfx906', 'code', 1000)} "
              f"| {both('gfx906', 'waves')} | {both('sm_80', 'registers')} | {both('sm_80', 'scratch')} | {both('sm_80', 'spills')} |")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=("spirv", "shape", "table"))
    parser.add_argument("--ptxas", default="ptxas")
    parser.add_argument("--csv", default=SHAPES, help="table: of this file")
    parser.add_argument("--write", action="store_true")
    options = parser.parse_args()
    if options.what == "table":
        print_table(options.csv)
        return 0
    if options.what == "spirv":
        return min(check_spirv(), 1)
    versions = compilers(options.ptxas)
    if options.write:
        write_shapes(measure(versions, options.ptxas))
        return 0
    return min(check_shapes(versions, options.ptxas), 1)


if __name__ == "__main__":
    sys.exit(main())
