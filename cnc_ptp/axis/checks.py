"""Checks of what a command asks of an axis, before anything is changed. Source: TX1250 2.1."""

from __future__ import annotations

from collections.abc import Mapping

from cnc_ptp.axis.faults import (
    ABOVE_REFERENCE_VELOCITY,
    ACCELERATION_TOO_HIGH,
    BAD_DYNAMICS,
    JERK_RESCALED,
    OUT_OF_RANGE,
    SOFT_LIMIT_NEGATIVE,
    SOFT_LIMIT_POSITIVE,
    VELOCITY_TOO_HIGH,
)
from cnc_ptp.errors import CncError
from cnc_ptp.motion import Limits
from cnc_ptp.motion.limits import LARGEST_STATE, SMALLEST_LIMIT
from cnc_ptp.parameters import AxisParameters


class MotionChecks:
    """Limits of one axis; each check raises CncError with who, where, value and limit, or gives what is to be used."""

    def __init__(self, parameters: AxisParameters, *, cycle_time: float) -> None:
        """`cycle_time` in s."""
        self._parameters = parameters
        self._cycle_time = cycle_time
        self._unit = "deg" if parameters.rotary else "mm"

    def refusal(self, command: str, error_id: int, reason: str) -> CncError:
        return CncError(error_id, f"axis {self._parameters.name}: {command} refused: {reason}; nothing was changed")

    def own_limits(self) -> Limits:
        """The limits of a motion that says nothing about its dynamics."""
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
                raise self.refusal(command, BAD_DYNAMICS, f"{name} = {value} must be greater than 0")
            if value < SMALLEST_LIMIT:
                raise self.refusal(command, BAD_DYNAMICS, f"{name} = {value} must be at least {SMALLEST_LIMIT:g}")

    def velocity(self, command: str, velocity: float) -> None:
        """Raises 23004 above the maximum and 23011 above the reference velocity."""
        highest, reference = self._parameters.max_velocity, self._parameters.reference_velocity
        unit = f"{self._unit}/s"
        if velocity > highest:
            reason = f"velocity {velocity} {unit} is above the maximum {highest} {unit} (P-AXIS-00212)"
            raise self.refusal(command, VELOCITY_TOO_HIGH, reason)
        if velocity > reference:
            reason = f"velocity {velocity} {unit} is above the reference velocity {reference} {unit} (P-MACH-00008)"
            raise self.refusal(command, ABOVE_REFERENCE_VELOCITY, reason)

    def acceleration(self, command: str, name: str, value: float) -> None:
        """Raises 23013 above the maximum."""
        most = self._parameters.max_acceleration
        if value > most:
            unit = f"{self._unit}/s²"
            reason = f"{name} {value} {unit} is above the maximum {most} {unit} (P-AXIS-00008)"
            raise self.refusal(command, ACCELERATION_TOO_HIGH, reason)

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
            f"P-WARN-{JERK_RESCALED} axis {self._parameters.name}: {command}: jerk {limits.jerk} {self._unit}/s³ is "
            f"above A/T, the acceleration over one cycle; {highest} {self._unit}/s³ is used"
        )
        return limits._replace(jerk=highest), warning

    def soft_limits(self, command: str, target: float) -> None:
        """Raises 120002 and 120003 for a target outside, 23002 for one out of all range; the start may be anywhere."""
        low, high = self._parameters.soft_limit_negative, self._parameters.soft_limit_positive
        unit = self._unit
        if target > high:
            reason = f"target {target} {unit} lies beyond the positive soft limit {high} {unit} (P-AXIS-00178)"
            raise self.refusal(command, SOFT_LIMIT_POSITIVE, reason)
        if target < low:
            reason = f"target {target} {unit} lies beyond the negative soft limit {low} {unit} (P-AXIS-00177)"
            raise self.refusal(command, SOFT_LIMIT_NEGATIVE, reason)
        if abs(target) > LARGEST_STATE:
            reason = f"target {target} {unit} is not within ±{LARGEST_STATE:g} {unit}"
            raise self.refusal(command, OUT_OF_RANGE, reason)
