"""Small programs beside the engine: lines of JSON, OpenIGTLink, the search for motions."""

import contextlib
import io
import json
import socket
import struct
import subprocess
import sys

import numpy as np
import pytest

import seldinger
from seldinger import ask, igtlink, lines

SWING = {"scene__duration_s": 0.02}
SET = ["--set", "scene.duration_s=0.02"]


def said(program, *words, given=""):
    out, err = io.StringIO(), io.StringIO()
    stdin, sys.stdin = sys.stdin, io.StringIO(given)
    try:
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
            code = program.main(list(words))
    finally:
        sys.stdin = stdin
    return code, out.getvalue(), err.getvalue()


# ---- lines

def test_each_line_is_a_step():
    code, out, err = said(lines, "swing", *SET, "--every", "2")
    rows = [json.loads(line) for line in out.splitlines()]
    world = seldinger.World("swing", **SWING)
    assert code == 0 and not err and len(rows) == world._steps // 2
    world.step(n=2 * len(rows))
    last = rows[-1]["instruments"][0]
    assert last["nodes_m"] == world.output.nodes.tolist() and last["tip_m"] == world.output.tip.tolist()
    assert rows[-1]["step"] == world.output.step and rows[-1]["time_s"] == world.output.time


def test_lines_of_input_are_steps():
    given = "".join(json.dumps({"advance_m": 0.05 + 1e-4 * k, "turn_rad": 0.01 * k}) + "\n" for k in range(1, 4))
    code, out, _ = said(lines, "aortic-arch", "--control", given=given)
    rows = [json.loads(line)["instruments"][0] for line in out.splitlines()]
    assert code == 0 and len(rows) == 3
    assert rows[2]["inserted_m"] - rows[0]["inserted_m"] == pytest.approx(2e-4) and rows[2]["turned_rad"] == pytest.approx(0.03)


@pytest.mark.parametrize("words, given, says", [
    (["no-such-scene"], "", "no-such-scene"), (["swing", "--every", "0"], "", "--every: got 0"),
    (["aortic-arch", "--control"], "push\n", "line 1: got 'push'"), (["aortic-arch", "--control"], "[1, 2]\n", "line 1: got"),
    (["aortic-arch", "--control"], "{\"advance_m\": \"far\"}\n", "expected numbers"), (["swing", "--set", "wire.nodes=many"], "", "wire.nodes")])
def test_lines_refuse_in_one_line(words, given, says):
    code, out, err = said(lines, *words, given=given)
    assert code in (2, 3) and not out and says in err and err.count("\n") == 1


# ---- OpenIGTLink

@pytest.fixture
def server():
    program = subprocess.Popen([sys.executable, "-m", "seldinger.igtlink", "swing", "--port", "0", "--every", "5", "--film", "24"],
                               stdout=subprocess.PIPE, text=True)
    yield int(program.stdout.readline().split()[1])
    program.kill()
    program.wait()
    program.stdout.close()


def world_after(steps):
    world = seldinger.World("swing")
    world.step(None, n=steps)
    return world.output


def test_a_client_gets_tip_and_wire_as_the_protocol_says(server):
    with socket.create_connection(("127.0.0.1", server)) as client, client.makefile("rb") as stream:
        seen = {}
        while len(seen) < 3:
            _, kind, device, _, size, crc = struct.unpack(">H12s20sQQQ", stream.read(58))
            content = stream.read(size)
            assert igtlink.crc64(content) == crc
            seen[kind.rstrip(b"\0").decode(), device.rstrip(b"\0").decode()] = content
    output = world_after(5)
    matrix = np.frombuffer(seen["TRANSFORM", "Tip"], ">f4").reshape(4, 3)
    assert np.allclose(matrix[3], 1e3 * output.tip, atol=1e-4) and np.allclose(matrix[:3] @ matrix[:3].T, np.eye(3), atol=1e-6)
    ahead = output.nodes[0] - output.nodes[1]
    assert np.allclose(matrix[2], ahead / np.linalg.norm(ahead), atol=1e-6) and np.linalg.det(matrix[:3]) > 0
    wire, count = seen["POLYDATA", "Wire"], len(output.nodes)
    assert np.frombuffer(wire[:40], ">u4").tolist() == [count, 0, 0, 1, 4 * (count + 1), 0, 0, 0, 0, 0]
    assert np.allclose(np.frombuffer(wire[40:40 + 12 * count], ">f4").reshape(-1, 3), 1e3 * output.nodes, atol=1e-4)
    assert np.frombuffer(wire[40 + 12 * count:], ">u4").tolist() == [count, *range(count)]


def test_pyigtl_reads_tip_and_film(server):
    pyigtl = pytest.importorskip("pyigtl", reason="pyigtl is not installed: pip install pyigtl")
    client = pyigtl.OpenIGTLinkClient("127.0.0.1", server)
    tip, film = (client.wait_for_message(name, timeout=60) for name in ("Tip", "Film"))
    client.stop()
    assert tip.matrix.shape == (4, 4) and np.allclose(tip.matrix[:3, :3].T @ tip.matrix[:3, :3], np.eye(3), atol=1e-6)
    assert film.image.shape == (1, 24, 24) and film.image.dtype == np.uint16 and 0 < film.image.max() < 4096
    assert np.allclose(film.ijk_to_world_matrix, np.eye(4))  # the first pixel at the origin


# ---- ask

def test_choices_are_all_combinations():
    assert ask.choices(['a.b=["x", "y"]', "c=[1, 2.5]"]) == [['a.b="x"', "c=1"], ['a.b="x"', "c=2.5"], ['a.b="y"', "c=1"], ['a.b="y"', "c=2.5"]]
    assert ask.choices([]) == [[]]


@pytest.mark.parametrize("words, says", [(["--choose", "a=b"], "--choose: got"), (["--hands", "1"], "--hands: got 1")])
def test_ask_refuses_in_one_line(tmp_path, words, says):
    code, out, err = said(ask, "swing", *words, "-o", str(tmp_path))
    assert code == 2 and says in err and err.count("\n") == 1


def test_a_search_finds_its_way_and_writes_it_as_a_scene(tmp_path):
    pytest.importorskip("cma", reason="cma is not installed: pip install cma")
    scene = {"scene": {"name": "pipe", "gravity": [0.0, 0.0, 0.0], "duration_s": 2.0, "dt_s": 0.01},
             "wire": {"length_m": 0.2, "radius_m": 4e-4, "density": 6500.0, "bend_nm2": 2e-5, "twist_nm2": 2e-5, "stretch_n": 1e4},
             "vessel": {"shape": "arc", "radius_m": 3e-3, "bend_radius_m": 0.05, "angle_deg": 60.0, "triangles": 4000},
             "feed": {"inlet": "auto", "keys": [{"t_s": 0.0, "advance_m": 0.005}]},
             "task": {"target": {"branch": 1, "beyond_m": 0.03}}}
    file = tmp_path / "pipe.toml"
    file.write_text(seldinger._toml.document(scene))
    words = ["--choose", "wire.bend_nm2=[1e-5, 4e-4]", "--least", "wall_force", "--hands", "4", "--rounds", "2", "--knots", "2", "--speed", "0.02"]
    answers = []
    for folder in ("a", "b"):
        code, out, err = said(ask, str(file), *words, "-o", str(tmp_path / folder))
        assert code == 0, err
        answers.append(json.loads((tmp_path / folder / "ranking.json").read_text()))
    assert answers[0] == answers[1]  # by the seed
    soft, stiff = answers[0]
    assert soft["choice"] == ["wire.bend_nm2=1e-05"] and soft["until_wall_force_max_n"] < stiff["until_wall_force_max_n"]
    assert soft["band_n"] > 0
    with seldinger.World(tmp_path / "a" / soft["scene"]) as world:
        world.run()
        assert world.task()["reached"] and world.task()["until_wall_force_max_n"] == pytest.approx(soft["until_wall_force_max_n"])
