"""Geometry of arcs in a plane: centre from offsets or radius, angle swept, extreme points; mm and degrees.

Points are (first, second) coordinates of the plane; counter-clockwise is from the first towards the second axis.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

from cnc_ptp.nc.canonical import NO_PART, CircularMove
from cnc_ptp.nc.coordinates.frame import dot
from cnc_ptp.nc.degrees import cosine, sine

Point = tuple[float, float]

RESOLUTION = 1e-4
"""Points closer than this (0.1 µm, the vendor's position increment) are the same point: the arc is a full circle."""

CHORD_TOLERANCE = 1e-3
"""A chord longer than 2·R by up to twice this (mm) is a half circle whose radius the post-processor has rounded."""


class CorrectedCentre(NamedTuple):
    """Centre moved onto the perpendicular bisector of the chord: `offset` is the distance it moved (mm)."""

    centre: Point
    radius: float
    offset: float


def correct_centre(start: Point, target: Point, centre: Point) -> CorrectedCentre:
    """Nearest centre with equal radii to start and target (G165); start and target must differ.

    With chord vector c = target - start, unit vector u, midpoint m: offset t = (centre - m)·u, centre' = centre - t·u.
    """
    chord = math.hypot(target[0] - start[0], target[1] - start[1])
    u0, u1 = (target[0] - start[0]) / chord, (target[1] - start[1]) / chord
    middle0, middle1 = (start[0] + target[0]) / 2.0, (start[1] + target[1]) / 2.0
    offset = (centre[0] - middle0) * u0 + (centre[1] - middle1) * u1
    corrected = (centre[0] - offset * u0, centre[1] - offset * u1)
    return CorrectedCentre(corrected, distance(corrected, start), abs(offset))


def centre_from_radius(start: Point, target: Point, radius: float, clockwise: bool) -> tuple[Point, float] | None:
    """Centre and radius of the arc with `radius` (negative: the arc above 180 degrees); None if it is too small.

    The centre lies at h = sqrt(R² - d²/4) from the chord's midpoint: left of the chord for a short
    counter-clockwise arc.
    """
    half = distance(start, target) / 2.0
    size = abs(radius)
    if size < half - CHORD_TOLERANCE:
        return None
    size = max(size, half)
    height = math.sqrt((size - half) * (size + half)) / (2.0 * half)
    if clockwise != (radius < 0.0):
        height = -height
    return (
        (start[0] + target[0]) / 2.0 - height * (target[1] - start[1]),
        (start[1] + target[1]) / 2.0 + height * (target[0] - start[0]),
    ), size


def swept_angle(start: Point, target: Point, centre: Point, clockwise: bool) -> float:
    """Angle from start to target about the centre, in degrees: (0, 360] counter-clockwise, [-360, 0) clockwise."""
    begin = math.atan2(start[1] - centre[1], start[0] - centre[0])
    end = math.atan2(target[1] - centre[1], target[0] - centre[0])
    turn = math.degrees(end - begin) % 360.0
    if clockwise:
        return turn - 360.0
    return turn if turn > 0.0 else 360.0


def distance(a: Point, b: Point) -> float:
    """Distance of two points, mm."""
    return math.hypot(b[0] - a[0], b[1] - a[1])


def directions(move: CircularMove) -> tuple[Sequence[float], Sequence[float]]:
    """Those of the first and second axis of the arc's plane, with a value for each axis."""
    if move.directions is not None:
        return move.directions
    first, second = ([float(index == axis) for index in range(len(move.target))] for axis in move.plane)
    return first, second


def linear_part(distances: Sequence[float], move: CircularMove) -> list[float]:
    """The linear motion of each axis, of its distance from start to target; what lies in the plane is the circle's."""
    first, second = directions(move)
    forth, aside = dot(distances, first), dot(distances, second)
    return [value - forth * u - aside * w for value, u, w in zip(distances, first, second, strict=True)]


def extreme_points(start: tuple[float, ...], move: CircularMove) -> list[tuple[float, ...]]:
    """Points of the arc between its ends where an axis of the circle reverses, in the order of the path.

    An axis goes by size·cos(angle - crest) and by its linear part m for each radian: it reverses where
    sin(angle - crest) = m/size, in a plane of two axes at the multiples of 90 degrees.
    """
    if move.directions is None:
        return _quarter_points(start, move)
    first, second = directions(move)
    linear = linear_part([end - begin for begin, end in zip(start, move.target, strict=True)], move)
    begin = math.degrees(math.atan2(dot(start, second) - move.center[1], dot(start, first) - move.center[0]))
    low, high = min(begin, begin + move.sweep), max(begin, begin + move.sweep)
    angles: set[float] = set()
    for u, w, along in zip(first, second, linear, strict=True):
        size, slope = move.radius * math.hypot(u, w), along / math.radians(move.sweep)
        if size <= abs(slope) or size <= NO_PART * move.radius:
            continue
        crest, lag = math.degrees(math.atan2(w, u)), math.degrees(math.asin(slope / size))
        for angle in (crest + lag, crest + 180.0 - lag):
            turns = range(math.ceil((low - angle) / 360.0), math.floor((high - angle) / 360.0) + 1)
            angles.update(angle + 360.0 * turn for turn in turns)
    inside = sorted((angle for angle in angles if low < angle < high), reverse=move.sweep < 0.0)
    return [_point_at(start, move, linear, angle, (angle - begin) / move.sweep) for angle in inside]


def _quarter_points(start: tuple[float, ...], move: CircularMove) -> list[tuple[float, ...]]:
    """Those of an arc in a plane of two axes; the other axes go in proportion to the angle."""
    first, second = move.plane
    center0, center1 = move.center
    begin = math.degrees(math.atan2(start[second] - center1, start[first] - center0))
    low, high = min(begin, begin + move.sweep), max(begin, begin + move.sweep)
    points: list[tuple[float, ...]] = []
    quarter = math.floor(low / 90.0) + 1
    while 90.0 * quarter < high:
        angle = 90.0 * quarter
        fraction = (angle - begin) / move.sweep
        point = [a + (b - a) * fraction for a, b in zip(start, move.target, strict=True)]
        point[first] = center0 + move.radius * cosine(angle)
        point[second] = center1 + move.radius * sine(angle)
        points.append(tuple(point))
        quarter += 1
    return points if move.sweep > 0.0 else points[::-1]


def _point_at(
    start: tuple[float, ...], move: CircularMove, linear: Sequence[float], angle: float, fraction: float
) -> tuple[float, ...]:
    """The point of the arc at an angle (deg), after this fraction of it."""
    first, second = directions(move)
    x = move.center[0] + move.radius * cosine(angle) - dot(start, first)
    y = move.center[1] + move.radius * sine(angle) - dot(start, second)
    return tuple([p + m * fraction + x * u + y * w for p, m, u, w in zip(start, linear, first, second, strict=True)])
