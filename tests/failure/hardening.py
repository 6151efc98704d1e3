#!/usr/bin/env python3
"""What an attacker finds in a program that was built: hardening.py SOURCE_FOLDER BUILD_FOLDER FILE ...

For each file (command, library, Python extension): its table of functions is read-only after the start, the stack is never executed, checks
of the stack and of buffers are called, and no path of the source or build folder is in it. Exit 77 without readelf.
"""
import re
import shutil
import subprocess
import sys
from pathlib import Path


def readelf(*options):
    return subprocess.run(["readelf", "-W", *options], check=True, capture_output=True, text=True).stdout


def faults(path, source, build):
    headers, dynamic, symbols = readelf("-l", path), readelf("-d", path), readelf("--dyn-syms", path)
    if "GNU_RELRO" not in headers or not re.search(r"BIND_NOW|\bNOW\b", dynamic):
        yield "functions of libraries are looked up while it runs: their table stays writable; expected full RELRO (-z relro -z now)"
    if not re.search(r"DYN ", headers):
        yield "lies at a fixed address; expected a position-independent program"
    if not (stack := re.search(r"GNU_STACK.*", headers)) or re.search(r"\bRWE\b", stack[0]):
        yield "its stack may be executed"
    if "__stack_chk_fail" not in symbols:
        yield "no function checks its stack; expected -fstack-protector-strong"
    if not re.search(r"__(mem|str|read|pread|vsnprintf|snprintf|printf|fprintf|fread|poll|recv|realpath|readlink)\w*_chk", symbols):
        yield "no buffer is checked; expected -D_FORTIFY_SOURCE=2"
    data = Path(path).read_bytes()
    # A compiler may cut a name into pieces of 16 bytes and lay other text behind them, so a path counts by what the folder really holds.
    inside = {entry.name for entry in Path(source).iterdir()}
    paths = {m[0].decode("utf-8", "replace") for m in re.finditer(re.escape(source.encode()) + rb"/[\w.+-]+", data)}
    found = {p for p in paths if p[len(source) + 1:] in inside}
    if Path(source) not in Path(build).parents:
        found |= {build for _ in re.finditer(re.escape(build.encode()) + b"/", data)}
    if found:
        yield f"{len(found)} paths of the machine that built it, {min(found)} among them; expected none"


def main():
    if not shutil.which("readelf"):
        print("left out: readelf (Debian's binutils) is not installed")
        return 77
    source, build = (str(Path(p).resolve()) for p in sys.argv[1:3])
    said = [f"{path}: {fault}" for path in sys.argv[3:] for fault in faults(path, source, build)]
    print("\n".join(said))
    return 1 if said else 0


if __name__ == "__main__":
    sys.exit(main())
