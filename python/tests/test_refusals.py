"""What must never end the interpreter: forks, missing devices, damaged pickles, pictures from several threads, impossible arguments."""

import multiprocessing
import os
import pickle
import subprocess
import sys
import tempfile
import threading

import numpy as np
import pytest

import seldinger


def in_a_process(code, **environment):
    # the limit only ends what hangs; plan() writes where it runs
    with tempfile.TemporaryDirectory() as here:
        return subprocess.run([sys.executable, "-c", code], env={**os.environ, **environment}, capture_output=True, text=True,
                              timeout=120, cwd=here)


FORKED = """
import gc, os, signal, sys, threading, seldinger
{before}
child = os.fork()
if child == 0:
    signal.alarm(60)  # ends a child that hangs
    try:
        {ask}
    except seldinger.Error as error:
        sys.exit(17 if error.code == 5 and "spawn" in str(error) else 1)
    sys.exit(18)
print(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), flush=True)
"""
WORLD = "world = seldinger.World('experiment2'); world.step([0.001, 0.0])"


@pytest.mark.parametrize("before, ask", [
    (WORLD, "world.output"), (WORLD, "world.save()"), (WORLD, "world.render(64, 48)"), (WORLD, "seldinger.World('swing')"),
    (WORLD, "seldinger.devices()"), (WORLD, "seldinger.batch('swing', {'wire.nodes': [11]})"), (WORLD, "seldinger.plan('swing', 1e-3)"),
    (WORLD, "seldinger.chart(['swing'])"), ("seldinger.devices()", "seldinger.World('swing')"),
    # the lock of the world is held by a thread that the child does not have
    (WORLD + "; threading.Thread(target=lambda: world.step([0.05, 0.0], n=1000)).start()", "world.step([0.002, 0.0])")])
def test_what_a_forked_child_asks_is_refused(before, ask):
    done = in_a_process(FORKED.format(before=before, ask=ask))
    assert done.stdout.strip() == "17", done.stdout + done.stderr


@pytest.mark.parametrize("ask", ["world.close()", "del world; gc.collect()", "pass"])
def test_a_forked_child_lets_go_and_ends(ask):
    done = in_a_process(FORKED.format(before=WORLD + "; world.render(64, 48) if os.environ.get('DRAW') else None", ask=ask))
    assert done.stdout.strip() == "18", done.stdout + done.stderr


def _in_a_child(queue):
    world = seldinger.World("swing")
    world.step(n=5)
    queue.put(world.state_hash())


def test_spawn_is_the_way():
    here = seldinger.World("swing")
    here.step(n=5)
    context = multiprocessing.get_context("spawn")
    queue = context.Queue()
    child = context.Process(target=_in_a_child, args=(queue,))
    child.start()
    assert queue.get(timeout=120) == here.state_hash()
    child.join()


@pytest.mark.parametrize("ask", ["seldinger.World('experiment2')", "seldinger.batch('experiment2', {'wire.nodes': [41]})",
                                 "seldinger.plan('experiment2', 1e-3)"])
def test_without_a_device_it_says_what_to_install(tmp_path, ask):
    code = f"import seldinger\ntry:\n    {ask}\nexcept seldinger.Error as error:\n    print(error.code, error)"
    done = in_a_process(code, OCL_ICD_VENDORS=str(tmp_path))
    assert done.returncode == 0 and done.stdout.startswith("5 ") and "pocl-opencl-icd" in done.stdout, done.stdout + done.stderr


def drawn(world, **how):
    try:
        return world.render(64, 48, legend=False, **how)
    except seldinger.Error as error:
        assert error.code == 5
        pytest.skip(str(error))


def test_any_thread_draws_and_closes():
    worlds = [seldinger.World("experiment2"), seldinger.World("swing")]
    first = [drawn(world) for world in worlds]
    seen, go = [], threading.Event()

    def draw():
        seen.extend(world.render(64, 48, legend=False) for world in worlds)
        go.wait(60)  # alive while another thread draws and closes what it drew last

    thread = threading.Thread(target=draw)
    thread.start()
    while len(seen) < 2 and thread.is_alive():
        thread.join(0.01)
    again = [world.render(64, 48, legend=False) for world in worlds]
    worlds[1].close()
    del worlds
    go.set()
    thread.join()
    for one in (seen, again):
        assert all(np.array_equal(a, b) for a, b in zip(first, one)) and len(one) == 2


def test_pictures_while_others_step_draw_and_close():
    world = seldinger.World("experiment2")
    drawn(world)
    refused = []

    def go_on():
        try:
            for k in range(200):
                world.step(n=1)
                world.render(64 + 8 * (k % 2), 48, legend=False)
        except seldinger.Error as error:
            refused.append("closed" in str(error))

    threads = [threading.Thread(target=go_on) for _ in range(3)]
    for t in threads:
        t.start()
    for _ in range(10):
        world.output.nodes.sum()
    world.close()
    for t in threads:
        t.join()
    assert all(refused)


def test_a_camera_is_for_one_picture():
    world = seldinger.World("swing")
    whole = drawn(world)
    middle = world.output.nodes.mean(axis=0)
    near = drawn(world, camera=(middle + [0.0, 0.02, 0.0], middle, [0.0, 0.0, 1.0]))
    assert not np.array_equal(whole, near) and np.array_equal(whole, drawn(world))
    for camera in [((np.nan, 0, 0), (0, 0, 0), (0, 0, 1)), ((0, 0, 0),), ((0, 0), (0, 0), (0, 1)), "left"]:
        with pytest.raises((ValueError, TypeError), match="camera|float"):
            world.render(64, 48, camera=camera)


@pytest.mark.parametrize("size", [(0, 10), (10, -1), (10**6, 10**6), (2**40, 1)])
def test_pictures_that_cannot_be(size):
    with pytest.raises((seldinger.Error, ValueError, OverflowError, TypeError)):
        seldinger.World("swing").render(*size)


def test_damaged_pickles_are_refused():
    world = seldinger.World("swing")
    world.step(n=3)
    state, before = world.save(), world.state_hash()
    make, (kind, *_), parts = state.__reduce_ex__(2)[:3]
    system, held, output, scores = parts
    damaged = [(system, held[:-1], output), (system, b"", output), (system, held, output[:-1]), (system, held, output[:100]),
               (system, held, bytes(len(output))), (system, held, output[:20] + b"\xff" * 8 + output[28:]), (system, held),
               (system, held + held, output), (4711, held, output), (system, b"\xff" * len(held), output)]
    damaged = [(*parts, scores) if len(parts) == 3 else parts for parts in damaged]
    damaged += [(system, held, output), (system, held, output, b""), (system, held, output, b"\xff" * 8), (system, held, output, b"\x01" + bytes(7) + b"\xff" * 400)]
    for parts in damaged:
        with pytest.raises(seldinger.Error):
            bad = make(kind)
            bad.__setstate__(parts)
            world.restore(bad)
        assert world.state_hash() == before
    world.restore(pickle.loads(pickle.dumps(state)))
    world.restore(state)


def test_objects_without_contents_are_refused():
    # each of these crashed once, so each runs in a separate process
    code = """
import copy, pickle, seldinger
from seldinger import _engine
world = seldinger.World("swing")
empty = seldinger.State.__new__(seldinger.State)
for ask in (lambda: empty.system, lambda: empty.bytes, lambda: pickle.dumps(empty), lambda: copy.copy(empty), lambda: world.restore(empty),
            lambda: world._world.restore(empty), lambda: repr(empty.system)):
    try:
        ask()
        raise SystemExit("taken")
    except seldinger.Error as error:
        assert error.code == 3 and "no contents" in str(error), error
for kind in (seldinger.Output, seldinger.InstrumentOutput, _engine.World, _engine.Navigator):
    for make in (kind, lambda: kind.__new__(kind), lambda: object.__new__(kind), lambda: type("Own", (kind,), {})()):
        try:
            make()
            raise SystemExit(f"{kind} was made")
        except TypeError:
            pass
assert copy.copy(world.save()).bytes == world.save().bytes
print("done")
"""
    done = in_a_process(code)
    assert done.returncode == 0 and done.stdout == "done\n", (done.returncode, done.stdout, done.stderr)


def test_a_subinterpreter_is_refused_and_does_not_hang():
    code = """
import _xxsubinterpreters as interpreters
try:
    interpreters.run_string(interpreters.create(), "import seldinger")
except interpreters.RunFailedError as error:
    print(error)
"""
    if sys.version_info >= (3, 13):
        pytest.skip("the module for subinterpreters is another one")
    done = in_a_process(code)  # hung before, until its limit of time
    assert "main one" in done.stdout, done.stdout + done.stderr


@pytest.mark.parametrize("copies, says", [(10**6, "got 1000000"), (3, "got 3"), ("ab", "got 'ab'"), (["ab"], r"copies\[0\]: got 'ab'"), ([[], 7], r"copies\[1\]"),
                                          ({}, "got {}"), ([], "got none"), ([[]] * 10**6, "more than 65536")])
def test_numbers_of_copies_that_cannot_be_are_refused_in_words(copies, says):
    with pytest.raises((TypeError, ValueError), match=says):
        seldinger.World("swing", copies=copies)


def test_systems_that_are_not_there():
    world = seldinger.World("swing", copies=[[], []])
    for ask in (world.save, world.state_hash):
        for system in (2, 10**6):
            with pytest.raises(seldinger.Error, match="system"):
                ask(system)
    with pytest.raises((TypeError, OverflowError, ValueError)):
        world.save(10**30)


@pytest.mark.parametrize("control", [
    np.zeros((1, 2, 1)), np.zeros((2, 1)), np.zeros((0, 2)), [[0.0, 0.0], [0.0]], np.zeros(2, bool), np.zeros(2, object),
    np.zeros(2, "datetime64[s]"), {0: np.array([np.nan, 0.0])}, {0: "ab"}, {0: None}, {(0, 1): (0.0, 0.0)}, {"wire": 3.0}, "push", b"ab",
    np.array([0.0, -np.inf], np.float32), object(), {1.5: (0.0, 0.0)}])
def test_more_controls_that_cannot_be(control):
    world = seldinger.World("experiment2")
    before = world.state_hash()
    with pytest.raises((TypeError, ValueError, seldinger.Error)):
        world.step(control)
    assert world.state_hash() == before


@pytest.mark.parametrize("kind", [np.float32, np.float16, np.int8, np.uint64])
def test_other_kinds_of_numbers_are_numbers(kind):
    world, same = seldinger.World("experiment2"), seldinger.World("experiment2")
    wide = np.zeros((2, 4), kind)
    world.step(wide[0, ::2])  # not contiguous
    same.step([0.0, 0.0])
    assert world.state_hash() == same.state_hash()


@pytest.mark.parametrize("dt", [0.0, -1.0, np.nan, np.inf, "fast", None])
def test_lengths_of_steps_that_cannot_be(dt):
    world = seldinger.World("swing")
    before = world.state_hash()
    if dt is None:
        world.step(dt=dt)  # the scene's
        return
    with pytest.raises((ValueError, seldinger.Error)):
        world.step(dt=dt)
    assert world.state_hash() == before


@pytest.mark.parametrize("arguments", [
    {"copies": []}, {"copies": [["wire.nodes"]]}, {"copies": [["nothing.known=1"]]}, {"copies": 3}, {"device": "gpu"}, {"set": ["wire"]},
    {"wire__nodes": None}, {"wire__nodes": object()}, {"wire__nodes": float("inf")}, {"nothing": 1}, {"copies": [[], ["scene.dt_s=7"]]}])
def test_worlds_that_cannot_be(arguments):
    with pytest.raises((TypeError, ValueError, seldinger.Error)):
        seldinger.World("experiment2", **arguments)


@pytest.mark.parametrize("scene", [{}, {"wire": None}, {"wire": {"nodes": object()}}, "[wire\n", "\n", {"scene": {"dt_s": "slow"}}, b"swing"])
def test_scenes_that_cannot_be(scene):
    with pytest.raises((TypeError, seldinger.Error)):
        seldinger.World(scene)


@pytest.mark.parametrize("vary", [{}, {"wire.nodes": []}, {"wire.nodes": "many"}, {"wire.knots": [1, 2]}, "no-such.toml", {"wire.nodes": {"min": 1}}])
def test_sweeps_that_cannot_be(vary):
    with pytest.raises((TypeError, ValueError, OSError, seldinger.Error)):
        seldinger.batch("swing", vary, scene__duration_s=0.01)


def test_a_numpy_that_the_build_does_not_know_is_refused_at_import():
    code = "import numpy; numpy.__version__ = '2.1.0'; import seldinger"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    if done.returncode == 0:
        pytest.skip("built with a pybind11 that knows NumPy 2")
    assert "ImportError" in done.stderr and "numpy<2" in done.stderr.splitlines()[-1]
