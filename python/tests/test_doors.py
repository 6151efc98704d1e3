"""Loads of a control, and forces of one's own: against the scene's, closed forms, and what is refused. The examples of examples/doors."""

import importlib.util
import pickle
from pathlib import Path

import numpy as np
import pytest

import seldinger

DOORS = Path(__file__).resolve().parents[2] / "examples" / "doors"

WIRE = {
    "scene": {"name": "cantilever", "gravity": [0.0, 0.0, 0.0], "duration_s": 1.0, "dt_s": 1e-3},
    "wire": {"length_m": 0.2, "radius_m": 5e-4, "density": 6500.0, "bend_nm2": 1e-3, "twist_nm2": 1e-3, "stretch_n": 1e5, "nodes": 21},
    "hold": [{"at": "base", "position": True, "direction": True, "spin": True}],
}


def example(name):
    spec = importlib.util.spec_from_file_location(name, DOORS / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


class Pull(seldinger.Force):
    """20 mN upwards on the tip, as long as `ok` says so, with a count of steps as state."""

    def __init__(self, ok=lambda: None):
        super().__init__(at=0.0, state=[0.0, 1.0])
        self.ok = ok

    def forces(self, p):
        p.force = [0.0, 0.0, 0.02 * p.state[1]]
        return self.ok()

    def accept(self, p):
        p.state[0] += 1
        p.state[1] = 1 - 10 * p.position[0, 2]


# ---- loads of a control

def test_a_load_of_a_control_has_the_bits_of_the_scenes_own():
    load = {"at": 0.03, "force_n": [0.0, 0.01, 0.02], "moment_nm": [0.0, 1e-4, 0.0]}
    scene, own = seldinger.World({**WIRE, "load": [load]}), seldinger.World(WIRE)
    scene.step(n=5)
    own.step(seldinger.Control().load(0, 0.03, load["force_n"], load["moment_nm"]), n=5)
    assert own.state_hash() == scene.state_hash()
    assert own.output.energy["outside"] == scene.output.energy["outside"] > 0
    own.step()
    scene.step()
    assert own.state_hash() != scene.state_hash()  # for one call


@pytest.mark.parametrize("given, error", [
    ({"force": [0.0, np.nan, 0.0]}, ValueError), ({"force": [0.0, 1.0]}, ValueError), ({"force": "up"}, TypeError),
    ({"moment": np.zeros((1, 3))}, ValueError), ({"at": np.inf}, ValueError), ({"at": [0.0]}, ValueError)])
def test_a_load_of_a_wrong_kind_is_refused(given, error):
    with pytest.raises(error, match="load|numbers"):
        seldinger.Control().load(0, **given)


@pytest.mark.parametrize("where", [(1, 0.0), (0, 0.3), (0, -0.1), ("catheter", 0.0)])
def test_a_load_off_the_wire_is_refused_and_nothing_changes(where):
    world = seldinger.World(WIRE)
    before = world.state_hash()
    with pytest.raises(seldinger.Error) as caught:
        world.step(seldinger.Control().load(*where, force=[0.0, 0.0, 1.0]))
    assert caught.value.code == 2 and world.state_hash() == before


# ---- forces

def test_a_function_is_asked_once_a_step_and_acts_as_a_load():
    calls = []

    def pull(p):
        calls.append((p.time, p.position.copy()))
        return np.array([[0.0, 0.0, 0.02]])

    own, scene = seldinger.World(WIRE), seldinger.World(WIRE)
    own.on_step(pull, at=0.05)
    for _ in range(4):
        assert not own.step().failed
        scene.step(seldinger.Control().load(0, 0.05, [0.0, 0.0, 0.02]))
    assert [round(time, 9) for time, _ in calls] == [1e-3, 2e-3, 3e-3, 4e-3] and calls[0][1].shape == (1, 3)
    assert np.abs(own.output.nodes - scene.output.nodes).max() < 1e-8
    energy = own.output.energy
    assert energy["outside"] == 0 and energy["forces"] == pytest.approx(scene.output.energy["outside"], rel=1e-3)
    assert abs(energy["open"]) < 1e-3 * energy["forces"]


def test_what_a_force_sees():
    seen = {}

    class Look(seldinger.Force):
        def forces(self, p):
            seen.update(time=p.time, dt=p.dt, s=p.s.copy(), length=p.length.copy(), axis=p.axis.copy(), director=p.director.copy(),
                        velocity=p.velocity.copy(), position=p.position.copy())
            with pytest.raises(ValueError):
                p.position[:] = 0

    world = seldinger.World(WIRE)
    world.on_step(Look("nodes"))
    world.step(n=2)
    assert seen["time"] == pytest.approx(2e-3) and seen["dt"] == pytest.approx(1e-3)
    assert seen["length"].sum() == pytest.approx(0.2) and seen["s"][-1] == pytest.approx(0.2)
    # straight from the base along x: towards the tip, but for the engine's differences of 1e-6 rad
    assert np.abs(seen["axis"] - [1, 0, 0]).max() < 2e-6
    assert np.abs((seen["axis"] * seen["director"]).sum(1)).max() < 1e-9
    world.on_step(Look("edges"))
    world.step()
    assert len(seen["s"]) == 20


def test_its_state_is_saved_hashed_restored_and_pickled():
    world = seldinger.World(WIRE)
    bare = world.state_hash()
    world.on_step(Pull())
    assert world.state_hash() != bare
    world.step(n=5)
    state, then = world.save(), world.state_hash()
    world.step(n=5)
    after = world.state_hash()
    world.restore(state)
    assert world.state_hash() == then
    world.step(n=5)
    assert world.state_hash() == after
    world.restore(pickle.loads(pickle.dumps(state)))
    assert world.state_hash() == then


class Broken(Exception):
    pass


@pytest.mark.parametrize("bad, error, says", [
    (Broken("no more"), Broken, "no more"),
    (np.array([[0.0, 0.0, np.nan]]), seldinger.Error, "force that is not finite"),
    ((np.zeros((1, 3)), [[0.0, np.inf, 0.0]]), seldinger.Error, "moment that is not finite"),
    (np.zeros((2, 3)), ValueError, r"got shape \(2, 3\); expected \(1, 3\)"),
    ("up", TypeError, "expected numbers")])
@pytest.mark.parametrize("call", ["step", "settle", "run"])
def test_what_it_raises_ends_the_step_with_its_traceback_and_leaves_the_world(bad, error, says, call):
    on = [False]

    def ok():
        if not on[0]:
            return None
        if isinstance(bad, Exception):
            raise bad
        return bad

    world = seldinger.World(WIRE, scene__duration_s=0.1)
    world.on_step(Pull(ok))
    world.step(n=3)
    before, nodes = world.save().bytes, world.output.nodes
    on[0] = True
    with pytest.raises(error, match=says) as caught:
        getattr(world, call)()
    if error is not seldinger.Error:
        assert any(entry.name in ("ok", "_write") for entry in caught.traceback)
    assert world.save().bytes == before and np.array_equal(world.output.nodes, nodes)
    on[0] = False
    assert not world.step().failed


def test_a_force_that_turns_to_its_own_world_is_refused():
    world = seldinger.World(WIRE)
    other = seldinger.World(WIRE)

    class Curious(seldinger.Force):
        def forces(self, p):
            assert other.output.step == 0  # another world is free to be read
            return [[0.0, 0.0, world.output.tip[2]]]

    world.on_step(Curious())
    with pytest.raises(seldinger.Error, match="one of its own forces"):
        world.step()


@pytest.mark.parametrize("given, error", [
    ({"at": "everywhere"}, ValueError), ({"at": [0.0, np.nan]}, ValueError), ({"at": 0.5}, seldinger.Error), ({"at": []}, seldinger.Error),
    ({"instrument": 3}, seldinger.Error)])
def test_a_place_that_is_none_is_refused(given, error):
    world = seldinger.World(WIRE)
    with pytest.raises(error):
        world.on_step(lambda p: np.zeros((1, 3)), **given)
    assert not world.step().failed


def test_a_force_without_tangents_moves_as_one_with_them():
    spring = example("spring_to_a_point").Spring

    class Without(spring):
        tangents = seldinger.Force.tangents

    ends = []
    for kind in (spring, Without):
        world = seldinger.World(WIRE)
        world.on_step(kind([0.2, 0.0, 0.05], 50.0))
        assert not world.step(n=20).failed
        ends.append(world.output.tip)
        assert world.output.force_energy == pytest.approx(25.0 * ((world.output.tip - [0.2, 0.0, 0.05]) ** 2).sum(), rel=1e-9)
    assert np.abs(ends[0] - ends[1]).max() < 1e-7


class Shared(seldinger.Force):
    """Drag and weight by instrument on every node, asked for all at once or one by one."""

    def __init__(self, together):
        super().__init__(at="nodes", together=together)
        self.calls = 0

    def forces(self, p):
        self.calls += 1
        p.force = -1e-3 * p.velocity
        p.force[:, 2] += 1e-4 * (1 + p.wire)

    def tangents(self, p):
        p.damping[:, :3, :3] = -1e-3 * np.eye(3)


def test_a_force_of_several_instruments_is_asked_once_for_all_with_the_same_bits():
    worlds, forces = [seldinger.World(WIRE, copies=[[]] * 3) for _ in range(2)], [Shared(True), Shared(False)]
    for world, force in zip(worlds, forces):
        world.on_step(force, instrument=range(3))
        assert not world.step(n=5).failed
    assert worlds[0].state_hash() == worlds[1].state_hash()
    assert worlds[0].state_hash(0) != worlds[0].state_hash(1)
    assert 2.5 < forces[1].calls / forces[0].calls <= 3
    again = pickle.loads(pickle.dumps(worlds[0]))
    for world in (worlds[0], again):
        world.step()
    assert again.state_hash() == worlds[0].state_hash()


@pytest.mark.parametrize("given", [{"state": [1.0], "together": True}, {"record": ["time_s"]}])
def test_a_state_that_cannot_be_kept_is_refused(given):
    with pytest.raises(seldinger.Error, match="state: got some|record: got 1 names"):
        seldinger.World(WIRE).on_step(type("Odd", (seldinger.Force,), {"forces": lambda self, p: None})(**given))


def test_of_several_instruments_all_get_a_force_or_none():
    world = seldinger.World(WIRE, copies=[[], ["wire.length_m=0.1"]])
    before = world.state_hash()
    with pytest.raises(seldinger.Error, match="0.15 m"):
        world.on_step(Shared(True).__class__.__bases__[0](at=0.15, state=[1.0]), instrument=[0, 1])
    assert world.state_hash() == before


def test_samples_of_a_sensor_go_with_the_state():
    coil = example("em_coil").Coil(noise=0.0)
    world = seldinger.World(WIRE, scene__dt_s=0.01)
    world.on_step(coil)
    world.step(n=4)
    sample = world.output.sensors["coil"]
    assert list(sample) == ["time_s", "x_m", "y_m", "z_m"] and sample["time_s"] == pytest.approx(0.03) and sample["x_m"] != 0
    state = pickle.loads(pickle.dumps(world.save()))
    world.step(n=10)
    assert world.output.sensors["coil"] != sample
    world.restore(state)
    assert world.output.sensors["coil"] == sample


def test_a_push_moves_a_hub_with_a_mass_and_no_other():
    drive = example("robot_backlash")
    world = seldinger.World({**drive.SCENE, "scene": {**drive.SCENE["scene"], "dt_s": 1e-4}}, set=["feed.hub_friction_n=0.0"])
    world.step(seldinger.Control().push(0, 0.1), n=100)
    wire = np.pi * 4e-4**2 * 6500.0 * 0.05  # kg, inside
    speed = 0.1 / drive.DAMPING * (1 - np.exp(-drive.DAMPING * 0.01 / (drive.MASS + wire)))
    # backward Euler is dt c/2 m behind, and outside of the wire is no mass
    assert (world.output.inserted - 0.0) == pytest.approx(0.1 / drive.DAMPING * (0.01 - speed / 0.1 * (drive.MASS + wire)), rel=0.03)
    with pytest.raises(seldinger.Error):
        seldinger.World({**drive.SCENE, "feed": {**{k: v for k, v in drive.SCENE["feed"].items() if not k.startswith("hub")},
                                                 "keys": [{"t_s": 0.0, "advance_m": 0.05}]}}).step(seldinger.Control().push(0, 0.1))


# ---- examples

def test_the_spring_of_the_example_deflects_by_the_formula():
    computed, exact = example("spring_to_a_point").deflection()
    # slopes of 0.5 %: 1e-4 of the arm at second order, and the edges' (1/80)^2
    assert computed == pytest.approx(exact, rel=1e-3)


@pytest.mark.parametrize("share, alpha", [(0.3, 90), (2.0, 120), (5.0, 60)])
def test_the_magnet_of_the_example_bends_the_wire_to_the_exact_elastica(share, alpha):
    computed, exact = example("magnetic_tip").tip(share, np.radians(alpha))
    assert np.linalg.norm(computed - exact) < 1e-3 * 0.1


def test_becks_column_flutters_at_its_load():
    assert example("becks_column").flutter_load() == pytest.approx(20.05, rel=0.01)


def test_a_pull_wire_bends_to_a_circle_and_less_with_friction():
    pull_wire = example("pull_wire")
    turned, formula, spread = pull_wire.tip_angle(3.0, 0.0)
    assert turned == pytest.approx(formula, rel=0.02) and spread < 0.02
    turned, formula, spread = pull_wire.tip_angle(3.0, 0.3)
    assert turned == pytest.approx(formula, rel=0.02) and spread > 0.2


def test_blood_drags_a_wire_by_the_formula():
    computed, formula = example("blood_drag").deflection()
    assert computed == pytest.approx(formula, rel=0.01)


def test_a_dipole_bends_a_magnetic_tip_by_the_formula():
    computed, formula = example("magnet_dipole").deflection()
    assert computed == pytest.approx(formula, rel=1e-3)


def test_a_coil_measures_at_its_rate_with_its_noise_and_seed():
    em_coil = example("em_coil")
    samples, tips = em_coil.record(duration=1.0, rate=40.0, noise=5e-4, seed=3)
    dt = seldinger.World("swing").dt
    assert len(samples) == int(40 * dt * round(1 / dt) + 1e-6) and np.allclose(np.diff(samples[:, 0]), 1 / 40, atol=dt)
    error = samples[:, 1:] - tips  # 120 numbers: their spread is known to 6.5 %, their mean to 46 um; four times that
    assert error.std() == pytest.approx(5e-4, rel=0.26) and abs(error.mean()) < 4 * 4.6e-5
    assert np.array_equal(samples, em_coil.record(seed=3)[0]) and not np.array_equal(samples, em_coil.record(seed=4)[0])


def test_a_drive_loses_its_play_and_its_friction():
    found, formula = example("robot_backlash").lost_motion()
    assert found == pytest.approx(formula, rel=0.01)
