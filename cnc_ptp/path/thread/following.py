"""How the angle φ of a thread follows its spindle: where that is expected, and a mismatch that goes to 0.

φ counts in the direction in which the spindle turns, from the start of the thread on. After each report of the spindle
the expectation is another one; φ continues from where it is, with its speed and acceleration, and comes to the new
one by a `Fading`.
"""

from __future__ import annotations

from typing import Final

from cnc_ptp.motion import Limits
from cnc_ptp.motion.setpoints import MotionState
from cnc_ptp.path.thread.lead import Fading, fading
from cnc_ptp.path.thread.leading_spindle import LeadingSpindle
from cnc_ptp.path.thread.thread_check import ThreadSettings, limits_of
from cnc_ptp.path.thread.thread_geometry import ThreadGeometry

JOINT_SHARE: Final = 0.25
"""Of acceleration and jerk that is left for following the spindle through a joint."""
KNEE_SHARE: Final = 0.1
"""Of the jerk: with so much the path goes along when the acceleration of the spindle ends …"""
LARGEST_KNEE_SHARE: Final = 0.5
"""… and with so much where that is soon."""
FREE_SHARE: Final = 0.95
"""Of the jerk, for that and for the mismatch."""
SLOWER_SHARE: Final = 0.5
"""Of the speed of the spindle by which the path may be slower: it never turns back."""
SMALLEST_RATE: Final = 1e-3
"""deg/s for a correction where the axes or a spindle at a standstill leave none."""


class Following:
    """Of one thread.

    sign   1 or -1, the direction of the spindle
    zero   deg from its zero passage and OFFSET to the start of the thread, in this direction
    """

    def __init__(self, settings: ThreadSettings, spindle: LeadingSpindle, offset: float) -> None:
        """`offset` in deg."""
        self._settings, self._spindle, self._offset = settings, spindle, offset
        self.sign, self.zero = 1.0, 0.0
        self._fading: Fading | None = None
        self._fading_begin = 0

    def turned(self, cycle: float) -> MotionState:
        """What the spindle is expected to have turned from the zero passage to when the axes act."""
        angle, speed, gain, jerk = self._spindle.angle.at(cycle + self._settings.delay)
        sign = self.sign
        return sign * angle - sign * self._offset, sign * speed, sign * gain, sign * jerk

    def spindle_angle(self, angle: float) -> float:
        """deg of the spindle at φ."""
        return self.sign * (angle + self.zero) + self._offset

    def rest(self) -> tuple[float, float] | None:
        """φ where the spindle comes to rest, and the cycle in which it does; None if that is not known."""
        known = self._spindle.angle.rest
        if known is None:
            return None
        angle, cycle = known
        return self.sign * (angle - self._offset) - self.zero, cycle - self._settings.delay

    def renew(self, geometry: ThreadGeometry, cycle: int, state: MotionState, horizon: float, *, stops: bool) -> None:
        """From a state of φ at `cycle` on it comes to what is expected now; at the soonest within `horizon` s.

        `stops`: the path will leave the expectation where the spindle comes to rest.
        """
        soon = min(geometry.end, state[0] + state[1] * horizon)
        blocks = range(geometry.block_at(state[0]), geometry.block_at(soon) + 1)
        limits = limits_of(self._settings, geometry, blocks, abs(state[1]))
        if geometry.in_joint(state[0], soon):
            limits = Limits(limits.velocity, *[JOINT_SHARE * limit for limit in limits[1:]])
        used = 0.0 if stops and self.rest() is not None else self._soften(cycle, state[1], limits.jerk)
        angle, speed, gain, _ = self._expected(cycle)
        mismatch = (state[0] - angle, state[1] - speed, state[2] - gain)
        is_ahead = mismatch[0] + mismatch[1] * horizon > 0.0
        free = SLOWER_SHARE * speed if is_ahead else geometry.fastest(blocks) - speed
        limits = limits._replace(velocity=max(free, SMALLEST_RATE), jerk=FREE_SHARE * limits.jerk - used)
        self._fading, self._fading_begin = fading(mismatch, horizon, gain, limits), cycle

    def _soften(self, cycle: int, speed: float, jerk: float) -> float:
        """Of the end of an acceleration of the spindle; the jerk that is used for it.

        A path out of step by more than what is still to come goes straight to what comes then.
        """
        angle = self._spindle.angle
        in_step = abs(speed - self._expected(cycle)[1]) < angle.change
        return angle.expect(KNEE_SHARE * jerk, LARGEST_KNEE_SHARE * jerk if in_step else 0.0)

    def at(self, cycle: int) -> MotionState:
        """φ and its derivatives at a cycle."""
        assert self._fading is not None
        angle, speed, gain, jerk = self._expected(cycle)
        mismatch, rate, bend, change = self._fading.at((cycle - self._fading_begin) * self._settings.cycle_time)
        return angle + mismatch, speed + rate, gain + bend, jerk + change

    def _expected(self, cycle: int) -> MotionState:
        angle, speed, gain, jerk = self.turned(cycle)
        return angle - self.zero, speed, gain, jerk
