"""Navigate-v1: what gymnasium checks, seeds, and that a vector is its environments, bit for bit."""

import numpy as np
import pytest

gymnasium = pytest.importorskip("gymnasium", reason="gymnasium is not installed: pip install gymnasium")

import seldinger.gym  # noqa: E402
from gymnasium.utils.env_checker import check_env  # noqa: E402
from gymnasium.vector import AutoresetMode, SyncVectorEnv  # noqa: E402

SMALL = {"starts": 2, "max_steps": 12, "start_advance": (0.06, 0.08), "least_advance": 0.02}


@pytest.fixture(scope="module")
def env():
    made = seldinger.gym.NavigateEnv(**SMALL)
    yield made
    made.close()


@pytest.mark.filterwarnings("ignore")
def test_check_env():
    check_env(gymnasium.make("seldinger/Navigate-v1", **SMALL).unwrapped, skip_render_check=True)


def episode(env, seed):
    rng = np.random.default_rng(seed)
    seen = [env.reset(seed=seed)[0]]
    for _ in range(8):
        seen.append(env.step(rng.uniform(-1, 1, 2).astype(np.float32))[0])
    return seen, env.world.output.nodes.copy()


def test_seeds_are_obeyed(env):
    first, nodes = episode(env, 3)
    again, nodes_again = episode(env, 3)
    assert np.array_equal(nodes, nodes_again)
    for a, b in zip(first, again):
        assert all(np.array_equal(a[k], b[k]) for k in a)
    assert not np.array_equal(episode(env, 4)[1], nodes)


def same(a, b):
    if isinstance(a, dict):
        return all(same(a[k], b[k]) for k in a)
    return np.array_equal(a, b)


@pytest.mark.parametrize("mode", [AutoresetMode.NEXT_STEP, AutoresetMode.SAME_STEP])
@pytest.mark.parametrize("vary", [None, {"wire.mu_sliding": [0.02, 0.05], "wire.density": [3700.0, 6000.0]},
                                  {"wire.mu_sliding": [0.02, 0.05], "vessel.triangles": [30000, 12000]},
                                  {"wire.bend_scale": [0.2, 4.0], "scene.gravity": [[0.0, 0.0, -9.81], [0.0, 0.0, 0.0]]}])
def test_a_vector_is_its_environments(mode, vary):
    count = 4
    single = SyncVectorEnv([lambda i=i: seldinger.gym.NavigateEnv(vary=vary, variant=i, **SMALL) for i in range(count)],
                           autoreset_mode=mode)
    vector = seldinger.gym.NavigateVectorEnv(count, vary=vary, autoreset_mode=mode, **SMALL)
    assert vector.metadata["autoreset_mode"] == mode
    a, b = single.reset(seed=5)[0], vector.reset(seed=5)[0]
    assert same(a, b)
    rng = np.random.default_rng(0)
    ends = 0
    for _ in range(30):
        action = rng.uniform(-1, 1, (count, 2)).astype(np.float32)
        one, all_ = single.step(action), vector.step(action)
        assert all(same(x, y) for x, y in zip(one[:4], all_[:4]))
        for s in np.flatnonzero(all_[4].get("_final_obs", [])):
            assert same(one[4]["final_obs"][s], all_[4]["final_obs"][s])
        ends += int((one[2] | one[3]).sum())
    assert ends >= 2 * count
    single.close()
    vector.close()


def test_every_episode_may_draw_its_variant():
    # stiffness: the rigid wall's own follows the wire, so that the two are of two worlds
    settings = {**SMALL, "flat": True, "max_steps": 4, "variant": "draw", "vary": {"wire.bend_scale": [0.2, 4.0], "wire.mu_sliding": [0.02, 0.1]}}
    single = SyncVectorEnv([lambda: seldinger.gym.NavigateEnv(**settings)] * 3)
    vector = seldinger.gym.NavigateVectorEnv(3, **settings)
    a, b = single.reset(seed=2), vector.reset(seed=2)
    rng, met = np.random.default_rng(0), set()
    for _ in range(20):
        assert same(a[0], b[0]) and np.array_equal(a[-1]["variant"], b[-1]["variant"]) and np.array_equal(vector.variant, b[-1]["variant"])
        met |= {(s, int(v)) for s, v in enumerate(vector.variant)}
        action = rng.uniform(-1, 1, (3, 2)).astype(np.float32)
        a, b = single.step(action), vector.step(action)
        assert all(same(x, y) for x, y in zip(a[:4], b[:4]))
    assert len(vector.worlds) == 2
    assert any(len({v for s, v in met if s == i}) > 1 for i in range(3)), "no environment met a second variant"
    episode = vector.save()
    ahead = [vector.step(np.zeros((3, 2)))[0] for _ in range(8)]
    vector.restore(episode)
    assert same(ahead, [vector.step(np.zeros((3, 2)))[0] for _ in range(8)])
    single.close()
    vector.close()


def test_a_variant_that_is_asked_for_stays():
    vary = {"wire.mu_sliding": [0.02, 0.05, 0.1]}
    env = seldinger.gym.NavigateEnv(vary=vary, **SMALL)
    for _ in range(2):
        for options in ({"variant": 2}, None, {"start": 1}):
            assert env.reset(seed=3, options=options)[1]["variant"] == env.variant == 2
            assert env.variants[env.variant] == ["wire.mu_sliding=0.1"] and "mu_sliding = 0.1\n" in env.world.scene
    assert {env.reset(options={"variant": None})[1]["variant"] for _ in range(12)} > {2}
    for wrong in (3, -1, "2", 0.5):
        with pytest.raises(ValueError, match="variant: got .*expected None, or 0 to 2"):
            env.reset(options={"variant": wrong})
    env.close()
    vector = seldinger.gym.NavigateVectorEnv(3, vary=vary, **SMALL)
    assert vector.reset(seed=1)[1]["variant"].tolist() == [0, 1, 2]
    assert vector.reset(options={"variant": [2, None, 0]})[1]["variant"].tolist() == [2, 1, 0]
    assert vector.reset()[1]["variant"].tolist() == [2, 1, 0]
    with pytest.raises(ValueError, match="reset_mask.*Fix: make the environment with variant=.draw."):
        vector.reset(options={"variant": 1, "reset_mask": np.array([True, False, False])})
    assert vector.reset()[1]["variant"].tolist() == [2, 1, 0]  # what was refused has changed nothing
    vector.close()
    with pytest.raises(ValueError, match="4096"):
        seldinger.gym.NavigateVectorEnv(2000, vary=vary, variant="draw")
    with pytest.raises(ValueError, match="variant"):
        seldinger.gym.NavigateEnv(variant="any")


def test_variants_have_as_many_instruments():
    one = {"name": "a", "preset": "terumo-angled-035", "length_m": 0.3, "feed": {"inlet": "auto", "keys": [{"t_s": 0.0, "advance_m": 0.0}]}}
    scene = {"scene": {"duration_s": 1.0, "dt_s": 0.004}, "vessel": {"shape": "aortic-arch"}, "instrument": [one]}
    other = {"name": "b", "length_m": 0.3, "radius_m": 0.0004, "density": 6e3, "youngs_pa": 6e10, "feed": {"inlet": 2, "keys": [{"t_s": 0.0, "advance_m": 0.0}]}}
    env = seldinger.gym.NavigateVectorEnv(2, scene=scene, starts=1, start_advance=(0.01, 0.01), vary={"instrument.1": [other]})
    with pytest.raises(ValueError, match="vary: got variants with 2 instruments; expected 1"):
        env.reset(seed=0)


def test_the_reward_is_the_sum_of_its_terms():
    """A wire that is pushed on bears on the wall with some hundredths of a newton: the penalty acts, as it did not before v1."""
    terms = ("reward_progress", "reward_time", "reward_force", "reward_success")
    env, old = (gymnasium.make(f"seldinger/Navigate-{version}", starts=1, max_steps=180) for version in ("v1", "v0"))
    info, before = env.reset(seed=0)[1], old.reset(seed=0)[1]
    assert [info[t] for t in terms] == [0.0] * 4
    met, ended = [], False
    while not ended:
        _, reward, ended, truncated, info = env.step(np.array([1.0, 0.0], np.float32))
        _, earlier, _, _, before = old.step(np.array([1.0, 0.0], np.float32))
        assert reward == pytest.approx(sum(info[t] for t in terms), abs=1e-15)
        assert info["reward_force"] == pytest.approx(-0.1 * max(0.0, info["wall_force"] - 0.01), abs=1e-15)
        assert earlier - reward == pytest.approx(before["reward_force"] - info["reward_force"], abs=1e-12)  # nothing else has changed
        met.append((info["reward_force"], before["reward_force"]))
        ended = ended or truncated
    assert min(m[0] for m in met) < -0.001 and min(m[1] for m in met) == 0.0
    env.close()
    old.close()


def test_start_up_is_told_of_and_shared(monkeypatch, capsys):
    """Twelve variants: one world makes the starts of their first episodes, and one all the others when another is drawn; a line says
    how far it is, once a second has gone."""
    from seldinger import _fleet
    made, make_starts = [], _fleet.Fleet.make_starts
    monkeypatch.setattr(_fleet.Fleet, "make_starts", lambda fleet, *rest: made.append(fleet.count) or make_starts(fleet, *rest))
    settings = {**SMALL, "start_seed": 23, "vary": {"wire.mu_sliding": [0.02 + 0.01 * k for k in range(12)]}}
    env = seldinger.gym.NavigateVectorEnv(12, progress_line=False, **settings)
    first, _ = env.reset(options={"start": 0})
    assert made == [12]
    env.reset(options={"start": [0] * 11 + [1]})
    assert made == [12, 12] and capsys.readouterr().err == ""
    env.reset(options={"start": 1})
    again, _ = env.reset(options={"start": 0})
    assert made == [12, 12] and same(first, again)
    # what the line says, without waiting for the clock
    progress = _fleet.Progress(True)
    progress.text, waits = "seldinger: 24 starts", iter([False, False, True])
    monkeypatch.setattr(progress._over, "wait", lambda seconds: next(waits))
    progress._tell()
    assert capsys.readouterr().err.split() == ["seldinger:", "24", "starts"]


def test_a_stiffness_that_a_preset_has_is_refused_with_what_to_vary():
    with pytest.raises(seldinger.Error, match="Fix: with a preset that has stiffnesses, set bend_scale"):
        seldinger.gym.NavigateEnv(vary={"wire.youngs_pa": [1e10, 2e10]}).reset()


def test_steps_that_fail_are_told_alike():
    # explicit steps of 4 ms are far above the stable length
    settings = {"starts": 2, "max_steps": 60, "flat": True, "start_advance": (0.002, 0.003), "least_advance": 0.0,
                "overrides": {"integrator.scheme": "explicit"}}
    vector = seldinger.gym.NavigateVectorEnv(2, **settings)
    single = SyncVectorEnv([lambda: seldinger.gym.NavigateEnv(**settings)] * 2)
    assert same(vector.reset(seed=0)[0], single.reset(seed=0)[0])
    failed = 0
    for _ in range(40):
        a, b = vector.step(np.full((2, 2), 0.5)), single.step(np.full((2, 2), 0.5))
        assert all(same(x, y) for x, y in zip(a[:4], b[:4]))
        assert np.array_equal(a[4]["failed"] & a[3], a[4]["failed"])  # truncated
        failed += int(a[4]["failed"].sum())
    assert failed > 0
    vector.close()
    single.close()


def test_disabled_autoreset():
    vector = seldinger.gym.NavigateVectorEnv(2, autoreset_mode="Disabled", **SMALL)
    vector.reset(seed=1)
    for k in range(14):
        truncated = vector.step(np.ones((2, 2)))[3]
        assert truncated.all() == (k >= 11)
    vector.reset(options={"reset_mask": np.array([True, False])})
    assert vector.step(np.ones((2, 2)))[3].tolist() == [False, True]
    with pytest.raises(ValueError, match="reset_mask"):
        vector.reset(options={"reset_mask": [1, 0]})
    vector.close()


def test_make_vec():
    vector = gymnasium.make_vec("seldinger/Navigate-v1", num_envs=3, vectorization_mode="vector_entry_point", flat=True, **SMALL)
    seen, _ = vector.reset(seed=1)
    assert seen.shape == vector.observation_space.shape and vector.observation_space.contains(seen)
    vector.close()
    with pytest.raises(seldinger.Error):
        vector.step(np.zeros((3, 2)))


@pytest.mark.parametrize("action, error", [(np.full(2, np.nan), ValueError), (np.zeros(3), ValueError), (["a", "b"], TypeError)])
def test_actions_that_cannot_be(env, action, error):
    env.reset(seed=0)
    with pytest.raises(error):
        env.step(action)


@pytest.mark.parametrize("settings", [{"observation": ["sound"]}, {"target": "left-knee"}, {"rate": 0}, {"max_steps": -1},
                                      {"start_advance": (0.2, 0.1)}, {"target": [0.0, np.nan, 0.0]}])
def test_settings_that_cannot_be(settings):
    with pytest.raises(ValueError):
        seldinger.gym.NavigateEnv(**{**SMALL, **settings})


def test_fluoroscopy_is_seen_alike_alone_and_in_a_vector():
    settings = {**SMALL, "image": "fluoroscopy", "image_shape": (48, 64), "image_c_arm": "LAO 30", "observation": ["tip"]}
    single = SyncVectorEnv([lambda: seldinger.gym.NavigateEnv(**settings)] * 2)
    vector = seldinger.gym.NavigateVectorEnv(2, **settings)
    assert same(single.reset(seed=2)[0], vector.reset(seed=2)[0])
    rng = np.random.default_rng(0)
    for _ in range(14):  # past the end of an episode
        action = rng.uniform(-1, 1, (2, 2)).astype(np.float32)
        a, b = single.step(action)[0], vector.step(action)[0]
        assert same(a, b) and vector.observation_space.contains(b)
    assert b["image"].shape == (2, 48, 64, 3) and b["image"].std() > 5
    assert all(np.array_equal(b["image"][..., 0], b["image"][..., c]) for c in (1, 2))
    single.close()
    vector.close()
    old = gymnasium.make("seldinger/Navigate-v0", **settings)
    assert old.observation_space["image"].shape == (48, 64, 1)


@pytest.mark.parametrize("settings", [{"image": "ultrasound"}, {"image": 3}, {"image": "fluoroscopy", "image_shape": (64,)},
                                      {"image": "fluoroscopy", "flat": True},
                                      {"image": "fluoroscopy", "image_channels": 2}])
def test_images_that_cannot_be(settings):
    with pytest.raises(ValueError, match="image"):
        seldinger.gym.NavigateEnv(**{**SMALL, **settings})


def test_an_image_is_seen():
    env = seldinger.gym.NavigateEnv(image=lambda world, system: np.full((8, 8), 7, np.uint8), image_shape=(8, 8), **SMALL)
    seen, _ = env.reset(seed=0)
    assert seen["image"].shape == (8, 8, 1) and env.observation_space.contains(seen)
    env.close()


class Weight(seldinger.Force):
    """A pull on the tip, asked for all environments at once."""

    def __init__(self, pull):
        super().__init__(at=0.0, together=True)
        self.pull, self.points = pull, 0

    def forces(self, p):
        self.points = max(self.points, len(p.force))
        p.force[:, 2] = self.pull


def test_forces_act_in_environments_and_their_starts():
    nodes, seen = {}, {}
    for pull in (0.0, 1e-3):
        force = Weight(pull)
        vector = seldinger.gym.NavigateVectorEnv(2, forces=[force], **SMALL)
        single = seldinger.gym.NavigateEnv(forces=[(Weight(pull), 0)], **SMALL)
        seen[pull] = vector.reset(seed=5)[0]["shape"]
        assert np.array_equal(seen[pull][0], single.reset(seed=5)[0]["shape"])  # starts are those of the forces, alone or together
        vector.step(np.full((2, 2), 0.5, np.float32))
        assert force.points == 2
        kept = vector.save()
        vector.step(np.full((2, 2), 0.5, np.float32))
        nodes[pull] = vector._fleet.world.output.nodes.copy()
        vector.restore(kept)
        vector.step(np.full((2, 2), 0.5, np.float32))
        assert np.array_equal(vector._fleet.world.output.nodes, nodes[pull])
        other = seldinger.gym.NavigateVectorEnv(2, forces=[Weight(2e-3)], **SMALL)
        with pytest.raises(ValueError, match="forces"):
            other.restore(kept)
        for made in (vector, single, other):
            made.close()
    assert not np.array_equal(seen[0.0], seen[1e-3]) and not np.array_equal(nodes[0.0], nodes[1e-3])


@pytest.mark.parametrize("forces, says", [([lambda p: None], "expected seldinger.Force"), ([(Weight(0.0), 3)], "instrument 3")])
def test_forces_that_are_none_are_refused(forces, says):
    with pytest.raises(ValueError, match=says):
        seldinger.gym.NavigateEnv(forces=forces, **SMALL).reset()
