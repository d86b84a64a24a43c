"""`pytest.approx` compares value by value; for arrays and lists of a whole run that takes longer than the run."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

SEVERAL = 8
"""Fewer values are not worth an array."""


def within(approx: Any, actual: Any) -> bool:
    """Whether all values are surely within the tolerance; where not, `pytest.approx` decides and finds the words."""
    expected = approx.expected
    if not (are_numbers(actual) and (isinstance(expected, float) or are_numbers(expected))):
        return False
    found, wanted = np.asarray(actual), np.asarray(expected)
    if found.dtype != float or wanted.dtype != float or not np.isfinite(wanted).all():
        return False
    if found.shape != wanted.shape and not (isinstance(expected, float) and isinstance(actual, np.ndarray)):
        return False
    tolerance = np.full(wanted.shape, 1e-12 if approx.abs is None else approx.abs)
    if approx.rel is not None or approx.abs is None:
        tolerance = np.maximum(tolerance, (1e-6 if approx.rel is None else approx.rel) * np.abs(wanted))
    return bool((np.abs(found - wanted) <= tolerance).all())


def are_numbers(values: Any) -> bool:
    """Of an array, or of a list in which each is one: pytest does not take True for one."""
    return isinstance(values, np.ndarray) or (
        isinstance(values, list | tuple)
        and all(isinstance(value, int | float) and not isinstance(value, bool) for value in values)
    )


def compare_at_once() -> None:
    """From now on, arrays and lists of numbers are compared at once where that is enough."""
    for kind in {type(pytest.approx(expected)) for expected in (1.0, [1.0], np.ones(1))}:
        kind.__eq__ = quick(kind.__eq__)  # type: ignore[method-assign]


def count_of(values: Any) -> int:
    return int(values.size) if isinstance(values, np.ndarray) else len(values)


def quick(slow: Any) -> Any:
    def equals(self: Any, actual: Any) -> bool:
        several = isinstance(actual, list | tuple | np.ndarray) and count_of(actual) >= SEVERAL
        return (several and within(self, actual)) or slow(self, actual)

    return equals
