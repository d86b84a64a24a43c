"""Parts of the path that are run through without a stop, and the cells into which the velocity planner divides them."""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil, inf, sqrt
from typing import Final, NamedTuple, Protocol

from cnc_ptp.motion.limits import LARGEST_LIMIT
from cnc_ptp.path.geometry import AxisLimits
from cnc_ptp.path.lookahead.path_cell import AxisLoad, PathCell, largest_square
from cnc_ptp.path.shape import AxisState, Bounds, Shape

CELL_TIME: Final = 0.004
"""s that a cell takes at most at the largest velocity."""
FIRST_CELL_TIME: Final = 0.005
"""s from rest with full jerk in the first cell of a straight part; the cells grow from there."""
GROWTH: Final = 1.6
MOST_END_CELLS: Final = 20
"""A first cell is at least the length of its part divided by this."""
CELL_TURN: Final = 0.1
"""rad by which the direction may turn in a cell; of an axis with a larger q1, part of that by which it may change."""


class Geometry(Protocol):
    """What a part of the path has to offer, by its parameter u from 0 to `length`."""

    @property
    def length(self) -> float: ...

    def shape(self, u: float) -> list[Shape]: ...

    def bounds(self, begin: float, end: float) -> list[Bounds]: ...

    def speed(self, u: float, axes: Sequence[int]) -> float: ...

    def largest_speed(self, begin: float, end: float, axes: Sequence[int]) -> float: ...

    def evaluate(self, u: float, v: float, a: float, j: float) -> tuple[AxisState, ...]: ...


class PathPart:
    """A part of the path with what it is run through with.

    axes   limits of the axes of the channel in this part
    feed   mm/s at override 1; inf in rapid traverse, where the override acts on what the axes permit
    block  number of the program block within the path, from 0
    entry  largest y = u'² at its start; 0 is an exact stop
    transformed  its geometry is that of axes behind kinematics, one of them in degrees
    quiet  mm at its start and at its end in which kinks that are passed need a share of what the axes permit
    """

    __slots__ = (
        "axes", "block", "entry", "feed", "geometry", "length", "path_axes", "quiet", "quiet_axes", "transformed",
    )  # fmt: skip

    def __init__(
        self,
        geometry: Geometry,
        axes: Sequence[AxisLimits],
        path_axes: Sequence[int],
        feed: float,
        block: int,
        entry: float = inf,
        quiet: tuple[float, float] = (0.0, 0.0),
        quiet_axes: Sequence[AxisLimits] = (),
        *,
        transformed: bool = False,
    ) -> None:
        """`quiet_axes`: limits there."""
        self.geometry, self.axes, self.path_axes = geometry, axes, path_axes
        self.feed, self.block, self.entry = feed, block, entry
        self.length = geometry.length
        self.transformed = transformed
        self.quiet, self.quiet_axes = quiet, quiet_axes

    def limits(self, begin: float, end: float) -> Sequence[AxisLimits]:
        """Of the axes from `begin` to `end`."""
        return self.quiet_axes if begin < self.quiet[0] or end > self.length - self.quiet[1] else self.axes


def cell_of(part: PathPart, origin: float, begin: float, end: float) -> PathCell:
    """What the part permits from `begin` to `end`; `origin`: u of the path at which the part begins."""
    geometry, axes = part.geometry, part.limits(begin, end)
    bounds = geometry.bounds(begin, end)
    curved = False
    limit = up = down = jerk = LARGEST_LIMIT
    for index, (first, second, third) in enumerate(bounds):
        axis = axes[index]
        curved = curved or second > 0.0 or third > 0.0
        if first > 0.0:
            limit = min(limit, (axis.velocity / first) ** 2)
            up = min(up, axis.acceleration / first)
            down = min(down, axis.deceleration / first)
            jerk = min(jerk, axis.jerk / first)
    loads: list[AxisLoad] = []
    if curved:
        loads = loads_of(part, axes, bounds, 0.5 * (begin + end), 0.5 * (end - begin))
        limit = min(limit, largest_square(loads))
    if begin == 0.0 and part.entry > 0.0:
        limit = min(limit, part.entry)
    speed = geometry.largest_speed(begin, end, part.path_axes)
    feed = limit if part.feed == inf else (part.feed / (speed or 1.0)) ** 2  # the path of other axes is their own
    return PathCell(origin + begin, origin + end, limit, feed, up, down, jerk, loads)


def loads_of(
    part: PathPart, axes: Sequence[AxisLimits], bounds: list[Bounds], middle: float, half: float
) -> list[AxisLoad]:
    """For each axis that the path moves in a cell.

    Where the sign of q1 changes in the cell, q2 and q3 count for both signs. q3 of a cubic piece is the same
    everywhere; of other parts only its size is known.
    """
    loads: list[AxisLoad] = []
    for index, (_, direction, bend, twist) in enumerate(part.geometry.shape(middle)):
        first, second, third = bounds[index]
        if first == 0.0 and second == 0.0:
            continue
        sign = 1.0 if direction > 0.0 else -1.0
        least, spread, wring = abs(direction) - second * half, third * half, 0.0
        if least <= 0.0:
            least, bend, spread = 0.0, 0.0, second
        if least <= 0.0 or abs(twist) < third:
            twist, wring = 0.0, third
        load = AxisLoad(
            first=first,
            least=least,
            second=second,
            third=third,
            bend=sign * bend,
            spread=spread,
            twist=sign * twist,
            wring=wring,
            limits=axes[index],
        )
        loads.append(load)
    return loads


def whole_cell(part: PathPart) -> PathCell:
    """What all of a part permits."""
    return cell_of(part, 0.0, 0.0, part.length)


class Division(NamedTuple):
    """How a part is divided into cells: those of `head`, then `equal` ones of the same length, then those of `tail`.

    `head`, `tail`: ends of their cells, mm from the start of the part.
    """

    head: list[float]
    equal: int
    begin: float
    length: float
    tail: list[float]

    @property
    def cells(self) -> int:
        """All of them."""
        return len(self.head) + self.equal + len(self.tail)

    def end(self, index: int) -> float:
        """Where a cell ends; -1 is the start of the first one."""
        if index < len(self.head):
            return self.head[index] if index >= 0 else 0.0
        index -= len(self.head)
        if index < self.equal - 1:
            return self.begin + self.length * (index + 1) / self.equal
        if index == self.equal - 1:
            return self.begin + self.length  # exactly: the path ends where the last cell does
        return self.tail[index - self.equal]


def division_of(part: PathPart, whole: PathCell, fewest: int = 1, cell_time: float = CELL_TIME) -> Division:
    """The cells of a part (`whole`: its whole_cell), at least `fewest`; short ones at both ends of a straight part.

    `cell_time`: s that a cell may take at the largest velocity.
    """
    length = part.length
    largest = min(cell_time * sqrt(min(whole.limit, whole.feed)), length / fewest)
    turn = sqrt(sum([(load.second / max(1.0, load.first)) ** 2 for load in whole.loads]))
    if turn > 0.0:
        return Division([], max(1, ceil(length / min(largest, CELL_TURN / turn))), 0.0, length, [])
    smallest = max(length / MOST_END_CELLS, whole.jerk * FIRST_CELL_TIME**3 / 6.0)
    return graded(length, min(smallest, largest), largest)


def graded(length: float, smallest: float, largest: float) -> Division:
    """Cells that grow from both ends of a part to its middle, up to the largest."""
    half: list[float] = []
    place, cell = 0.0, smallest
    while place + cell < 0.5 * length and cell < largest:
        place += cell
        half.append(place)
        cell *= GROWTH
    between = length - 2.0 * place
    count = max(1, ceil(between / min(cell, largest)))
    tail = [length - place for place in reversed(half[:-1])] + ([length] if half else [])
    return Division(half, count, place, between, tail)


class UndividedPart:
    """What is left of a part that is divided into cells as they are needed.

    part, origin   the part, and u of the path at which it begins
    """

    def __init__(self, part: PathPart, origin: float, division: Division) -> None:
        self.part, self.origin = part, origin
        self._division = division
        self._next = 0

    @property
    def cells(self) -> int:
        """All cells of the part."""
        return self._division.cells

    @property
    def begun(self) -> bool:
        """Some of its cells have been taken."""
        return self._next > 0

    @property
    def empty(self) -> bool:
        """All of its cells have been taken."""
        return self._next >= self._division.cells

    def take(self, most: int) -> list[PathCell]:
        """The next cells, at most so many."""
        cells: list[PathCell] = []
        begin = self._division.end(self._next - 1)
        last = min(self._next + most, self._division.cells)
        while self._next < last:
            end = self._division.end(self._next)
            cells.append(cell_of(self.part, self.origin, begin, end))
            begin = end
            self._next += 1
        return cells
