"""Navigate-v0: what gymnasium checks, seeds, and that a vector is its environments, bit for bit."""

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
    check_env(gymnasium.make("seldinger/Navigate-v0", **SMALL).unwrapped, skip_render_check=True)


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
                                  {"wire.mu_sliding": [0.02, 0.05], "vessel.triangles": [30000, 12000]}])
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
    vector = gymnasium.make_vec("seldinger/Navigate-v0", num_envs=3, vectorization_mode="vector_entry_point", flat=True, **SMALL)
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
    assert b["image"].shape == (2, 48, 64, 1) and b["image"].std() > 5
    single.close()
    vector.close()


@pytest.mark.parametrize("settings", [{"image": "ultrasound"}, {"image": 3}, {"image": "fluoroscopy", "image_shape": (64,)},
                                      {"image": "fluoroscopy", "flat": True}])
def test_images_that_cannot_be(settings):
    with pytest.raises(ValueError, match="image"):
        seldinger.gym.NavigateEnv(**{**SMALL, **settings})


def test_an_image_is_seen():
    env = seldinger.gym.NavigateEnv(image=lambda world, system: np.full((8, 8), 7, np.uint8), image_shape=(8, 8), **SMALL)
    seen, _ = env.reset(seed=0)
    assert seen["image"].shape == (8, 8, 1) and env.observation_space.contains(seen)
    env.close()
