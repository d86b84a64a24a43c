"""Parts of the path that are run through without a stop, and the nodes that the velocity planner needs of them.

A node stands between two cells. What it permits holds for the half cells on both of its sides.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil, inf, sqrt
from typing import Final, Protocol

from cnc_ptp.motion.limits import LARGEST_LIMIT
from cnc_ptp.path.geometry import AxisLimits
from cnc_ptp.path.lookahead.nodes import AxisLoad, PathNode, largest_square
from cnc_ptp.path.shape import AxisState, Shape

CELL_TIME: Final = 0.004
"""s that a cell may take at the largest velocity."""
FIRST_CELL_TIME: Final = 0.005
"""s from rest with full jerk in the first cell of a straight part; the cells grow from there."""
GROWTH: Final = 1.6
MOST_END_CELLS: Final = 20
"""A first cell is at least the length of its part divided by this."""
CELL_TURN: Final = 0.1
"""rad by which the direction may turn in a cell."""


class Geometry(Protocol):
    """What a part of the path has to offer, by its parameter u from 0 to `length`."""

    @property
    def length(self) -> float: ...

    def shape(self, u: float) -> list[Shape]: ...

    def bounds(self, begin: float, end: float) -> list[tuple[float, float, float]]: ...

    def speed(self, u: float, axes: Sequence[int]) -> float: ...

    def evaluate(self, u: float, v: float, a: float, j: float) -> tuple[AxisState, ...]: ...


class PathPart:
    """A part of the path with what it is run through with.

    axes   limits of the axes of the channel in this part
    feed   mm/s at override 1; inf in rapid traverse, where the override acts on what the axes permit
    block  number of the program block within the path, from 0
    entry  largest y = u'² at its begin
    """

    __slots__ = ("axes", "block", "entry", "feed", "geometry", "length", "path_axes")

    def __init__(
        self,
        geometry: Geometry,
        axes: Sequence[AxisLimits],
        path_axes: Sequence[int],
        feed: float,
        block: int,
        entry: float = inf,
    ) -> None:
        self.geometry, self.axes, self.path_axes = geometry, axes, path_axes
        self.feed, self.block, self.entry = feed, block, entry
        self.length = geometry.length


class HalfCell:
    """What half a cell permits: of a straight part at once, of a curved one for each axis.

    `node`: u of the part at the node to which the half cell belongs, `end` its other end.
    """

    __slots__ = ("bounds", "curved", "down", "feed", "jerk", "limit", "node", "part", "up", "width")

    def __init__(self, part: PathPart, node: float, end: float) -> None:
        self.part, self.node, self.width = part, node, abs(end - node)
        self.bounds = part.geometry.bounds(min(node, end), max(node, end))
        self.curved = False
        self.limit = self.up = self.down = self.jerk = LARGEST_LIMIT
        for (first, second, third), axis in zip(self.bounds, part.axes, strict=True):
            if second > 0.0 or third > 0.0:
                self.curved = True
            if first > 0.0:
                self.limit = min(self.limit, (axis.velocity / first) ** 2)
                self.up = min(self.up, axis.acceleration / first)
                self.down = min(self.down, axis.deceleration / first)
                self.jerk = min(self.jerk, axis.jerk / first)
        speed = max(part.geometry.speed(node, part.path_axes), part.geometry.speed(end, part.path_axes))
        self.feed = (part.feed / speed) ** 2 if speed > 0.0 and part.feed < inf else inf


def node_between(u: float, before: HalfCell, after: HalfCell) -> PathNode:
    """The node at u of the path with the half cells on its two sides."""
    limit = min(before.limit, after.limit)
    loads: list[AxisLoad] = []
    if before.curved or after.curved:
        loads = loads_between(before, after)
        limit = min(limit, largest_square(loads))
    feed = min(limit if before.feed == inf else before.feed, limit if after.feed == inf else after.feed)
    up, down, jerk = min(before.up, after.up), min(before.down, after.down), min(before.jerk, after.jerk)
    return PathNode(u, limit, feed, up, down, jerk, loads)


def loads_between(before: HalfCell, after: HalfCell) -> list[AxisLoad]:
    """For each axis that the path moves around a node.

    Where the sign of q1 is not certain, the bend counts for both signs.
    """
    loads: list[AxisLoad] = []
    shape = before.part.geometry.shape(before.node)
    behind = shape if after.part is before.part else after.part.geometry.shape(after.node)
    for index, (_, direction, bend, _) in enumerate(shape):
        first0, second0, third0 = before.bounds[index]
        first1, second1, third1 = after.bounds[index]
        first, second, third = max(first0, first1), max(second0, second1), max(third0, third1)
        if first == 0.0 and second == 0.0:
            continue
        spread = max(third0 * before.width, abs(behind[index][2] - bend) + third1 * after.width)
        if abs(direction) <= second * max(before.width, after.width):
            bend, spread = 0.0, second
        one, other = before.part.axes[index], after.part.axes[index]
        acceleration = min(one.acceleration, one.deceleration, other.acceleration, other.deceleration)
        velocity, jerk = min(one.velocity, other.velocity), min(one.jerk, other.jerk)
        signed = bend if direction > 0.0 else -bend
        loads.append(AxisLoad(first, second, third, signed, spread, velocity, acceleration, jerk))
    return loads


def cells(part: PathPart) -> list[float]:
    """Where the cells of a part end, the last at its length; short ones at both ends of a straight part."""
    length = part.length
    whole = HalfCell(part, 0.0, length)
    largest = CELL_TIME * sqrt(min(whole.limit, whole.feed))
    turn = max(sqrt(sum([second * second for _, second, _ in whole.bounds])), 0.0)
    if turn > 0.0:
        largest = min(largest, CELL_TURN / turn)
        count = max(1, ceil(length / largest))
        return [length * (index + 1) / count for index in range(count)]
    smallest = max(length / MOST_END_CELLS, whole.jerk * FIRST_CELL_TIME**3 / 6.0)
    return graded(length, min(smallest, largest), largest)


def graded(length: float, smallest: float, largest: float) -> list[float]:
    """Ends of cells that grow from both ends of a part to its middle, up to the largest."""
    half: list[float] = []
    place, cell = 0.0, smallest
    while place + cell < 0.5 * length and cell < largest:
        place += cell
        half.append(place)
        cell *= GROWTH
    between = length - 2.0 * place
    count = max(1, ceil(between / min(cell, largest)))
    middle = [place + between * (index + 1) / count for index in range(count)]
    return half + middle + [length - place for place in reversed(half[:-1])] + ([length] if half else [])
