"""Where the axes are on a Cartesian motion (#FACE, #CYL), for soft limits and the centre of rotation."""

from __future__ import annotations

from collections.abc import Sequence
from math import atan2, cos, hypot, sin
from typing import Final

from cnc_ptp.kinematics.face import CENTRE, Face
from cnc_ptp.kinematics.kinematics import Kinematics, Point
from cnc_ptp.nc import c_axis_faults as own
from cnc_ptp.nc.arcs import extreme_points
from cnc_ptp.nc.canonical import CircularMove, LinearMove, Source

TURN: Final = 6.283185307179586
"""rad."""


def machine_points(start: Point, motion: LinearMove | CircularMove, source: Source) -> list[Point]:
    """Machine positions between which a motion from `start` (Cartesian) moves the axes.

    Raises ProgramError 21755 for a way through the centre.
    """
    kinematics = motion.kinematics
    assert kinematics is not None
    points = [start, motion.target, *centre_points(kinematics, start, motion)]
    if isinstance(motion, CircularMove):
        points += extreme_points(start, motion)
    if isinstance(kinematics, Face):
        _require_way(kinematics, source, motion, points)
    return [kinematics.inverse(point, kinematics.origin) for point in points]


def _require_way(face: Face, source: Source, motion: LinearMove | CircularMove, points: Sequence[Point]) -> None:
    """A line through the centre needs X to pass it, an arc through it has no angle there."""
    start, target, *between = [hypot(point[face.x], point[face.c]) for point in points]
    if isinstance(motion, LinearMove) and (face.through or min(start, target) < CENTRE):
        return
    if min(start, target, *between) < CENTRE:
        raise own.THROUGH_CENTRE.at(source, 1, command=face.name)


def centre_points(kinematics: Kinematics, start: Point, motion: LinearMove | CircularMove) -> list[Point]:
    """Points of a motion that are nearest to the centre of its plane, and farthest from it."""
    first, second = kinematics.plane
    points = (
        [part_of_arc(motion, start, outwards) for outwards in (False, True)]
        if isinstance(motion, CircularMove)
        else [part_of_line(start, motion.target, first, second)]
    )
    return [_moved(start, kinematics.plane, point) for point in points if point is not None]


def part_of_line(start: Point, target: Point, first: int, second: int) -> tuple[float, float] | None:
    """The foot of the perpendicular from the centre, if it is on the line."""
    x, y = start[first], start[second]
    dx, dy = target[first] - x, target[second] - y
    square = dx * dx + dy * dy
    part = -(x * dx + y * dy) / square if square > 0.0 else 0.0
    return (x + part * dx, y + part * dy) if 0.0 < part < 1.0 else None


def part_of_arc(motion: CircularMove, start: Point, outwards: bool) -> tuple[float, float] | None:
    """The point of the circle on the way from the centre to that of the circle, or behind it, if the arc has it."""
    (x, y), (first, second) = motion.center, motion.plane
    if hypot(x, y) < CENTRE:
        return None
    angle = atan2(y, x) if outwards else atan2(-y, -x)
    begin = atan2(start[second] - y, start[first] - x)
    turned = (angle - begin) if motion.sweep > 0.0 else (begin - angle)
    if turned % TURN > abs(motion.sweep) / 360.0 * TURN:
        return None
    return x + motion.radius * cos(angle), y + motion.radius * sin(angle)


def _moved(start: Point, plane: tuple[int, int], point: tuple[float, float]) -> Point:
    moved = list(start)
    moved[plane[0]], moved[plane[1]] = point
    return tuple(moved)
