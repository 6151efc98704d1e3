"""Every public name has a docstring, and its examples run."""

import doctest
import importlib

import pytest

import seldinger

MODULES = ["seldinger", "seldinger._errors", "seldinger._force", "seldinger._scene", "seldinger._world", "seldinger._studies", "seldinger.gym", "seldinger.sb3"]


@pytest.mark.parametrize("name", MODULES)
def test_examples(name):
    if name.endswith(("gym", "sb3")):
        pytest.importorskip("gymnasium", reason="gymnasium is not installed: pip install gymnasium")
    if name.endswith("sb3"):
        pytest.importorskip("stable_baselines3", reason="stable-baselines3 is not installed: pip install stable-baselines3")
    failed, tried = doctest.testmod(importlib.import_module(name))
    assert failed == 0 and tried > 0


def test_everything_public_is_described():
    for name in seldinger.__all__:
        thing = getattr(seldinger, name)
        assert thing.__doc__, name
        for member, value in vars(thing).items() if isinstance(thing, type) else ():
            if not member.startswith("_") and (callable(value) or isinstance(value, property)):
                assert value.__doc__, f"{name}.{member}"
