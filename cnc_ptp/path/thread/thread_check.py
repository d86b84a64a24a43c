"""Whether the axes can follow a spindle through a thread: velocities, run-up, joints and run-out."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final, NamedTuple

from cnc_ptp.errors import CncError
from cnc_ptp.motion import Limits, plan_to_velocity, stopping_distance
from cnc_ptp.nc.canonical import LinearMove, Thread
from cnc_ptp.parameters import AxisParameters, ChannelParameters
from cnc_ptp.parameters.list_units import DEG_S_PER_RPM
from cnc_ptp.path.geometry import AxisLimits
from cnc_ptp.path.motion_plan import NO_LIMITS, feed_limits, path_axes
from cnc_ptp.path.thread.retract import RETRACT_SHARE, Retract
from cnc_ptp.path.thread.thread_geometry import ThreadGeometry

THREAD_TOO_FAST = 22082
THREAD_TOO_SHORT = 22083
RUN_UP_TOO_LONG = 22084
LEAD_TOO_FAST = 22088
BEND_SHARE: Final = 0.3
"""Of the acceleration of an axis for a lead that changes."""
TURN: Final = 360.0
ROUNDING: Final = 1e-9
"""deg."""


class ThreadSettings(NamedTuple):
    """What all threads of a channel have in common.

    names        of the axes
    limits       of the axes
    path_axes    places of the axes whose path the feed is for
    cycle_time   s
    delay        cycles by which the axes act later than their setpoints come
    run_up       longest way in mm from the start on that may be out of pitch, 0.0: any
    retract      None: the path stops in the thread
    """

    names: Sequence[str]
    limits: Sequence[AxisLimits]
    path_axes: Sequence[int]
    cycle_time: float
    delay: int
    run_up: float
    retract: Retract | None


def thread_settings(channel: ChannelParameters, axes: Sequence[AxisParameters], cycle_time: float) -> ThreadSettings:
    """Of the threads of a channel. All axes of a path act equally late."""
    names, limits = list(channel.path_axes), feed_limits(axes)
    if channel.c_axis:
        limits.append(NO_LIMITS)
    retract = None
    if channel.thread_retract_axis in names and channel.thread_retract:
        axis = names.index(channel.thread_retract_axis)
        retract = Retract(axis, channel.thread_retract_axis, channel.thread_retract)
    delay = max((axis.control.delay_cycles for axis in axes), default=0)
    places = sorted(path_axes(channel))
    return ThreadSettings(names, limits, places, cycle_time, delay, channel.thread_run_up, retract)


class Ramps(NamedTuple):
    """deg of the run-up at the start of a thread, and of the run-out at its end."""

    run_up: float
    run_out: float


def with_retract(settings: ThreadSettings, motion: LinearMove) -> ThreadSettings:
    """Those of a thread that begins with this block: the program may say how the tool leaves it."""
    words = words_of(motion)
    if words.retract is None:
        return settings
    axis, way = words.retract
    return settings._replace(retract=Retract(axis, settings.names[axis], way) if way else None)


def angle_of(motion: LinearMove) -> float:
    """deg by which the spindle turns in a block of a thread."""
    return words_of(motion).angle


def words_of(motion: LinearMove) -> Thread:
    """What a block of a thread has of it."""
    assert motion.thread is not None
    return motion.thread


def pitch_of(motion: LinearMove) -> float:
    """mm per deg along the axis of the pitch, at the start of the block."""
    return words_of(motion).lead / TURN


def last_pitch_of(motion: LinearMove) -> float:
    """The same at its end."""
    thread = words_of(motion)
    return (thread.lead + thread.change * thread.angle / TURN) / TURN


def limits_of(settings: ThreadSettings, geometry: ThreadGeometry, blocks: Sequence[int], velocity: float) -> Limits:
    """What the axes permit of the angle φ on these blocks: its `velocity`, acceleration and jerk.

    The retract axis keeps a part for its retract.
    """
    spared = [1.0] * len(settings.limits)
    if settings.retract is not None:
        spared[settings.retract.axis] = 1.0 - RETRACT_SHARE
    return geometry.limits(blocks, velocity, spared)


def way_out(settings: ThreadSettings, geometry: ThreadGeometry, block: int, speed: float) -> float:
    """deg of the ramp at the end of a block."""
    limits = limits_of(settings, geometry, [block], speed)
    return stopping_distance(speed, 0.0, limits.deceleration, limits.jerk)


def checked_geometry(
    settings: ThreadSettings, start: tuple[float, ...], motions: Sequence[LinearMove], speed: float
) -> tuple[ThreadGeometry, Ramps]:
    """The geometry of a thread at a speed (deg/s) that the axes can follow. Raises CncError 22082 … 22084."""
    geometry = ThreadGeometry(start, settings.limits, settings.path_axes)
    for number, motion in enumerate(motions):
        geometry.append(motion.target, words_of(motion), speed)
        require_velocity(settings, geometry.slopes_of(number), motion, speed)
        _require_acceleration(settings, geometry.bends_of(number), motion, speed)
    ramp = plan_to_velocity(0.0, 0.0, 0.0, speed, limits_of(settings, geometry, [0], speed))
    ramps = Ramps(ramp.end[0], way_out(settings, geometry, len(geometry) - 1, speed))
    for number, motion in enumerate(motions):
        _require_length(geometry, ramps, number, motion, speed)
    _require_pitch_soon(settings, ramps, motions[0])
    return geometry, ramps


def joined(
    settings: ThreadSettings, geometry: ThreadGeometry, motion: LinearMove, speed: float, begin: float
) -> float | None:
    """Appends a block to a thread under way at `speed` (deg/s): deg of the run-out at its new end.

    None if that does not fit: the geometry is as before. The joint must lie behind φ = `begin`.
    """
    end = geometry.end
    geometry.append(motion.target, words_of(motion), speed)
    last = len(geometry) - 1
    reach = end - 0.5 * geometry.zone_of(last)
    free = max(begin, geometry.begin_of(last - 1) + 0.5 * geometry.zone_of(last - 1))
    out = way_out(settings, geometry, last, speed)
    fits = reach >= free and end + 0.5 * geometry.zone_of(last) + out <= geometry.end
    fits = fits and not too_fast(settings, geometry.slopes_of(last), speed)
    if fits and not bends_too_much(settings, geometry.bends_of(last), speed):
        return out
    geometry.pop()
    return None


def too_fast(settings: ThreadSettings, slopes: Sequence[float], speed: float) -> bool:
    """An axis cannot follow the spindle; `slopes` in mm per deg, `speed` in deg/s."""
    return any(abs(m) * speed > axis.velocity for m, axis in zip(slopes, settings.limits, strict=True))


def require_velocity(settings: ThreadSettings, slopes: Sequence[float], motion: LinearMove, speed: float) -> None:
    """Raises CncError 22082 when an axis cannot follow the spindle at `speed` (deg/s)."""
    if not too_fast(settings, slopes, speed):
        return
    for name, m, axis in zip(settings.names, slopes, settings.limits, strict=True):
        needed = abs(m) * speed
        if needed > axis.velocity:
            lead = max(pitch_of(motion), last_pitch_of(motion)) * TURN
            rpm = speed / DEG_S_PER_RPM
            thread = f"a thread with {lead:g} mm per revolution at {rpm:.6g} rpm"
            reason = f"{thread} needs {needed:.6g} mm/s of axis {name}, its limit is {axis.velocity:.6g} mm/s"
            reason += " (P-AXIS-00212)"
            raise CncError(THREAD_TOO_FAST, reason, velocity=needed, limit=axis.velocity, at_speed=rpm, lead=lead)


def bends_too_much(settings: ThreadSettings, bends: Sequence[float], speed: float) -> bool:
    """The lead changes faster than the axes can; `bends` in mm per deg², `speed` in deg/s."""
    pairs = zip(bends, settings.limits, strict=True)
    return any(abs(c) * speed * speed > BEND_SHARE * min(axis.acceleration, axis.deceleration) for c, axis in pairs)


def _require_acceleration(settings: ThreadSettings, bends: Sequence[float], motion: LinearMove, speed: float) -> None:
    """Raises CncError 22088 when the lead changes too fast."""
    if not bends_too_much(settings, bends, speed):
        return
    for name, c, axis in zip(settings.names, bends, settings.limits, strict=True):
        needed, limit = abs(c) * speed * speed, BEND_SHARE * min(axis.acceleration, axis.deceleration)
        if needed > limit:
            change, rpm = abs(words_of(motion).change), speed / DEG_S_PER_RPM
            reason = f"a lead that changes by {change:g} mm per revolution at {rpm:.6g} rpm needs {needed:.6g} mm/s² of"
            reason += f" axis {name}, it may take {limit:.6g} mm/s²"
            raise CncError(LEAD_TOO_FAST, reason, acceleration=needed, limit=limit, at_speed=rpm, change=change)


def _require_length(geometry: ThreadGeometry, ramps: Ramps, number: int, motion: LinearMove, speed: float) -> None:
    """A block must have room for what is at its begin and at its end. Raises CncError 22083."""
    is_last = number == len(geometry) - 1
    begin = ramps.run_up if number == 0 else 0.5 * geometry.zone_of(number)
    end = ramps.run_out if is_last else 0.5 * geometry.zone_of(number + 1)
    angle, pitch, last_pitch = angle_of(motion), pitch_of(motion), last_pitch_of(motion)
    missing = begin + end - angle
    if missing > ROUNDING:
        parts = f"{'run-up' if number == 0 else 'joint'} {begin * pitch:.3f} mm"
        parts += f" and {'run-out' if is_last else 'joint'} {end * last_pitch:.3f} mm"
        length = 0.5 * angle * (pitch + last_pitch)
        rpm, short = speed / DEG_S_PER_RPM, missing * last_pitch
        reason = f"block {number + 1} of the thread is {short:.3f} mm too short at"
        reason += f" {rpm:.6g} rpm: {parts} need more than its {length:.3f} mm"
        raise CncError(THREAD_TOO_SHORT, reason, missing=short, at_speed=rpm, length=length)


def _require_pitch_soon(settings: ThreadSettings, ramps: Ramps, motion: LinearMove) -> None:
    """Raises CncError 22084 for a run-up that is longer than permitted."""
    most, way = settings.run_up, ramps.run_up * pitch_of(motion)
    if most and way > most:
        reason = f"the run-up of the thread takes {way:.3f} mm, {way - most:.3f} mm more than"
        reason += f" the {most:g} mm in which it may be out of pitch (P-CHAN-90025)"
        raise CncError(RUN_UP_TOO_LONG, reason, way=way, limit=most)
