"""The one exception of the engine."""

from __future__ import annotations

_NAMES = {2: "bad scene", 3: "bad file", 4: "stopped", 5: "no device", 6: "not feasible", 75: "time limit", 130: "interrupted"}


class Error(RuntimeError):
    """The command's error in one line: place, expected value, fix.

    Attributes
    ----------
    code : int
        The command's exit code (docs/command-line.md): 2 the scene or the request is wrong, 3 a file is missing or unusable, 4
        the simulation stopped, 5 no usable OpenCL device, 6 no model meets the request of `plan`.

    Examples
    --------
    >>> import seldinger
    >>> try:
    ...     seldinger.World("aortic-arch", **{"wire.nodes": -3})
    ... except seldinger.Error as error:
    ...     print(error.code, "wire.nodes" in str(error))
    2 True
    """

    code: int

    def __init__(self, message: str, code: int = 2) -> None:
        super().__init__(message)
        self.code = code

    def __reduce__(self):
        return type(self), (str(self), self.code)

    @property
    def kind(self) -> str:
        """The code in words."""
        return _NAMES.get(self.code, "error")
