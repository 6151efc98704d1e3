"""load_run: the folder of a run as arrays, against the files that the command writes; tasks of a World against the command's."""

import csv
import json
import os
import pathlib
import subprocess

import numpy as np
import pytest

import seldinger

COMMAND = os.environ.get("SELDINGER_COMMAND")
SCENES = pathlib.Path(__file__).resolve().parents[2] / "tests" / "scenes"
needs_command = pytest.mark.skipif(not COMMAND, reason="the command is not built")

SCENE = ('[scene]\nduration_s = 0.3\ndt_s = 0.002\nrecord_every = 1\nuntil = "reached"\n' + (SCENES / "tube.toml").read_text() + """\
keys = [ {t_s = 0.0, advance_m = 0.004}, {t_s = 0.3, advance_m = 0.05} ]
[task]
target = { point = [0.03, 0.0, -0.005], radius_m = 0.002 }
[output]
wire_every = 10
""")


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    dir = tmp_path_factory.mktemp("run")
    (dir / "t.toml").write_text(SCENE)
    subprocess.run([COMMAND, "run", "t.toml", "-o", "R", "--quiet"], cwd=dir, check=True)
    return dir


@needs_command
def test_shapes_are_those_of_the_tables(folder):
    run = seldinger.load_run(folder / "R")
    assert run.instruments == ("wire",)
    shapes = run.shapes()
    assert len(shapes) == len(run.time) > 5
    with open(folder / "R/wire.csv", newline="") as table:
        last = np.array([[float(row[c]) for c in ("x_m", "y_m", "z_m")] for row in csv.DictReader(table)])
    assert np.array_equal(shapes[-1], last)
    even = run.resample(30)
    assert even.shape == (len(run.time), 30, 3)
    assert np.array_equal(even[:, 0], [points[0] for points in shapes])
    with np.load(folder / "R/wire.npz") as file:
        assert np.array_equal(file["time_s"], run.time)
        assert np.allclose(file["position_m"], run.resample(64), rtol=0, atol=1e-12)
    # chords of a smooth wire: even within a percent, and no point farther from the nodes than half an edge
    steps = np.linalg.norm(np.diff(even[-1], axis=0), axis=1)
    assert np.ptp(steps) < 0.01 * steps.mean()
    assert run.trace["time_s"][-1] == run.summary["simulated_s"]
    assert len(run.time) == len(set(run.time))


@needs_command
def test_what_is_no_run_is_refused(folder):
    with pytest.raises(seldinger.Error, match="holds no run"):
        seldinger.load_run(folder)
    run = seldinger.load_run(folder / "R")
    with pytest.raises(ValueError, match="2 or more"):
        run.resample(1)
    frame = sorted((folder / "R").glob("wire_*.vtp"))[-1]
    whole = frame.read_bytes()
    frame.write_bytes(whole[:-400])
    with pytest.raises(seldinger.Error, match="cut short"):
        run.shapes()
    frame.write_bytes(whole)


@needs_command
def test_a_task_is_that_of_the_command(folder):
    said = json.loads((folder / "R/summary.json").read_text())
    world = seldinger.World(folder / "t.toml")
    world.run()
    assert said["task"]["reached"] and world.task() == said["task"]
    assert world.time == said["simulated_s"] < 0.3
    assert world.branch() == (said["branch"], said["branch_depth_m"])


@needs_command
def test_a_task_goes_back_with_the_state(folder):
    import pickle

    world = seldinger.World(folder / "t.toml")
    world.step(n=40)
    state, before = pickle.loads(pickle.dumps(world.save())), world.task()
    world.run()
    after = world.task()
    assert after["reached"] and not before["reached"]
    world.restore(state)
    assert world.task() == before
    world.run()
    assert world.task() == after
    with pytest.raises(seldinger.Error, match="no \\[task\\]"):
        seldinger.World("swing").task()


@needs_command
def test_the_table_of_a_task_is_that_of_the_scene(folder):
    assert seldinger.World(folder / "t.toml").task_table == {"target": {"point": [0.03, 0.0, -0.005], "radius_m": 0.002}}
    limits = ["task.wall_force_n=0.5", "task.time_s=3.0", 'task.target={name = "left", branch = 1, beyond_m = 0.002}']
    table = seldinger.World("aortic-arch", set=limits).task_table
    assert table == {"wall_force_n": 0.5, "time_s": 3.0, "target": {"name": "left", "branch": 1, "beyond_m": 0.002}}
    again = [f"task.{key}={seldinger._toml.value(value)}" for key, value in table.items()]
    assert seldinger.World("aortic-arch", set=again).task_table == table
    assert seldinger.World("swing").task_table == {}
