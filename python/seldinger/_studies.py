"""Batches, the planner and the chart, by the library of the command."""

from __future__ import annotations

import csv
import io
import json
import os
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from . import _engine, _toml
from ._scene import Scene, SceneLike, assets


def _sweep_text(vary: Any) -> str:
    if isinstance(vary, Mapping):
        return "[vary]\n" + "\n".join(f"{json.dumps(str(k))} = {_toml.value(v, str(k))}" for k, v in vary.items()) + "\n"
    if isinstance(vary, str) and "\n" in vary:
        return vary
    return Path(vary).read_text(encoding="utf-8")


def sweep(vary: Any, seed: int = 0) -> list[list[str]]:
    """The runs of a sweep as lists of overrides.

    Parameters
    ----------
    vary : dict, text or path
        {"table.key": [values] or {"min": a, "max": b, "n": count, "log": bool}}, or a sweep file: lists make a grid, draws are
        made together (docs/command-line.md, batch).

    Examples
    --------
    >>> import seldinger
    >>> seldinger.sweep({"wire.nodes": [21, 41]})
    [['wire.nodes=21'], ['wire.nodes=41']]
    """
    return _engine.sweep(_sweep_text(vary), int(seed))


def batch(scene: SceneLike, vary: Any, *, set: Sequence[str] = (), device: int = -1, **overrides: Any) -> dict[str, np.ndarray]:
    """Runs a scene many times with varied keys, as systems of shared worlds. Each run has the bits of a single run.

    Returns
    -------
    dict of arrays [runs]
        The columns of the command's results.csv: `run`, the varied keys, `status`, numbers in SI, `state_hash`.
        `pandas.DataFrame(table)` accepts it.

    Examples
    --------
    >>> import seldinger
    >>> table = seldinger.batch("swing", {"wire.nodes": [11, 21]}, scene__duration_s=0.02)
    >>> table["wire.nodes"].tolist(), len(table["tip_z_m"])
    ([11.0, 21.0], 2)
    """
    given = Scene(scene, set=set, **overrides)
    table = _engine.batch(given.text, given.file, given.overrides, _sweep_text(vary), int(device))
    with np.load(io.BytesIO(table)) as columns:
        return {name: columns[name] for name in columns.files}


def plan(scene: SceneLike, tolerance: float, *, force_tolerance: float = 0.0, force_is_relative: bool = True,
         peak_force_tolerance: float = 0.0, peak_force_is_relative: bool = True, rate: float = 0.0, budget: float = 120.0,
         out: str | os.PathLike[str] = "planned.toml", set: Sequence[str] = (), device: int = -1,
         **overrides: Any) -> dict[str, Any]:
    """The cheapest model that meets a tolerance for a scene, as the output of `plan --json`.

    Parameters
    ----------
    tolerance : float
        Largest error of the wire, root mean square over the run [m].
    force_tolerance : float
        Largest error of the hand force: a fraction, or [N] with `force_is_relative=False`; 0: no limit.
    peak_force_tolerance : float
        Largest error of the peaks of hand force, friction and force per length (20 ms means): a fraction of each, or [N] with
        `peak_force_is_relative=False` (for force per length: on one diameter of the wire); 0: no limit.
    rate : float
        Steps per second, each computed in real time; 0: no limit.
    budget : float
        Wall time [s].
    out : path
        The scene file to write.

    Raises
    ------
    Error
        Code 6: no model meets the request; the message has the nearest one.
    """
    given = Scene(scene, set=set, **overrides)
    return json.loads(_engine.plan(given.text, given.file, given.overrides, float(tolerance), float(force_tolerance),
                                   bool(force_is_relative), float(peak_force_tolerance), bool(peak_force_is_relative), float(rate),
                                   float(budget), os.fspath(out), int(device)))


def chart(scenes: Sequence[str] = (), *, quick: bool = True, dir: str | os.PathLike[str] | None = None, run_limit: float = 0.0,
          reference_limit: float = 0.0, device: int = -1) -> dict[str, np.ndarray]:
    """Speed against accuracy: scenes under every model.

    Parameters
    ----------
    scenes : list of str
        Names of built-in benchmarks or scene files; none: all.
    dir : path
        Folder for finished runs, from which an interrupted chart continues; without it nothing is kept.

    Returns
    -------
    dict of arrays
        The columns of the command's chart.csv, one row per scene and model; numbers are float64, an empty field NaN.
    """
    if isinstance(scenes, str):
        raise TypeError(f"scenes: got the text \"{scenes}\"; expected a list of names")
    if dir is None:
        with tempfile.TemporaryDirectory() as kept:
            return chart(scenes, quick=quick, dir=kept, run_limit=run_limit, reference_limit=reference_limit, device=device)
    text, _ = _engine.chart([os.fspath(s) for s in scenes], os.fspath(dir), str(assets()), bool(quick), float(run_limit),
                            float(reference_limit), int(device))
    return _columns(text)


def _columns(text: str) -> dict[str, np.ndarray]:
    rows = list(csv.DictReader(io.StringIO(text)))
    names = rows[0].keys() if rows else []
    return {name: _column([row[name] for row in rows]) for name in names}


def _column(fields: list[str]) -> np.ndarray:
    try:
        return np.array([float(f) if f else np.nan for f in fields])
    except ValueError:
        return np.array(fields)
