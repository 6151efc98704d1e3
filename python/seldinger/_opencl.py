"""Which OpenCL the engine finds where the system has none: those that PyPI carries, which no loader finds by itself.

The loader (ocl-icd) reads /etc/OpenCL/vendors, or what OCL_ICD_VENDORS names. `pocl-binary-distribution` and `intel-opencl-rt`
install their libraries inside the environment and tell the loader nothing of it.
"""

from __future__ import annotations

import ctypes
import os
import re
import shutil
import warnings
from importlib import metadata
from pathlib import Path

# by preference: PoCL is what the engine is tested on; the second has the same bits
_POCL = "pocl-binary-distribution"
_PACKAGES = ((_POCL, r"libpocl.*\.so"), ("intel-opencl-rt", r"libintelocl\.so"))


def _library(package: str, name: str) -> Path | None:
    """The file of an installed package whose name matches."""
    try:
        files = metadata.files(package) or []
    except metadata.PackageNotFoundError:
        return None
    for file in files:
        path = Path(file.locate())
        if re.fullmatch(name, path.name) and path.is_file():
            return path.resolve()
    return None


def packaged_library() -> Path | None:
    """The OpenCL library of a package from PyPI that is installed beside this one, if any."""
    found = {package: library for package, name in _PACKAGES if (library := _library(package, name))}
    if _POCL in found and not shutil.which("ld"):  # as it makes the first kernel it would end the process
        del found[_POCL]
        if not found:
            warnings.warn("PoCL of PyPI needs the linker ld, which is not in PATH. Fix: install binutils, or pip install 'seldinger[cpu]'")
    return next(iter(found.values()), None)


def has_system_opencl(vendors: str = "/etc/OpenCL/vendors") -> bool:
    return any(Path(vendors).glob("*.icd"))


def name_opencl() -> Path | None:
    """Sets OCL_ICD_VENDORS where it is needed: what the environment names goes first, then what the system has, then packages.

    Intel's runtime wants symbols that the engine's libtbb does not have yet. A newer one serves both, if it is loaded first: returned.
    """
    named = os.environ.get("OCL_ICD_VENDORS") or os.environ.get("OPENCL_VENDOR_PATH")
    if not named and not has_system_opencl() and (found := packaged_library()):
        named = os.environ["OCL_ICD_VENDORS"] = str(found)
    return _library("tbb", r"libtbb\.so\.12") if named and "libintelocl" in named else None


def find_opencl() -> None:
    """Before the engine is loaded."""
    if threads := name_opencl():
        ctypes.CDLL(str(threads), mode=ctypes.RTLD_GLOBAL)
