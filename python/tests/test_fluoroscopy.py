"""X-ray pictures of a world: the command's grey levels, a wire that is dark, what is refused."""

import subprocess
import struct
import zlib

import numpy as np
import pytest

import seldinger


def grey_png(path):
    """16-bit grey levels of a PNG whose rows have any of the five filters."""
    data, at, packed = path.read_bytes(), 8, b""
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + length]
        if kind == b"IHDR":
            width, height, bits, colour = struct.unpack(">IIBB", body[:10])
            assert (bits, colour) == (16, 0)
        packed += body if kind == b"IDAT" else b""
        at += length + 12
    raw, above, rows = zlib.decompress(packed), bytearray(2 * width), []
    for r in range(height):
        line = bytearray(raw[r * (2 * width + 1):(r + 1) * (2 * width + 1)])
        rule, line = line[0], line[1:]
        for i in range(2 * width):
            a, b, c = (line[i - 2], above[i], above[i - 2]) if i > 1 else (0, above[i], 0)
            nearest = min((abs(b - c), 0, a), (abs(a - c), 1, b), (abs(a + b - 2 * c), 2, c))[2]
            line[i] = (line[i] + (0, a, b, (a + b) // 2, nearest)[rule]) & 255
        rows.append(np.frombuffer(bytes(line), ">u2"))
        above = line
    return np.array(rows) >> 4


def test_the_commands_picture(command, tmp_path):
    run = tmp_path / "run"
    scene = seldinger.assets() / "scenes" / "aortic-arch.toml"
    subprocess.run([command, "run", str(scene), "-o", str(run), "--quiet", "--set", "scene.duration_s=0.2"], check=True)
    subprocess.run([command, "render", str(run), "--view", "fluoro", "--c-arm", "LAO 30", "--size", "96x96", "--no-noise"], check=True)
    theirs = grey_png(run / "fluoro.png").astype(int)
    world = seldinger.World(scene, scene__duration_s=0.2)
    world.run()
    ours = world.fluoroscopy(96, 96, c_arm="LAO 30", noise=False).astype(int)
    # the run's files are in single precision, 1e-7 of places: a level where the silhouette of a face is rounded otherwise
    assert ours.shape == theirs.shape and np.mean(np.abs(ours - theirs)) < 0.05
    assert np.percentile(np.abs(ours - theirs), 99) <= 1


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


@pytest.mark.parametrize("how", [{"width": 0}, {"height": -5}, {"width": 10**6}, {"c_arm": "LOA 3"}, {"c_arm": 30}, {"field": 0.0},
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
    with pytest.raises(ValueError, match="2 given for 3 systems"):
        world.fluoroscopy(48, 32, system=range(3), frame=[1, 2])
    with pytest.raises(seldinger.Error, match="no such system"):
        world.fluoroscopy(48, 32, system=[0, 3])
