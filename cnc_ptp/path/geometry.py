"""Geometric elements of a path: lines, arcs and helices over any number of axes.

An element is run through by its path length s (mm). `shape(s)` gives position and derivatives of each axis by s, and
`bounds(begin, end)` how large these derivatives become on a part of it. `evaluate(s, v, a, j)` gives each axis its own
position and derivatives by the chain rule, from the path's velocity v, acceleration a and jerk j. `limits(feed, axes)`
gives the path's dynamics at which no axis exceeds its own limits.

The feed refers to the path of the axes with the indices `path_axes` (X, Y, Z, in any order); further axes travel
along and arrive together. If only further axes move, the path is theirs.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from math import atan2, cbrt, ceil, cos, hypot, inf, isfinite, pi, radians, sin, sqrt, tau
from typing import NamedTuple, Protocol

from cnc_ptp.errors import CncError
from cnc_ptp.motion import Limits
from cnc_ptp.motion.limits import LARGEST_LIMIT
from cnc_ptp.path.shape import AxisState, Bounds, Shape, speed_of

BAD_POINTS = 22100
TARGET_OFF_ARC = 22101
EMPTY_ARC = 22102
BAD_FEED = 22103

CENTRIPETAL_SHARE = 0.8
"""Largest part of the weakest plane axis's acceleration that the curvature may take: v²/r <= 0.8·A.

Along the path 0.6·A is left.
"""

CURVATURE_JERK_SHARE = 0.3
"""Largest part of the plane axes' jerk that v³/r² may take."""

CROSS_JERK_SHARE = 0.6
"""Largest part of the plane axes' jerk that 3·v·a/r may take.

0.5·J is left for the path's own jerk: (0.3 + 0.5)² + 0.6² = 1.
"""

CLOSING_TOLERANCE_MM = 0.01
CLOSING_TOLERANCE = 1e-4
"""An arc may miss its target by this distance plus this part of its radius."""

NEGLIGIBLE_MM = 1e-9
"""Smaller motion of the path axes counts as rounding: the path is then that of all axes."""


class AxisLimits(NamedTuple):
    """Largest velocity, acceleration (growth of |v|), deceleration (its reduction) and jerk of one axis; mm or deg."""

    velocity: float
    acceleration: float
    deceleration: float
    jerk: float


class Element(Protocol):
    """What the path interpolator needs of an element."""

    @property
    def length(self) -> float:
        """Path length, mm."""

    def evaluate(self, s: float, v: float, a: float, j: float) -> tuple[AxisState, ...]:
        """State of each axis at path length s."""


class Line:
    """Straight motion of all axes from `start` to `target` (mm or deg, one value per axis)."""

    __slots__ = ("_axes", "length", "start", "target")

    def __init__(self, start: Sequence[float], target: Sequence[float], path_axes: Collection[int]) -> None:
        _check_points(start, target)
        self.start = tuple(start)
        self.target = tuple(target)
        distances = [b - a for a, b in zip(self.start, self.target, strict=True)]
        self.length = hypot(*(distance for n, distance in enumerate(distances) if n in path_axes))
        if self.length < NEGLIGIBLE_MM:
            self.length = hypot(*distances)
        scale = 1.0 / self.length if self.length else 0.0
        self._axes = tuple([(p, distance * scale) for p, distance in zip(self.start, distances, strict=True)])

    def evaluate(self, s: float, v: float, a: float, j: float) -> tuple[AxisState, ...]:
        """State of each axis at path length s: position p0 + k·s, derivatives k·v, k·a, k·j.

        Exactly the target at the end.
        """
        if s >= self.length:
            return tuple([(p, k * v, k * a, k * j) for p, (_, k) in zip(self.target, self._axes, strict=True)])
        return tuple([(p + k * s, k * v, k * a, k * j) for p, k in self._axes])

    def shape(self, s: float) -> list[Shape]:
        """q, q1, q2, q3 of each axis at path length s; exactly the target at the end."""
        if s >= self.length:
            return [(p, k, 0.0, 0.0) for p, (_, k) in zip(self.target, self._axes, strict=True)]
        return [(p + k * s, k, 0.0, 0.0) for p, k in self._axes]

    def bounds(self, begin: float, end: float) -> list[Bounds]:
        """Largest |q1|, |q2|, |q3| of each axis; the same everywhere."""
        return [(abs(k), 0.0, 0.0) for _, k in self._axes]

    def speed(self, s: float, axes: Sequence[int]) -> float:
        """|dq/ds| of the given axes."""
        return speed_of(self.shape(0.0), axes)

    def limits(self, feed: float, axes: Sequence[AxisLimits], override_max: float = 1.0) -> Limits:
        """Path dynamics by projection: each axis gives its limit divided by its share |k| of the path.

        feed           programmed path velocity, mm/s; inf for rapid traverse, where the axes alone limit
        override_max   largest factor on the feed that may be commanded
        """
        _check_feed(feed)
        slopes = [abs(k) for _, k in self._axes]
        return _combine(feed * override_max, [_project(slopes, axes)])


class Arc:
    """Circular motion in a plane of two axes, linear motion of all others (helix).

    plane       indices of the first and second plane axis; positive sweep turns from the first to the second
    center      centre in these two axes, mm (absolute)
    sweep_deg   signed angle, deg; several turns allowed
    length      √(arc² + linear²): the arc and the linear motion of the remaining axes among `path_axes`
    rate        rad by which the arc turns in 1 mm of path length, with the sign of the sweep

    The circle runs through `start` around `center`. A closing error at the target (rounded I, J, K) is spread evenly
    over the path; more than 0.01 mm + radius/10000 is refused with CncError 22101, an arc without length with 22102.
    """

    __slots__ = (
        "_angle", "_center", "_drift", "_linear",
        "center", "length", "plane", "radius", "rate", "start", "sweep_deg", "target",
    )  # fmt: skip

    def __init__(
        self,
        start: Sequence[float],
        target: Sequence[float],
        center: Sequence[float],
        plane: Sequence[int],
        radius: float,
        sweep_deg: float,
        path_axes: Collection[int],
    ) -> None:
        _check_points(start, target)
        self.start = tuple(start)
        self.target = tuple(target)
        self.center = (center[0], center[1])
        self.plane = (plane[0], plane[1])
        self.sweep_deg = sweep_deg
        first, second = self.plane
        x, y = self.start[first] - center[0], self.start[second] - center[1]
        self.radius = hypot(x, y)
        if not (0.0 < self.radius < inf and 0.0 < abs(sweep_deg) < inf):
            raise CncError(
                EMPTY_ARC,
                f"arc with radius {self.radius!r} mm and sweep {sweep_deg!r} deg: both must be finite and not 0",
                "the motion is refused",
                radius=self.radius,
                sweep_deg=sweep_deg,
            )
        sweep = radians(sweep_deg)
        others = [(n, b - a) for n, (a, b) in enumerate(zip(start, target, strict=True)) if n not in self.plane]
        self.length = hypot(self.radius * sweep, *(distance for n, distance in others if n in path_axes))
        self._angle = atan2(y, x)
        self.rate = sweep / self.length
        self._linear = tuple([(n, self.start[n], distance / self.length) for n, distance in others])
        self._set_drift(x, y, sweep, radius)

    def _set_drift(self, x: float, y: float, sweep: float, radius: float) -> None:
        """Spread the closing error at the target (and the rounding of r·cos, r·sin at the start) over the path."""
        first, second = self.plane
        miss_x = self.target[first] - self.center[0] - (x * cos(sweep) - y * sin(sweep))
        miss_y = self.target[second] - self.center[1] - (x * sin(sweep) + y * cos(sweep))
        miss = hypot(miss_x, miss_y)
        limit = CLOSING_TOLERANCE_MM + CLOSING_TOLERANCE * self.radius
        if miss > limit:
            raise CncError(
                TARGET_OFF_ARC,
                f"arc around ({self.center[0]!r}, {self.center[1]!r}) with radius {self.radius:.6g} mm "
                f"(programmed {radius:.6g} mm) ends {miss:.6g} mm away from its target; the limit is {limit:.6g} mm",
                "the motion is refused",
                miss=miss,
                limit=limit,
            )
        self._drift = (miss_x / self.length, miss_y / self.length)
        self._center = (
            self.start[first] - self.radius * cos(self._angle),
            self.start[second] - self.radius * sin(self._angle),
        )

    def evaluate(self, s: float, v: float, a: float, j: float) -> tuple[AxisState, ...]:
        """State of each axis at path length s; exactly the target at the end.

        The linear axes as on a line; with θ = θ0 + w·s the plane axes have θ' = w·v, θ'' = w·a, θ''' = w·j and
        x = cx + r·cosθ, x' = -r·sinθ·θ', x'' = -r·sinθ·θ'' - r·cosθ·θ'², x''' = -r·sinθ·(θ''' - θ'³) - 3·r·cosθ·θ'·θ''.
        """
        angle = self._angle + self.rate * s
        x = self.radius * cos(angle)
        y = self.radius * sin(angle)
        rate = self.rate * v
        swing = self.rate * a
        square = rate * rate
        turn = self.rate * j - square * rate
        cross = 3.0 * rate * swing
        dx, dy = self._drift
        cx, cy = self._center
        first, second = self.plane
        states: list[AxisState] = [(0.0, 0.0, 0.0, 0.0)] * len(self.start)
        for n, p, k in self._linear:
            states[n] = (p + k * s, k * v, k * a, k * j)
        states[first] = (
            cx + x + dx * s,
            dx * v - y * rate,
            dx * a - y * swing - x * square,
            dx * j - y * turn - x * cross,
        )
        states[second] = (
            cy + y + dy * s,
            dy * v + x * rate,
            dy * a + x * swing - y * square,
            dy * j + x * turn - y * cross,
        )
        if s >= self.length:
            return tuple([(p, *state[1:]) for p, state in zip(self.target, states, strict=True)])
        return tuple(states)

    def shape(self, s: float) -> list[Shape]:
        """q, q1, q2, q3 of each axis at path length s; exactly the target at the end.

        The linear axes as on a line; with θ = θ0 + w·s and its drift k the first plane axis has
        q = cx + r·cosθ + k·s, q1 = k - w·r·sinθ, q2 = -w²·r·cosθ, q3 = w³·r·sinθ.
        """
        w = self.rate
        angle = self._angle + w * s
        x = self.radius * cos(angle)
        y = self.radius * sin(angle)
        square = w * w
        cube = square * w
        dx, dy = self._drift
        cx, cy = self._center
        first, second = self.plane
        shape: list[Shape] = [(0.0, 0.0, 0.0, 0.0)] * len(self.start)
        for n, p, k in self._linear:
            shape[n] = (p + k * s, k, 0.0, 0.0)
        shape[first] = (cx + x + dx * s, dx - y * w, -x * square, y * cube)
        shape[second] = (cy + y + dy * s, dy + x * w, -y * square, -x * cube)
        if s >= self.length:
            return [(p, q1, q2, q3) for p, (_, q1, q2, q3) in zip(self.target, shape, strict=True)]
        return shape

    def bounds(self, begin: float, end: float) -> list[Bounds]:
        """Largest |q1|, |q2|, |q3| of each axis from s = `begin` to `end`, from the ranges of sine and cosine there."""
        w, r = self.rate, self.radius
        least, most = self._angle + w * begin, self._angle + w * end
        if w < 0.0:
            least, most = most, least
        low_sine, high_sine = _range(least, most, sin(least), sin(most), 0.5 * pi)
        low_cosine, high_cosine = _range(least, most, cos(least), cos(most), 0.0)
        sine, cosine = r * max(-low_sine, high_sine), r * max(-low_cosine, high_cosine)
        square = w * w
        cube = abs(square * w)
        dx, dy = self._drift
        first, second = self.plane
        found: list[Bounds] = [(0.0, 0.0, 0.0)] * len(self.start)
        for n, _, k in self._linear:
            found[n] = (abs(k), 0.0, 0.0)
        along = max(abs(dx - r * low_sine * w), abs(dx - r * high_sine * w))
        found[first] = (along, cosine * square, sine * cube)
        along = max(abs(dy + r * low_cosine * w), abs(dy + r * high_cosine * w))
        found[second] = (along, sine * square, cosine * cube)
        return found

    def speed(self, s: float, axes: Sequence[int]) -> float:
        """|dq/ds| of the given axes."""
        return speed_of(self.shape(s), axes)

    def limits(self, feed: float, axes: Sequence[AxisLimits], override_max: float = 1.0) -> Limits:
        """Path dynamics under which no axis exceeds its limits at any angle, at any velocity up to the returned one.

        The plane axes share the weaker one's limits. With k the plane part of the path velocity, u = k·v and r the
        radius:
        velocity       u <= V, u²/r <= 0.8·min(A+, A-), u³/r² <= 0.3·J
        acceleration   (k·a)² + (u²/r)² <= A² for A+ and A- apart, and 3·u·k·a/r <= 0.6·J
        jerk           (k·j + u³/r²)² + (3·u·k·a/r)² <= J²
        All are taken at the highest velocity, so that a later override within it needs no other limits; where the
        velocity is low against the radius they tend to those of a line. `feed`, `override_max` as for a line.
        """
        _check_feed(feed)
        r = self.radius
        first, second = axes[self.plane[0]], axes[self.plane[1]]
        velocity = min(first.velocity, second.velocity)
        up = min(first.acceleration, second.acceleration)
        down = min(first.deceleration, second.deceleration)
        jerk = min(first.jerk, second.jerk)
        k = abs(self.rate) * r + hypot(*self._drift)
        linear = _project([abs(slope) for _, _, slope in self._linear], [axes[n] for n, _, _ in self._linear])
        u = min(
            velocity,
            sqrt(CENTRIPETAL_SHARE * min(up, down) * r),
            cbrt(CURVATURE_JERK_SHARE * jerk * r * r),
            k * min(feed * override_max, linear.velocity),
        )
        normal = u * u / r
        along = CROSS_JERK_SHARE * jerk * r / (3.0 * u) if u else inf
        up = min(sqrt(up * up - normal * normal), along)
        down = min(sqrt(down * down - normal * normal), along)
        cross = 3.0 * u * max(up, down) / r
        free = sqrt(jerk * jerk - cross * cross) - normal * u / r
        return _combine(u / k, [linear, Limits(inf, up / k, down / k, free / k)])


def _range(least: float, most: float, at_least: float, at_most: float, crest: float) -> tuple[float, float]:
    """Smallest and largest value between two angles, of a sine wave that has a crest at the angle `crest`."""
    low, high = min(at_least, at_most), max(at_least, at_most)
    if crest + tau * ceil((least - crest) / tau) <= most:
        high = 1.0
    if crest + pi + tau * ceil((least - crest - pi) / tau) <= most:
        low = -1.0
    return low, high


def _project(slopes: Sequence[float], axes: Sequence[AxisLimits]) -> Limits:
    """Path limits of linear axes: each limit divided by the axis's share of the path; inf where nothing moves."""
    velocity = acceleration = deceleration = jerk = inf
    for k, axis in zip(slopes, axes, strict=True):
        if k:
            velocity = min(velocity, axis.velocity / k)
            acceleration = min(acceleration, axis.acceleration / k)
            deceleration = min(deceleration, axis.deceleration / k)
            jerk = min(jerk, axis.jerk / k)
    return Limits(velocity, acceleration, deceleration, jerk)


def _combine(feed: float, parts: Sequence[Limits]) -> Limits:
    """The tightest of all limits, within the feed.

    A path on which nothing moves gets the largest limits that planners take.
    """
    return Limits(
        min(feed, LARGEST_LIMIT, *(part.velocity for part in parts)),
        min(LARGEST_LIMIT, *(part.acceleration for part in parts)),
        min(LARGEST_LIMIT, *(part.deceleration for part in parts)),
        min(LARGEST_LIMIT, *(part.jerk for part in parts)),
    )


def _check_feed(feed: float) -> None:
    """Refuse a feed that is not above 0 (inf is rapid traverse). Raises CncError 22103."""
    if not feed > 0.0:
        raise CncError(BAD_FEED, f"path feed {feed!r} mm/s must be greater than 0", "the motion is refused", feed=feed)


def _check_points(start: Sequence[float], target: Sequence[float]) -> None:
    """Refuse points with different numbers of axes or with coordinates that are no finite numbers.

    Raises CncError 22100.
    """
    if len(start) != len(target):
        reason = f"path from {len(start)} to {len(target)} axes"
        raise CncError(BAD_POINTS, reason, "the motion is refused", start=len(start), target=len(target))
    for name, point in (("start", start), ("target", target)):
        for n, value in enumerate(point):
            if not isfinite(value):
                reason = f"path {name} of axis {n} = {value!r} must be a finite number"
                raise CncError(BAD_POINTS, reason, "the motion is refused", point=name, axis=n, value=value)
