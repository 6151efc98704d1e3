"""Worlds: the command's bits, saving and restoring, views, threads, pickles, and what is refused."""

import gc
import json
import os
import pickle
import resource
import subprocess
import sys
import threading

import numpy as np
import pytest

import seldinger


def command_hash(command, scene, tmp_path, *sets):
    words = [command, "run", str(scene), "-o", str(tmp_path / "run"), "--overwrite", "--quiet"]
    for text in sets:
        words += ["--set", text]
    subprocess.run(words, check=True)
    return json.loads((tmp_path / "run" / "summary.json").read_text())["state_hash"]


@pytest.mark.parametrize("scene, seconds", [("experiment1", 1.0), ("experiment2", 1.0), ("catheter-over-wire", 0.3)])
def test_the_same_hash_as_the_command(command, tmp_path, scene, seconds):
    path = seldinger.assets() / "scenes" / f"{scene}.toml"
    expected = command_hash(command, path, tmp_path, f"scene.duration_s={seconds}")
    world = seldinger.World(path, scene__duration_s=seconds)
    world.run()
    assert world.state_hash() == expected


def test_a_batch_has_the_hashes_of_its_runs_alone():
    vary = {"contact.mu_sliding": [0.02, 0.09], "wire.density": [6000.0, 7800.0]}
    table = seldinger.batch("aortic-arch", vary, scene__duration_s=4.0)
    assert table["status"].tolist() == ["done"] * 4 and len(set(table["state_hash"])) == 4
    for run, sets in enumerate(seldinger.sweep(vary)):
        world = seldinger.World("aortic-arch", set=sets, scene__duration_s=4.0)
        world.run()
        assert world.state_hash() == table["state_hash"][run]


def push(world, steps, start):
    for k in range(steps):
        assert not world.step([2e-5 * (start + k + 1), 0.002 * (start + k + 1)]).failed


def test_restore_then_the_same_trajectory():
    world = seldinger.World("experiment2")
    push(world, 1000, 0)
    state, then = world.save(), world.output
    push(world, 200, 1000)
    after, force = world.state_hash(), world.output.hand_force
    world.restore(state)
    assert world.output.hand_force == then.hand_force and np.array_equal(world.output.contacts, then.contacts)
    push(world, 200, 1000)
    assert world.state_hash() == after and world.output.hand_force == force
    copy = pickle.loads(pickle.dumps(world))  # scene and state
    assert copy.state_hash() == after and copy.output.hand_force == force
    push(copy, 50, 1200)
    push(world, 50, 1200)
    assert copy.state_hash() == world.state_hash()


@pytest.mark.parametrize("choice", [{}, {"contact__detection": "layer"}, {"contact__normal": "barrier"}, {"vessel__wall": "elastic"}])
def test_one_system_goes_back_and_the_others_do_not(choice):
    alone = seldinger.World("experiment2", wire__nodes=61, **choice)
    pair = seldinger.World("experiment2", wire__nodes=61, copies=[[], []], **choice)
    start = pair.save(0)
    for k in range(60):
        pair.step([[1e-3 * k, 0.0], [8e-4 * k, 0.05 * k]])
        if k < 20:
            alone.step([1e-3 * k, 0.0])
    other = pair.output.instruments[1].nodes
    pair._world.restore(start, 0)
    assert np.array_equal(pair.output.instruments[1].nodes, other)
    for k in range(20):
        pair.step({0: (1e-3 * k, 0.0)})
    assert np.array_equal(pair.output.instruments[0].nodes, alone.output.nodes)
    assert pair.output.instruments[0].hand_force == alone.output.hand_force


def test_instruments_that_touch_go_back_alike():
    keys = {"coaxial__model": "separate"}
    try:
        alone, pair = seldinger.World("catheter-over-wire", **keys), seldinger.World("catheter-over-wire", copies=[[], []], **keys)
    except seldinger.Error as error:
        pytest.skip(f"no instruments inside each other in this build: {error}")
    pair.step(n=300)
    alone.step(n=400)
    kept = pair.save(0)
    pair.step(n=100)
    other = pair.save(1).bytes
    pair._world.restore(kept, 0)
    assert pair.save(0).bytes == kept.bytes and pair.save(1).bytes == other
    pair.step(n=100)
    for k in range(2):
        assert np.array_equal(pair.output.instruments[k].nodes, alone.output.instruments[k].nodes)


def test_views_are_of_a_moment_and_outlive_the_world():
    world = seldinger.World("experiment2")
    world.step([0.03, 0.0], n=600)
    output = world.output
    nodes, contacts = output.nodes, output.contacts
    copy = nodes.copy()
    assert nodes.base is not None and not nodes.flags.writeable and not contacts.flags.writeable
    assert world.output.nodes.ctypes.data == nodes.ctypes.data  # no copy
    with pytest.raises(ValueError):
        nodes[0] = 0
    assert set(contacts.dtype.names) >= {"point", "normal", "normal_force", "gap", "instrument", "edge"}
    world.step([0.04, 0.0], n=100)
    assert np.array_equal(nodes, copy)
    del world, output
    gc.collect()
    assert np.array_equal(nodes, copy) and nodes.shape == (len(copy), 3)


def resident_mb():
    gc.collect()
    with open("/proc/self/statm") as statm:
        return int(statm.read().split()[1]) * resource.getpagesize() / 1e6


def test_worlds_that_are_gone_leave_no_memory_though_views_are_kept():
    def view():
        world = seldinger.World("navigate")
        world.step([0.01, 0.0], n=5)
        return world.output.nodes

    kept = [view() for _ in range(2)]  # what is made once: kernels, pools
    before = resident_mb()
    kept += [view() for _ in range(6)]
    # a view holds one copy of a state of some nodes, less than 0.1 MB; a world with its vessel's triangles is more than 5
    assert resident_mb() - before < 6
    assert all(np.isfinite(v).all() for v in kept)


def test_names_address_instruments():
    world = seldinger.World("catheter-over-wire")
    assert len(world.instruments) == 2
    first = world.instruments[0]
    world.step({first: (0.001, 0.0)}, n=10)
    assert world.output.instruments[0].inserted == pytest.approx(0.001)
    with pytest.raises(seldinger.Error, match="instrument: got"):
        world.step({"forceps": (0.0, 0.0)})


def test_a_scene_as_a_dict():
    scene = {"scene": {"duration_s": 0.01, "dt_s": 0.001, "gravity": [0.0, 0.0, -9.81]},
             "wire": {"length_m": 0.1, "radius_m": 0.0002, "density": 7800.0, "youngs_pa": 2e11, "nodes": 21,
                      "place": {"shape": "straight", "base": [0, 0, 0], "direction": [1, 0, 0], "normal": [0, 0, 1]}},
             "hold": [{"at": "base", "position": True, "direction": True, "spin": True}]}
    world = seldinger.World(scene)
    assert world.run().tip[2] < 0
    assert seldinger.World(world.scene).dt == 0.001


@pytest.mark.parametrize("control, error", [
    ([0.0], ValueError), ([[0.0, 0.0, 0.0]], ValueError), (np.zeros((5, 2)), ValueError), (["a", "b"], TypeError),
    ([np.nan, 0.0], ValueError), ([np.inf, 0.0], ValueError), (np.zeros(2, complex), TypeError), (np.array(None), TypeError),
    ({7: (0, 0)}, seldinger.Error), ({0: (0,)}, ValueError), ([99.0, 0.0], seldinger.Error), ([-1.0, 0.0], seldinger.Error)])
def test_controls_that_cannot_be(control, error):
    world = seldinger.World("experiment2")
    before = world.state_hash()
    with pytest.raises(error):
        world.step(control)
    assert world.state_hash() == before


def test_a_step_that_no_number_can_tell_of_has_failed():
    world = seldinger.World("experiment2")
    assert not world.step([0.02, 0.0]).failed
    report = world.step([0.02, 1e154])  # its energy is just a number, its force would be none
    assert report.failed
    assert np.isfinite(world.output.hand_force)


@pytest.mark.parametrize("n", [0, -1, 1.5, True])
def test_numbers_of_steps_that_cannot_be(n):
    with pytest.raises(ValueError, match="1 or more"):
        seldinger.World("swing").step(n=n)


def test_one_line_says_what_is_wrong():
    with pytest.raises(seldinger.Error) as raised:
        seldinger.World("experiment2", wire__nodes="many")
    assert raised.value.code == 2 and "wire.nodes" in str(raised.value) and "\n" not in str(raised.value)
    with pytest.raises(seldinger.Error) as raised:
        seldinger.World("no-such.toml")
    assert raised.value.code == 3
    with pytest.raises(seldinger.Error):
        seldinger.World("experiment2", device=4711)
    with pytest.raises(TypeError):
        seldinger.World(17)
    with pytest.raises(ValueError, match="finite"):
        seldinger.World("experiment2", scene__dt_s=float("nan"))
    with pytest.raises(seldinger.Error):
        seldinger.World("swing").step(dt=-1.0)
    assert pickle.loads(pickle.dumps(raised.value)).code == 3


def test_states_of_other_worlds_are_refused():
    world, other = seldinger.World("experiment2"), seldinger.World("swing")
    before = world.state_hash()
    with pytest.raises(seldinger.Error):
        world.restore(other.save())
    with pytest.raises(TypeError):
        world.restore(b"abc")
    assert world.state_hash() == before


def test_a_closed_world_says_so():
    world = seldinger.World("swing")
    state, nodes = world.save(), world.output.nodes
    world.close()
    for ask in (world.step, world.save, lambda: world.output, world.settle, world.state_hash, lambda: world.time, world.render,
                lambda: world.restore(state), lambda: world.model, lambda: pickle.dumps(world), lambda: world.centreline,
                lambda: world.vessel):
        with pytest.raises(seldinger.Error, match="closed"):
            ask()
    assert np.isfinite(nodes).all()
    world.close()


def in_a_process(code, **environment):
    return subprocess.run([sys.executable, "-c", code], env={**os.environ, **environment}, capture_output=True, text=True, timeout=120)


def test_a_fork_is_told():
    code = """
import os, seldinger
world = seldinger.World("experiment2")
child = os.fork()
if child == 0:
    try:
        world.step([0.001, 0.0])
    except seldinger.Error as error:
        os._exit(17 if "forked" in str(error) else 1)
    os._exit(2)
assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 17
"""
    done = in_a_process(code)
    assert done.returncode == 0, done.stderr


def test_a_fork_before_the_first_world_is_none_of_our_business():
    code = """
import os, seldinger
child = os.fork()
if child == 0:
    seldinger.World("experiment2").step([0.001, 0.0])
    os._exit(17)
assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 17
"""
    done = in_a_process(code)
    assert done.returncode == 0, done.stderr


def test_no_device(tmp_path):
    code = """
import seldinger
try:
    seldinger.World("experiment2")
except seldinger.Error as error:
    print(error.code)
"""
    done = in_a_process(code, OCL_ICD_VENDORS=str(tmp_path))
    assert done.stdout.strip() == "5", done.stderr


def test_other_threads_run_while_a_world_steps():
    world, seen = seldinger.World("experiment2"), []
    thread = threading.Thread(target=lambda: world.step([0.05, 0.0], n=1500))
    thread.start()
    while thread.is_alive():
        seen.append(1)
        thread.join(0.001)
    assert len(seen) > 10 and world.time == pytest.approx(1500 * world.dt)


def test_threads_that_share_a_world_wait_for_each_other():
    world = seldinger.World("experiment2")
    threads = [threading.Thread(target=lambda: [(world.step(n=5), world.output.nodes.sum()) for _ in range(40)]) for _ in range(3)]
    for t in threads:
        t.start()
    for t in threads:
        t.join()
    assert world.output.step == 600


def test_render():
    world = seldinger.World("experiment2")
    world.step([0.05, 0.0], n=300)
    try:
        picture = world.render(160, 120, legend=False)
    except seldinger.Error as error:
        assert error.code == 5
        pytest.skip(str(error))
    assert picture.shape == (120, 160, 3) and picture.dtype == np.uint8 and picture.std() > 5
    with pytest.raises(seldinger.Error):
        world.render(0, 10)


def test_plan(tmp_path):
    plan = seldinger.plan("swing", 1e-3, budget=20, out=tmp_path / "planned.toml")
    assert plan["status"] and (tmp_path / "planned.toml").is_file()
