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
ROUNDING = 4e-15
"""Part of a position by which it may differ after sums of relative motions; a line of that length is none."""


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
            if self.length <= ROUNDING * max(map(abs, self.target)):
                self.length = 0.0
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


class Ring(NamedTuple):
    """What an axis does on an arc: q = centre + slope·s + along·cosθ + across·sinθ, with θ by path length s.

    slope   of the linear motion and of the closing error, mm/mm
    size    √(along² + across²), mm: amplitude of the circular motion, 0 for an axis that has none
    crest   angle (rad) at which this motion is largest
    """

    centre: float
    slope: float
    along: float
    across: float
    size: float
    crest: float


class Arc:
    """Circular motion in a plane, linear motion of all axes beside it (helix).

    plane       indices of the first and second plane axis; positive sweep turns from the first to the second
    directions  two unit vectors at right angles, a value for each axis, in place of the two plane axes
    center      centre along the plane axes or directions, mm (absolute)
    sweep_deg   signed angle, deg; several turns allowed
    length      √(arc² + linear²): the arc and the linear motion of the `path_axes`
    rate        rad by which the arc turns in 1 mm of path length, with the sign of the sweep

    The circle runs through `start` around `center`. A closing error at the target (rounded I, J, K) is spread evenly
    over the path; more than 0.01 mm + radius/10000 is refused with CncError 22101, an arc without length with 22102.
    """

    __slots__ = (
        "_angle", "_drift", "_linear", "_rings",
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
        directions: tuple[Sequence[float], Sequence[float]] | None = None,
    ) -> None:
        _check_points(start, target)
        self.start = tuple(start)
        self.target = tuple(target)
        self.center = (center[0], center[1])
        self.plane = (plane[0], plane[1])
        self.sweep_deg = sweep_deg
        first, second = directions or [[float(n == axis) for n in range(len(start))] for axis in plane]
        x, y = _along(start, first) - center[0], _along(start, second) - center[1]
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
        distances = [b - a for a, b in zip(start, target, strict=True)]
        forth, aside = _along(distances, first), _along(distances, second)
        linear = [d - forth * u - aside * w for d, u, w in zip(distances, first, second, strict=True)]
        self.length = hypot(self.radius * sweep, *[distance for n, distance in enumerate(linear) if n in path_axes])
        self._angle = atan2(y, x)
        self.rate = sweep / self.length
        self._linear = [distance / self.length for distance in linear]
        self._set_rings(x, y, sweep, radius, first, second)

    def _set_rings(
        self, x: float, y: float, sweep: float, radius: float, first: Sequence[float], second: Sequence[float]
    ) -> None:
        """Spread the closing error at the target (and the rounding of r·cos, r·sin at the start) over the path."""
        miss_x = _along(self.target, first) - self.center[0] - (x * cos(sweep) - y * sin(sweep))
        miss_y = _along(self.target, second) - self.center[1] - (x * sin(sweep) + y * cos(sweep))
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
        drift_x, drift_y = miss_x / self.length, miss_y / self.length
        self._drift = hypot(drift_x, drift_y)
        cosine, sine = cos(self._angle), sin(self._angle)
        self._rings = []
        for p, k, u, w in zip(self.start, self._linear, first, second, strict=True):
            along, across = self.radius * u, self.radius * w
            centre, slope = p - (along * cosine + across * sine), k + (drift_x * u + drift_y * w)
            self._rings.append(Ring(centre, slope, along, across, hypot(along, across), atan2(across, along)))

    def evaluate(self, s: float, v: float, a: float, j: float) -> tuple[AxisState, ...]:
        """State of each axis at path length s; exactly the target at the end.

        With θ = θ0 + w·s: θ' = w·v, θ'' = w·a, θ''' = w·j. With g = along·cosθ + across·sinθ and
        h = dg/dθ = across·cosθ - along·sinθ the circular motion is g, its derivatives are h·θ', h·θ'' - g·θ'² and
        h·(θ''' - θ'³) - 3·g·θ'·θ''.
        """
        angle = self._angle + self.rate * s
        cosine, sine = cos(angle), sin(angle)
        rate = self.rate * v
        swing = self.rate * a
        square = rate * rate
        twist = self.rate * j - square * rate
        cross = 3.0 * rate * swing
        states: list[AxisState] = []
        for centre, k, along, across, _, _ in self._rings:
            g, h = along * cosine + across * sine, across * cosine - along * sine
            states.append(
                (centre + g + k * s, k * v + h * rate, k * a + h * swing - g * square, k * j + h * twist - g * cross)
            )
        if s >= self.length:
            return tuple([(p, *state[1:]) for p, state in zip(self.target, states, strict=True)])
        return tuple(states)

    def shape(self, s: float) -> list[Shape]:
        """q, q1, q2, q3 of each axis at path length s; exactly the target at the end.

        With θ = θ0 + w·s and g, h as in `evaluate`: q1 = slope + w·h, q2 = -w²·g, q3 = -w³·h.
        """
        w = self.rate
        angle = self._angle + w * s
        cosine, sine = cos(angle), sin(angle)
        square = w * w
        cube = square * w
        shape: list[Shape] = []
        for centre, k, along, across, _, _ in self._rings:
            g, h = along * cosine + across * sine, across * cosine - along * sine
            shape.append((centre + g + k * s, k + h * w, -g * square, -h * cube))
        if s >= self.length:
            return [(p, q1, q2, q3) for p, (_, q1, q2, q3) in zip(self.target, shape, strict=True)]
        return shape

    def bounds(self, begin: float, end: float) -> list[Bounds]:
        """Largest |q1|, |q2|, |q3| of each axis from s = `begin` to `end`, from the ranges of sine and cosine there."""
        w = self.rate
        least, most = self._angle + w * begin, self._angle + w * end
        if w < 0.0:
            least, most = most, least
        square = w * w
        cube = abs(square * w)
        found: list[Bounds] = []
        for _, k, _, _, size, crest in self._rings:
            if size == 0.0:
                found.append((abs(k), 0.0, 0.0))
                continue
            low, high = _range(least - crest, most - crest, 0.0)
            falling, rising = _range(least - crest, most - crest, -0.5 * pi)
            along = max(abs(k + size * falling * w), abs(k + size * rising * w))
            found.append((along, size * max(-low, high) * square, size * max(-falling, rising) * cube))
        return found

    def fourth_derivative(self, axis: int) -> float:
        """Largest |q4| of an axis on the whole circle: its amplitude times w⁴."""
        square = self.rate * self.rate
        return self._rings[axis].size * square * square

    def speed(self, s: float, axes: Sequence[int]) -> float:
        """|dq/ds| of the given axes."""
        return speed_of(self.shape(s), axes)

    def limits(self, feed: float, axes: Sequence[AxisLimits], override_max: float = 1.0) -> Limits:
        """Path dynamics under which no axis exceeds its limits at any angle, at any velocity up to the returned one.

        The axes of the circle share the weakest one's limits V, A, J. With k the plane part of the path velocity,
        u = k·v and r the radius:
        velocity       u <= V, u²/r <= 0.8·min(A+, A-), u³/r² <= 0.3·J
        acceleration   (k·a)² + (u²/r)² <= A² for A+ and A- apart, and 3·u·k·a/r <= 0.6·J
        jerk           (k·j + u³/r²)² + (3·u·k·a/r)² <= J²
        An axis has the share size/r of the circle, and with the slope m of its linear motion the share size/r + |m|/k;
        its limits count divided by that share, which is 1 in a plane of two axes.
        All are taken at the highest velocity, so that a later override within it needs no other limits; where the
        velocity is low against the radius they tend to those of a line. `feed`, `override_max` as for a line.
        """
        _check_feed(feed)
        r = self.radius
        k = abs(self.rate) * r + self._drift
        shares = [
            ring.size / r + abs(m) / k if ring.size else 0.0 for ring, m in zip(self._rings, self._linear, strict=True)
        ]
        circle = _project(shares, axes)
        linear = _project([0.0 if ring.size else abs(ring.slope) for ring in self._rings], axes)
        up, down, jerk = circle.acceleration, circle.deceleration, circle.jerk
        u = min(
            circle.velocity,
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


def _along(point: Sequence[float], direction: Sequence[float]) -> float:
    """Coordinate of a point along a direction."""
    return sum([p * d for p, d in zip(point, direction, strict=True)])


def _range(least: float, most: float, crest: float) -> tuple[float, float]:
    """Smallest and largest value of cos(θ - crest) for θ between two angles."""
    at_least, at_most = cos(least - crest), cos(most - crest)
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


def _combine(feed: float, parts: list[Limits]) -> Limits:
    """The tightest of all limits, within the feed.

    A path on which nothing moves gets the largest limits that planners take.
    """
    velocity = min(feed, LARGEST_LIMIT)
    acceleration = deceleration = jerk = LARGEST_LIMIT
    for part in parts:
        velocity = min(velocity, part.velocity)
        acceleration = min(acceleration, part.acceleration)
        deceleration = min(deceleration, part.deceleration)
        jerk = min(jerk, part.jerk)
    return Limits(velocity, acceleration, deceleration, jerk)


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


def begins_element(before: float, now: float) -> bool:
    """From the distances to go (mm) of two cycles: within an element they only decrease, but for rounding."""
    return now > before + NEGLIGIBLE_MM
