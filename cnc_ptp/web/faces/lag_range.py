"""Smallest and largest lag between two states of an axis: of each cycle, not only of those that pages see."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from cnc_ptp.protocol.blocks import AxisBlock, CycleBlock
from cnc_ptp.web.faces.unit_fields import shown


def lag_ranges(blocks: Iterable[tuple[str, CycleBlock]]) -> Mapping[str, Mapping[str, float]]:
    """Axis -> `lag_low`, `lag_high` (mm, deg) in its blocks."""
    ranges: dict[str, tuple[float, float]] = {}
    for axis, block in blocks:
        if isinstance(block, AxisBlock):
            low, high = ranges.get(axis, (float("inf"), float("-inf")))
            ranges[axis] = min(low, *block.following_error), max(high, *block.following_error)
    return {axis: {"lag_low": shown(low), "lag_high": shown(high)} for axis, (low, high) in ranges.items()}
