"""What a drive does when its setpoints cease: it brakes on its own, from where it is, until it stands.

Real drives watch their telegrams (SERCOS: C1D diagnosis after missing MDTs; EtherCAT: watchdog of the sync manager) and
then stop without a master. No command can come any more, so that a whole stop is one profile from the last actual
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
    """Actual values of the cycles after the last setpoint, mm and mm/s (deg, deg/s); the last one is at a standstill."""

    positions: list[float]
    velocities: list[float]


def axis_deceleration(axis: AxisParameters) -> float:
    """The deceleration of the emergency ramp, mm/s² (deg/s²): P-AXIS-00003, never weaker than P-AXIS-00002."""
    return max(axis.deceleration, axis.emergency_deceleration)


def gear_deceleration(gear: GearParameters) -> float:
    """The same of a gear of a spindle, deg/s²."""
    return max(gear.deceleration, gear.emergency_deceleration)


def axis_stop(axis: AxisParameters, position: float, velocity: float, acceleration: float) -> Profile:
    """The jerk-limited emergency ramp of an axis from its actual values.

    The acceleration counts as far as the axis can have it (P-AXIS-00008 and its emergency ramp).
    """
    braking = axis_deceleration(axis)
    most = max(axis.max_acceleration, braking)
    limits = Limits(axis.max_velocity, axis.acceleration, braking, axis.jerk)
    return plan_to_velocity(position, velocity, min(most, max(-most, acceleration)), 0.0, limits)


def gear_stop(gear: GearParameters, position: float, velocity: float) -> Profile:
    """The emergency ramp of a spindle in this gear: a constant deceleration, v²/2a to the standstill."""
    braking = gear_deceleration(gear)
    duration = abs(velocity) / braking
    end = position + 0.5 * velocity * duration
    return Profile([(0.0, position, velocity, -copysign(braking, velocity), 0.0), (duration, end, 0.0, 0.0, 0.0)])


def stands(velocity: float, deceleration: float, cycle_time: float) -> bool:
    """The drive can take this velocity away within a cycle: nothing that one would call a motion."""
    return abs(velocity) <= deceleration * cycle_time


def own_stop(profile: Profile, cycle_time: float) -> OwnStop:
    """The stop cycle by cycle, from the cycle after the last setpoint on; at least one cycle."""
    count = max(1, ceil(profile.duration / cycle_time - ROUNDING))
    states = [profile.state_at(number * cycle_time) for number in range(1, count)]
    position, velocity, _ = profile.end
    return OwnStop([state[0] for state in states] + [position], [state[1] for state in states] + [velocity])
