"""The usual moves of people who train policies with Gymnasium and stable-baselines3, one test each."""

import copy
import os
import pickle
import subprocess
import sys

import numpy as np
import pytest

gymnasium = pytest.importorskip("gymnasium", reason="gymnasium is not installed: pip install gymnasium")

import gymnasium.utils.env_checker  # noqa: E402
import seldinger.gym  # noqa: E402
from gymnasium.vector import SyncVectorEnv  # noqa: E402

ID = "seldinger/Navigate-v1"
# three controls to the first start, and episodes of twelve
SMALL = {"starts": 2, "max_steps": 12, "start_advance": (0.06, 0.08), "least_advance": 0.02}
FLAT = {**SMALL, "flat": True}
PIXELS = {**SMALL, "image": "fluoroscopy", "observation": (), "image_shape": (36, 48), "image_field": 0.3}
PUSH = np.array([0.6, 0.2], np.float32)
MOVES = {}
pytestmark = pytest.mark.filterwarnings("ignore")  # gymnasium advises against much that it allows


def move(name):
    def keep(function):
        MOVES[name] = function
        return function
    return keep


@pytest.mark.parametrize("name", ["make without an import", "check_env", "close twice, render modes", "make_vec sync", "make_vec async",
                                  "AsyncVectorEnv by default", "AsyncVectorEnv spawned", "make_vec, max_episode_steps", "deepcopy", "pickle",
                                  "copies of the vector form", "save and restore", "World.restore inside", "seeds, options of reset", "FlattenObservation, RescaleAction",
                                  "TimeLimit", "RecordEpisodeStatistics", "FrameStackObservation", "RecordVideo", "RecordVideo of the vector form",
                                  "pixels alone, views, stacks", "PPO over the vector form", "SAC over make_vec_env"])
def test_a_usual_move(name, tmp_path):
    MOVES[name](tmp_path)


def test_every_move_is_made():
    assert len(MOVES) == 23


def same(a, b):
    if isinstance(a, dict):
        return a.keys() == b.keys() and all(same(a[k], b[k]) for k in a)
    if isinstance(a, (tuple, list)):
        return len(a) == len(b) and all(map(same, a, b))
    return np.array_equal(a, b)


def begun(count=None, **settings):
    """An environment, or the vector form, in the middle of an episode."""
    env = seldinger.gym.NavigateVectorEnv(count, **settings) if count else seldinger.gym.NavigateEnv(**settings)
    env.reset(seed=3)
    for _ in range(4):
        env.step(np.tile(PUSH, (count, 1)) if count else PUSH)
    return env


def future(env, resets=2):
    """What follows, past the ends of some episodes; the starts of the next ones are drawn by the environment's generator."""
    count = getattr(env, "num_envs", None)
    seen = []
    for _ in range(resets):
        seen += [env.step(np.tile(PUSH, (count, 1)) if count else PUSH) for _ in range(3)]
        seen.append(env.reset())
    return seen


def in_a_process(tmp_path, code):
    """A file of its own, as a training script is: "spawn" imports it again."""
    script = tmp_path / "script.py"
    script.write_text("import gymnasium, numpy as np\n"
                      f"SMALL = {FLAT!r}\nID = {ID!r}\n" + code)
    done = subprocess.run([sys.executable, str(script)], env={**os.environ}, capture_output=True, text=True, timeout=600, cwd=tmp_path)
    assert done.returncode == 0 and done.stdout.strip().endswith("done"), done.stdout + done.stderr


# -- Gymnasium -------------------------------------------------------------------------------------------------------------


@move("make without an import")
def _(tmp_path):
    # gymnasium reads no entry points since 1.0; the module goes before the name
    in_a_process(tmp_path, "env = gymnasium.make('seldinger.gym:' + ID, **SMALL)\nenv.reset(seed=1)\nenv.step(env.action_space.sample())\nprint('done')\n")


@move("check_env")
def _(tmp_path):
    gymnasium.utils.env_checker.check_env(gymnasium.make(ID, render_mode="rgb_array", **SMALL).unwrapped)


@move("close twice, render modes")
def _(tmp_path):
    env = gymnasium.make(ID, render_mode="rgb_array", **FLAT)
    env.reset(seed=1)
    picture = env.render()
    assert picture.shape == (480, 640, 3) and picture.dtype == np.uint8 and picture.std() > 5
    env.close()
    env.close()
    with pytest.raises(seldinger.Error, match="close"):
        env.reset()
    seldinger.gym.NavigateEnv(**FLAT).close()  # without a world
    with pytest.raises(ValueError, match="render_mode"):
        seldinger.gym.NavigateEnv(render_mode="human")


@move("make_vec sync")
def _(tmp_path):
    env = gymnasium.make_vec(ID, num_envs=2, vectorization_mode="sync", **FLAT)
    seen, _ = env.reset(seed=1)
    assert env.observation_space.contains(seen)
    assert env.step(env.action_space.sample())[1].shape == (2,)
    env.close()


ASYNC = """
def controls(env):
    seen = [env.reset(seed=5)[0]]
    for k in range(14):  # past the end of an episode
        seen += env.step(np.tile(np.array([0.5, 0.1 * k], np.float32), (2, 1)))[:2]
    env.close()
    return seen

if __name__ == "__main__":
    import seldinger.gym
    {before}
    many = controls({env})
    one = controls(gymnasium.make_vec(ID, num_envs=2, **SMALL))
    assert all(np.array_equal(a, b) for a, b in zip(many, one)), "other bits than the vector form"
    print("done")
"""


@move("make_vec async")
def _(tmp_path):
    in_a_process(tmp_path, ASYNC.format(before="pass", env="gymnasium.make_vec(ID, num_envs=2, vectorization_mode='async', **SMALL)"))


@move("AsyncVectorEnv by default")
def _(tmp_path):
    looked_at = "env = gymnasium.make(ID, **SMALL); print(env.observation_space.sample().shape, env.action_space)"
    in_a_process(tmp_path, ASYNC.format(before=looked_at, env="gymnasium.vector.AsyncVectorEnv([lambda: gymnasium.make(ID, **SMALL)] * 2)"))


@move("AsyncVectorEnv spawned")
def _(tmp_path):
    stepped = "env = gymnasium.make(ID, **SMALL); env.reset(); env.step(env.action_space.sample())"
    in_a_process(tmp_path, ASYNC.format(before=stepped, env="gymnasium.make_vec(ID, num_envs=2, vectorization_mode='async', "
                                                            "vector_kwargs={'context': 'spawn'}, **SMALL)"))


def test_a_fork_that_comes_too_late_says_what_to_do(tmp_path):
    in_a_process(tmp_path, """
import seldinger.gym
gymnasium.make(ID, **SMALL).reset()
many = gymnasium.make_vec(ID, num_envs=2, vectorization_mode='async', **SMALL)
try:
    many.reset(seed=1)
except seldinger.Error as error:
    print('done' if 'context="spawn"' in str(error) else error)
many.close(terminate=True)
""")


@move("make_vec, max_episode_steps")
def _(tmp_path):
    env = gymnasium.make_vec(ID, num_envs=2, max_episode_steps=3, **FLAT)
    assert isinstance(env, seldinger.gym.NavigateVectorEnv)
    env.reset(seed=1)
    assert [bool(env.step(env.action_space.sample())[3].all()) for _ in range(3)] == [False, False, True]
    env.close()


# -- copies, and the whole episode -----------------------------------------------------------------------------------------


@move("deepcopy")
def _(tmp_path):
    env = begun(**SMALL)
    other = copy.deepcopy(env)
    first = future(env)
    assert same(first, future(other)), "the copy has its own world, clock and generator"
    env.close()
    assert other.step(PUSH)[4]["time"] > 0


@move("pickle")
def _(tmp_path):
    env = gymnasium.make(ID, **PIXELS)  # with gymnasium's wrappers, and a picture of an earlier control in the stack
    env.reset(seed=3)
    env.step(PUSH)
    assert same(future(pickle.loads(pickle.dumps(env))), future(env))
    untouched = pickle.loads(pickle.dumps(seldinger.gym.NavigateEnv(**FLAT)))
    assert same(untouched.reset(seed=1)[0], seldinger.gym.NavigateEnv(**FLAT).reset(seed=1)[0])


@move("copies of the vector form")
def _(tmp_path):
    vessels = {"vessel.triangles": [30000, 12000]}
    for settings in (FLAT, {**FLAT, "vary": vessels}):
        env = begun(2, **settings)
        copies = [copy.deepcopy(env), pickle.loads(pickle.dumps(env))]
        ahead = future(env)
        for other in copies:
            assert same(ahead, future(other))
            other.close()
        env.close()


@move("save and restore")
def _(tmp_path):
    for count in (None, 3):
        env = begun(count, **{**PIXELS, "image_stack": 2})
        episode = env.save()
        first = future(env)
        env.restore(pickle.loads(pickle.dumps(episode)))
        assert same(first, future(env)), "hubs, clock, progress, stack or generator were not restored"
        with pytest.raises(TypeError, match="env.save"):
            env.restore(env.world.save())
        env.close()
    other = begun(**{**PIXELS, "image_stack": 2, "target": "left-carotid"})
    before = other.world.state_hash()
    with pytest.raises(ValueError, match="environments"):
        other.restore(episode)
    with pytest.raises(ValueError, match="target = 'left-subclavian'"):
        other.restore(begun(**{**PIXELS, "image_stack": 2}).save())
    assert other.world.state_hash() == before


@move("World.restore inside")
def _(tmp_path):
    env = begun(**FLAT)
    state, before = env.world.save(), env.world.state_hash()
    for call in (lambda: env.world.restore(state), lambda: env.world.step([0.1, 0.0]), lambda: env.world.settle(), lambda: env.world.run()):
        with pytest.raises(seldinger.Error, match="of an environment"):
            call()
    assert env.world.state_hash() == before
    env.close()


@move("seeds, options of reset")
def _(tmp_path):
    def actions_and_seen(seed):
        env = gymnasium.make(ID, **FLAT)
        env.action_space.seed(seed)
        seen = [env.reset(seed=seed)[0]] + [env.step(env.action_space.sample())[0] for _ in range(5)] + [env.reset()[0]]
        env.close()
        return seen

    assert same(actions_and_seen(7), actions_and_seen(7)) and not same(actions_and_seen(7), actions_and_seen(8))
    single, many = gymnasium.make(ID, **FLAT), gymnasium.make_vec(ID, num_envs=2, **FLAT)
    starts = [single.reset(seed=0, options={"start": k})[0] for k in (0, 1)]
    assert not same(*starts) and same(list(many.reset(seed=0, options={"start": [0, 1]})[0]), starts)
    assert same(list(many.reset(seed=0, options={"start": 1})[0]), [starts[1]] * 2)


# -- wrappers --------------------------------------------------------------------------------------------------------------


@move("FlattenObservation, RescaleAction")
def _(tmp_path):
    from gymnasium.wrappers import FlattenObservation, RescaleAction
    env = RescaleAction(FlattenObservation(gymnasium.make(ID, **SMALL)), 0.0, 1.0)
    plain = gymnasium.make(ID, **SMALL)
    env.reset(seed=1), plain.reset(seed=1)
    # float32 of (0.8 - 0.5) * 2 differs from 0.6 in the last bits: 1e-7 of an observation near one, times what contact makes of it
    seen, expected = env.step(np.array([0.8, 0.6], np.float32))[0], plain.step(PUSH)[0]
    assert env.observation_space.contains(seen)
    assert np.allclose(np.sort(seen), np.sort(np.concatenate(list(expected.values()))), atol=1e-4)


@move("TimeLimit")
def _(tmp_path):
    env = gymnasium.make(ID, max_episode_steps=3, **FLAT)
    env.reset(seed=1)
    assert [env.step(PUSH)[3] for _ in range(3)] == [False, False, True]


@move("RecordEpisodeStatistics")
def _(tmp_path):
    single = gymnasium.wrappers.RecordEpisodeStatistics(gymnasium.make(ID, **FLAT))
    many = gymnasium.wrappers.vector.RecordEpisodeStatistics(gymnasium.make_vec(ID, num_envs=2, **FLAT))
    single.reset(seed=1), many.reset(seed=1)
    total = 0.0
    for _ in range(12):
        _, reward, terminated, truncated, info = single.step(PUSH)
        both = many.step(np.tile(PUSH, (2, 1)))[4]
        total += reward
    assert (terminated or truncated) and info["episode"]["l"] == 12 and info["episode"]["r"] == pytest.approx(total)
    assert both["episode"]["l"].tolist() == [12, 12] and both["episode"]["r"][0] == pytest.approx(total)
    assert both["is_success"].tolist() == [info["is_success"]] * 2 and both["_is_success"].all()


@move("FrameStackObservation")
def _(tmp_path):
    env = gymnasium.wrappers.FrameStackObservation(gymnasium.make(ID, **FLAT), 3)
    env.reset(seed=1)
    first = env.step(PUSH)[0]
    second = env.step(PUSH)[0]
    assert first.shape == second.shape == (3, 45) and np.array_equal(first[-1], second[-2]) and not np.array_equal(second[-1], second[-2])


def film(folder):
    """(width, height) of the only film in a folder, of six frames; moviepy leaves out the last one where the duration is rounded down."""
    import imageio_ffmpeg  # moviepy's
    from moviepy import VideoFileClip
    path, = folder.glob("*.mp4")
    with VideoFileClip(str(path)) as clip:
        assert np.ptp(clip.get_frame(0)) > 100
        assert imageio_ffmpeg.count_frames_and_secs(str(path))[0] in (5, 6)
        return tuple(clip.size)


@move("RecordVideo")
def _(tmp_path):
    pytest.importorskip("moviepy", minversion="2", reason="moviepy is not installed: pip install moviepy")
    env = gymnasium.wrappers.RecordVideo(gymnasium.make(ID, render_mode="rgb_array", **FLAT), str(tmp_path / "films"))
    env.reset(seed=1)
    for _ in range(5):
        env.step(PUSH)
    env.close()
    assert film(tmp_path / "films") == (640, 480)


@move("RecordVideo of the vector form")
def _(tmp_path):
    pytest.importorskip("moviepy", minversion="2", reason="moviepy is not installed: pip install moviepy")
    many = gymnasium.make_vec(ID, num_envs=2, render_mode="rgb_array", **FLAT)
    env = gymnasium.wrappers.vector.RecordVideo(many, str(tmp_path / "films"), video_aspect_ratio=(2, 1))
    env.reset(seed=1)
    for _ in range(5):
        env.step(np.array([[1.0, 0.0], [-1.0, 0.0]]))
    left, right = many.render()
    assert not np.array_equal(left, right), "each picture shows its own environment"
    env.close()
    assert film(tmp_path / "films") in ((1280, 480), (640, 960))


@move("pixels alone, views, stacks")
def _(tmp_path):
    settings = {**PIXELS, "image_channels": 1, "image_c_arm": ("LAO 30", "RAO 30"), "image_stack": 3}
    single, many = seldinger.gym.NavigateEnv(**settings), seldinger.gym.NavigateVectorEnv(2, **settings)
    assert single.observation_space == gymnasium.spaces.Box(0, 255, (36, 48, 6), np.uint8)
    seen, both = single.reset(seed=2)[0], many.reset(seed=2)[0]
    assert np.array_equal(seen[..., :2], seen[..., 4:]) and not np.array_equal(seen[..., 0], seen[..., 1])
    for _ in range(14):  # past the end of an episode
        before = seen
        seen, _, terminated, truncated, _ = single.step(PUSH)
        both = many.step(np.tile(PUSH, (2, 1)))[0]
        assert np.array_equal(seen[..., :4], before[..., 2:]) and np.array_equal(both[0], seen)
        if terminated or truncated:
            seen, _ = single.reset()
            assert np.array_equal(many.step(np.tile(PUSH, (2, 1)))[0][0], seen)
    assert both.shape == (2, 36, 48, 6) and both.std() > 5
    gymnasium.utils.env_checker.check_env(single, skip_render_check=True)


# -- stable-baselines3 -----------------------------------------------------------------------------------------------------


def baselines():
    pytest.importorskip("torch", reason="torch is not installed: pip install torch")
    return pytest.importorskip("stable_baselines3", reason="stable-baselines3 is not installed: pip install stable-baselines3")


@move("PPO over the vector form")
def _(tmp_path):
    sb3 = baselines()
    from stable_baselines3.common.evaluation import evaluate_policy
    from stable_baselines3.common.vec_env import VecMonitor, VecNormalize
    from seldinger.sb3 import NavigateVecEnv
    env = VecNormalize(VecMonitor(NavigateVecEnv(2, **FLAT)))
    model = sb3.PPO("MlpPolicy", env, n_steps=16, batch_size=16, n_epochs=1, seed=0, device="cpu")
    before = [p.detach().clone() for p in model.policy.parameters()]
    model.learn(32)
    assert model.num_timesteps == 32 and any((p != q).any() for p, q in zip(model.policy.parameters(), before))
    assert len(model.ep_info_buffer) == 2 and model.ep_info_buffer[0]["l"] == 12 and list(model.ep_success_buffer) == [False, False]
    assert np.isfinite(evaluate_policy(model, env, n_eval_episodes=2)[0])
    env.close()
    cnn = NavigateVecEnv(2, **PIXELS)
    sb3.PPO("CnnPolicy", cnn, n_steps=2, batch_size=4, n_epochs=1, device="cpu").learn(4)  # 36 x 48: the least that its network takes
    cnn.close()


@move("SAC over make_vec_env")
def _(tmp_path):
    sb3 = baselines()
    from stable_baselines3.common.env_checker import check_env
    from stable_baselines3.common.env_util import make_vec_env
    check_env(seldinger.gym.NavigateEnv(**FLAT))
    env = make_vec_env(ID, n_envs=2, env_kwargs=SMALL)
    model = sb3.SAC("MultiInputPolicy", env, learning_starts=4, batch_size=4, buffer_size=100, device="cpu", seed=0)
    model.learn(12)
    assert model.num_timesteps == 12
    env.close()


def test_the_adapter_is_the_vector_form():
    """The same rewards; at an episode's end its last observation, its success, and whether only its time was up."""
    baselines()
    from seldinger.sb3 import NavigateVecEnv
    ours, plain = NavigateVecEnv(3, **FLAT), SyncVectorEnv([lambda: seldinger.gym.NavigateEnv(**FLAT)] * 3, autoreset_mode="SameStep")
    ours.seed(4)
    assert same(ours.reset(), plain.reset(seed=4)[0])
    for _ in range(13):
        actions = np.tile(PUSH, (3, 1))
        seen, rewards, done, infos = ours.step(actions)
        expected = plain.step(actions)
        assert same(seen, expected[0]) and np.array_equal(rewards, expected[1].astype(np.float32))
        assert np.array_equal(done, expected[2] | expected[3])
        for s in np.flatnonzero(done):
            assert same(infos[s]["terminal_observation"], expected[4]["final_obs"][s])
            assert infos[s]["TimeLimit.truncated"] == bool(expected[3][s]) and infos[s]["is_success"] == bool(expected[4]["final_info"]["success"][s])
        if done.any():
            assert not any("terminal_observation" in infos[s] for s in np.flatnonzero(~done))
    with pytest.raises(NotImplementedError, match="Fix"):
        ours.set_attr("target", "left-carotid")
    ours.set_options({"start": 1})
    assert same(ours.reset(), plain.reset(options={"start": 1})[0])
    ours.set_options({"stop": 1})
    with pytest.raises(ValueError, match="options: got"):
        ours.reset()
    ours.close()
    plain.close()


def test_starts_are_made_once(monkeypatch):
    """Later environments of the same task take the starts of the first."""
    from seldinger import _fleet
    made, make_starts = [], _fleet.Fleet.make_starts
    monkeypatch.setattr(_fleet.Fleet, "make_starts", lambda fleet, *rest: made.append(fleet.count) or make_starts(fleet, *rest))
    settings = {**FLAT, "start_seed": 17}
    for start in range(2):
        seldinger.gym.NavigateEnv(**settings).reset(options={"start": start})
    assert made == [1, 1]
    seldinger.gym.NavigateVectorEnv(2, **settings).reset(options={"start": [0, 1]})
    seldinger.gym.NavigateEnv(**{**settings, "force": 0.2, "max_steps": 5}).reset(seed=0)  # rewards are not of the start
    assert made == [1, 1]
    seldinger.gym.NavigateEnv(**{**settings, "start_seed": 18}).reset(seed=0)
    assert made == [1, 1, 1]
