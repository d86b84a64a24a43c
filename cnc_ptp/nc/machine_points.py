"""Where the axes are on a Cartesian motion (#FACE, #CYL), for soft limits; whether they can go it at all."""

from __future__ import annotations

from math import atan2, radians

from cnc_ptp.kinematics.extremes import extremes
from cnc_ptp.kinematics.kinematics import Point
from cnc_ptp.kinematics.way import Way
from cnc_ptp.nc import c_axis_faults as own
from cnc_ptp.nc.arcs import directions, linear_part
from cnc_ptp.nc.canonical import CircularMove, LinearMove, Source
from cnc_ptp.nc.coordinates.frame import dot


def machine_points(start: Point, motion: LinearMove | CircularMove, source: Source) -> list[Point]:
    """Machine positions between which a motion from `start` (Cartesian) moves the axes, those of its ends first.

    Raises ProgramError 21755 for a way that the axes cannot go.
    """
    kinematics = motion.kinematics
    assert kinematics is not None
    way = way_of(start, motion)
    if not kinematics.possible(way):
        raise own.THROUGH_CENTRE.at(source, 1, command=kinematics.name, place=kinematics.reasons.impossible)
    points = [start, motion.target, *extremes(kinematics, way, kinematics.origin)]
    return [kinematics.inverse(point, kinematics.origin) for point in points]


def way_of(start: Point, motion: LinearMove | CircularMove) -> Way:
    """The motion over its part of the way, 0 to 1."""
    distances = [end - begin for begin, end in zip(start, motion.target, strict=True)]
    if isinstance(motion, LinearMove):
        return Way(start, tuple(distances))
    first, second = directions(motion)
    x, y = motion.center[0] - dot(start, first), motion.center[1] - dot(start, second)
    return Way(
        base=tuple([p + x * u + y * w for p, u, w in zip(start, first, second, strict=True)]),
        linear=tuple(linear_part(distances, motion)),
        cosine=tuple([motion.radius * u for u in first]),
        sine=tuple([motion.radius * w for w in second]),
        begin=atan2(-y, -x),
        sweep=radians(motion.sweep),
    )
