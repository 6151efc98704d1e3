"""A run's folder as arrays: its trace, and the shapes of its instruments over time."""

from __future__ import annotations

import json
import os
import re
import struct
from pathlib import Path
from typing import Any

import numpy as np

from ._errors import Error
from ._studies import _columns

_TYPES = {"Float64": "<f8", "Int32": "<i4"}


def _points_of(file: Path) -> np.ndarray:
    """Points [n, 3] of a .vtp file that the program has written: raw blocks after the XML."""
    data = file.read_bytes()
    head, mark, blocks = data.partition(b'<AppendedData encoding="raw">\n_')
    found = re.search(rb"<Points>\s*<DataArray type=\"(\w+)\"[^>]* offset=\"(\d+)\"", head)
    if not mark or not found or found[1].decode() not in _TYPES:
        raise Error(f"{file}: got no frame of a run; expected a .vtp that `seldinger run` has written", 3)
    offset = int(found[2])
    size = struct.unpack_from("<Q", blocks, offset)[0] if offset + 8 <= len(blocks) else 1 << 62
    if size % 24 or offset + 8 + size > len(blocks):
        raise Error(f"{file}: got a file that is cut short; expected a whole one. Fix: run again with --overwrite", 3)
    return np.frombuffer(blocks, _TYPES[found[1].decode()], size // 8, offset + 8).reshape(-1, 3)


def _resampled(points: np.ndarray, n: int) -> np.ndarray:
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    stations = np.linspace(0.0, along[-1], n)
    return np.stack([np.interp(stations, along, points[:, d]) for d in range(3)], axis=1)


class Run:
    """What `load_run` returns.

    Attributes
    ----------
    dir : Path
    summary : dict
        `summary.json`.
    trace : dict of arrays [rows]
        The columns of `trace.csv`.
    instruments : tuple of str
        Names of the series: "wire", or those of the [[instrument]] tables.
    time : array [frames]
        Of the frames of the shapes [s].
    """

    def __init__(self, dir: str | os.PathLike[str]) -> None:
        self.dir = Path(dir)
        try:
            self.summary: dict[str, Any] = json.loads((self.dir / "summary.json").read_text(encoding="utf-8"))
            self.trace = _columns((self.dir / "trace.csv").read_text(encoding="utf-8"))
        except (OSError, ValueError) as why:
            raise Error(f"{self.dir}: got a folder that holds no run that has ended ({why}); expected what `seldinger run -o` wrote", 3) from None
        self.instruments = tuple(one["name"] for one in self.summary.get("instruments", [])) or ("wire",)
        pvd = self.dir / "wire.pvd"
        frames = re.findall(r'<DataSet timestep="([^"]+)" group="" part="(\d+)"[^>]*file="([^"/]+)"', pvd.read_text(encoding="utf-8") if pvd.is_file() else "")
        self._files = [[file for _, part, file in frames if int(part) == k] for k in range(len(self.instruments))]
        self.time = np.array([float(time) for time, part, _ in frames if part == "0"])

    def shapes(self, instrument: int | str = 0) -> list[np.ndarray]:
        """Nodes [n, 3] of an instrument in each frame, tip first [m]. Their number changes where nodes are adaptive or fed."""
        k = self.instruments.index(instrument) if isinstance(instrument, str) else int(instrument)
        return [_points_of(self.dir / file) for file in self._files[k]]

    def resample(self, n: int, instrument: int | str = 0) -> np.ndarray:
        """The shapes as one array [frames, n, 3]: n points at even arc lengths, tip first [m].

        >>> import numpy, seldinger                                             # doctest: +SKIP
        >>> run = seldinger.load_run("arch-run")
        >>> numpy.savez("shapes.npz", time_s=run.time, position_m=run.resample(200))
        """
        if int(n) < 2:
            raise ValueError(f"n: got {n}; expected 2 or more")
        shapes = [_resampled(points, int(n)) for points in self.shapes(instrument)]
        return np.stack(shapes) if shapes else np.empty((0, int(n), 3))


def load_run(dir: str | os.PathLike[str]) -> Run:
    """The folder of a finished run as arrays: summary, trace and shapes over time.

    Raises
    ------
    Error
        Code 3: no run that has ended, or a damaged file.
    """
    return Run(dir)
