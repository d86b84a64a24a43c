"""What takes long together: `make test LONG=1` runs it, `make test` does not."""

from collections.abc import Collection, Iterable, Sequence
from typing import Any

import pytest

SHORT = False
"""Whether tests with the mark are left out: conftest says so before it imports a test."""


def long(values: Iterable[Any]) -> list[Any]:
    """Parameters of a test, each with the mark."""
    return [pytest.param(value, marks=pytest.mark.long) for value in values]


def long_sets(sets: Iterable[Sequence[Any]]) -> list[Any]:
    """Sets of values for several parameters, each with the mark."""
    return [pytest.param(*values, marks=pytest.mark.long) for values in sets]


def long_but(values: Iterable[Any], short: Collection[Any]) -> list[Any]:
    """Parameters of a test in their order, each with the mark but those that are in `short`."""
    values = [*values]
    if missing := [each for each in short if each not in values]:
        raise ValueError(f"{missing} are no parameters: nothing of the test would be short")
    return [value if value in short else long([value])[0] for value in values]


def examples(count: int) -> int:
    """How many of a property that is tested at random; without long tests a third."""
    return count // 3 if SHORT else count
