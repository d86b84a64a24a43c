"""Path interpolator: runs one geometric element after the other with exact stop at each end."""

from __future__ import annotations

from math import inf

from cnc_ptp.errors import CncError
from cnc_ptp.motion import Limits, Profile
from cnc_ptp.motion.limits import SMALLEST_LIMIT, check_limits
from cnc_ptp.motion.setpoints import MotionState
from cnc_ptp.motion.sine_profile import SineProfile
from cnc_ptp.path.geometry import Element
from cnc_ptp.path.planner import JERK_LIMITED, Planner

STILL_MOVING = 22110
BAD_FEED = 22111
BAD_DWELL = 22112
BAD_OVERRIDE = 22113

PathRow = tuple[float, float, float, float, bool]
"""One cycle on the path: length s (mm), velocity, acceleration, jerk, element finished."""

LARGEST_OVERRIDE = 1000.0
LONGEST_DWELL = 1e9
BRAKE_ROUNDING = 1e-12
"""Part of the element's length that counts as rounding when its braking point is looked for."""


class PathInterpolator:
    """Runs elements along their path length; the caller evaluates the element's geometry with the rows.

        interpolator.start(element, element.limits(feed, axes))
        while len(rows) < count:
            rows += interpolator.step(count - len(rows), cycle_time)
            if len(rows) < count and <there is a next element>:
                interpolator.start(next_element, limits)        # continues at the exact instant, inside the cycle

    `step` gives a row (s, v, a, j, done) per cycle. It returns early, without the row of the cycle in which the element
    ends, and `done` is then true: that cycle belongs to the next element, which `start` starts `remaining_time` before
    it. So the time of a program is the sum of its profile durations, not rounded up to cycles. A caller without a next
    element calls `step` again: from then on it gets rows at rest at the end (done = True), and a later `start` acts
    from the last of them.

    element           the active element, None before the first; `length` is its path length
    done              the element has finished
    stopped           `stop` was called and the path is at a standstill
    remaining_time    s: when an element has just ended, the time from its end to the cycle that is still to be filled,
                      else 0
    distance_to_go    mm to the end of the element
    state             (s, v, a, j) of the last cycle that was given out

    Commands act from the last cycle given out, in any phase: the profile is replanned from its s, v and a,
    which therefore never step. Times are offset + cycles·cycle_time with an integer count, so long elements
    accumulate no rounding.
    """

    def __init__(self) -> None:
        self.element: Element | None = None
        self.done = True
        self.remaining_time = 0.0
        self.override = 1.0
        self._limits: Limits | None = None
        self._planner = JERK_LIMITED
        self._length = 0.0
        self._feed = 0.0
        self._profile = _standing(0.0)
        self._reaches_end = False
        self._stopping = False
        self._offset = 0.0
        self._next_offset = 0.0
        self._cycles = 0
        self._cycle_time = 0.0

    @property
    def state(self) -> MotionState:
        """(s, v, a, j) of the last cycle that was given out, mm and s."""
        return self._profile.state_at(self._now())

    @property
    def stopped(self) -> bool:
        """True when `stop` was called and the path is at a standstill, on the element or at its end."""
        return self._stopping and (self.done or (not self._reaches_end and self._now() >= self._profile.duration))

    @property
    def ends_by_itself(self) -> bool:
        """The override no longer acts: the element has finished or brakes for its end, or `stop` was called."""
        return self.done or self._stopping or (self._limits is not None and self._brakes(self._limits))

    @property
    def distance_to_go(self) -> float:
        """Path length (mm) from the last cycle given out to the end of the element."""
        return 0.0 if self.done else self._length - self.state[0]

    @property
    def end(self) -> float:
        """Path length (mm) at which the path comes to rest, as it is planned now."""
        return self._profile.end[0]

    @property
    def next_offset(self) -> float:
        """s by which the next cycle's predecessor is behind the exact end of the last element; 0 or less."""
        return self._next_offset

    def go_on(self, offset: float) -> None:
        """What has moved the path meanwhile has ended; `offset` as above."""
        self._next_offset = offset

    @property
    def time_to_go(self) -> float:
        """Seconds from the last cycle given out to the end of the element or dwell, at the present override.

        0.0 when it is done, -1.0 while the override or a stop does not let it reach its end.
        """
        if self.done:
            return 0.0
        return max(0.0, self._profile.duration - self._now()) if self._reaches_end else -1.0

    def start(
        self, element: Element, limits: Limits, feed: float | None = None, *, planner: Planner = JERK_LIMITED
    ) -> None:
        """Begin an element at rest; directly after the end of another one at that exact instant.

        limits   dynamics of the path; `limits.velocity` is never exceeded, whatever the override
        feed     path velocity at override 1, mm/s; without it (or inf) `limits.velocity`
        planner  makes all profiles of the element
        Raises CncError 22110 while an element is running, 22111 for a bad feed and 23001 for bad limits.
        """
        self._check_free("the next element")
        feed = limits.velocity if feed is None or feed == inf else feed
        if not feed > 0.0:
            reason = f"path feed {feed!r} mm/s must be greater than 0"
            raise CncError(BAD_FEED, reason, "the element is not started", feed=feed)
        check_limits(limits)
        velocity = min(feed * self.override, limits.velocity)
        if velocity < SMALLEST_LIMIT and element.length > 0.0:
            profile, reaches_end = _standing(0.0), False
        else:
            velocity = max(velocity, SMALLEST_LIMIT)
            profile, reaches_end = planner.from_rest(0.0, element.length, limits._replace(velocity=velocity)), True
        self.element, self._limits, self._feed, self._planner = element, limits, feed, planner
        self._begin(element.length, profile, reaches_end)

    def dwell(self, seconds: float) -> None:
        """Dwell at the present position, with the same exact instants; `step` and `done` as for an element.

        Raises CncError 22110 while an element is running and 22112 for a time that is negative or not finite.
        """
        self._check_free("a dwell")
        if not 0.0 <= seconds <= LONGEST_DWELL:
            reason = f"dwell of {seconds!r} s must be between 0 and {LONGEST_DWELL:g} s"
            raise CncError(BAD_DWELL, reason, "it is not started", seconds=seconds, limit=LONGEST_DWELL)
        s = self._length if self.done else self.state[0]
        self._limits = None
        self._begin(s, Profile(((0.0, s, 0.0, 0.0, 0.0), (seconds, s, 0.0, 0.0, 0.0))), True)

    def set_override(self, override: float) -> None:
        """The velocity becomes feed·override (1 is 100 %), at most `limits.velocity`; 0 is feed hold.

        It also holds for later elements. If the element already brakes for its end, the table is kept.
        Raises CncError 22113 for an override outside 0 … 1000.
        """
        if not 0.0 <= override <= LARGEST_OVERRIDE:
            reason = f"path override {override!r} must be between 0 and {LARGEST_OVERRIDE:g}"
            raise CncError(BAD_OVERRIDE, reason, "it is not changed", factor=override, limit=LARGEST_OVERRIDE)
        if override != self.override:
            self.override = override
            self._plan_anew()

    def stop(self) -> None:
        """Ramp to rest on the path; if the element already brakes for its end, it rests there.

        The override no longer acts.
        """
        if not self._stopping:
            self._stopping = True
            self._plan_anew()

    def step(self, count: int, cycle_time: float) -> list[PathRow]:
        """Rows of the next `count` cycles of `cycle_time` seconds.

        Fewer when the element ends before (see the class).
        """
        if cycle_time != self._cycle_time:
            self._offset, self._cycles, self._cycle_time = self._now(), 0, cycle_time
        if self.done:
            return self._rest(count)
        state_at, offset, first = self._profile.state_at, self._offset, self._cycles + 1
        end = self._profile.duration if self._reaches_end else inf
        rows: list[PathRow] = []
        for cycle in range(first, first + count):
            t = offset + cycle * cycle_time
            if t >= end:
                self._end(t - end)
                break
            rows.append((*state_at(t), False))
        self._cycles += len(rows)
        return rows

    def _check_free(self, what: str) -> None:
        if not self.done and not self.stopped:
            raise CncError(
                STILL_MOVING,
                f"{what} was started {self.distance_to_go:.6g} mm before the end of the running path element",
                "the active one continues",
                distance_to_go=self.distance_to_go,
            )

    def _begin(self, length: float, profile: Profile, reaches_end: bool) -> None:
        self._length, self._profile, self._reaches_end = length, profile, reaches_end
        self._offset, self._cycles = self._next_offset, 0
        self._next_offset = 0.0
        self.remaining_time = 0.0
        self.done = self._stopping = False

    def _end(self, surplus: float) -> None:
        self.done = True
        self.remaining_time = surplus
        self._next_offset = surplus - self._cycle_time

    def _rest(self, count: int) -> list[PathRow]:
        """Nothing follows: rows at rest, and a later start acts from the last of them."""
        self.remaining_time = self._next_offset = 0.0
        self._profile = _standing(self._length)
        return [(self._length, 0.0, 0.0, 0.0, True)] * count

    def _now(self) -> float:
        """Time of the last cycle given out on the active profile, s.

        Negative while the element only starts after it.
        """
        return self._offset + self._cycles * self._cycle_time

    def _plan_anew(self) -> None:
        """A new profile from the state of the last cycle given out, unless the element already brakes for its end."""
        limits = self._limits
        if self.done or limits is None or self._brakes(limits):
            return
        now, before = self._now(), self._profile
        begin = before.settled(now)
        s, v, a, _ = before.state_at(begin)
        velocity = 0.0 if self._stopping else min(self._feed * self.override, limits.velocity)
        if velocity < SMALLEST_LIMIT:
            self._profile, self._reaches_end = self._planner.to_rest(s, v, a, limits), False
        else:
            limits = limits._replace(velocity=velocity)
            self._profile, self._reaches_end = self._planner.to_position(s, v, a, self._length, limits), True
        if begin > now and isinstance(before, SineProfile):
            self._profile = before.continued(begin, self._profile)
        else:
            self._offset, self._cycles = min(now, 0.0), 0

    def _brakes(self, limits: Limits) -> bool:
        """True if in the last cycle given out a stop would end no earlier than the element."""
        s, v, a, _ = self._profile.state_at(self._profile.settled(self._now()))
        to_brake = self._length - s - self._planner.stopping_distance(v, a, limits)
        return self._reaches_end and to_brake <= BRAKE_ROUNDING * self._length


def _standing(s: float) -> Profile:
    return Profile(((0.0, s, 0.0, 0.0, 0.0),))
