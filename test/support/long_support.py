"""Parameters of tests that take long together: `make test LONG=1` runs them, `make test` does not."""

from collections.abc import Iterable
from typing import Any

import pytest


def long(values: Iterable[Any]) -> list[Any]:
    """The values, each with the mark."""
    return [pytest.param(value, marks=pytest.mark.long) for value in values]
