"""Forces of the program: what acts on points of an instrument, asked for by the engine."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Union

import numpy as np

_ON = {"nodes": 1, "edges": 2}


class Points:
    """What a force sees of its points, and where it writes what acts on them.

    Read: `time` (end of the sub-step) and `dt` (its length, 0 in an equilibrium) [s]; `wire`, the instrument's number, [points]; `s`, distance from the tip along the unstressed
    wire, and `length` of the wire that a point stands for (0: a point alone) [m], [points]; `position` [m], `velocity` [m/s], `axis`
    (unit, in the direction of insertion), `director` (unit, of the material), `turning` (angular velocity [rad/s]), [points, 3]; `state`.

    Write: `force` [N] and `moment` [N m], [points, 3], in world axes, 0 when called; in `tangents`: `tangent`, d(force, moment)/d(position,
    turn), and `damping`, d(force, moment)/d(velocity, turning), [points, 6, 6]; in `accept`: `state`.
    """

    __slots__ = ("time", "dt", "wire", "s", "length", "position", "velocity", "axis", "director", "turning", "state", "_out")

    def __init__(self, wire: Any, s: Any, length: Any, position: Any, velocity: Any, axis: Any, director: Any, turning: Any, state: Any, *out: Any) -> None:
        self.time = self.dt = 0.0
        self.wire, self.s, self.length, self.position, self.velocity = wire, s, length, position, velocity
        self.axis, self.director, self.turning, self.state = axis, director, turning, state
        self._out = dict(zip(("force", "moment", "tangent", "damping"), out))

    def _write(self, name: str, value: Any) -> None:
        to = self._out[name]
        if value is to:
            return
        given = np.asarray(value)
        if given.dtype.kind not in "fiu":
            raise TypeError(f"{name}: got {given.dtype}; expected numbers")
        if given.shape != to.shape and not (len(to) == 1 and given.shape == to.shape[1:]):
            raise ValueError(f"{name}: got shape {given.shape}; expected {to.shape}")
        to[...] = given

    def _of(name: str, text: str) -> property:  # type: ignore[misc]  # noqa: N805
        return property(lambda self: self._out[name], lambda self, value: self._write(name, value), doc=text)

    force = _of("force", "[points, 3] N, in world axes.")
    moment = _of("moment", "[points, 3] N m, in world axes.")
    tangent = _of("tangent", "[points, 6, 6]: d(force, moment)/d(position, turn).")
    damping = _of("damping", "[points, 6, 6]: d(force, moment)/d(velocity, turning).")
    del _of


class Force:
    """A force of your own on points of an instrument. Subclass it, write `forces`, and give it to `World.on_step`.

    Parameters
    ----------
    at : float, sequence of float, "nodes" or "edges"
        Points: distances from the tip [m]; each node; the middle of each edge. What is not inside yet is left out.
    state : sequence of float
        Numbers that the force remembers, at the start. They are saved, hashed and restored with the world, and change in `accept` only.
    name : str
        In messages, and in sensor_NAME.csv; default: the name of the class.
    together : bool
        On several instruments: `forces` and `tangents` are asked once for the points of all, one instrument after the other (`p.wire`).
        No state then.
    record : sequence of str
        Of a sensor: names of the first numbers of the state, for `output.sensors` and sensor_NAME.csv of a run. The first is the time of
        the sample, or whatever changes with each.

    Examples
    --------
    A spring from the tip to a point:

    >>> import numpy as np, seldinger
    >>> class Spring(seldinger.Force):
    ...     def __init__(self, anchor, stiffness):
    ...         super().__init__(at=0.0)
    ...         self.anchor, self.stiffness = np.array(anchor), stiffness
    ...     def forces(self, p):
    ...         p.force = self.stiffness * (self.anchor - p.position)
    ...     def tangents(self, p):
    ...         p.tangent[:, :3, :3] = -self.stiffness * np.eye(3)
    ...     def energy(self, p):
    ...         return 0.5 * self.stiffness * ((self.anchor - p.position) ** 2).sum()
    >>> world = seldinger.World("swing")
    >>> _ = world.on_step(Spring([0.3, 0.0, 0.1], 0.5))
    >>> world.step(n=10).failed
    False
    """

    each_trial = True

    def __init__(self, at: Union[float, str, Sequence[float]] = 0.0, state: Sequence[float] = (), name: str | None = None,
                 together: bool = False, record: Sequence[str] = ()) -> None:
        self.at, self.state, self.name, self.together, self.record = at, state, name, together, record

    def forces(self, p: Points) -> Any:
        """Writes `p.force` and `p.moment`, or returns the force, or (force, moment)."""
        raise NotImplementedError("forces: got a Force without it; expected def forces(self, p)")

    def tangents(self, p: Points) -> None:
        """Writes `p.tangent` and `p.damping`. A force without it is differentiated by the engine: six more calls a trial."""

    def energy(self, p: Points) -> float:
        """Potential energy of all points [J], for `output.force_energy`."""
        return 0.0

    def accept(self, p: Points) -> None:
        """The end of a sub-step: the place to change `p.state`."""

    def _forces(self, p: Points) -> None:
        given = self.forces(p)
        if given is None:
            return
        p.force, moment = given if isinstance(given, tuple) and len(given) == 2 else (given, None)
        if moment is not None:
            p.moment = moment

    def _about(self) -> dict[str, Any]:
        at = getattr(self, "at", 0.0)
        if isinstance(at, str) and at not in _ON:
            raise ValueError(f"at: got \"{at}\"; expected \"nodes\", \"edges\" or distances from the tip [m]")
        lists = {"places": [] if isinstance(at, str) else at, "state": getattr(self, "state", ())}
        for name, given in lists.items():
            values = np.atleast_1d(np.asarray(given, float if np.size(given) == 0 else None))
            if values.ndim != 1 or values.dtype.kind not in "fiu" or not np.isfinite(values).all():
                raise ValueError(f"{'at' if name == 'places' else name}: got {given!r:.60}; expected finite numbers in a row")
            lists[name] = values.astype(float).tolist()
        own = type(self)
        return {"name": str(getattr(self, "name", None) or own.__name__), "on": _ON[at] if isinstance(at, str) else 0, **lists,
                "each_trial": bool(self.each_trial), "together": bool(getattr(self, "together", False)),
                "record": [str(column) for column in getattr(self, "record", ())],
                "has": [getattr(own, method) is not getattr(Force, method) for method in ("tangents", "energy", "accept")]}


class _OnStep(Force):
    """A function that is asked once a sub-step."""

    each_trial = False

    def __init__(self, callback: Callable[[Points], Any], at: Union[float, str, Sequence[float]]) -> None:
        super().__init__(at, name=getattr(callback, "__name__", None))
        self.forces = callback  # type: ignore[method-assign]
