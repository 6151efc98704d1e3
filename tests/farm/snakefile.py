#!/usr/bin/env python3
"""The workflow of examples/farm with names that a shell would take apart: snakefile.py SELDINGER SOURCE. Exit 77 where Snakemake is not installed."""
import os, shutil, subprocess, sys, tempfile
from pathlib import Path

from slurm_names import SCENE


def main():
    app, source = os.path.abspath(sys.argv[1]), Path(sys.argv[2]).resolve()
    if not shutil.which("snakemake"):
        print("skipped: no Snakemake here (Debian: apt-get install snakemake)")
        return 77
    folder = tempfile.mkdtemp(prefix="seldinger-snake-")
    try:
        os.chdir(folder)
        Path("my scene.toml").write_text(SCENE)
        Path("it's $(touch owned).toml").write_text('[vary]\n"wire.density" = [6000.0, 7000.0]\n')
        os.mkdir("bin dir")
        os.symlink(app, "bin dir/seldinger")
        done = subprocess.run(["snakemake", "--cores", "1", "--quiet", "-s", source / "examples/farm/Snakefile", "--config", f"seldinger={folder}/bin dir/seldinger",
                               "scene=my scene.toml", "sweep=it's $(touch owned).toml", "dir=a; touch owned", "tasks=2",
                               "set=['scene.duration_s=0.002', 'scene.name=it is; touch owned']"],
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=300)
        assert done.returncode == 0, done.stdout
        assert Path("a; touch owned/results.csv").exists() and not Path("owned").exists(), os.listdir(".")
        scene = Path("a; touch owned/scene.toml").read_text()
        assert "duration_s = 0.002" in scene and "it is; touch owned" in scene, scene[:2000]
        print("a workflow with blanks, quotes and semicolons in its names ran to its end")
    finally:
        os.chdir("/")
        shutil.rmtree(folder, ignore_errors=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
