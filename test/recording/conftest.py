"""Makes the helper module of these tests importable (pytest runs in importlib mode)."""

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))

from recording_support import Blocks


@pytest.fixture
def blocks() -> Blocks:
    return Blocks(seed=2)
