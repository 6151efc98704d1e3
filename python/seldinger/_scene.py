"""Scenes: files, names of those that come with the package, dicts."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Union

from . import _toml
from ._errors import Error

SceneLike = Union[str, "os.PathLike[str]", Mapping[str, Any], "Scene"]


def assets() -> Path:
    """The folder of scenes and instruments that come with the package ($SELDINGER_ASSETS, else beside it).

    >>> import seldinger
    >>> (seldinger.assets() / "scenes" / "aortic-arch.toml").is_file()
    True
    """
    return Path(os.environ["SELDINGER_ASSETS"])


class Scene:
    """A scene as text, with the folder for its relative paths.

    Parameters
    ----------
    scene : str, path, dict or Scene
        A name of the package ("aortic-arch"), a file, TOML text (with a line break), or the same as a dict.
    set : list of str
        Overrides as in the command's --set, "table.key=value".
    **overrides
        The same as keywords: `contact__mu_sliding=0.1` or `**{"contact.mu_sliding": 0.1}`; with Python values.

    Examples
    --------
    >>> import seldinger
    >>> seldinger.Scene("swing", wire__nodes=21).overrides
    ['wire.nodes=21']
    """

    def __init__(self, scene: SceneLike, *, set: Sequence[str] = (), **overrides: Any) -> None:
        earlier: list[str] = []
        if isinstance(scene, Scene):
            self.text, self.file, earlier = scene.text, scene.file, scene.overrides
        elif isinstance(scene, Mapping):
            self.text, self.file = _toml.document(scene), str(Path.cwd() / "scene.toml")
        elif isinstance(scene, str) and "\n" in scene:
            self.text, self.file = scene, str(Path.cwd() / "scene.toml")
        elif isinstance(scene, (str, os.PathLike)):
            self.file = str(_find(scene))
            try:
                self.text = Path(self.file).read_text(encoding="utf-8")
            except (OSError, UnicodeDecodeError) as why:
                raise Error(f"{scene}: {getattr(why, 'strerror', None) or why}; expected a scene file, or one of "
                            f"{', '.join(scene_names())}", 3) from None
        else:
            raise TypeError(f"scene: got {type(scene).__name__}; expected a name, a path, a dict or a Scene")
        self.overrides: list[str] = [*earlier, *_toml.overrides(overrides, set)]

    def __repr__(self) -> str:
        return f"Scene({self.file!r}, set={self.overrides!r})"


def scene_names() -> list[str]:
    """Names of the scenes that come with the package.

    >>> import seldinger
    >>> "aortic-arch" in seldinger.scene_names()
    True
    """
    folder = assets() / "scenes"
    return sorted({p.stem for p in folder.glob("*.toml")} | {p.stem for p in (folder / "reference").glob("*.toml")})


def _find(name: str | os.PathLike[str]) -> Path:
    path = Path(name)
    if path.exists() or path.suffix == ".toml" or path.is_absolute() or ".." in path.parts:
        return path
    for folder in ("", "reference"):
        place = assets() / "scenes" / folder / f"{path}.toml"
        if place.is_file():
            return place
    return path
