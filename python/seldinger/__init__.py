"""Guidewires pushed, pulled and turned inside blood vessels.

>>> import seldinger
>>> world = seldinger.World("aortic-arch", wire__nodes=101)
>>> report = world.step([0.01, 0.0], n=200)                 # advance [m], turn [rad]; 200 steps of world.dt
>>> world.output.nodes.shape[1], world.output.hand_force < 1.0
(3, True)
"""

from __future__ import annotations

import os as _os
from pathlib import Path as _Path


def _check_processor() -> None:
    built_for = (_Path(__file__).parent / "_processor.txt")
    wanted = set(built_for.read_text().split()) if built_for.is_file() else set()
    if not wanted or not _os.path.exists("/proc/cpuinfo"):
        return
    with open("/proc/cpuinfo", encoding="ascii", errors="replace") as info:
        here = next((set(line.split(":", 1)[1].split()) for line in info if line.startswith("flags")), wanted)
    if wanted - here:
        raise ImportError("seldinger was built for a processor with " + ", ".join(sorted(wanted - here)) + ", which this one does "
                          "not have; install it here, or with: pip install . -C cmake.define.SELDINGER_NATIVE=OFF")


def _check_interpreter() -> None:
    # pybind11 asks for the lock of the main interpreter as it is loaded, and would wait for ever for it
    try:
        import _interpreters as interpreters  # Python 3.13
    except ImportError:
        try:
            import _xxsubinterpreters as interpreters
        except ImportError:
            return
    if interpreters.get_current() != interpreters.get_main():
        raise ImportError("seldinger cannot be imported in a subinterpreter. Fix: import it in the main one, or in a process of its own "
                          "(multiprocessing's \"spawn\"; with mod_wsgi: WSGIApplicationGroup %{GLOBAL})")


_check_processor()
_check_interpreter()
_os.environ.setdefault("SELDINGER_ASSETS", str(_Path(__file__).parent / "assets"))

from ._opencl import find_opencl as _find_opencl  # noqa: E402

_find_opencl()

from . import _engine  # noqa: E402
from ._engine import InstrumentOutput, Output, State  # noqa: E402
from ._errors import Error  # noqa: E402
from ._force import Force, Points  # noqa: E402
from ._runs import Run, load_run  # noqa: E402
from ._studies import batch, chart, plan, sweep  # noqa: E402
from ._scene import Scene, assets, scene_names  # noqa: E402
from ._world import Control, StepReport, World  # noqa: E402

_engine.set_error(Error)
for _class in (InstrumentOutput, Output, State):
    _class.__module__ = "seldinger"
__version__: str = _engine.version()


def devices() -> list[str]:
    """Names of the OpenCL devices, by the number that `World(device=...)` takes.

    >>> import seldinger
    >>> len(seldinger.devices()) > 0
    True
    """
    return [name for name, _ in _engine.devices()]


__all__ = ["Control", "Error", "Force", "InstrumentOutput", "Output", "Points", "Run", "Scene", "State", "StepReport", "World", "assets", "batch", "chart",
           "devices", "load_run", "plan", "scene_names", "sweep"]
