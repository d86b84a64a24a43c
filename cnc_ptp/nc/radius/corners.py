"""How the centre of the tool gets from one element of the contour to the next.

In an inner corner the parallels of both elements cross. Around an outer corner they do not meet: with an arc (G26) the
tool rolls around the corner; with straight lines (G25) it continues in the direction of the element and comes from that
of the next one, to the point where both directions cross, or past a corner of more than 90° by a straight line between
points that are one radius away from the elements.
"""

from __future__ import annotations

from itertools import pairwise
from math import pi, tan
from typing import Final

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


def corner_turn(before: Shape, behind: Shape, left: float) -> float:
    """Change of direction between two elements, radians: above 0 where the corner is an outer one for the tool.

    `left`: distance of the tool's centre to the left of the contour, mm.
    """
    turn = turn_between(before.last_direction, behind.first_direction)
    if abs(turn) > OPPOSITE:
        bends_towards_tool = (before.curvature + behind.curvature) * left >= 0.0
        return abs(turn) if bends_towards_tool else -abs(turn)
    return -turn if left > 0.0 else turn


def is_joined(turn: float, left: float) -> bool:
    """Whether the direction changes so little that the parallels meet."""
    return abs(turn * left) < JOINED and abs(turn) < pi / 4.0


def join(before: Shape, behind: Shape, corner: Point, turn: float, left: float) -> tuple[Shape, Shape]:
    """The parallels of two elements with one point between them: that on the line that halves the angle."""
    half = -turn / 2.0 if left > 0.0 else turn / 2.0
    direction = before.last_direction
    point = ahead_of(left_of(corner, direction, left), direction, -left * tan(half))
    return moved_end(before, point), moved_start(behind, point)


def around_by_arc(before: Shape, corner: Point, turn: float, left: float) -> Shape:
    """The tool rolls around the corner."""
    return arc_through(corner, before.end, -turn if left > 0.0 else turn)


def around_by_lines(
    before: Shape, behind: Shape, corner: Point, turn: float, left: float
) -> tuple[Shape, list[Shape], Shape]:
    """Lines in place of the arc: the parallels, longer if they are lines, and what is between them."""
    radius = abs(left)
    past = turn > RIGHT_ANGLE
    way = radius if past else radius * tan(turn / 2.0)
    points = [ahead_of(before.end, before.last_direction, way)]
    if past:
        points.append(ahead_of(behind.start, behind.first_direction, -way))
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
