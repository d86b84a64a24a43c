"""Geometry of arcs in a plane: centre from offsets or radius, angle swept, extreme points; mm and degrees.

Points are (first, second) coordinates of the plane; counter-clockwise is from the first towards the second axis.
"""

import math
from typing import NamedTuple

from cnc_ptp.nc.canonical import CircularMove

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


def extreme_points(start: tuple[float, ...], move: CircularMove) -> list[tuple[float, ...]]:
    """Points of the arc between its ends where one axis of the plane reverses, in the order of the path.

    They are at the multiples of 90 degrees inside the sweep; the axes outside the plane are interpolated linearly.
    """
    first, second = move.plane
    begin = math.degrees(math.atan2(start[second] - move.center[1], start[first] - move.center[0]))
    low, high = min(begin, begin + move.sweep), max(begin, begin + move.sweep)
    quarters = range(math.floor(low / 90.0) + 1, math.ceil(high / 90.0))
    points = [_quarter_point(start, move, quarter, (90.0 * quarter - begin) / move.sweep) for quarter in quarters]
    return points if move.sweep > 0.0 else points[::-1]


def _quarter_point(start: tuple[float, ...], move: CircularMove, quarter: int, fraction: float) -> tuple[float, ...]:
    point = [begin + fraction * (end - begin) for begin, end in zip(start, move.target, strict=True)]
    cosine, sine = ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))[quarter % 4]
    point[move.plane[0]] = move.center[0] + move.radius * cosine
    point[move.plane[1]] = move.center[1] + move.radius * sine
    return tuple(point)
