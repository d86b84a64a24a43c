"""Where a spindle will be: its set motion continues to the commanded speed, and its actual angle stays beside it.

The set speed changes with the set acceleration of the last cycle until it is the commanded speed; where that is not
on the way, for TREND. What the actual angles of the last N cycles are beside the set motion is a parabola for TREND,
then a straight line. With u = -(N-1)/2 … (N-1)/2 for these cycles and sums over them, the least squares fit of the
distance y = c0 + c1·u + c2·u² has

    c1 = Σu·y / Σu²      c2 = Σ(u² - Σu²/N)·y / (Σu⁴ - (Σu²)²/N)      c0 = (Σy - c2·Σu²) / N

Speed and drive lag thus are in the parabola, and so is a load. Knees of the set motion are exact.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from typing import Final, NamedTuple

from cnc_ptp.motion import Profile
from cnc_ptp.motion.setpoints import MotionState

SAMPLES: Final = 12
"""Cycles whose angles count."""
TREND: Final = 0.03
"""s for which an acceleration of unknown end is taken to last."""
AT_ONCE: Final = 1e30
"""deg/s³: no jerk that a path would have to keep."""
_CENTRE: Final = 0.5 * (SAMPLES - 1)
_PLACES: Final = [index - _CENTRE for index in range(SAMPLES)]
_SQUARES: Final = sum([u * u for u in _PLACES])
_MEAN: Final = _SQUARES / SAMPLES
_BENT: Final = [u * u - _MEAN for u in _PLACES]
_BENT_SQUARES: Final = sum([w * w for w in _BENT])


class SpindleReport(NamedTuple):
    """Cycles of a spindle.

    angles, speeds   actual angle (deg) and set speed (deg/s) of each cycle
    acceleration     set acceleration of the last one, deg/s²
    wanted           speed that is commanded in it, deg/s
    """

    first_cycle: int
    angles: Sequence[float]
    speeds: Sequence[float]
    acceleration: float
    wanted: float


class SpindleAngle:
    """The actual angle of a spindle, deg, and what is to be expected of it."""

    def __init__(self, cycle_time: float) -> None:
        """`cycle_time` in s."""
        self._cycle_time = cycle_time
        self._angles: deque[float] = deque(maxlen=SAMPLES)
        self._speeds: deque[float] = deque(maxlen=SAMPLES)
        self._last_cycle = 0
        self._beside = (0.0, 0.0, 0.0)
        """Distance from the set motion that goes through the last angle, its rate and bend, in the last cycle."""
        self._acceleration = self._wanted = 0.0
        self._set_motion = Profile([(0.0, 0.0, 0.0, 0.0, 0.0)])
        """From the last cycle on; its angle, and …"""
        self._distance = self._set_motion
        """… the distance from it."""

    def read(self, report: SpindleReport) -> None:
        """A block of cycles; behind a gap those before it do not count."""
        if report.first_cycle != self._last_cycle + 1:
            self._angles.clear()
            self._speeds.clear()
        self._angles.extend(report.angles)
        self._speeds.extend(report.speeds)
        self._last_cycle = report.first_cycle + len(report.angles) - 1
        self._acceleration, self._wanted = report.acceleration, report.wanted
        if self.known:
            self._beside = self._fit()
            self.expect_at_once()

    @property
    def known(self) -> bool:
        """Enough cycles were reported."""
        return len(self._angles) == SAMPLES

    @property
    def speed(self) -> float:
        """deg/s, signed."""
        return self._speeds[-1] + self._beside[1] if self.known else 0.0

    @property
    def acceleration(self) -> float:
        """deg/s², signed."""
        return self._acceleration + self._beside[2]

    def _fit(self) -> tuple[float, float, float]:
        t = self._cycle_time
        angles, speeds = list(self._angles), list(self._speeds)
        last, way = angles[-1], 0.0
        total = tilt = bend = 0.0
        for index in range(SAMPLES - 1, -1, -1):
            if index < SAMPLES - 1:
                way -= 0.5 * t * (speeds[index] + speeds[index + 1])
            y = angles[index] - last - way
            total += y
            tilt += _PLACES[index] * y
            bend += _BENT[index] * y
        c2 = bend / _BENT_SQUARES
        c1 = tilt / _SQUARES
        c0 = total / SAMPLES - c2 * _MEAN
        at_last = c0 + _CENTRE * (c1 + _CENTRE * c2)
        return at_last, (c1 + 2.0 * c2 * _CENTRE) / t, 2.0 * c2 / (t * t)

    @property
    def lasts(self) -> float:
        """s for which the set acceleration lasts."""
        missing, gain = self._wanted - self._speeds[-1], self._acceleration
        return missing / gain if missing * gain > 0.0 else TREND

    @property
    def change(self) -> float:
        """deg/s by which the set speed still changes."""
        return abs(self.lasts * self._acceleration)

    @property
    def rest(self) -> tuple[float, float] | None:
        """Angle at which the spindle comes to rest and the cycle in which it does; None if that is not known."""
        if self._wanted or self._speeds[-1] * self._acceleration >= 0.0:
            return None
        cycle = self._last_cycle + self.lasts / self._cycle_time
        return self.at(cycle)[0], cycle

    def expect(self, gentle: float, most: float) -> float:
        """Plans what `at` says, from the last report; the largest jerk of that, deg/s³.

        A path cannot change its acceleration at once: where that of the spindle ends, it does so with the jerk
        `gentle`, or if there is no time for it with up to `most`.
        """
        speed, gain = self._speeds[-1], self._acceleration
        self._set_motion = coming(self._angles[-1], speed, gain, self.lasts, gentle, most)
        distance, rate, bend = self._beside
        self._distance = coming(distance, rate, bend, TREND, 0.5 * gentle, 0.5 * gentle)
        return largest_jerk(self._set_motion) + largest_jerk(self._distance)

    def expect_at_once(self) -> None:
        """As `expect` for a path that need not keep any jerk."""
        self.expect(AT_ONCE, AT_ONCE)

    def at(self, cycle: float) -> MotionState:
        """Angle, speed, acceleration and jerk expected at a cycle (also between two of them)."""
        t = (cycle - self._last_cycle) * self._cycle_time
        angle, speed, gain, jerk = self._set_motion.state_at(t)
        distance, rate, bend, change = self._distance.state_at(t)
        return angle + distance, speed + rate, gain + bend, jerk + change


def coming(angle: float, speed: float, gain: float, lasts: float, gentle: float, most: float) -> Profile:
    """A motion whose acceleration `gain` lasts for some s, then its speed stays; around that instant the jerk acts.

    Where there is no time for `most`, it is the straight line behind that instant from the beginning on: who follows
    has to come there anyway.
    """
    end = speed + lasts * gain
    if abs(gain) > 2.0 * lasts * max(gentle, most):
        return Profile([(0.0, angle - 0.5 * gain * lasts * lasts, end, 0.0, 0.0)])
    half = min(lasts, 0.5 * abs(gain) / gentle)
    begin, span = lasts - half, 2.0 * half
    at_begin = speed + begin * gain
    place = angle + 0.5 * begin * (speed + at_begin)
    rows = [(0.0, angle, speed, gain, 0.0)]
    if span > 0.0:
        rows.append((begin, place, at_begin, gain, -gain / span))
    rows.append((begin + span, place + span * (at_begin + span * gain / 3.0), end, 0.0, 0.0))
    return Profile(rows)


def largest_jerk(profile: Profile) -> float:
    """deg/s³."""
    return max([abs(jerk) for _, _, _, _, jerk in profile.rows])
