"""Checks of the values of a command to an axis, before anything is changed. Source: TX1250 2.1."""

from __future__ import annotations

from collections.abc import Mapping
from math import copysign, inf, isfinite
from typing import NamedTuple

from cnc_ptp.axis.faults import (
    ABOVE_REFERENCE_VELOCITY,
    ACCELERATION_TOO_HIGH,
    BAD_DYNAMICS,
    JERK_RESCALED,
    SOFT_LIMIT_NEGATIVE,
    SOFT_LIMIT_POSITIVE,
    VELOCITY_TOO_HIGH,
)
from cnc_ptp.errors import CncError, Value, warning_text
from cnc_ptp.motion import Limits
from cnc_ptp.motion.limits import LARGEST_STATE, OUT_OF_RANGE, SMALLEST_LIMIT
from cnc_ptp.parameters import AxisParameters

NEGLIGIBLE_SHIFT = 1e-9
"""mm (deg): what rounding leaves of a shift that was taken back."""


class SoftLimit(NamedTuple):
    """The soft limit of one direction; its `text` names it with position, unit and parameter."""

    position: float
    number: int
    text: str


class MotionChecks:
    """Limits of one axis; each check raises CncError with command, value and limit, or returns what is to be used."""

    def __init__(self, parameters: AxisParameters, *, cycle_time: float) -> None:
        """`cycle_time` in s."""
        self._cycle_time = cycle_time
        self.coordinate_shift = 0.0
        """By how much set_position has moved the coordinates of the axis against those of the machine, mm (deg)."""
        self.referenced = parameters.referenced_at_start
        """The coordinates of the axis are those of the machine; without that there are no soft limits."""
        self.take(parameters)

    def take(self, parameters: AxisParameters) -> None:
        """Other limits of the axis; its coordinates stay."""
        self._parameters = parameters
        self._unit = "deg" if parameters.rotary else "mm"
        positive, negative = parameters.soft_limit_positive, parameters.soft_limit_negative
        positive_text = f"positive soft limit {positive} {self._unit} (P-AXIS-00178)"
        negative_text = f"negative soft limit {negative} {self._unit} (P-AXIS-00177)"
        self._positive_limit = SoftLimit(positive, SOFT_LIMIT_POSITIVE, positive_text)
        self._negative_limit = SoftLimit(negative, SOFT_LIMIT_NEGATIVE, negative_text)

    def refusal(self, command: str, number: int, reason: str, /, **values: Value) -> CncError:
        where = f"axis {self._parameters.name}: {command} refused"
        return CncError(number, reason, "nothing was changed", where=where, **values)

    def own_limits(self) -> Limits:
        """The limits of a motion without dynamics of its own."""
        parameters = self._parameters
        velocity = min(parameters.max_velocity, parameters.reference_velocity)
        return Limits(velocity, parameters.acceleration, parameters.deceleration, parameters.jerk)

    def dynamics(self, command: str, dynamics: Mapping[str, float]) -> Limits:
        """Limits of a start; what is left out comes from the axis. Raises 23003, 23004, 23011 and 23013."""
        self.positive(command, dynamics)
        limits = self.own_limits()._replace(**{name: float(value) for name, value in dynamics.items()})
        self.velocity(command, limits.velocity)
        self.acceleration(command, "acceleration", limits.acceleration)
        self.acceleration(command, "deceleration", limits.deceleration)
        return limits

    def positive(self, command: str, values: Mapping[str, float]) -> None:
        for name, value in values.items():
            if not value > 0.0:
                reason = f"{name} = {value} must be greater than 0"
                raise self.refusal(command, BAD_DYNAMICS, reason, argument=name, value=value)
            if value < SMALLEST_LIMIT:
                reason = f"{name} = {value} must be at least {SMALLEST_LIMIT:g}"
                raise self.refusal(command, BAD_DYNAMICS, reason, argument=name, value=value, limit=SMALLEST_LIMIT)

    def velocity(self, command: str, velocity: float) -> None:
        """Raises 23004 above the maximum and 23011 above the reference velocity."""
        highest, reference = self._parameters.max_velocity, self._parameters.reference_velocity
        unit = f"{self._unit}/s"
        if velocity > highest:
            reason = f"velocity {velocity} {unit} is above the maximum {highest} {unit} (P-AXIS-00212)"
            raise self.refusal(command, VELOCITY_TOO_HIGH, reason, velocity=velocity, limit=highest)
        if velocity > reference:
            reason = f"velocity {velocity} {unit} is above the reference velocity {reference} {unit} (P-MACH-00008)"
            raise self.refusal(command, ABOVE_REFERENCE_VELOCITY, reason, velocity=velocity, limit=reference)

    def acceleration(self, command: str, name: str, value: float) -> None:
        """Raises 23013 above the maximum."""
        most = self._parameters.max_acceleration
        if value > most:
            unit = f"{self._unit}/s²"
            reason = f"{name} {value} {unit} is above the maximum {most} {unit} (P-AXIS-00008)"
            raise self.refusal(command, ACCELERATION_TOO_HIGH, reason, argument=name, value=value, limit=most)

    @property
    def most_deceleration(self) -> float:
        """The largest deceleration of an emergency stop, mm/s² (deg/s²): P-AXIS-00008, or P-AXIS-00003 if larger."""
        return max(self._parameters.max_acceleration, self._parameters.emergency_deceleration)

    def rescaled_jerk(self, command: str, limits: Limits) -> tuple[Limits, str | None]:
        """A jerk that brings an acceleration up within less than a cycle is reduced to A/T, with a warning."""
        highest = min(limits.acceleration, limits.deceleration) / self._cycle_time
        if limits.jerk <= highest:
            return limits, None
        warning = (
            f"axis {self._parameters.name}: {command}: jerk {limits.jerk} {self._unit}/s³ is above A/T, the "
            f"acceleration over one cycle; {highest} {self._unit}/s³ is used"
        )
        return limits._replace(jerk=highest), warning_text(JERK_RESCALED, warning, jerk=limits.jerk, corrected=highest)

    def soft_limit(self, direction: float) -> SoftLimit:
        """The soft limit in this direction of motion (> 0: positive); infinity until the axis is referenced."""
        limit = self._positive_limit if direction > 0.0 else self._negative_limit
        if not self.referenced:
            return limit._replace(position=copysign(inf, direction))
        if self.coordinate_shift and isfinite(limit.position):
            return self._shifted(limit)
        return limit

    def shift_coordinates(self, distance: float) -> None:
        """All positions of the axis grow by `distance`; its place on the machine stays."""
        shift = self.coordinate_shift + distance
        self.coordinate_shift = shift if abs(shift) > NEGLIGIBLE_SHIFT else 0.0

    def _shifted(self, limit: SoftLimit) -> SoftLimit:
        """A soft limit stays where it is on the machine (set_position)."""
        position = limit.position + self.coordinate_shift
        text = f"{limit.text}, which is at {position} {self._unit} now"
        return limit._replace(position=position, text=text)

    def soft_limits(self, command: str, target: float) -> None:
        """Raises 120002 and 120003 for a target outside, 23002 for one out of range; the start may be anywhere."""
        unit = self._unit
        for direction in (1.0, -1.0):
            limit = self.soft_limit(direction)
            if direction * target > direction * limit.position:
                reason = f"target {target} {unit} lies beyond the {limit.text}"
                raise self.refusal(command, limit.number, reason, target=target, limit=limit.position)
        if abs(target) > LARGEST_STATE:
            reason = f"target {target} {unit} is not within ±{LARGEST_STATE:g} {unit}"
            raise self.refusal(command, OUT_OF_RANGE, reason, target=target, limit=LARGEST_STATE)
