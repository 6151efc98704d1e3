"""Where OpenCL comes from: what is named, what the system has, then what PyPI's packages carry."""

import ctypes
import os
import subprocess
import sys
from importlib import metadata

import pytest

import seldinger
from seldinger import _opencl


class Installed:
    def __init__(self, path):
        self._path = path

    def locate(self):
        return self._path


@pytest.fixture
def packages(monkeypatch, tmp_path):
    """Takes {package: [file names]}: what is installed, as files of a folder."""
    def install(listing, missing=()):
        folder = tmp_path / "lib"
        folder.mkdir(exist_ok=True)
        for name in (name for names in listing.values() for name in names if name not in missing):
            (folder / name).touch()

        def files(package):
            if package not in listing:
                raise metadata.PackageNotFoundError(package)
            return [Installed(folder / name) for name in listing[package]]
        monkeypatch.setattr(_opencl.metadata, "files", files)
        monkeypatch.setattr(_opencl.shutil, "which", lambda program: "/usr/bin/" + program)
        return folder
    return install


POCL = {"pocl-binary-distribution": ["libhwloc-4fb5.so.15", "libpocl-2106.so", "pocl.icd"]}
INTEL = {"intel-opencl-rt": ["libintelocl.so.2026.22", "libintelocl.so", "intel-cpu.icd"], "tbb": ["libtbbmalloc.so.2", "libtbb.so.12"]}


def test_pocl_is_taken_before_intel(packages):
    folder = packages({**INTEL, **POCL})
    assert _opencl.packaged_library() == folder / "libpocl-2106.so"


def test_intel_where_it_is_alone(packages):
    folder = packages(INTEL)
    assert _opencl.packaged_library() == folder / "libintelocl.so"


def test_a_file_that_was_removed_is_not_named(packages):
    packages(POCL, missing=["libpocl-2106.so"])
    assert _opencl.packaged_library() is None


def test_pocl_without_a_linker_gives_way_to_intel(packages, monkeypatch):
    folder = packages({**INTEL, **POCL})
    monkeypatch.setattr(_opencl.shutil, "which", lambda program: None)
    assert _opencl.packaged_library() == folder / "libintelocl.so"


def test_pocl_without_a_linker_says_what_to_install(packages, monkeypatch):
    packages(POCL)
    monkeypatch.setattr(_opencl.shutil, "which", lambda program: None)
    with pytest.warns(UserWarning, match="binutils"):
        assert _opencl.packaged_library() is None


def test_without_packages_there_is_none(packages):
    packages({})
    assert _opencl.packaged_library() is None


def test_what_the_system_has(tmp_path):
    assert not _opencl.has_system_opencl(str(tmp_path)) and not _opencl.has_system_opencl(str(tmp_path / "none"))
    (tmp_path / "pocl.icd").touch()
    assert _opencl.has_system_opencl(str(tmp_path))


@pytest.mark.parametrize("system, named, wanted", [(False, None, "libpocl-2106.so"), (True, None, None), (False, "/mine.so", "/mine.so")])
def test_the_order(packages, monkeypatch, system, named, wanted):
    folder = packages(POCL)
    monkeypatch.setattr(_opencl, "has_system_opencl", lambda: system)
    monkeypatch.delenv("OPENCL_VENDOR_PATH", raising=False)
    monkeypatch.setenv("OCL_ICD_VENDORS", named or "")
    _opencl.find_opencl()
    assert (os.environ["OCL_ICD_VENDORS"] or None) == (str(folder / wanted) if wanted and not named else wanted)


def test_intel_brings_its_own_threads(packages, monkeypatch):
    folder = packages(INTEL)
    loaded = []
    monkeypatch.setattr(_opencl.ctypes, "CDLL", lambda path, mode: loaded.append((path, mode)))
    monkeypatch.setenv("OCL_ICD_VENDORS", "/elsewhere/libintelocl.so")
    _opencl.find_opencl()
    assert loaded == [(str(folder / "libtbb.so.12"), ctypes.RTLD_GLOBAL)]


PRINTS = "import seldinger; w = seldinger.World('experiment2'); w.step([0.01, 0.0], n=50); print(w.state_hash())"


@pytest.mark.parametrize("package", ["pocl-binary-distribution", "intel-opencl-rt"])
def test_a_packaged_runtime_has_the_same_bits(package):
    name = dict(_opencl._PACKAGES)[package]
    library = _opencl._library(package, name)
    if library is None:
        pytest.skip(f"{package} is not installed: pip install {package}" + (" intel-cmplr-lib-rt" if "intel" in package else ""))
    done = subprocess.run([sys.executable, "-c", PRINTS], env={**os.environ, "OCL_ICD_VENDORS": str(library)}, capture_output=True,
                          text=True, timeout=600)  # the limit only ends what hangs
    here = seldinger.World("experiment2")
    here.step([0.01, 0.0], n=50)
    assert done.stdout.strip() == str(here.state_hash()), done.stderr
