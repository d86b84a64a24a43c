"""Friction over velocity from phases of constant velocity: without acceleration, the motor's torque is the friction.

Source: TF5200 friction 3.1 (torque read off during a motion at constant speed), done for both directions.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from cnc_ptp.commissioning.faults import NO_MOTION, NO_TORQUE, NOT_STEADY, ONE_DIRECTION, TOO_SHORT, refusal
from cnc_ptp.commissioning.steady_motion import SteadyPhase, longest_steady, steady_phases
from cnc_ptp.commissioning.timing import Seconds
from cnc_ptp.commissioning.trace import Array, AxisTrace
from cnc_ptp.errors import CncError

SHORTEST = 0.05
"""Seconds of settled motion that a phase must have."""
BATCHES = 5
"""Parts of a phase whose means are compared: neighbouring cycles are not independent."""
SAME_SPEED = 0.01
"""Relative difference of set velocities that are taken as one."""
LARGEST_RIPPLE = 0.3
"""Standard deviation of the actual velocity over its mean, above which the axis sticks and slips."""
EVEN = 0.01
"""Seconds; an axis that sticks and slips does it more slowly."""
LARGEST_DEVIATION = 0.05
"""Relative deviation of the mean actual velocity from the set one, above which it has not settled."""


@dataclass(frozen=True, slots=True)
class FrictionPoint:
    """Friction at one speed; mm/s (deg/s), N (Nm).

    `friction` = (M(+v) - M(-v)) / 2, `load` = (M(+v) + M(-v)) / 2 (weight of a hanging axis), `scatter`: standard
    deviation of the batch means about the mean of their direction, and half a digit of the torque, squares added.
    """

    speed: float
    positive: float
    negative: float
    scatter: float
    seconds: float

    @property
    def friction(self) -> float:
        return 0.5 * (self.positive - self.negative)

    @property
    def load(self) -> float:
        return 0.5 * (self.positive + self.negative)


@dataclass(frozen=True, slots=True)
class FrictionCurve:
    """The friction in a recording: points in ascending order, and the speeds that could not be used."""

    axis: str
    points: tuple[FrictionPoint, ...]
    one_way: tuple[float, ...] = ()
    """Set velocities (with sign) that were driven in one direction only …"""
    uneven: tuple[float, ...] = ()
    """… those at which the axis did not move evenly (stick-slip, or not settled) …"""
    standing: tuple[float, ...] = ()
    """… and those at which it did not move: the torque does not come above the friction."""


@dataclass(frozen=True, slots=True)
class _Sample:
    """A phase: set velocity, means of its batches, length in s."""

    velocity: float
    batches: Array
    seconds: float


def friction_curve(trace: AxisTrace, *, settling: Seconds, half_digit: float = 0.0) -> FrictionCurve:
    """The friction curve of a recording; `settling`: seconds dropped at the start of each phase, by speed.

    `half_digit` of the recorded torque in N (Nm): a steady torque in whole digits may be off by that without a sign.
    Raises CncError 27003 too short, 27004 no motion, 27005 no torque, 27006 nothing steady, 27007 one direction only.
    """
    torque = _torque(trace)
    phases = steady_phases(trace, settling=settling, shortest=SHORTEST)
    if not phases:
        raise _nothing_steady(trace, settling)
    even = [phase for phase in phases if moves_evenly(trace, phase)]
    standing = [phase for phase in phases if stands(trace, phase)]
    held = tuple(sorted({phase.velocity for phase in standing}))
    uneven = tuple(sorted({phase.velocity for phase in phases if phase not in even and phase not in standing}))
    if not even and not uneven:
        raise _stands_still(trace, torque, standing)
    if not even:
        shown = ", ".join(f"{velocity:g}" for velocity in uneven)
        raise refusal(
            NOT_STEADY,
            trace.axis,
            f"moves unevenly at every constant velocity ({shown}): it sticks and slips, or had not settled; "
            "no table was made, drive faster or longer",
        )
    samples = [_sample(trace, torque, phase) for phase in even]
    points, one_way = _points(samples, half_digit)
    if not points:
        shown = ", ".join(f"{velocity:g}" for velocity in one_way)
        raise refusal(
            ONE_DIRECTION,
            trace.axis,
            f"no speed was driven in both directions (constant velocities: {shown}); weight and friction "
            "cannot be told apart, no table was made, drive each speed in both directions",
        )
    return FrictionCurve(trace.axis, points, one_way, uneven, held)


def _stands_still(trace: AxisTrace, torque: Array, phases: Sequence[SteadyPhase]) -> CncError:
    largest = max(float(np.max(np.abs(torque[phase.first : phase.end]))) for phase in phases)
    shown = ", ".join(f"{velocity:g}" for velocity in sorted({phase.velocity for phase in phases}))
    return refusal(
        NOT_STEADY,
        trace.axis,
        f"does not move at any constant velocity ({shown}), the torque comes up to {largest:.4g} and not above the "
        "friction: is the torque limit of the drive too low, or the axis blocked? no table was made",
    )


def _torque(trace: AxisTrace) -> Array:
    if len(trace) == 0 or trace.seconds < SHORTEST:
        raise refusal(
            TOO_SHORT,
            trace.axis,
            f"{trace.seconds:g} s were recorded, at least {SHORTEST:g} s are needed; nothing was made",
        )
    if not np.any(trace.set_velocity):
        raise refusal(NO_MOTION, trace.axis, f"does not move in the recorded {trace.seconds:g} s; nothing was made")
    if trace.actual_torque is None:
        raise refusal(
            NO_TORQUE,
            trace.axis,
            "the recording holds no actual_torque (it was made by an older version); nothing was made, record again",
        )
    if not np.any(trace.actual_torque):
        raise refusal(
            NO_TORQUE,
            trace.axis,
            "the drive reported no torque (actual_torque is 0 in all cycles); nothing was made. The telegram needs "
            "S-0-0084 or object 6077, a simulated drive has friction with simulation.model CASCADED (P-SIM-00006)",
        )
    return trace.actual_torque


def _nothing_steady(trace: AxisTrace, settling: Seconds) -> CncError:
    seconds, velocity = longest_steady(trace)
    if not velocity:
        return refusal(NOT_STEADY, trace.axis, "never moves with constant velocity in the recording; nothing was made")
    needed = settling(abs(velocity)) + SHORTEST
    return refusal(
        NOT_STEADY,
        trace.axis,
        "no motion with constant velocity lasts long enough to settle and to be measured: the longest, at "
        f"{velocity:g}, lasts {seconds:g} s of the {needed:g} s that it needs; nothing was made",
    )


def stands(trace: AxisTrace, phase: SteadyPhase) -> bool:
    """Whether the axis does not move in a phase, or hardly."""
    position = trace.actual_position[phase.first : phase.end]
    set_distance = abs(phase.velocity) * (len(phase) - 1) * trace.cycle_time
    return float(np.ptp(position)) < LARGEST_DEVIATION * set_distance


def moves_evenly(trace: AxisTrace, phase: SteadyPhase) -> bool:
    """Whether the axis moves in a phase at its set velocity, without sticking."""
    speed, position = abs(phase.velocity), trace.actual_position[phase.first : phase.end]
    distance, time = float(position[-1] - position[0]), (len(phase) - 1) * trace.cycle_time
    mean = distance / time if len(phase) > 1 else float(trace.actual_velocity[phase.first])
    return abs(mean - phase.velocity) <= LARGEST_DEVIATION * speed and _ripple(trace, phase) <= LARGEST_RIPPLE * speed


def _ripple(trace: AxisTrace, phase: SteadyPhase) -> float:
    """Standard deviation of the velocity, or of the distance of EVEN seconds by its time if that is steadier.

    Noise of a measured velocity is no motion, digits of a position are none either; sticking shows in both.
    """
    span, window = slice(phase.first, phase.end), round(EVEN / trace.cycle_time)
    measured, position = float(np.std(trace.actual_velocity[span])), trace.actual_position[span]
    if not 1 < window < len(position):
        return measured
    return min(measured, float(np.std(position[window:] - position[:-window])) / (window * trace.cycle_time))


def _sample(trace: AxisTrace, torque: Array, phase: SteadyPhase) -> _Sample:
    parts = np.array_split(torque[phase.first : phase.end], min(BATCHES, len(phase)))
    batches = np.array([float(part.mean()) for part in parts])
    return _Sample(phase.velocity, batches, len(phase) * trace.cycle_time)


def _points(samples: Sequence[_Sample], half_digit: float) -> tuple[tuple[FrictionPoint, ...], tuple[float, ...]]:
    points, one_way = [], []
    for group in _by_speed(samples):
        forth = [sample for sample in group if sample.velocity > 0.0]
        back = [sample for sample in group if sample.velocity < 0.0]
        if forth and back:
            points.append(_point(group, forth, back, half_digit))
        else:
            one_way.append(group[0].velocity)
    return tuple(points), tuple(one_way)


def _by_speed(samples: Iterable[_Sample]) -> list[list[_Sample]]:
    groups: list[list[_Sample]] = []
    for sample in sorted(samples, key=lambda sample: abs(sample.velocity)):
        if groups and abs(sample.velocity) <= abs(groups[-1][0].velocity) * (1.0 + SAME_SPEED):
            groups[-1].append(sample)
        else:
            groups.append([sample])
    return groups


def _point(
    group: Sequence[_Sample], forth: Sequence[_Sample], back: Sequence[_Sample], half_digit: float
) -> FrictionPoint:
    means, residuals = [], []
    for direction in (forth, back):
        batches = np.concatenate([sample.batches for sample in direction])
        means.append(float(batches.mean()))
        residuals.append(batches - means[-1])
    all_residuals = np.concatenate(residuals)
    freedom = len(all_residuals) - 2
    scatter = float(np.sqrt(np.sum(all_residuals**2) / freedom)) if freedom > 0 else 0.0
    scatter = math.hypot(scatter, half_digit)
    speed = float(np.mean([abs(sample.velocity) for sample in group]))
    return FrictionPoint(speed, means[0], means[1], scatter, sum(sample.seconds for sample in group))
