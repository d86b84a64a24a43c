"""The cells of a part lie side by side and end exactly where it ends: else a path would wait for its end for ever."""

from __future__ import annotations

import random
from itertools import pairwise
from math import inf

import pytest
from long_support import long

from cnc_ptp.path.geometry import AxisLimits, Line
from cnc_ptp.path.lookahead.parts import PathPart, UndividedPart, division_of, whole_cell
from cnc_ptp.path.lookahead.spans import whole

LIMITS = [AxisLimits(200.0, 2000.0, 2400.0, 40000.0)] * 3


@pytest.mark.parametrize("fewest", [1, *long([3])])
def test_cells_end_exactly_with_their_part(fewest: int) -> None:
    numbers = random.Random(15)
    for _ in range(300):
        begin = tuple(numbers.uniform(-50.0, 50.0) for _ in range(3))
        target = tuple(place + numbers.uniform(-40.0, 40.0) * numbers.random() ** 4 for place in begin)
        part = PathPart(
            whole(Line(begin, target, {0, 1, 2}), 0), LIMITS, [0, 1, 2], numbers.choice([5.0, 100.0, inf]), 0
        )
        origin = numbers.uniform(0.0, 1000.0)
        waiting = UndividedPart(part, origin, division_of(part, whole_cell(part), fewest))
        cells = []
        while not waiting.empty:
            cells += waiting.take(7)
        assert len(cells) >= fewest
        assert cells[0].begin == origin and cells[-1].end == origin + part.length
        assert all(one.end == other.begin for one, other in pairwise(cells))
