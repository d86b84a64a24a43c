"""The drive as a first-order lag with dead time, fitted to command velocity and actual velocity.

Model, exact for a command that is held over a cycle: v[k+1] = g·u[k-d] + (v[k] - g·u[k-d])·exp(-T/Ta); T cycle time,
u command velocity, d dead time in cycles, g gain (1 where the scaling is right). Source: TF5200 feedforward, figure 1.
If the telegram carries no velocity, the actual one is the distance of a cycle by its time, m[k+1] = g·u[k-d] +
(v[k] - g·u[k-d])·L/T with L = Ta·(1 - exp(-T/Ta)).
The sum of the squares of (simulated - recorded velocity) is the smallest possible (output error), so that noise on the
recorded velocity does not bend the result.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize_scalar
from scipy.signal import lfilter

from cnc_ptp.commissioning.faults import NO_COMMAND, NO_FIT, NO_MOTION, NOT_EXCITED, TOO_SHORT, refusal
from cnc_ptp.commissioning.trace import Array, AxisTrace, Span

LONGEST_DEAD_TIME = 20
"""Cycles (P-SIM-00018)."""
SHORTEST = 0.1
"""Seconds of recording."""
SLOWEST_POLE = 0.9999
POLES = (0.0, 0.15, 0.3, 0.45, 0.6, 0.75, 0.87, 0.94, 0.98, SLOWEST_POLE)
"""Of the first search."""
HARDLY_WORSE = 1.2
"""Ratio of misfits up to which a shorter dead time is preferred: lag and dead time look alike …"""
STILL_POSSIBLE = 1.5
"""… and up to which another one has to be reckoned with."""
NO_LAG = 1e-9
NEGLIGIBLE = 1e-12
"""Remaining part of a start velocity below which it does not count."""
AFTERWARDS = 0.1
"""Seconds after the end of a motion that still belong to it."""
MOST_CYCLES = 20_000
CORRELATED = 0.02
"""Seconds after which what the model does not explain is taken for independent."""
LARGEST_MISFIT = 0.2
"""Misfit above which the drive is no first-order lag at all."""
LEAST_CHANGE = 0.05
"""Part of the velocity that has to change within the recording: a constant one shows no lag."""


@dataclass(frozen=True, slots=True)
class DriveFit:
    """Result of the fit. Times in s.

    `deviation`: two standard deviations of Ta with this dead time. `speed`: the highest, mm/s (deg/s).
    `misfit`: root mean square of (simulated - recorded velocity) over that of (velocity - its mean).
    `alternatives`: (Ta, dead cycles) that fit nearly as well, as lag and dead time look alike in smooth motions.
    """

    time_constant: float
    dead_cycles: int
    gain: float
    misfit: float
    cycles: int
    cycle_time: float
    alternatives: tuple[tuple[float, int], ...] = ()
    deviation: float = 0.0
    speed: float = 0.0

    @property
    def dead_time(self) -> float:
        return self.dead_cycles * self.cycle_time

    @property
    def delay(self) -> float:
        """Ta + dead time: how far the velocity is behind its command in a long ramp."""
        return self.time_constant + self.dead_time


@dataclass(frozen=True, slots=True)
class _Piece:
    """Command and actual velocity of a stretch without gaps; whether the latter is the mean of the cycle before."""

    command: Array
    actual: Array
    mean_velocity: bool


def fit_drive(trace: AxisTrace) -> DriveFit:
    """Ta, dead time and gain of the drive, from the stretches in which the axis moves.

    Raises CncError 27003 too short, 27004 no motion, 27012 velocity never changes, 27014 no command, 27013 no fit.
    """
    pieces = _pieces(trace)
    fits = [_fit(pieces, dead) for dead in range(LONGEST_DEAD_TIME + 1)]
    least = min(fit[0] for fit in fits)
    error, pole, dead = next(fit for fit in fits if fit[0] <= HARDLY_WORSE**2 * least)
    alternatives = tuple(
        (_time_constant(fit[1], trace.cycle_time), fit[2]) for fit in fits if fit[0] <= STILL_POSSIBLE**2 * least
    )
    actual = np.concatenate([piece.actual for piece in pieces])
    misfit = math.sqrt(error) / float(np.linalg.norm(actual - actual.mean()))
    if misfit > LARGEST_MISFIT or pole >= SLOWEST_POLE:
        raise refusal(
            NO_FIT,
            trace.axis,
            "the actual velocity does not follow the command velocity like a first-order lag (misfit "
            f"{100.0 * misfit:.0f} %, at most {100.0 * LARGEST_MISFIT:.0f} %); nothing was made, look for errors and "
            "the torque limit in the recording",
        )
    gain = _errors(pieces, pole, dead)[1]
    cycle_time, time_constant = trace.cycle_time, _time_constant(pole, trace.cycle_time)
    deviation = _deviation(pieces, time_constant, dead, cycle_time)
    speed = float(np.max(np.abs(actual)))
    return DriveFit(time_constant, dead, gain, misfit, len(actual), cycle_time, alternatives, deviation, speed)


def _deviation(pieces: Sequence[_Piece], time_constant: float, dead: int, cycle_time: float) -> float:
    """Two standard deviations of Ta, s, from residuals r and their slopes d = dr/dTa: 2·sqrt(Σ(Σrd)²) / Σd².

    The inner sum covers CORRELATED seconds, in which neighbouring residuals may be alike (sandwich estimator of Newey
    and West for blocks): friction leaves residuals that are no noise.
    """
    step = max(0.01 * time_constant, 0.5 * cycle_time if time_constant < cycle_time else 0.0)
    residuals, more = (
        _residuals(pieces, _pole(lag, cycle_time), dead)[0] for lag in (time_constant, time_constant + step)
    )
    slopes = (more - residuals) / step
    blocks = np.arange(0, len(residuals), max(1, round(CORRELATED / cycle_time)))
    scores = np.add.reduceat(residuals * slopes, blocks)
    return 2.0 * math.sqrt(float(np.sum(scores * scores))) / float(np.sum(slopes * slopes))


def _pole(time_constant: float, cycle_time: float) -> float:
    return math.exp(-cycle_time / time_constant) if time_constant > 0.0 else 0.0


def _time_constant(pole: float, cycle_time: float) -> float:
    return 0.0 if pole <= NO_LAG else -cycle_time / math.log(pole)


def _pieces(trace: AxisTrace) -> list[_Piece]:
    spans = [span for span in trace.unbroken() if (span[1] - span[0]) * trace.cycle_time >= SHORTEST]
    if not spans:
        raise refusal(
            TOO_SHORT,
            trace.axis,
            f"{trace.seconds:g} s were recorded, at least {SHORTEST:g} s without a gap are needed; nothing was made",
        )
    if not np.any(trace.actual_velocity) or not np.any(trace.set_velocity):
        raise refusal(NO_MOTION, trace.axis, f"does not move in the recorded {trace.seconds:g} s; nothing was made")
    command = trace.command_velocity + trace.additive_velocity
    if not np.any(command):
        raise refusal(
            NO_COMMAND,
            trace.axis,
            "the recording holds no command velocity; nothing was made",
        )
    if float(np.ptp(trace.actual_velocity)) < LEAST_CHANGE * float(np.max(np.abs(trace.actual_velocity))):
        raise refusal(
            NOT_EXCITED,
            trace.axis,
            "the velocity hardly changes in the recording, which says nothing about the drive; nothing was made, "
            "record starts and stops",
        )
    moving = [stretch for span in spans for stretch in _moving(trace, span)]
    actual, mean = trace.actual_velocity, trace.mean_velocity
    return [_Piece(command[first:end], actual[first:end], mean) for first, end in _first_cycles(moving)]


def _moving(trace: AxisTrace, span: Span) -> list[Span]:
    """Stretches in which the axis is to move, and the AFTERWARDS seconds after each.

    At rest, friction holds an axis against any small velocity command: that is no lag.
    """
    first, end = span
    tail = round(AFTERWARDS / trace.cycle_time)
    wanted = np.flatnonzero(trace.set_velocity[first:end]) + first
    if not len(wanted):
        return []
    breaks = np.flatnonzero(np.diff(wanted) > tail)
    starts = [int(wanted[0]), *wanted[breaks + 1].tolist()]
    ends = [*wanted[breaks].tolist(), int(wanted[-1])]
    return [(low, min(high + tail, end)) for low, high in zip(starts, ends, strict=True)]


def _first_cycles(spans: Sequence[Span]) -> list[Span]:
    """As many as are useful: more cycles make the answer later, not better."""
    kept, total = [], 0
    for first, end in spans:
        kept.append((first, min(end, first + MOST_CYCLES - total)))
        total += end - first
        if total >= MOST_CYCLES:
            break
    return kept


def _fit(pieces: Sequence[_Piece], dead: int) -> tuple[float, float, int]:
    """(sum of squared errors, pole exp(-T/Ta), dead cycles) of the best pole with this dead time.

    The best pole of POLES, then between its neighbours.
    """
    errors = [_errors(pieces, pole, dead)[0] for pole in POLES]
    place = int(np.argmin(errors))
    bounds = (POLES[max(place - 1, 0)], POLES[min(place + 1, len(POLES) - 1)])
    found = minimize_scalar(
        lambda pole: _errors(pieces, pole, dead)[0], bounds=bounds, method="bounded", options={"xatol": 1e-10}
    )
    return (
        (float(found.fun), float(found.x), dead) if found.fun <= errors[place] else (errors[place], POLES[place], dead)
    )


def _errors(pieces: Sequence[_Piece], pole: float, dead: int) -> tuple[float, float]:
    """Sum of squared errors and the best gain."""
    residuals, gain = _residuals(pieces, pole, dead)
    return float(np.sum(residuals * residuals)), gain


def _residuals(pieces: Sequence[_Piece], pole: float, dead: int) -> tuple[Array, float]:
    """Simulated less recorded velocity of all pieces, and the best gain.

    The simulated velocity is g · forced part + the rest of the velocity at the start of its piece, which is
    unknown: its share p^k is taken out of both sides.
    """
    forced, wanted = [np.zeros(0)], [np.zeros(0)]
    for piece in pieces:
        usable = len(piece.actual) - dead - 1
        if usable > 0:
            free: Array = np.power(pole, np.arange(min(usable, _cycles_to_rest(pole))), dtype=np.float64)
            forced.append(_without(free, lfilter(_response(pole, piece), [1.0, -pole], piece.command[:usable])))
            wanted.append(_without(free, piece.actual[dead + 1 :]))
    simulated, target = np.concatenate(forced), np.concatenate(wanted)
    # Not @: the threads of BLAS make sums of this size many times slower on a busy machine.
    power = float(np.sum(simulated * simulated))
    gain = float(np.sum(simulated * target)) / power if power > 0.0 else 0.0
    return gain * simulated - target, gain


def _response(pole: float, piece: _Piece) -> tuple[float, ...]:
    """Numerator of the lag over 1 - p/z: 1 - p, or with the mean velocity 1 - q + (q - p)/z, q = (1 - p)·Ta/T."""
    if not piece.mean_velocity:
        return (1.0 - pole,)
    mean = (1.0 - pole) / -math.log(pole) if pole > NO_LAG else 0.0
    return 1.0 - mean, mean - pole


def _cycles_to_rest(pole: float) -> int:
    return 1 if pole < NEGLIGIBLE else math.ceil(math.log(NEGLIGIBLE) / math.log(pole))


def _without(free: Array, velocity: Array) -> Array:
    """The part of a velocity that no multiple of `free` at its start explains."""
    rest = velocity.copy()
    rest[: len(free)] -= free * (np.sum(free * rest[: len(free)]) / np.sum(free * free))
    return rest
