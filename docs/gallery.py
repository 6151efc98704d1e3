#!/usr/bin/env python3
"""gallery.py SELDINGER FOLDER [NAME ...]: the pictures of docs/gallery.md, by the commands that the page names.

Runs each scene into FOLDER (unless its run is there already), draws its last frame, and writes docs/images/gallery-NAME.png with 256 colours:
at most 40 kB each. Needs python3-pil. All scenes take about half an hour on two cores.
"""
import io
import pathlib
import subprocess
import sys

from PIL import Image

REPOSITORY = pathlib.Path(__file__).resolve().parent.parent
LIMIT = 40_000  # bytes
PAGE = REPOSITORY / "docs/gallery.md"


def scenes():
    """(name, path in assets/scenes, options of render) of the rows of the page that show a picture of this script."""
    import re
    for row in PAGE.read_text(encoding="utf-8").splitlines():
        shown = re.search(r"images/gallery-([\w-]+)\.png", row)
        if shown:
            options = re.search(r"`render DIR([^`]*)`", row)
            yield shown[1], re.search(r"`(assets/scenes/[\w/-]+\.toml)`", row)[1], options[1].split() if options else []


def main():
    app, folder, names = sys.argv[1], pathlib.Path(sys.argv[2]), sys.argv[3:]
    for name, scene, options in scenes():
        if names and name not in names:
            continue
        run = folder / name
        if not (run / "summary.json").is_file():
            subprocess.run([app, "run", REPOSITORY / scene, "-o", run, "--overwrite", "--quiet", "--error-estimate", "off"], check=True)
        drawn = folder / f"{name}.png"
        subprocess.run([app, "render", run, *options, "--size", "480x360", "--no-legend", "--background", "white", "-o", drawn, "--quiet"], check=True)
        small = io.BytesIO()
        Image.open(drawn).convert("RGB").quantize(256).save(small, "PNG", optimize=True)
        if small.tell() > LIMIT:
            sys.exit(f"{name}: got {small.tell()} bytes; expected at most {LIMIT}")
        (REPOSITORY / "docs/images" / f"gallery-{name}.png").write_bytes(small.getvalue())
        print(f"{name}: {small.tell()} bytes")


if __name__ == "__main__":
    main()
