"""What a drive does when its setpoints cease: it brakes on its own, from where it is, until it stands.

Real drives watch their telegrams (SERCOS: missing MDTs of class 1 diagnostics; EtherCAT: watchdog of the sync manager)
and then stop without a master. No other command will come, so that a whole stop is one profile from the last actual
values. Units: mm, s or deg, s.
"""

from __future__ import annotations

from math import ceil, copysign
from typing import NamedTuple

from cnc_ptp.motion import Limits
from cnc_ptp.motion.profile import Profile
from cnc_ptp.motion.to_velocity import plan_to_velocity
from cnc_ptp.parameters.view.axis_view import AxisParameters
from cnc_ptp.parameters.view.spindle_view import GearParameters

ROUNDING = 1e-9
"""Cycles; a stop that ends this much behind a cycle ends with it."""


class OwnStop(NamedTuple):
    """Actual values of the cycles after the last setpoint, mm and mm/s (deg, deg/s); in the last one it stands."""

    positions: list[float]
    velocities: list[float]


def braking_deceleration(drive: AxisParameters | GearParameters, *, in_step: bool) -> float:
    """That of the emergency ramp, mm/s² (deg/s²): P-AXIS-00003, never weaker than P-AXIS-00002.

    `in_step`: that of the own ramp alone (P-AXIS-00002), on which the others of a coupled group stop.
    """
    return drive.deceleration if in_step else max(drive.deceleration, drive.emergency_deceleration)


def axis_stop(
    axis: AxisParameters, position: float, velocity: float, acceleration: float, deceleration: float
) -> Profile:
    """The jerk-limited ramp of an axis from its actual values.

    The acceleration counts as far as the axis can have it (P-AXIS-00008, or the ramp itself).
    """
    most = max(axis.max_acceleration, deceleration)
    limits = Limits(axis.max_velocity, axis.acceleration, deceleration, axis.jerk)
    return plan_to_velocity(position, velocity, min(most, max(-most, acceleration)), 0.0, limits)


def spindle_stop(position: float, velocity: float, deceleration: float) -> Profile:
    """The ramp of a spindle: a constant deceleration, v²/2a to the standstill."""
    duration = abs(velocity) / deceleration
    end = position + 0.5 * velocity * duration
    return Profile([(0.0, position, velocity, -copysign(deceleration, velocity), 0.0), (duration, end, 0.0, 0.0, 0.0)])


def own_stop(profile: Profile, cycle_time: float) -> OwnStop:
    """The stop cycle by cycle, from the cycle after the last setpoint on; one cycle for a drive that stands."""
    count = max(1, ceil(profile.duration / cycle_time - ROUNDING))
    states = [profile.state_at(number * cycle_time) for number in range(1, count)]
    position, velocity, _ = profile.end
    return OwnStop([state[0] for state in states] + [position], [state[1] for state in states] + [velocity])
