"""One axis over time as arrays, the input of all analyses."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
Span = tuple[int, int]
"""First index and index after the last one."""


@dataclass(frozen=True, slots=True)
class AxisTrace:
    """Columns (n,) with one value per cycle, in the order of the cycles; mm, s, N (linear) or deg, s, Nm.

    `actual_torque` is None if no torque was recorded. A row holds the drive's report before its cycle and its
    command in that cycle.
    """

    axis: str
    cycle_time: float
    cycle: npt.NDArray[np.int64]
    set_velocity: Array
    actual_position: Array
    actual_velocity: Array
    command_velocity: Array
    additive_velocity: Array
    actual_torque: Array | None
    mean_velocity: bool = False
    """The actual velocity is not the momentary one but the distance of the previous cycle by its time: so if
    the telegram carries no velocity."""

    @classmethod
    def of_rows(
        cls,
        axis: str,
        cycle_time: float,
        rows: Mapping[str, Any] | npt.NDArray[Any],
        *,
        mean_velocity: bool = False,
    ) -> AxisTrace:
        """Of the fields of AxisState messages (a mapping, or a structured array (n,)), repeated cycles once."""
        names = rows.dtype.names or () if isinstance(rows, np.ndarray) else tuple(rows)
        cycle = np.asarray(rows["cycle"]).astype(np.int64)
        order: slice | npt.NDArray[np.intp] = slice(None)
        if (cycle[1:] <= cycle[:-1]).any():
            cycle, order = np.unique(cycle, return_index=True)

        def column(name: str) -> Array:
            return np.ascontiguousarray(rows[name], dtype=np.float64)[order]

        return cls(
            axis,
            cycle_time,
            cycle,
            column("set_velocity"),
            column("actual_position"),
            column("actual_velocity"),
            column("command_velocity"),
            column("additive_velocity"),
            column("actual_torque") if "actual_torque" in names else None,
            mean_velocity,
        )

    def __len__(self) -> int:
        return len(self.cycle)

    @property
    def seconds(self) -> float:
        """Recorded time."""
        return len(self) * self.cycle_time

    def unbroken(self) -> Iterator[Span]:
        """Stretches without a missing cycle."""
        edges = np.flatnonzero(np.diff(self.cycle) != 1) + 1
        bounds = [0, *edges.tolist(), len(self)]
        return ((first, end) for first, end in pairwise(bounds) if end > first)
