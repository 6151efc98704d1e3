"""The training scripts of examples/python run, learn from what they collect, and write what they say."""

import csv
import os
import subprocess
import sys
from pathlib import Path

import pytest

EXAMPLES = Path(__file__).resolve().parents[2] / "examples" / "python"
pytest.importorskip("gymnasium", reason="gymnasium is not installed: pip install gymnasium")


def run(script, *options):
    done = subprocess.run([sys.executable, str(EXAMPLES / script), *map(str, options)], env={**os.environ}, capture_output=True, text=True, timeout=900)
    assert done.returncode == 0, done.stdout + done.stderr


def rows(path):
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


SHORT = ["--envs", 2, "--rollout", 8, "--steps", 32, "--episode", 6]


def test_ppo_in_a_single_file(tmp_path):
    torch = pytest.importorskip("torch", reason="torch is not installed: pip install torch")
    for steps in (16, 32):
        run("ppo_single_file.py", *SHORT, "--steps", steps, "-o", tmp_path / str(steps))
    curve = rows(tmp_path / "32" / "curve.csv")
    assert [row["steps"] for row in curve] == ["16", "32"] and int(curve[0]["episodes"]) == 2
    first, second = (torch.load(tmp_path / name / "policy.pt") for name in ("16", "32"))
    assert any(not torch.equal(first[name], second[name]) for name in first)


@pytest.mark.parametrize("seen", [[], ["--pixels"]])
def test_ppo_of_stable_baselines3(tmp_path, seen):
    pytest.importorskip("torch", reason="torch is not installed: pip install torch")
    pytest.importorskip("stable_baselines3", reason="stable-baselines3 is not installed: pip install stable-baselines3")
    run("ppo_sb3.py", *SHORT, *seen, "--evaluated", 2, "-o", tmp_path)
    assert [row["steps"] for row in rows(tmp_path / "success.csv")] == ["0", "32"] and (tmp_path / "model.zip").is_file()
