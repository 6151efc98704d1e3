#!/usr/bin/env python3
"""test_package.py PACKAGES [wheel | deb] [--keep FOLDER]: installs what `./dev package` made into empty Debian 12 systems.

Each system is made by mmdebstrap from the mirror that apt uses here, and has nothing but Debian's essential packages and what an
installation document says to install. There the front page's scene is run and drawn: the state hash is that of tests/golden, so that a
package computes what a native build computes. As root only (chroot). Exit 77, which ctest shows as Skipped, where something is missing.
"""
import argparse
import gzip
import os
import re
import shutil
import struct
import subprocess
import sys
import tempfile
import time
import zipfile
import zlib
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[2]
SCENE = "aortic-arch"
# of PEP 600: every Linux of that age has them
SYSTEM = re.compile(r"(lib(c|m|dl|rt|pthread|stdc\+\+|gcc_s|z)|ld-linux-x86-64)\.so\.\d")
OPENGL = ["libegl1", "libopengl0", "libgl1-mesa-dri"]


def run(*words, **options):
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True, **options)
    if done.returncode:
        raise SystemExit(f"failed ({done.returncode}): {' '.join(map(str, words))}\n{done.stdout[-3000:]}{done.stderr[-3000:]}")
    return done.stdout


class System:
    """An empty Debian system in a folder."""

    def __init__(self, folder, *packages):
        self.root = folder
        run("mmdebstrap", "--variant=minbase", "--mode=root", *(f"--include={p}" for p in packages), "bookworm", folder)
        shutil.copy("/etc/resolv.conf", folder / "etc/resolv.conf")
        run("chroot", folder, "useradd", "--create-home", "--uid", "1000", "user")

    def call(self, *words, user="user", writable=True, **environment):
        """Runs it there, in an environment of its own. Without `writable`, all but /tmp and the home folder is read-only."""
        home = "/root" if user == "root" else "/home/user"
        setup = f'mount --bind "{self.root}" "{self.root}" && cd "{self.root}" && mount -t proc proc proc && mount --rbind /dev dev && mount --rbind /sys sys && mount -t tmpfs tmpfs tmp'
        if not writable:
            setup += " && mount --bind home home && mount -o remount,bind,ro ."
        variables = {"PATH": "/usr/sbin:/usr/bin:/sbin:/bin", "HOME": home, "DEBIAN_FRONTEND": "noninteractive", **environment}
        inside = ["env", "-i", *(f"{k}={v}" for k, v in variables.items()), "sh", "-c", f'cd {home} && exec "$@"', "sh", *map(str, words)]
        group = [] if user == "root" else ["--userspec=1000:1000"]
        return subprocess.run(["unshare", "--mount", "sh", "-ec", f'{setup} && exec "$@"', "sh", "chroot", *group, str(self.root), *inside],
                              capture_output=True, text=True)

    def run(self, *words, **options):
        done = self.call(*words, **options)
        if done.returncode:
            raise SystemExit(f"failed ({done.returncode}) in {self.root}: {' '.join(map(str, words))}\n{done.stdout[-3000:]}{done.stderr[-3000:]}")
        return done.stdout

    def install(self, *packages):
        self.run("apt-get", "update", "-qq", user="root")
        self.run("apt-get", "install", "-y", "-qq", "--no-install-recommends", *packages, user="root")


def golden_hash():
    table = (SOURCE / "tests/golden/scenes.txt").read_text()
    return re.search(rf"^([0-9a-f]{{16}}) whole assets/scenes/{SCENE}\.toml$", table, re.MULTILINE)[1]


def expect(condition, what):
    if not condition:
        raise SystemExit(f"test_package: {what}")


def elf_files(folder):
    return [f for f in sorted(folder.rglob("*")) if f.is_file() and not f.is_symlink() and f.read_bytes()[:4] == b"\x7fELF"]


def check_contents(folder):
    """No path of the machine that built it, and no processor but x86-64 of the plain libraries."""
    paths = {str(SOURCE), str(Path.home()) + "/", "/tmp/pip", "/tmp/tmp"}
    for file in folder.rglob("*"):
        if file.is_file() and not file.is_symlink():
            found = [path for path in paths if path.encode() in file.read_bytes()]
            expect(not found, f"{file.relative_to(folder)}: has the path {found} of the machine that built it")


def check_links(folder):
    """What is linked is in the package or on every system; each library inside has its licence. Returns what it links."""
    files = elf_files(folder)
    here = {f.name for f in files}
    needed = {f: re.findall(r"\(NEEDED\).*\[(.+)\]", run("readelf", "-d", f)) for f in files}
    for file, names in needed.items():
        missing = [n for n in names if n not in here and not SYSTEM.fullmatch(n)]
        expect(not missing, f"{file.relative_to(folder)}: needs {missing}, which are neither inside nor on every Linux")
    licences = " ".join(f.stem.lower() for f in folder.glob("seldinger/licenses/*.txt"))
    for name in here:
        if inside := re.match(r"lib([a-z+]+)[-\w.]*-[0-9a-f]{8}\.so", name, re.IGNORECASE):
            stem = {"xrl": "xrl", "brotlicommon": "brotli", "brotlidec": "brotli"}.get(inside[1].lower(), inside[1].lower())
            expect(stem in licences, f"{name}: no licence of it in seldinger/licenses")
    return sorted(here), sorted({n for names in needed.values() for n in names} - here)


def colours(png):
    """Number of different pixels of an 8-bit PNG, rows filtered as they are: an empty picture has a handful."""
    data = png.read_bytes()
    expect(data[:8] == b"\x89PNG\r\n\x1a\n", f"{png}: not a PNG")
    at, body = 8, b""
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at:at + 8])
        body += data[at + 8:at + 8 + length] if kind == b"IDAT" else b""
        at += length + 12
    raw = zlib.decompress(body)
    return len({raw[i:i + 3] for i in range(0, len(raw) - 3, 3)})


def check_run(system, words, out, **environment):
    """The demo, by a user who owns nothing but a home folder; returns its seconds."""
    start = time.monotonic()
    system.run(*words, "run", SCENE, "-o", out, "--overwrite", writable=False, **environment)
    seconds = time.monotonic() - start
    summary = (system.root / "home/user" / out / "summary.json").read_text()
    got = re.search(r'"state_hash": "([0-9a-f]+)"', summary)[1]
    expect(got == golden_hash(), f"{out}: state {got}; the native build's is {golden_hash()}")
    return seconds


def check_picture(system, words, out):
    start = time.monotonic()
    system.run(*words, "render", out, writable=False)
    seconds = time.monotonic() - start
    picture = system.root / "home/user" / out / "picture.png"
    expect(colours(picture) > 1000, f"{picture}: looks empty")
    return seconds


def check_without_opengl(system, words, out):
    done = system.call(*words, "render", out)
    expect(done.returncode == 5 and "apt-get install libegl1" in done.stderr and done.stderr.count("\n") == 1,
           f"render without EGL: exit {done.returncode}, {done.stderr!r}; expected 5 and one line that says what to install")


def check_variants(system, words, out):
    """The loader takes the library that suits the processor, and the plain one for a processor without MOVBE: with the same bits. (Without
    FMA or AVX2 glibc's own sine and cosine have other bits, docs/determinism.md.)
    """
    words_here = set(Path("/proc/cpuinfo").read_text().split())
    if not {"avx2", "fma", "bmi2", "movbe"} <= words_here:
        print("  variants: not tried, this processor has one only")
        return
    for wanted, environment in (("glibc-hwcaps/x86-64-v3/", {}), ("", {"GLIBC_TUNABLES": "glibc.cpu.hwcaps=-MOVBE"})):
        told = system.call(*words, "--version", LD_DEBUG="libs", **environment).stderr
        taken = re.findall(r"calling init: \S*?(glibc-hwcaps/[\w-]+/)?libseldinger\.so", told)
        expect(taken == [wanted], f"libseldinger.so is taken from {taken}; expected [{wanted!r}]")
    print(f"  plain x86-64: {check_run(system, words, out, **environment):.1f} s, the same state")


def check_documents(share):
    """Man page, completion, and the site with the page that each of its links names."""
    manual = gzip.decompress((share / "man/man1/seldinger.1.gz").read_bytes()).decode()
    expect(manual.startswith(".TH SELDINGER 1") and ".SS run\n" in manual, "the man page has no command run")
    expect("complete -o" in (share / "bash-completion/completions/seldinger").read_text(), "no bash completion")
    site = share / "doc/seldinger/html"
    pages = sorted(site.rglob("*.html"))
    expect(len(pages) > 10 and (site / "index.html") in pages, f"{site}: {len(pages)} pages")
    size = sum(f.stat().st_size for f in site.rglob("*") if f.is_file())
    print(f"  man page, bash completion, {len(pages)} pages ({size / 1e6:.1f} MB)")


def check_consumer(system):
    """docs/example against the installed library, with a compiler and CMake and no other library's headers."""
    system.install("g++", "cmake", "make", "libjs-three")
    shutil.copytree(SOURCE / "docs/example", system.root / "opt/example")
    start = time.monotonic()
    system.run("cmake", "-S", "/opt/example", "-B", "example", "-DCMAKE_BUILD_TYPE=Release")
    system.run("cmake", "--build", "example")
    said = system.run("example/recorded_run", "recorded")
    expect(f"state {golden_hash()}\n" in said and "the ascending aorta (branch 4): passed" in said, f"the C++ example: {said}")
    for picture in ("picture.png", "fluoro.png"):
        expect((system.root / "home/user/recorded" / picture).stat().st_size > 10000, f"the C++ example's {picture} looks empty")
    print(f"  C++ example built and run in {time.monotonic() - start:.1f} s, the same state")


def test_wheel(packages, folder):
    wheels = list(packages.glob("seldinger-*.whl"))
    expect(len(wheels) == 1, f"{packages}: {len(wheels)} wheels; expected one. Fix: ./dev package wheel")
    unpacked = folder / "unpacked"
    zipfile.ZipFile(wheels[0]).extractall(unpacked)
    check_contents(unpacked)
    inside, outside = check_links(unpacked)
    print(f"{wheels[0].name}: {wheels[0].stat().st_size / 1e6:.1f} MB\n  inside: {', '.join(inside)}\n  of the system: {', '.join(outside)}")
    tag = re.search(r"-cp(\d)(\d+)-", wheels[0].name)
    downloads = folder / "downloads"
    run(sys.executable, "-m", "pip", "download", "-q", "--only-binary=:all:", f"--python-version={tag[1]}.{tag[2]}",
        "--platform=manylinux_2_34_x86_64", "--platform=manylinux_2_28_x86_64", "--platform=manylinux_2_17_x86_64", "--platform=manylinux2014_x86_64",
        "-d", downloads, f"{wheels[0]}[cpu]")
    system = System(folder / "root", "python3-venv")
    shutil.copytree(downloads, system.root / "wheels")
    start = time.monotonic()
    system.run("python3", "-m", "venv", "/home/user/venv")
    system.run("/home/user/venv/bin/pip", "install", "-q", "--no-index", "--find-links=/wheels", "seldinger[cpu]")
    install = time.monotonic() - start
    command = ["/home/user/venv/bin/seldinger"]
    seconds = check_run(system, command, "demo")
    check_without_opengl(system, command, "demo")
    system.install(*OPENGL)
    picture = check_picture(system, command, "demo")
    print(f"  venv and pip install {install:.1f} s, run {seconds:.1f} s, picture {picture:.1f} s")
    check_variants(system, command, "demo-plain")
    python = f"import seldinger; w = seldinger.World('{SCENE}'); w.run(); print(w.state_hash())"
    expect(golden_hash() in system.run("/home/user/venv/bin/python", "-c", python), "World.run() ends in another state than the command")
    return system.root / "home/user/demo/picture.png"


def test_deb(packages, folder):
    debs = list(packages.glob("seldinger_*.deb"))
    expect(len(debs) == 1, f"{packages}: {len(debs)} Debian packages; expected one. Fix: ./dev package deb")
    run("dpkg-deb", "-x", debs[0], folder / "unpacked")
    check_contents(folder / "unpacked")
    print(f"{debs[0].name}: {debs[0].stat().st_size / 1e6:.1f} MB\n  {run('dpkg-deb', '-f', debs[0], 'Depends').strip()}")
    if shutil.which("lintian"):
        found = subprocess.run(["lintian", "--allow-root", "--fail-on", "error", str(debs[0])], capture_output=True, text=True)
        print("  lintian: " + (found.stdout.strip().replace("\n", "\n    ") or "nothing"))
        expect(found.returncode == 0, "lintian finds errors")
    check_documents(folder / "unpacked/usr/share")
    system = System(folder / "root")
    shutil.copy(debs[0], system.root / "opt")
    start = time.monotonic()
    system.install(f"/opt/{debs[0].name}")
    install = time.monotonic() - start
    seconds = check_run(system, ["seldinger"], "demo")
    check_without_opengl(system, ["seldinger"], "demo")
    system.install(*OPENGL)
    print(f"  apt-get install {install:.1f} s, run {seconds:.1f} s, picture {check_picture(system, ['seldinger'], 'demo'):.1f} s")
    check_variants(system, ["seldinger"], "demo-plain")
    check_consumer(system)
    return system.root / "home/user/demo/picture.png"


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("packages", type=Path)
    parser.add_argument("which", nargs="*", metavar="wheel | deb", help="both where none is named")
    parser.add_argument("--keep", type=Path, help="the pictures are copied here")
    options = parser.parse_args()
    tests = {"wheel": test_wheel, "deb": test_deb}
    if set(options.which) - set(tests):
        parser.error(f"got {' '.join(options.which)}; expected wheel or deb")
    for program in ("mmdebstrap", "dpkg-deb", "readelf", "unshare"):
        if not shutil.which(program):
            print(f"skipped: {program} is not installed")
            return 77
    if os.geteuid() != 0:
        print("skipped: only root may make and enter another system")
        return 77
    if not list(options.packages.glob("seldinger*")):
        print(f"skipped: no packages in {options.packages}; ./dev package makes them")
        return 77
    for which in options.which or tests:
        with tempfile.TemporaryDirectory() as folder:
            os.chmod(folder, 0o755)
            picture = tests[which](options.packages.resolve(), Path(folder))
            if options.keep:
                options.keep.mkdir(parents=True, exist_ok=True)
                shutil.copy(picture, options.keep / f"{which}.png")
    return 0


if __name__ == "__main__":
    sys.exit(main())
