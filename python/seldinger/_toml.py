"""Python values as TOML: scenes given as dicts, values of overrides."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Mapping, Sequence
from numbers import Integral, Real
from typing import Any

import numpy as np


def value(x: Any, where: str = "value") -> str:
    """A value as TOML on one line."""
    if isinstance(x, (bool, np.bool_)):
        return "true" if x else "false"
    if isinstance(x, Integral):
        return str(int(x))
    if isinstance(x, Real):
        if not math.isfinite(x):
            raise ValueError(f"{where}: got {x}; expected a finite number")
        text = repr(float(x))
        return text if any(c in text for c in ".en") else text + ".0"
    if isinstance(x, (str, os.PathLike)):
        return json.dumps(os.fspath(x), ensure_ascii=False)
    if isinstance(x, Mapping):
        return "{" + ", ".join(f"{json.dumps(str(k))} = {value(v, f'{where}.{k}')}" for k, v in x.items()) + "}"
    if isinstance(x, np.ndarray):
        return value(x.tolist(), where)
    if isinstance(x, Sequence):
        return "[" + ", ".join(value(v, f"{where}[{i}]") for i, v in enumerate(x)) + "]"
    raise TypeError(f"{where}: got {type(x).__name__}; expected bool, int, float, str, list, dict or array")


def document(scene: Mapping[str, Any]) -> str:
    """A whole scene: one line a key, tables in line below the top."""
    lines, tables = [], []
    for key, entry in scene.items():
        if isinstance(entry, Mapping):
            tables.append(f"[{json.dumps(str(key))}]")
            tables += [f"{json.dumps(str(k))} = {value(v, f'{key}.{k}')}" for k, v in entry.items()]
        else:
            lines.append(f"{json.dumps(str(key))} = {value(entry, str(key))}")
    return "\n".join(lines + tables) + "\n"


def overrides(keywords: Mapping[str, Any], texts: Sequence[str] = ()) -> list[str]:
    """Texts of --set, then keywords: "table.key" or table__key."""
    if isinstance(texts, str):
        raise TypeError(f'set: got the text "{texts}"; expected a list of texts, ["table.key=value", ...]')
    return [str(t) for t in texts] + [f"{key.replace('__', '.')}={value(x, key)}" for key, x in keywords.items()]
