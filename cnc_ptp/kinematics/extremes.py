"""Where a kinematics turns axes round on a motion: between these places each of them goes one way."""

from __future__ import annotations

from functools import partial

from cnc_ptp.kinematics.kinematics import Kinematics, Point
from cnc_ptp.kinematics.way import Way


def extremes(kinematics: Kinematics, way: Way, near: Point) -> list[Point]:
    """Programmed points within a way at which an axis of the machine turns round; `near`: a machine position."""
    places: set[float] = set()
    for axis in range(len(near)):
        places.update(way.changes(partial(_slope, kinematics, way, near, axis)))
    return [way.point(u) for u in sorted(places)]


def _slope(kinematics: Kinematics, way: Way, near: Point, axis: int, u: float) -> float:
    """How a machine axis changes at u."""
    return kinematics.shape(way.shape(u), near)[axis][1]
