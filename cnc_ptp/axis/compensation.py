"""Position compensation: an additional distance D within a length L of the basic motion (TX1250 2.5).

The velocity of the compensation is a trapezoid over the time T = L/VP, without jerk limit. It begins with the rate r1
and ends with r2: AK+ and AK- for D > 0, AK- and AK+ for D < 0. Its peak v solves

    |D| = v·T - v²/2·(1/r1 + 1/r2)      with v <= VK and v·(1/r1 + 1/r2) <= T

and if no such v exists, the largest one is taken: what cannot be reached is cut off. The compensation is tied to the
basic motion: it moves in the same direction, its velocity follows that of the trapezoid times h = min(1, |v|/VP), and
its time stops while both are at rest. It never changes faster than r1 and r2: where the basic motion changes h faster,
it lags behind and may come to rest after the basic motion. As it stays within the trapezoid, D is never exceeded; it
is reached exactly if the basic motion keeps VP or more, less of it otherwise.
"""

from __future__ import annotations

from math import copysign, sqrt

from cnc_ptp.motion import Profile
from cnc_ptp.motion.setpoints import MotionState

ROUNDING = 1e-12
"""Part of a value that counts as rounding."""


def plan_compensation(
    length: float, difference: float, process_velocity: float, velocity_increase: float, rise: float, fall: float
) -> Profile:
    """Table of the compensation, counted in the direction of the basic motion; it ends at D, or as near as possible.

    `length` and `difference` in mm (deg), `process_velocity` VP and `velocity_increase` VK in mm/s, `rise` AK+ and
    `fall` AK- in mm/s²; all but the difference > 0.
    """
    sign = 1.0 if difference > 0.0 else -1.0
    first, last = (rise, fall) if difference > 0.0 else (fall, rise)
    duration = length / process_velocity
    slopes = 1.0 / first + 1.0 / last
    under_root = duration * duration - 2.0 * slopes * abs(difference)
    wanted = 2.0 * abs(difference) / (duration + sqrt(max(0.0, under_root)))
    if under_root >= -ROUNDING * duration * duration and wanted <= velocity_increase * (1.0 + ROUNDING):
        return _trapezoid(sign, wanted, first, last, duration, abs(difference))
    peak = min(velocity_increase, duration / slopes)
    return _trapezoid(sign, peak, first, last, duration, peak * (duration - 0.5 * slopes * peak))


def _trapezoid(sign: float, peak: float, first: float, last: float, duration: float, end: float) -> Profile:
    """Rows for ramps of the rates `first` and `last`, between them the peak is held for the rest of `duration`."""
    rise, fall = peak / first, peak / last
    hold_end = max(rise, duration - fall)
    rows = [
        (0.0, 0.0, 0.0, sign * first, 0.0),
        (rise, sign * 0.5 * peak * rise, sign * peak, 0.0, 0.0),
        (hold_end, sign * (end - 0.5 * peak * fall), sign * peak, -sign * last, 0.0),
        (max(duration, hold_end), sign * end, 0.0, 0.0, 0.0),
    ]
    return Profile(rows)


class Compensation:
    """The compensation of one axis, added to the basic motion cycle by cycle.

    `at` must be called in the order of cycles; for the same cycle it may be called again. What has been compensated
    stays as an offset between axis and basic motion.
    """

    def __init__(self, *, cycle_time: float) -> None:
        """`cycle_time` in s."""
        self._cycle_time = cycle_time
        self._direction = self._side = 1.0
        self._process_velocity = 1.0
        self._rise = self._fall = 0.0
        self._profile: Profile | None = None
        self._ran = 0
        self._cycle = 0
        self._base = (0.0, 0.0)
        self._speed = 0.0
        self._lags = False
        self.offset = 0.0
        """Axis minus basic motion, mm (deg)."""

    @property
    def _time(self) -> float:
        """Elapsed time of the table, s."""
        return self._ran * self._cycle_time

    @property
    def active(self) -> bool:
        return self._profile is not None

    @property
    def moving(self) -> bool:
        """True while it adds a velocity to the basic motion."""
        return self._profile is not None and self._speed > 0.0

    def start(
        self, cycle: int, base: MotionState, *, direction: float, process_velocity: float, profile: Profile
    ) -> None:
        """Starts at `cycle`, at which the basic motion has the state `base` and goes in `direction` (+1, -1)."""
        sign = copysign(1.0, profile.rows[0][3])
        self._profile = Profile([(t, sign * p, sign * v, sign * a, 0.0) for t, p, v, a, _ in profile.rows])
        self._rise, self._fall = self._profile.rows[0][3], -self._profile.rows[-2][3]
        self._direction, self._side = direction, direction * sign
        self._process_velocity = process_velocity
        self._ran = 0
        self._cycle, self._base = cycle, base[1:3]
        self._speed, self._lags = 0.0, False

    def stop(self) -> bool:
        """Ramps the compensation down with its last rate: D becomes what is reached by then. False in its last ramp.

        If it still rises while the basic motion is at rest, it does not rise further.
        """
        profile = self._profile
        if profile is None:
            return False
        distance, velocity, _, _ = profile.state_at(self._time)
        h = self._follow(self._base[0])[0]
        if self._lags and self._speed < velocity * h:
            velocity = self._speed / h
        elif self._time >= profile.starts[-2]:
            return False
        d = velocity / self._fall
        end = (d, distance + 0.5 * velocity * d, 0.0, 0.0, 0.0)
        self._profile = Profile([(0.0, distance, velocity, -self._fall, 0.0), end]) if d > 0.0 else None
        self._ran = 0
        return True

    def end(self) -> None:
        """The basic motion has ended: so does the compensation, on its last ramp if it still moves."""
        if self.moving:
            self.stop()
        else:
            self._profile = None

    def reset(self) -> None:
        """The offset has been taken over by the basic motion."""
        self._profile = None
        self.offset = 0.0

    def at(self, cycle: int, base: MotionState) -> MotionState:
        """Basic motion plus compensation at `cycle`."""
        if self._profile is not None and cycle > self._cycle:
            self._advance(cycle, base)
        position, velocity, acceleration, jerk = base
        position += self.offset
        if self._profile is None:
            return position, velocity, acceleration, jerk
        rate, change = self._rates(self._profile, base)
        s = self._side
        return position, velocity + s * self._speed, acceleration + s * rate, jerk + s * change

    def _rates(self, profile: Profile, base: MotionState) -> tuple[float, float]:
        """First and second derivative of the additional speed, the first one within the rates."""
        _, w, dw, _ = profile.state_at(self._time)
        h, dh, ddh = self._follow(*base[1:])
        if self._lags:
            return (self._rise if w * h > self._speed else -self._fall), 0.0
        rate = dw * h + w * dh
        if -self._fall <= rate <= self._rise:
            return rate, 2.0 * dw * dh + w * ddh
        return min(max(rate, -self._fall), self._rise), 0.0

    def _follow(self, velocity: float, acceleration: float = 0.0, jerk: float = 0.0) -> tuple[float, float, float]:
        """h = min(1, v/VP) along the direction of the compensation, and its two derivatives."""
        scale = self._direction / self._process_velocity
        ratio = scale * velocity
        if ratio >= 1.0:
            return 1.0, 0.0, 0.0
        if ratio < 0.0:
            return 0.0, 0.0, 0.0
        return ratio, scale * acceleration, scale * jerk

    def _advance(self, cycle: int, base: MotionState) -> None:
        """The cycles since the last call: towards the speed for the basic motion, as far as the rates allow."""
        profile = self._profile
        assert profile is not None
        before, self._base = self._base, base[1:3]
        cycles, self._cycle = cycle - self._cycle, cycle
        if before[0] == 0.0 and base[1] == 0.0 and self._speed == 0.0:
            return
        start, seconds = self._time, cycles * self._cycle_time
        self._ran += cycles
        end = min(self._time, profile.duration)
        wanted = profile.state_at(end)[1] * self._follow(base[1])[0]
        change = min(max(wanted - self._speed, -self._fall * seconds), self._rise * seconds)
        reached = self._speed + change
        late = abs(wanted - reached) > ROUNDING * (wanted + self._speed)
        if late or self._lags:
            distance = seconds * (self._speed + 0.5 * change)
        else:
            distance = self._distance(profile, start, end, before, seconds)
        self.offset += self._side * distance
        self._speed, self._lags = reached if late else wanted, late
        if self._time >= profile.duration * (1.0 - ROUNDING) and not late:
            self._profile = None

    def _distance(
        self, profile: Profile, start: float, end: float, before: tuple[float, float], seconds: float
    ) -> float:
        """Distance of the trapezoid from `start` to `end` times the mean of h since `before` of the basic motion."""
        (v0, a0), (v1, a1) = before, self._base
        middle = 0.5 * (v0 + v1) + 0.125 * (a0 - a1) * seconds
        h0, hm, h1 = (self._follow(v)[0] for v in (v0, middle, v1))
        mean = (h0 + 4.0 * hm + h1) / 6.0
        w0, wm, w1 = (profile.state_at(t)[1] for t in (start, 0.5 * (start + end), end))
        distance = mean * (profile.state_at(end)[0] - profile.state_at(start)[0])
        return distance + (end - start) / 6.0 * (w0 * (h0 - mean) + 4.0 * wm * (hm - mean) + w1 * (h1 - mean))
