"""Blocks of a machine as test data."""

import pytest
from recording_support import Blocks


@pytest.fixture
def blocks() -> Blocks:
    return Blocks(seed=2)
