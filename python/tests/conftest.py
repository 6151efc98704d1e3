"""Where scenes are, and the command, for tests that compare with it."""

import os
import shutil
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def command():
    """The command's path: of the build that ctest runs in, or `build/`."""
    for place in (os.environ.get("SELDINGER_COMMAND"), ROOT / "build" / "seldinger", ROOT / "build-python" / "seldinger"):
        if place and Path(place).is_file():
            return str(place)
    found = shutil.which("seldinger")
    if not found:
        pytest.skip("the command is not built: ninja -C build seldinger_app")
    return found
