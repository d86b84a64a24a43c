"""How axes and spindle of a path come to rest when its channel is lost: in step, on one ramp that each computes alone.

All of them have the channel's last block and the parameters of the machine, so all come to the same ramp. It is that of
the spindle, as fast as spindle and axes permit; an axis goes by its way in each degree of it. So the tool keeps its
pitch to the standstill.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import inf
from typing import NamedTuple

from cnc_ptp.motion.limits import Limits
from cnc_ptp.motion.profile import Profile
from cnc_ptp.motion.to_velocity import plan_to_velocity
from cnc_ptp.parameters import AxisParameters, GearParameters, SpindleParameters
from cnc_ptp.protocol.blocks import ChannelBlock
from cnc_ptp.spindle.acceleration_curves import AccelerationCurve

PROPORTIONAL = 1e-6
"""Part of its velocity by which an axis may leave the ratio to the spindle."""
SLOWEST = 1e-9
"""mm/s (deg/s); slower is at rest."""
WEIGHT = 1e-4
"""s², of accelerations beside velocities where the ratio is computed: it is exact at a reversal, too."""


class PathStop(NamedTuple):
    """The ramp of a path that has lost its channel.

    spindle   that is on the path
    origin    the cycle in which it begins: the last one of the last block
    profile   travel of the spindle from there on, deg
    ratios    way of each axis in each degree of the spindle, mm (deg)
    """

    spindle: str
    origin: int
    profile: Profile
    ratios: dict[str, float]

    def of_axis(self, name: str, position: float) -> Profile:
        """The ramp of an axis that is at `position` in the cycle `origin`."""
        ratio, rows = self.ratios[name], self.profile.rows
        shift = position - ratio * rows[0][1]
        return Profile([(t, shift + ratio * p, ratio * v, ratio * a, ratio * j) for t, p, v, a, j in rows])


def path_stop(
    block: ChannelBlock, axes: Mapping[str, AxisParameters], spindles: Mapping[str, SpindleParameters]
) -> PathStop | None:
    """The ramp behind the last block of a channel.

    None where no spindle is on the path, or axes and spindle do not move in a ratio (#CAX): each has its own ramp then.
    """
    if len(block.path_spindles) != 1 or not block.path_active:
        return None
    last, spindle = block.count - 1, block.path_spindles[0]
    speed, rate = block.spindle_speed[last], block.spindle_acceleration[last]
    ratios = {
        name: _ratio(block.set_velocity[place], block.set_acceleration[place], speed, rate)
        for name, place in zip(block.axes, range(last, len(block.set_velocity), block.count), strict=True)
    }
    known = {name: ratio for name, ratio in ratios.items() if ratio is not None}
    moved = {name: ratio for name, ratio in known.items() if ratio}
    if len(known) < len(ratios) or not moved or spindle not in spindles or not moved.keys() <= axes.keys():
        return None
    limits = _limits(moved, axes, spindles[spindle])
    profile = plan_to_velocity(block.spindle_travel[last], speed, rate, 0.0, limits)
    return PathStop(spindle, block.first_cycle + last, profile, known)


def _ratio(velocity: float, acceleration: float, speed: float, rate: float) -> float | None:
    """Of an axis to the spindle; None if there is none."""
    square = speed * speed + WEIGHT * rate * rate
    moves = abs(velocity) + abs(acceleration) * WEIGHT
    if moves <= SLOWEST:
        return 0.0
    if square <= 0.0:
        return None
    ratio = (velocity * speed + WEIGHT * acceleration * rate) / square
    off = abs(velocity - ratio * speed) + abs(acceleration - ratio * rate) * WEIGHT
    return ratio if off <= PROPORTIONAL * moves + SLOWEST else None


def _limits(moved: Mapping[str, float], axes: Mapping[str, AxisParameters], spindle: SpindleParameters) -> Limits:
    """Of the spindle, with those of the axes in its degrees. It has no limit of the jerk of its own."""
    most = min(map(_acceleration, _gears(spindle)))
    jerk = inf
    for name, ratio in moved.items():
        axis, degrees = axes[name], 1.0 / abs(ratio)
        most = min(most, degrees * axis.acceleration, degrees * axis.deceleration)
        jerk = min(jerk, degrees * axis.jerk)
    return Limits(spindle.gears[spindle.gear].max_speed, most, most, jerk)


def _gears(spindle: SpindleParameters) -> Sequence[GearParameters]:
    """The one in which a path moves it (P-AXIS-00052), or all: an axis does not know which one is active."""
    gear = spindle.gears.get(spindle.path_gear)
    return tuple(spindle.gears.values()) if gear is None else (gear,)


def _acceleration(gear: GearParameters) -> float:
    most = min(gear.acceleration, gear.deceleration)
    if gear.curve is None:
        return most
    curve = AccelerationCurve(gear.curve, top_speed=gear.max_speed)
    return min(curve.acceleration(0.0), curve.acceleration(gear.max_speed * (1.0 - 1e-9)))
