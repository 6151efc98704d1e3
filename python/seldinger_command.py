"""The command `seldinger` of the wheel: the program, started with the OpenCL that belongs to this Python environment.

A module of its own, since importing `seldinger` would load the engine twice, here and in the program.
"""

from __future__ import annotations

import importlib.util
import os
import sys
from pathlib import Path


def main() -> None:
    package = Path(__file__).parent / "seldinger"
    spec = importlib.util.spec_from_file_location("_seldinger_opencl", package / "_opencl.py")
    opencl = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(opencl)
    if threads := opencl.name_opencl():
        os.environ["LD_PRELOAD"] = " ".join(filter(None, [str(threads), os.environ.get("LD_PRELOAD")]))
    program = package / "bin" / "seldinger"
    try:
        os.execv(program, ["seldinger", *sys.argv[1:]])
    except OSError as error:
        sys.exit(f"seldinger: {program}: {error.strerror}. Fix: install the package again: pip install --force-reinstall seldinger")


if __name__ == "__main__":
    main()
