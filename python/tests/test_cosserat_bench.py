"""The adapter for cosseratbench: the two cheapest of its experiments, the starts of all, and what it says about others."""

import importlib
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

bench = pytest.importorskip("cosseratbench", reason="cosseratbench is not installed: pip install cosseratbench")
scenarios = pytest.importorskip("cosseratbench.scenario")
experiment = pytest.importorskip("cosseratbench.experiment")
adapter = pytest.importorskip("seldinger.cosserat_bench")
EXPERIMENTS = ["cantilever", "catenary", "pendulum", "capstan", "twist", "pile", "crossing"]


def of(name):
    if name == "crossing":
        pytest.importorskip("scipy", reason="scipy is not installed: apt-get install python3-scipy")
    return getattr(importlib.import_module(f"cosseratbench.experiments.{name}"), name)


def test_the_package_names_the_adapter():
    project = (Path(__file__).resolve().parents[2] / "pyproject.toml").read_text()
    module, name = re.search(r'entry-points."cosseratbench.solvers"]\nseldinger = "(.*):(.*)"', project).groups()
    solver = getattr(importlib.import_module(module), name)()
    assert isinstance(solver, importlib.import_module("cosseratbench.solver").Solver) and solver.name == "seldinger"


def test_cantilever():
    # 20 edges: of the order of 1/20^2; not at rest yet (1 + w T) exp(-w T) = 2e-4 for w T = 11
    result = experiment.run(of("cantilever"), adapter.SeldingerSolver())
    assert result.outcome == "completed"
    assert result.metrics["tip_deflection_error"] < 2.7e-3 and result.metrics["settling_residual"] < 1e-4


def test_catenary():
    # the reference has no bending stiffness: the shape is off by B/T times the curvature, 1e-3 m^2 times 2/m, at most
    result = experiment.run(of("catenary"), adapter.SeldingerSolver())
    assert result.metrics["shape_error"] < 2e-3 and result.metrics["settling_residual"] < 1e-4


@pytest.mark.parametrize("name", EXPERIMENTS)
def test_starts_where_the_scenario_has_it(name):
    wanted = of(name)
    scenario, n = replace(wanted.scenario, duration=2e-3), wanted.n_elements
    result = adapter.SeldingerSolver().run(scenario, n_elements=n, n_frames=2)
    for rod, positions, directors in zip(scenario.rods, result.positions, result.directors):
        assert np.abs(positions[0] - rod.nodes(n)).max() < 1e-9
        assert np.abs(directors[0] - rod.directors(n)).max() < 1e-9
        assert 0 < np.abs(positions[1] - positions[0]).max() < 1e-3  # let go, and at rest before


def test_a_turned_end_twists_the_rod_evenly():
    material = scenarios.Material(1e6, 4e5, 1000.0)
    motion = scenarios.Motion((0.0, 1.0), ((0.0,) * 3,) * 2, ((0.0,) * 3, (1.0, 0.0, 0.0)), slides_along=(1.0, 0.0, 0.0))
    clamped = scenarios.EndCondition.CLAMPED
    rod = scenarios.Rod(((0.0, 0.0, 0.0), (0.2, 0.0, 0.0)), 0.01, material, start=clamped, end=clamped, end_motion=motion)
    scenario = scenarios.Scenario((rod,), duration=4.0, quasi_static=True, self_contact=False)
    result = adapter.SeldingerSolver().run(scenario, n_elements=10, n_frames=5)
    twist = importlib.import_module("cosseratbench.metrics").twist_angles(result.positions[0], result.directors[0])
    assert np.abs(twist[-1] - 0.1).max() < 1e-6  # 1 rad over ten edges, the half edges at the clamps included
    slower = adapter.SeldingerSolver(time_step_scale=0.5).settings(scenario, n_elements=10, n_frames=5)
    assert slower["time_step"] < adapter.SeldingerSolver().settings(scenario, n_elements=10, n_frames=5)["time_step"]


def test_the_mesh_of_a_cylinder_has_its_volume():
    scenario = of("capstan").scenario
    cylinder = scenario.obstacles[0]
    vertices, triangles = adapter._cylinder_mesh(cylinder, *adapter._facets(cylinder, scenario.rods))
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    volume = (a * np.cross(b, c)).sum() / 6  # above 0: the facets face outwards
    assert abs(volume / (np.pi * cylinder.radius**2 * cylinder.length) - 1) < 1e-3
    assert adapter.SeldingerSolver().settings(scenario, n_elements=100, n_frames=101)["cylinder_triangles"] == len(triangles)
    radial = np.linalg.norm(vertices[:-2, [0, 2]], axis=1)
    assert np.abs(radial - cylinder.radius).max() < adapter._SAG * scenario.rods[0].radius


def test_what_it_cannot_do_is_said():
    def refusal(**changes):
        with pytest.raises(NotImplementedError) as why:
            adapter.SeldingerSolver().run(replace(of("pile").scenario, **changes), n_elements=20, n_frames=2)
        return str(why.value)

    pile = of("pile").scenario
    plane, rod = pile.obstacles[0], pile.rods[0]
    assert "one vessel" in refusal(obstacles=(plane, replace(plane, point=(0.0, 0.0, -1.0))))
    assert "one coefficient" in refusal(obstacles=(replace(plane, friction=0.6),))
    tilt = scenarios.Motion((0.0, 1.0), ((0.0,) * 3,) * 2, ((0.0,) * 3, (1.0, 0.0, 0.0)))
    assert "tilts" in refusal(rods=(replace(rod, start_motion=tilt),))
    slide = scenarios.Motion((0.0, 1.0), ((0.0,) * 3,) * 2, ((0.0,) * 3,) * 2, slides_along=(1.0, 1.0, 0.0))
    assert "slides" in refusal(rods=(replace(rod, start_motion=slide),))
