"""How the centre of the tool gets from one element of the contour to the next.

In an inner corner the parallels of both elements cross. Around an outer corner they do not meet: with an arc (G26) the
tool rolls around the corner; with straight lines (G25) it continues in the direction of the element and comes from that
of the next one, to the point where both directions cross, or past a corner of more than 90° by a straight line between
points that are one radius away from the elements.
"""

from __future__ import annotations

from itertools import pairwise
from math import pi, tan
from typing import Final, NamedTuple

from cnc_ptp.nc.radius.shapes import Line, Point, Shape, Vector, arc_through, moved_end, moved_start, turn_between

JOINED: Final = 1e-4
"""mm: parallels whose ends are nearer than this (the vendor's position increment) are joined without a corner."""
RIGHT_ANGLE: Final = pi / 2.0 + 1e-9
OPPOSITE: Final = pi - 1e-6
"""Change of direction (radians) from which on a contour leads back: what the corner is depends on how it bends there,
along itself it is an outer one on either side.
"""


def left_of(point: Point, direction: Vector, left: float) -> Point:
    """The point at this distance to the left of a direction."""
    return point[0] - direction[1] * left, point[1] + direction[0] * left


def ahead_of(point: Point, direction: Vector, way: float) -> Point:
    return point[0] + direction[0] * way, point[1] + direction[1] * way


class Corner(NamedTuple):
    """Where two elements meet: the directions of motion there, and how much the second turns (radians).

    turn   above 0 where the corner is an outer one for the tool, below 0 where it is an inner one
    left   distance of the tool's centre to the left of the contour, mm
    """

    point: Point
    before: Vector
    behind: Vector
    turn: float
    left: float

    @property
    def is_joined(self) -> bool:
        """Whether the direction changes so little that the parallels meet."""
        return abs(self.turn * self.left) < JOINED and abs(self.turn) < pi / 4.0


def corner_between(before: Shape, behind: Shape, left: float) -> Corner:
    """The corner of two elements of the contour."""
    directions = before.last_direction, behind.first_direction
    turn = turn_between(*directions)
    outer = -turn if left > 0.0 else turn
    if abs(turn) > OPPOSITE:
        bends_towards_tool = (before.curvature + behind.curvature) * left >= 0.0
        outer = abs(turn) if bends_towards_tool else -abs(turn)
    return Corner(before.end, *directions, outer, left)


def join(before: Shape, behind: Shape, corner: Corner) -> tuple[Shape, Shape]:
    """The parallels of two elements with one point between them: that on the line that halves the angle."""
    beside = left_of(corner.point, corner.before, corner.left)
    point = ahead_of(beside, corner.before, abs(corner.left) * tan(corner.turn / 2.0))
    return moved_end(before, point), moved_start(behind, point)


def around_by_arc(before: Shape, corner: Corner) -> Shape:
    """The tool rolls around the corner."""
    return arc_through(corner.point, before.end, -corner.turn if corner.left > 0.0 else corner.turn)


def around_by_lines(before: Shape, behind: Shape, corner: Corner) -> tuple[Shape, list[Shape], Shape]:
    """Lines in place of the arc: the parallels, longer if they are lines, and what is between them."""
    past = corner.turn > RIGHT_ANGLE
    way = abs(corner.left) * (1.0 if past else tan(corner.turn / 2.0))
    points = [ahead_of(before.end, corner.before, way)]
    if past:
        points.append(ahead_of(behind.start, corner.behind, -way))
    return _longer(before, points, behind)


def _longer(before: Shape, points: list[Point], behind: Shape) -> tuple[Shape, list[Shape], Shape]:
    if isinstance(before, Line):
        before = Line(before.start, points[0])
    else:
        points = [before.end, *points]
    if isinstance(behind, Line):
        behind = Line(points[-1], behind.end)
    else:
        points = [*points, behind.start]
    between: list[Shape] = [Line(a, b) for a, b in pairwise(points)]
    return before, between, behind
