"""X-ray pictures of a world: the command's grey levels, a wire that is dark, what is refused."""

import json
import subprocess
import struct
import zlib

import numpy as np
import pytest

import seldinger


def png(path):
    """Grey levels of 8 or 16 bits of a PNG whose rows have any of the five filters."""
    data, at, packed = path.read_bytes(), 8, b""
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + length]
        if kind == b"IHDR":
            width, height, bits, colour = struct.unpack(">IIBB", body[:10])
            assert bits in (8, 16) and colour == 0
        packed += body if kind == b"IDAT" else b""
        at += length + 12
    size = bits // 8
    raw, above, rows = zlib.decompress(packed), bytearray(size * width), []
    for r in range(height):
        line = bytearray(raw[r * (size * width + 1):(r + 1) * (size * width + 1)])
        rule, line = line[0], line[1:]
        for i in range(size * width):
            a, b, c = (line[i - size], above[i], above[i - size]) if i >= size else (0, above[i], 0)
            nearest = min((abs(b - c), 0, a), (abs(a - c), 1, b), (abs(a + b - 2 * c), 2, c))[2]
            line[i] = (line[i] + (0, a, b, (a + b) // 2, nearest)[rule]) & 255
        rows.append(np.frombuffer(bytes(line), f">u{size}"))
        above = line
    return np.array(rows).astype(int)


def test_the_commands_picture(command, tmp_path):
    run = tmp_path / "run"
    scene = seldinger.assets() / "scenes" / "aortic-arch.toml"
    subprocess.run([command, "run", str(scene), "-o", str(run), "--quiet", "--set", "scene.duration_s=0.2"], check=True)
    subprocess.run([command, "render", str(run), "--view", "fluoro", "--c-arm", "LAO 30", "--size", "96x96", "--no-noise"], check=True)
    theirs = png(run / "fluoro.png") >> 4
    world = seldinger.World(scene, scene__duration_s=0.2)
    world.run()
    ours = world.fluoroscopy(96, 96, c_arm="LAO 30", noise=False).astype(int)
    # the run's files are in single precision, 1e-7 of places: a level where the silhouette of a face is rounded otherwise
    assert ours.shape == theirs.shape and np.mean(np.abs(ours - theirs)) < 0.05
    assert np.percentile(np.abs(ours - theirs), 99) <= 1


def test_labels_are_those_of_the_command(command, tmp_path):
    run, labels = tmp_path / "run", tmp_path / "labels"
    scene = seldinger.assets() / "scenes" / "aortic-arch.toml"
    subprocess.run([command, "run", str(scene), "-o", str(run), "--quiet", "--set", "scene.duration_s=2", "--set", "output.contacts_every=500",
                    "--set", "output.wire_every=500", "--set", "scene.record_every=500"], check=True)
    subprocess.run([command, "render", str(run), "--view", "fluoro", "--c-arm", "LAO 30", "--size", "512x512", "--field", "0.5", "--labels", str(labels),
                    "--label-vessel", "--quiet"], check=True)
    theirs = json.loads((labels / "fluoro.json").read_text())
    world = seldinger.World(scene, scene__duration_s=2)
    world.run()
    picture, ours = world.fluoroscopy(512, 512, c_arm="LAO 30", field=0.5, labels=True, lumen=True)
    assert picture.shape == (512, 512) and ours["step"] == theirs["step"] and ours["time_s"] == pytest.approx(theirs["time_s"])
    assert ours["image"] == {key: value for key, value in theirs["image"].items() if key != "file"}
    for key, value in theirs["camera"].items():
        assert ours["camera"][key] == pytest.approx(np.array(value), rel=1e-9, abs=1e-12), key
    (wire,), (file,) = ours["instruments"], theirs["instruments"]
    assert wire["name"] == file["name"] and wire["in_field"].tolist() == file["in_field"]
    # the run's files are in single precision: 1e-7 of places, and 1e-3 pixel where a pixel is 0.7 mm
    for key, near in (("radius_m", 1e-7), ("tip_m", 1e-6), ("centreline_m", 1e-6), ("tip_px", 1e-3), ("centreline_px", 1e-3)):
        assert wire[key] == pytest.approx(np.array(file[key]), abs=near), key
    for key in ("hand_force_n", "hand_torque_nm"):
        assert wire[key] == pytest.approx(file[key], rel=1e-5, abs=1e-9), key
    assert 0 < len(file["contacts"]) == len(wire["contacts"]["force_n"])
    for key in ("position_m", "position_px", "force_n"):
        assert wire["contacts"][key] == pytest.approx(np.array([c[key] for c in file["contacts"]]).reshape(-1, 2 if key == "position_px" else 3), abs=1e-3)
    point = ours["camera"]["projection"] @ [*wire["tip_m"], 1.0]
    assert abs(point[:2] / point[2] - wire["tip_px"]).max() < 1e-6
    assert np.sum(ours["mask"]) > 50 and np.sum(ours["mask"] != png(labels / "fluoro_mask.png")) <= 2  # edges within 1e-3 of half a pixel
    thickness = png(labels / "fluoro_lumen.png")
    assert thickness.max() > 10000  # an aorta
    assert np.percentile(abs(np.minimum(1e6 * ours["lumen_m"], 65535) - thickness), 99) < 2
    pictures, dicts = world.fluoroscopy(16, 16, system=[0], labels=True)
    assert pictures.shape == (1, 16, 16) and len(dicts) == 1 and "lumen_m" not in dicts[0]
    with pytest.raises(ValueError, match="labels=True"):
        world.fluoroscopy(16, 16, lumen=True)


def test_a_wire_is_dark_and_noise_is_drawn_by_its_number():
    world = seldinger.World("navigate")
    how = {"c_arm": "LAO 30", "field": 0.25}
    before = world.fluoroscopy(64, 64, noise=False, **how).astype(int)
    for k in range(1, 41):
        assert not world.step([0.004 * k, 0.0], n=4).failed
    after = world.fluoroscopy(64, 64, noise=False, **how).astype(int)
    assert (before - after).max() > 40  # 1e5 photons are 5 of 1700 levels
    first, same, other = (world.fluoroscopy(64, 64, frame=k, **how) for k in (3, 3, 4))
    assert np.array_equal(first, same) and not np.array_equal(first, other)


@pytest.mark.parametrize("how", [{"width": 0}, {"height": -5}, {"width": 10**6}, {"c_arm": "LOA 3"}, {"c_arm": 30}, {"c_arm": []}, {"c_arm": ["LAO 30", 5]}, {"field": 0.0},
                                 {"field": float("nan")}, {"system": 1}, {"system": -1}, {"frame": -1}, {"width": 2**40}])
def test_pictures_that_cannot_be(how):
    world = seldinger.World("aortic-arch")
    with pytest.raises((seldinger.Error, TypeError)):
        world.fluoroscopy(**{"width": 16, "height": 16, **how})


def test_without_a_vessel():
    assert seldinger.World("swing").fluoroscopy(32, 32, noise=False).std() > 0


def test_several_systems_have_the_pictures_that_they_have_alone():
    world = seldinger.World("navigate", copies=[[], [], []])
    for k in range(1, 21):
        assert not world.step([[0.003 * k, 0.0], [0.004 * k, 0.1 * k], [0.005 * k, 0.0]], n=4).failed
    together = world.fluoroscopy(48, 32, system=[2, 0, 1, 2], frame=[7, 8, 9, 10])
    assert together.shape == (4, 32, 48)
    for picture, system, frame in zip(together, (2, 0, 1, 2), (7, 8, 9, 10)):
        assert np.array_equal(picture, world.fluoroscopy(48, 32, system=system, frame=frame))
    assert world.fluoroscopy(48, 32, system=[]).shape == (0, 32, 48)
    with pytest.raises(ValueError, match="got 2 for 3 systems"):
        world.fluoroscopy(48, 32, system=range(3), frame=[1, 2])
    with pytest.raises(seldinger.Error, match="no such system"):
        world.fluoroscopy(48, 32, system=[0, 3])


def test_several_positions_of_the_c_arm_in_one_call():
    world = seldinger.World("navigate", copies=[[], []])
    for k in range(1, 11):
        assert not world.step([[0.004 * k, 0.0], [0.005 * k, 0.1 * k]], n=4).failed
    arms, how = ["LAO 30", "RAO 30", None], {"frame": [3, 9], "field": 0.3}
    both = world.fluoroscopy(40, 30, system=[1, 0], c_arm=arms, **how)
    assert both.shape == (2, 3, 30, 40)
    for v, arm in enumerate(arms):
        alone = world.fluoroscopy(40, 30, system=[1, 0], c_arm=arm, field=0.3, frame=[f + (v << 48) for f in how["frame"]])
        assert np.array_equal(both[:, v], alone)  # noise of its own in each view
    one, labels = world.fluoroscopy(40, 30, c_arm=arms[:2], noise=False, field=0.3, labels=True)
    assert one.shape == (2, 30, 40) and [label["camera"]["primary_deg"] for label in labels] == pytest.approx([30.0, -30.0])
    assert np.array_equal(one[0], world.fluoroscopy(40, 30, c_arm="LAO 30", noise=False, field=0.3))
