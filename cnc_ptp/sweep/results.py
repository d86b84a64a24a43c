"""Variants and what has become of them; which are the best."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np

from cnc_ptp.parameters.declare.declarations import ParameterValue
from cnc_ptp.sweep.goals import Goal


class Variant(NamedTuple):
    """Values in the order of the variations."""

    number: int
    values: tuple[ParameterValue, ...]


class Row(NamedTuple):
    """A variant and what has become of it. A failed one has an error number and text, and nan as its goals."""

    number: int
    values: tuple[ParameterValue, ...]
    goals: tuple[float, ...]
    error: int = 0
    message: str = ""


class Results(NamedTuple):
    """A sweep that is finished: names of what varied, goals, a row for each variant in the order of their numbers."""

    names: Sequence[str]
    goals: Sequence[Goal]
    rows: Sequence[Row]

    @property
    def sound(self) -> list[Row]:
        return [row for row in self.rows if not row.error]

    @property
    def failed(self) -> list[Row]:
        return [row for row in self.rows if row.error]

    def best(self, place: int) -> Row | None:
        """The variant with the best value of a goal, the first of several; None if all have failed."""
        sign = self.goals[place].sign
        return min(self.sound, key=lambda row: (sign * row.goals[place], row.number), default=None)

    def pareto_front(self) -> list[Row]:
        """The variants that no other one beats: at least as good in every goal and better in one."""
        sound = self.sound
        signs = np.array([goal.sign for goal in self.goals])
        values = np.array([row.goals for row in sound]).reshape(len(sound), len(signs)) * signs
        return [row for row, own in zip(sound, values, strict=True) if not _beaten(own, values)]


def _beaten(own: np.ndarray, values: np.ndarray) -> bool:
    return bool(((values <= own).all(axis=1) & (values < own).any(axis=1)).any())


def by_number(rows: Iterable[Row]) -> list[Row]:
    return sorted(rows, key=lambda row: row.number)
