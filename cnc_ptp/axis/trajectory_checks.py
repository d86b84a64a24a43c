"""Checks of a trajectory before it begins: form, where it starts and ends, limits from the extrema of its segments."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import NoReturn

from cnc_ptp.axis.axis import ROUNDING, Axis
from cnc_ptp.axis.faults import (
    ABOVE_REFERENCE_VELOCITY,
    ACCELERATION_TOO_HIGH,
    BAD_TRAJECTORY,
    VELOCITY_TOO_HIGH,
)
from cnc_ptp.motion.limits import LARGEST_STATE, rounding
from cnc_ptp.motion.trajectory import Extremum, Trajectory, TrajectoryPoint, TrajectorySegment
from cnc_ptp.protocol.commands import is_finite

BEGIN = "begin_trajectory"
VALUES = ("time", "position", "velocity", "acceleration")
SHORTEST = 1e-6
"""s between two points."""


class TrajectoryChecks:
    """Each check refuses with axis, value, limit and time; nothing is changed then."""

    def __init__(self, axis: Axis, *, cycle_time: float) -> None:
        """`cycle_time` in s."""
        self._axis = axis
        self._cycle_time = cycle_time

    # form

    def points(self, rows: Sequence[object], now: float) -> list[TrajectoryPoint]:
        """The points of `rows`, from where the axis is (`now`) on. Raises 23064."""
        points = self._read(rows)
        for before, point in pairwise(points):
            if point.time - before.time < SHORTEST:
                least = f"at least {SHORTEST:g} s must lie between them"
                self._bad(f"the point at {point.time:g} s comes after that at {before.time:g} s; {least}")
        points = self._from(points, now)
        last = points[-1]
        if last.velocity:
            velocity = f"velocity {last.velocity} {self._axis.unit}/s"
            self._bad(f"{velocity} in the last point at {last.time:g} s; a trajectory ends at a standstill")
        return points

    def _read(self, rows: Sequence[object]) -> list[TrajectoryPoint]:
        if not rows:
            self._bad("it has no points")
        points = [self._point(number, row) for number, row in enumerate(rows, 1)]
        if points[0].time < 0.0:
            self._bad(f"time = {points[0].time} of point 1 is negative")
        given = sum(value is not None for value in points[0])
        for number, point in enumerate(points, 1):
            if sum(value is not None for value in point) != given:
                self._bad(f"point {number} has other values than point 1; {', '.join(VALUES[:given])} are needed")
        return points

    def _point(self, number: int, row: object) -> TrajectoryPoint:
        names = ", ".join(VALUES)
        if not isinstance(row, (list, tuple)) or not 2 <= len(row) <= len(VALUES):
            self._bad(f"point {number} = {row!r} is not a list of {names} (the last two may be left out)")
        for name, value in zip(VALUES, row, strict=False):
            is_number = isinstance(value, (int, float)) and not isinstance(value, bool) and is_finite(value)
            if not is_number or not abs(value) <= LARGEST_STATE:
                self._bad(f"{name} = {value!r} of point {number} is not a number within ±{LARGEST_STATE:g}")
        return TrajectoryPoint(*map(float, row))

    def _from(self, points: list[TrajectoryPoint], now: float) -> list[TrajectoryPoint]:
        """With a first point at time 0, which is where the axis stands; without one the axis goes to the first point.

        That point may be in the position window around it, and is moved there, so that nothing jumps.
        """
        axis, first = self._axis, points[0]
        rest = first._replace(
            time=0.0,
            position=now,
            velocity=None if first.velocity is None else 0.0,
            acceleration=None if first.acceleration is None else 0.0,
        )
        if first.time > 0.0:
            return [rest, *points]
        window = axis.parameters.position_window
        if abs(first.position - now) > max(window, rounding(first.position, now)):
            where = f"the axis is at {now} {axis.unit}, the first point at 0 s is {first.position} {axis.unit}"
            self._bad(f"{where}; they may differ by the position window {window} {axis.unit} (P-AXIS-00236)")
        if first.velocity:
            velocity = f"velocity {first.velocity} {axis.unit}/s"
            self._bad(f"{velocity} in the first point at 0 s; the axis is at a standstill")
        if len(points) < 2:
            self._bad("its only point is at 0 s, where the axis is already")
        return [first._replace(position=now), *points[1:]]

    # limits

    def limits(self, trajectory: Trajectory, now: float) -> None:
        """Raises 23004, 23011, 23013, 120002 and 120003 for the first segment that leads beyond a limit."""
        before = 0.0
        for segment in trajectory.segments:
            self._step(before, segment)
            for extremum in segment.extrema(segment.velocity):
                self._velocity(extremum)
            for extremum in segment.extrema(segment.acceleration):
                self._acceleration(extremum)
            for extremum in segment.extrema(segment.position):
                self._soft_limits(extremum, now)
            before = segment.velocity[0]
        if len(trajectory.segments[-1].position) == 2:
            last = trajectory.segments[-1]
            self._check_step(0.0 - before, last.begin + last.duration)

    def _step(self, before: float, segment: TrajectorySegment) -> None:
        """With positions alone the velocity changes from one cycle to the next."""
        if len(segment.position) == 2:
            self._check_step(segment.velocity[0] - before, segment.begin)

    def _check_step(self, step: float, time: float) -> None:
        most = self._axis.parameters.max_acceleration * self._cycle_time
        if abs(step) > most * (1.0 + ROUNDING):
            unit = f"{self._axis.unit}/s"
            reason = (
                f"without velocities the velocity steps by {abs(step):g} {unit} at {time:g} s, more than {most:g} "
                f"{unit} in a cycle (P-AXIS-00008); give velocities"
            )
            self._axis.refuse(BEGIN, ACCELERATION_TOO_HIGH, reason, velocity=abs(step), limit=most, time=time)

    def _velocity(self, extremum: Extremum) -> None:
        parameters, unit = self._axis.parameters, f"{self._axis.unit}/s"
        for number, most, name in (
            (VELOCITY_TOO_HIGH, parameters.max_velocity, f"maximum {parameters.max_velocity} {unit} (P-AXIS-00212)"),
            (
                ABOVE_REFERENCE_VELOCITY,
                parameters.reference_velocity,
                f"reference velocity {parameters.reference_velocity} {unit} (P-MACH-00008)",
            ),
        ):
            if abs(extremum.value) > most * (1.0 + ROUNDING):
                reason = f"velocity {extremum.value:g} {unit} at {extremum.time:g} s is above the {name}"
                self._axis.refuse(BEGIN, number, reason, velocity=extremum.value, limit=most, time=extremum.time)

    def _acceleration(self, extremum: Extremum) -> None:
        most = self._axis.parameters.max_acceleration
        unit = f"{self._axis.unit}/s²"
        if abs(extremum.value) > most * (1.0 + ROUNDING):
            above = f"is above the maximum {most} {unit} (P-AXIS-00008)"
            reason = f"acceleration {extremum.value:g} {unit} at {extremum.time:g} s {above}"
            values = {"acceleration": extremum.value, "limit": most, "time": extremum.time}
            self._axis.refuse(BEGIN, ACCELERATION_TOO_HIGH, reason, **values)

    def _soft_limits(self, extremum: Extremum, now: float) -> None:
        """An axis beyond a soft limit may come back."""
        for direction in (1.0, -1.0):
            limit = self._axis.checks.soft_limit(direction)
            beyond = direction * (extremum.value - limit.position)
            if beyond > rounding(extremum.value, 0.0) and beyond > direction * (now - limit.position):
                reason = (
                    f"position {extremum.value:g} {self._axis.unit} at {extremum.time:g} s is beyond the {limit.text}"
                )
                values = {"position": extremum.value, "limit": limit.position, "time": extremum.time}
                self._axis.refuse(BEGIN, limit.number, reason, **values)

    def tolerance(self, name: str, value: float) -> None:
        """Raises 23064 for a tolerance or a time below 0."""
        if value < 0.0:
            self._bad(f"{name} = {value} must not be negative")

    def _bad(self, reason: str) -> NoReturn:
        self._axis.refuse(BEGIN, BAD_TRAJECTORY, reason)
