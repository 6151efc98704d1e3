"""Worlds, controls and readings."""

from __future__ import annotations

import json
import os
import warnings
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, NamedTuple, Union

import numpy as np

from . import _engine
from ._errors import Error
from ._force import Force, Points, _OnStep
from ._scene import Scene, SceneLike

_FLAGS = {"halved": 1, "not_converged": 2, "wall_far": 4, "wall_penetration": 8, "non_finite": 16, "best_effort": 32, "energy": 64}
_ADVICE = {
    64: "the simulation gained energy; make scene.dt_s smaller, or leave integrator.beta and gamma out",
    16: "a value is not finite; check the wire's stiffness and density, make scene.dt_s smaller",
    2: "the step did not converge, even divided; make scene.dt_s smaller or contact.stiffness lower",
}


class StepReport(NamedTuple):
    """Report on the steps of one call; the worst of all.

    Fields: `flags` (bits, see `names`), `newton_iterations` and `sub_steps` (of the worst step), `steps` (taken: fewer than
    requested if one failed).
    """

    flags: int
    newton_iterations: int
    sub_steps: int
    steps: int

    @property
    def failed(self) -> bool:
        """Whether a step failed; the state before it was kept."""
        return bool(self.flags & (2 | 16 | 64))

    @property
    def names(self) -> tuple[str, ...]:
        """Flags in words."""
        return tuple(name for name, bit in _FLAGS.items() if self.flags & bit)

    @property
    def message(self) -> str:
        """The fix for a failure; empty if there is none."""
        return next((text for bit, text in _ADVICE.items() if self.flags & bit), "")


class Control:
    """Input of one call of `World.step`: hubs and loads. A hub without input stays.

    Examples
    --------
    >>> import seldinger
    >>> control = seldinger.Control().move_to(0, advance=0.002, turn=0.1)
    >>> control.targets
    {0: (0.002, 0.1)}
    >>> world = seldinger.World("swing")
    >>> world.step(seldinger.Control().load(0, at=0.0, force=[0.0, 0.0, 0.01])).failed    # 10 mN on the tip, for one step
    False
    """

    def __init__(self) -> None:
        self.targets: dict[Union[int, str], tuple[float, float]] = {}
        self.loads: list[tuple[Union[int, str], float, np.ndarray, np.ndarray]] = []
        self.pushes: dict[Union[int, str], tuple[float, float, float]] = {}

    def move_to(self, instrument: Union[int, str] = 0, advance: float = 0.0, turn: float = 0.0) -> "Control":
        """At the end of the call the hub of `instrument` (an index or a name) has `advance` [m] of wire pushed in and is turned by
        `turn` [rad], right-handed about the direction of insertion. The speed is constant."""
        self.targets[instrument] = (float(advance), float(turn))
        return self

    def push(self, instrument: Union[int, str] = 0, force: float = 0.0, turn: float = 0.0, spring: float = 0.0) -> "Control":
        """Pushes a hub that a force drives (`feed.hub_mass_kg`) with `force` [N], and turns it. With `spring` [N/m] the force falls by that
        much per metre that the hub goes on in the step: a spring to a hand or a motor, taken at the end of the step."""
        self.pushes[instrument] = tuple(float(_reals(v, (), "push")) for v in (force, turn, spring))  # type: ignore[assignment]
        return self

    def load(self, instrument: Union[int, str] = 0, at: float = 0.0, force: Sequence[float] = (0.0, 0.0, 0.0),
             moment: Sequence[float] = (0.0, 0.0, 0.0)) -> "Control":
        """During the call, `force` [N] and `moment` [N m] in world axes act on the point of `instrument` that is `at` metres from its tip
        along the unstressed wire. Loads add up. A point that is not inside yet feels nothing."""
        self.loads.append((instrument, float(_reals(at, (), "load: at")), _reals(force, (3,), "load: force [N]"),
                           _reals(moment, (3,), "load: moment [N m]")))
        return self


_MOST_COPIES = 65536


def _overrides_of(copies: Any) -> list[list[str]]:
    """The overrides of `copies`, a list for each system."""
    wanted = "expected a list of overrides for each system, as [[], []] or [[]] * 8"
    if isinstance(copies, (str, bytes, Mapping)) or not isinstance(copies, Iterable):
        raise TypeError(f"copies: got {copies!r:.60}; {wanted}")
    own: list[list[str]] = []
    for given in copies:
        if isinstance(given, (str, bytes)) or not isinstance(given, Iterable):
            raise TypeError(f"copies[{len(own)}]: got {given!r:.60}; {wanted}")
        if len(own) == _MOST_COPIES:
            raise ValueError(f"copies: got more than {_MOST_COPIES} systems. Fix: make several worlds")
        own.append(list(map(str, given)))
    if not own:
        raise ValueError(f"copies: got none; {wanted}")
    return own


ControlLike = Union[None, Control, Mapping[Union[int, str], Sequence[float]], Sequence[float], np.ndarray]


class World:
    """A simulated world: instruments inside a vessel.

    Parameters
    ----------
    scene : str, path, dict or Scene
        See `Scene`.
    set : list of str
        Overrides as in the command's --set.
    device : int
        OpenCL device as `seldinger.devices()` lists them; -1: the default.
    copies : list of list of str
        Several systems in one world, stepped by one launch for all: a list of overrides for each. They may differ in their
        instruments, feeds and coefficients of contact. Each has the bits of a single world.
    **overrides
        Keys of the scene, `wire__nodes=41` or `**{"wire.nodes": 41}`.

    Examples
    --------
    >>> import seldinger
    >>> world = seldinger.World("aortic-arch")
    >>> report = world.step([0.005, 0.0], n=100)       # the hub is pushed 5 mm in within 100 steps
    >>> report.failed, round(world.time, 3)
    (False, 0.1)
    >>> world.output.nodes.shape[1], round(world.output.inserted, 6)
    (3, 0.005)
    >>> world.close()

    Threads may share a world: calls wait for each other, and other Python threads run during a call. A world does not survive a
    fork; use multiprocessing's "spawn".
    """

    def __init__(self, scene: SceneLike, *, set: Sequence[str] = (), device: int = -1,
                 copies: Sequence[Sequence[str]] | None = None, **overrides: Any) -> None:
        given = Scene(scene, set=set, **overrides)
        own = [[]] if copies is None else _overrides_of(copies)
        self._scene, self._copies, self._device = given, own, int(device)
        self._world = _engine.make_world(given.text, given.file, [given.overrides + c for c in own], self._device)
        self._dt, self._duration, self._steps, self._settles = self._world.scene_numbers()
        wires, self._systems = self._world.counts()
        names = self._world.names()
        self._names = tuple(name or (f"wire{i}" if wires > 1 else "wire") for i, name in enumerate(names))
        self._settled = False
        self._forces: list[tuple[list[int], Force]] = []
        self._held = False  # by an environment, which counts on nobody else moving it

    # -- description ---------------------------------------------------------------------------------------------------

    @property
    def dt(self) -> float:
        """Length of a step [s], `scene.dt_s`."""
        return self._dt

    @property
    def duration(self) -> float:
        """Duration of the scene [s]."""
        return self._duration

    @property
    def instruments(self) -> tuple[str, ...]:
        """Names of the instruments, in the order of `Output.instruments`.

        >>> import seldinger
        >>> seldinger.World("swing").instruments
        ('wire',)
        """
        return self._names

    @property
    def systems(self) -> int:
        """Number of systems: 1, or the number of `copies`."""
        return self._systems

    @property
    def model(self) -> dict[str, str]:
        """The model and the reasons for it, "name": "value (reason)", as in summary.json."""
        return dict(self._world.model())

    @property
    def device(self) -> str:
        """Name of the OpenCL device."""
        return self._world.device_name()

    @property
    def scene(self) -> str:
        """The scene as TOML with every default; paths are relative to the current folder."""
        return self._world.scene_text(os.getcwd())

    @property
    def centreline(self) -> dict[str, np.ndarray]:
        """The vessel's axis as a tree: `points` [p, 3] m, `radius` [p] m, `parent` [p] (-1 at a root)."""
        return self._world.centreline()

    @property
    def vessel(self) -> tuple[np.ndarray, np.ndarray]:
        """The wall's mesh: vertices [v, 3] m, triangles [t, 3]."""
        return self._world.vessel()

    # -- running ------------------------------------------------------------------------------------------------------

    def step(self, control: ControlLike = None, n: int = 1, *, dt: float | None = None) -> StepReport:
        """Advances by `n` steps.

        Parameters
        ----------
        control
            None: the hubs follow the scene's key frames, as the command's `run` does. A `Control`; an array [2] (advance [m], turn
            [rad]) of the first instrument, or [instruments, 2]; a dict {index or name: (advance, turn)}. The hubs move there at
            constant speed over the n steps; hubs without input stay.
        n : int
            Number of steps. A failed one ends the call (in a world of several systems only its own system stops).
        dt : float
            Length of a step [s]; default: the scene's.

        Returns
        -------
        StepReport
            It reports numerical trouble, which is never raised.

        Raises
        ------
        Error
            An instrument that does not exist or is not fed, a value that is not finite or not on the wire; a closed world.
        TypeError, ValueError
            A control of a wrong type or shape. The world is unchanged.

        Examples
        --------
        >>> import seldinger
        >>> world = seldinger.World("swing")
        >>> world.step(n=10).failed
        False
        """
        self._refuse_if_held("step", "env.step(action)")
        n = _count(n)
        dt = self._dt if dt is None else float(dt)
        if control is None:
            return StepReport(*self._world.step(None, None, n, dt))
        targets, moves = self._targets(control)
        loads = [[self._index(k), at, *force, *moment] for k, at, force, moment in getattr(control, "loads", ())]
        pushes = [[self._index(k), *push] for k, push in getattr(control, "pushes", {}).items()]
        return StepReport(*self._world.step(targets, moves, n, dt, loads=np.array(loads, float).reshape(-1, 8),
                                            pushes=np.array(pushes, float).reshape(-1, 4)))

    def on_step(self, force: Union[Force, Callable[[Points], Any]], instrument: Union[int, str, Sequence[Union[int, str]]] = 0,
                at: Union[float, str, Sequence[float]] = 0.0) -> Force:
        """A force of your own acts on an instrument from the next step on.

        Parameters
        ----------
        force : Force or function
            A `Force` is asked at every trial of Newton's method. A function of `Points` is asked once, at the start of a (sub-)step, and
            what it returns, a force [points, 3] or (force, moment), acts through it.
        instrument : int, str or a sequence of them
            Index or name; of several, each feels it.
        at
            Points of a function, as `Force.at`.

        Returns
        -------
        Force

        Raises
        ------
        Error
            No such instrument, a place that is not on it. What a force raises, ends `step`, `run` and `settle` with its traceback; a force
            that is not finite raises Error. The world is then as before the step.

        Examples
        --------
        >>> import seldinger
        >>> world = seldinger.World("swing")
        >>> _ = world.on_step(lambda p: -0.01 * p.velocity)    # a dashpot at the tip, 0.01 N s/m
        >>> world.step(n=10).failed, world.output.energy["forces"] < 0
        (False, True)
        """
        own = force if isinstance(force, Force) else _OnStep(force, at)
        on = [self._index(k) for k in ([instrument] if isinstance(instrument, (int, str, np.integer)) else instrument)]
        self._world.add_force(on, own, own._about())
        self._forces.append((on, own))
        return own

    def settle(self) -> StepReport:
        """Static equilibrium of the present state (scheme = "static", start = "settled")."""
        self._refuse_if_held("settle", "env.reset()")
        self._settled = True
        return StepReport(*self._world.settle())

    def run(self, until: float | None = None) -> "_engine.Output":
        """Runs the scene as the command does, to its end or to the time `until` [s], and returns the output there.

        Raises
        ------
        Error
            Code 4, if a step fails.

        Examples
        --------
        >>> import seldinger
        >>> world = seldinger.World("swing", scene__duration_s=0.05, scene__dt_s=0.001)
        >>> _ = world.run()
        >>> round(world.time, 6)
        0.05
        """
        self._refuse_if_held("run", "env.step(action)")
        steps = self._steps if until is None else min(self._steps, round(float(until) / self._dt))
        settles = not self._settled and self.output.step == 0 and self._settles
        self._settled = self._settled or settles
        self._world.begin_run(settles)
        over, warned = False, False
        while not over:
            over, as_placed, failed, settling = self._world.run(steps, 64)
            if as_placed and not warned:
                warned = True
                warnings.warn("scene.start: got \"settled\", but no equilibrium was found; the run starts from the wire as it was placed", stacklevel=2)
            if failed is not None:
                self._check(StepReport(*failed), "settling" if settling else f"step {self.output.step}")
        return self.output

    def _refuse_if_held(self, call: str, instead: str) -> None:
        if self._held:
            raise Error(f"World.{call}: got the world of an environment; expected a world of your own, since the environment's rewards count on "
                        f"where it left the hubs and the clock. Fix: {instead}", 2)

    def _check(self, report: StepReport, where: str) -> None:
        if report.failed:
            raise Error(f"{where} ({self.time:.6g} s): {report.message}", 4)

    # -- reading ------------------------------------------------------------------------------------------------------

    @property
    def output(self) -> "_engine.Output":
        """Readings of the present state. Its arrays are read-only views without a copy. They keep their values when the world
        continues or is deleted.

        >>> import seldinger
        >>> nodes = seldinger.World("swing").output.nodes    # the world is gone already
        >>> nodes.flags.writeable, nodes.dtype.name, nodes.shape[1]
        (False, 'float64', 3)
        """
        return self._world.output()

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        return self._world.time()

    def task(self, system: int = 0) -> dict[str, Any]:
        """What became of the scene's [task] so far, as `task` of `summary.json` (docs/readings.md): `reached`, `reached_at_m`,
        `reached_at_s`, `distance_m`, `verdict`, and the largest forces until the target was reached.

        Raises
        ------
        Error
            Code 2: the scene has no [task].

        Examples
        --------
        >>> import seldinger
        >>> world = seldinger.World("swing", set=["task.target={point = [0.0, 0.0, 0.0], radius_m = 5.0}"], scene__duration_s=0.01)
        >>> _ = world.run()
        >>> world.task()["reached"], world.task()["verdict"]
        (True, 'passed')
        """
        return json.loads(self._world.task(int(system)))

    @property
    def task_table(self) -> dict[str, Any]:
        """The scene's [task] with the keys of the scene file, as far as they are given; empty without one.

        >>> import seldinger
        >>> seldinger.World("swing", set=["task.time_s=2.0", "task.target={point = [0.0, 0.0, 0.0], radius_m = 0.01}"]).task_table
        {'time_s': 2.0, 'target': {'point': [0.0, 0.0, 0.0], 'radius_m': 0.01}}
        """
        return self._world.task_table()

    def branch(self, system: int = 0) -> tuple[int, float]:
        """Branch of the vessel that the leading tip is in, numbered as `task.target.branch`, and how far behind its mouth [m];
        0: in a vessel that ends in a fork, or no centreline. `branch_path` names that vessel, too."""
        return self._world.branch(int(system))[:2]

    def branch_path(self, system: int = 0) -> str:
        """Path of the vessel that the leading tip is in, as `branch_path` of `summary.json`: "0" is the trunk, "2.1" leaves branch 2.
        Empty without a centreline."""
        return self._world.branch(int(system))[2]

    def branches(self, system: int = 0) -> list[dict[str, Any]]:
        """Vessels between forks, as the one who pushes sees them: `path`, `name` (of the centreline's file, or ""), `number` (of an end;
        0: it ends in a fork), and `points`, indices into `centreline["points"]` from the fork outwards."""
        return [{"path": path, "name": name, "number": number, "points": np.array(points, int)}
                for path, name, number, points in self._world.branches(int(system))]

    def state_hash(self, system: int = -1) -> str:
        """64-bit FNV-1a over every byte of the state as 16 hex digits, as in `summary.json`; of one system, or of all."""
        return self._world.state_hash(int(system))

    def save(self, system: int = -1) -> "_engine.State":
        """The whole changing state, of one system or of all. It can be pickled.

        >>> import seldinger
        >>> world = seldinger.World("swing")
        >>> state = world.save()
        >>> _ = world.step(n=20)
        >>> after = world.state_hash()
        >>> world.restore(state)
        >>> _ = world.step(n=20)
        >>> world.state_hash() == after
        True
        """
        return self._world.save(int(system))

    def restore(self, state: "_engine.State") -> None:
        """Returns to a saved state. Later steps have the same bits as after the save.

        Raises
        ------
        Error
            Code 3: not a state of such a world. The world is unchanged. Code 2: the world of an environment, which has its own
            `restore`.
        """
        if not isinstance(state, _engine.State):
            raise TypeError(f"state: got {type(state).__name__}; expected what save() returned")
        self._refuse_if_held("restore", "env.restore(env.save()), which carry hubs, clock, progress and generator too")
        self._world.restore(state)

    def render(self, width: int = 640, height: int = 480, *, legend: bool = True, force_scale: float = 0.0,
               camera: tuple[Sequence[float], Sequence[float], Sequence[float]] | None = None, system: int = -1) -> np.ndarray:
        """A picture of the present state, [height, width, 3] uint8, drawn without a display (EGL).

        Parameters
        ----------
        width, height : int
            In pixels.
        legend : bool
            Text, scale bars and the magnified view of the tip.
        force_scale : float
            Contact force at the top of the scale [N]; 0: a round number above the largest force.
        camera : (eye, target, up)
            Points and a direction [m]; without it the camera shows the whole vessel.
        system : int
            The system that is drawn; -1: all in one picture.

        Raises
        ------
        Error
            Code 5: no off-screen OpenGL; code 2: an impossible size.
        """
        views = None if camera is None else np.asarray(camera, float)
        if views is not None and (views.shape != (3, 3) or not np.isfinite(views).all()):
            raise ValueError(f"camera: got {camera}; expected (eye, target, up), each [3] and finite")
        return _engine.render(self._world, int(width), int(height), bool(legend), float(force_scale), views, int(system))

    def fluoroscopy(self, width: int = 512, height: int = 512, *, system: int | Sequence[int] = 0,
                    c_arm: str | Sequence[str | None] | None = None, field: float | None = None, noise: bool = True,
                    frame: int | Sequence[int] | None = None, labels: bool = False, lumen: bool = False) -> Any:
        """An X-ray picture of the present state, [height, width] uint16 of 12 bits (docs/fluoroscopy.md), without a display.

        Parameters
        ----------
        width, height : int
            In pixels.
        system : int or sequence of int
            The system, or several: their pictures are made in parallel, [systems, height, width].
        c_arm : str
            "LAO 30, CRA 15"; without it the scene's [carm] at the present time, LAO 0 by default. Tube, body, bones and contrast are
            the scene's. Several, as ["LAO 30", "RAO 30"]: [views, height, width], with several systems [systems, views, height,
            width]; the labels are lists likewise.
        field : float
            Width of the detector [m].
        noise, frame
            Quantum noise, seeded by the scene's seed and `frame` (one for each of a sequence of systems); default: the step's
            number. The same number gives the same picture. View v of several has the noise of number frame + v 2^48.
        labels : bool
            Return (picture, labels): the ground truth of the picture (docs/labels.md), a dict with the keys of a label file and
            arrays instead of lists: `image`, `camera` (`projection` [3, 4] from scene metres to pixels), `instruments`, and
            `mask` [height, width] uint8 (0 background, k instrument k). For a sequence of systems, a list of dicts.
        lumen : bool
            With labels: `lumen_m` [height, width] float32 too, the vessel's thickness along each ray [m].

        Examples
        --------
        >>> import seldinger
        >>> picture = seldinger.World("aortic-arch").fluoroscopy(64, 48, c_arm="LAO 30")
        >>> picture.shape, picture.dtype.name, bool(picture.max() < 4096)
        ((48, 64), 'uint16', True)
        >>> picture, labels = seldinger.World("aortic-arch").fluoroscopy(64, 48, c_arm="LAO 30", labels=True)
        >>> wire = labels["instruments"][0]
        >>> point = labels["camera"]["projection"] @ [*wire["tip_m"], 1.0]
        >>> bool(abs(point[:2] / point[2] - wire["tip_px"]).max() < 1e-6)
        True
        """
        several = not isinstance(system, (int, np.integer))
        systems = [int(s) for s in system] if several else [int(system)]
        if frame is None or isinstance(frame, (int, np.integer)):
            frames = [self.output.step if frame is None else int(frame)] * len(systems)
        else:
            frames = [int(f) for f in frame]
        if len(frames) != len(systems):
            raise ValueError(f"frame: got {len(frames)} for {len(systems)} systems; expected one number, or one for each")
        if lumen and not labels:
            raise ValueError("lumen: got labels=False; lumen is one of the labels. Fix: labels=True")
        views = list(c_arm) if isinstance(c_arm, (list, tuple)) else [c_arm]
        if not views or not all(view is None or isinstance(view, str) for view in views):
            raise TypeError(f"c_arm: got {c_arm!r:.60}; expected a text as \"LAO 30, CRA 15\", or a list of such")
        taken = [_engine.fluoroscopy(self._world, systems, int(width), int(height), view, field, bool(noise),
                                     [f + (v << 48) for f in frames], bool(labels), bool(lumen)) for v, view in enumerate(views)]
        pictures = np.stack([one[0] for one in taken] if labels else taken, axis=1)  # [systems, views, height, width]
        truths = [list(own) for own in zip(*(one[1] for one in taken))] if labels else []
        if not isinstance(c_arm, (list, tuple)):
            pictures, truths = pictures[:, 0], [own[0] for own in truths]
        if not several:
            pictures, truths = pictures[0], truths[0] if labels else None
        return (pictures, truths) if labels else pictures

    # -- life ---------------------------------------------------------------------------------------------------------

    def close(self) -> None:
        """Frees its memory. Views of its output stay valid; any other use raises Error."""
        self._world.close()

    def __enter__(self) -> "World":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __getstate__(self) -> dict[str, Any]:
        return {"text": self._scene.text, "file": self._scene.file, "set": self._scene.overrides, "copies": self._copies,
                "device": self._device, "settled": self._settled, "forces": self._forces, "state": self.save()}

    def __setstate__(self, kept: dict[str, Any]) -> None:
        scene = Scene.__new__(Scene)
        scene.text, scene.file, scene.overrides = kept["text"], kept["file"], kept["set"]
        self.__init__(scene, device=kept["device"], copies=kept["copies"])
        self._settled = kept["settled"]
        for k, force in kept["forces"]:
            self.on_step(force, k)
        self.restore(kept["state"])

    # -- controls -----------------------------------------------------------------------------------------------------

    def _index(self, instrument: Union[int, str]) -> int:
        if isinstance(instrument, str):
            if instrument not in self._names:
                raise Error(f"instrument: got \"{instrument}\"; expected one of {', '.join(self._names)}", 2)
            return self._names.index(instrument)
        k = int(instrument)
        if not 0 <= k < len(self._names):
            raise Error(f"instrument: got {k}; expected 0 to {len(self._names) - 1}", 2)
        return k

    def _targets(self, control: Any) -> tuple[np.ndarray, np.ndarray]:
        wires = len(self._names)
        if isinstance(control, Control):
            control = control.targets
        targets, moves = np.zeros((wires, 2)), np.zeros(wires, bool)
        if isinstance(control, Mapping):
            for name, to in control.items():
                k = self._index(name)
                targets[k], moves[k] = _reals(to, (2,)), True
            return targets, moves
        given = np.asarray(control)
        if given.shape == (2,):
            given = given.reshape(1, 2)
        _reals(given, (given.shape[0] if given.ndim == 2 else wires, 2))
        if not 1 <= given.shape[0] <= wires:
            raise ValueError(f"control: got shape {np.shape(control)}; expected (2,) or ({wires}, 2)")
        targets[: len(given)], moves[: len(given)] = given, True
        return targets, moves


def _reals(x: Any, shape: tuple[int, ...], what: str = "advance [m], turn [rad]") -> np.ndarray:
    a = np.asarray(x)
    if a.dtype.kind not in "fiu":
        raise TypeError(f"control: got {a.dtype}; expected numbers")
    if a.shape != shape:
        raise ValueError(f"control: got shape {a.shape}; expected {shape}: {what}")
    if not np.isfinite(a).all():
        raise ValueError(f"control: got {a.tolist()}; expected finite numbers")
    return a.astype(np.float64)


def _count(n: Any) -> int:
    if isinstance(n, bool) or int(n) != n or n < 1:
        raise ValueError(f"n: got {n}; expected a whole number of steps, 1 or more")
    return int(n)
