"""Lines and arcs in a plane (mm, radians): parallels, parts, intersections, distances.

A place on a shape is a fraction of its length, 0 at its start, 1 at its end. Left is seen in the direction of motion,
with the second axis of the plane to the left of the first.
"""

from __future__ import annotations

from math import atan2, cos, hypot, pi, sin, sqrt, tau
from typing import Final, NamedTuple

Point = tuple[float, float]
Vector = tuple[float, float]

SAME: Final = 1e-7
"""mm: a point that is beyond the end of a shape by less is its end."""


class Line(NamedTuple):
    """A straight line; `start` and `end` differ."""

    start: Point
    end: Point

    @property
    def length(self) -> float:
        return distance(self.start, self.end)

    @property
    def first_direction(self) -> Vector:
        """Unit vector of the motion at the start."""
        length = self.length
        return (self.end[0] - self.start[0]) / length, (self.end[1] - self.start[1]) / length

    @property
    def last_direction(self) -> Vector:
        return self.first_direction

    @property
    def curvature(self) -> float:
        return 0.0

    def point(self, place: float) -> Point:
        (x, y), (u, v) = self.start, self.end
        return x + (u - x) * place, y + (v - y) * place

    def place(self, point: Point) -> float:
        """Of the point of the line, without its ends, that is next to `point`."""
        x, y = self.end[0] - self.start[0], self.end[1] - self.start[1]
        return ((point[0] - self.start[0]) * x + (point[1] - self.start[1]) * y) / (x * x + y * y)

    def part(self, begin: float, end: float) -> Line:
        return Line(self.start if begin == 0.0 else self.point(begin), self.end if end == 1.0 else self.point(end))

    def parallel(self, left: float) -> Line:
        """The line at this distance to the left, mm."""
        x, y = self.first_direction
        dx, dy = -y * left, x * left
        return Line((self.start[0] + dx, self.start[1] + dy), (self.end[0] + dx, self.end[1] + dy))

    def distance(self, point: Point) -> float:
        """To the nearest point of the line."""
        return distance(point, self.point(min(1.0, max(0.0, self.place(point)))))


class Arc(NamedTuple):
    """An arc from angle `begin` by `sweep` radians, positive to the left (G03); a full circle has ±2π."""

    centre: Point
    radius: float
    begin: float
    sweep: float

    @property
    def start(self) -> Point:
        return self.point(0.0)

    @property
    def end(self) -> Point:
        return self.point(1.0)

    @property
    def length(self) -> float:
        return self.radius * abs(self.sweep)

    @property
    def curvature(self) -> float:
        """1/mm, above 0 to the left."""
        return self.turn / self.radius

    @property
    def turn(self) -> float:
        """1.0 to the left, -1.0 to the right."""
        return 1.0 if self.sweep > 0.0 else -1.0

    @property
    def first_direction(self) -> Vector:
        """Unit vector of the motion at the start."""
        return self._direction(self.begin)

    @property
    def last_direction(self) -> Vector:
        return self._direction(self.begin + self.sweep)

    def _direction(self, angle: float) -> Vector:
        return -sin(angle) * self.turn, cos(angle) * self.turn

    def point(self, place: float) -> Point:
        angle = self.begin + self.sweep * place
        return self.centre[0] + self.radius * cos(angle), self.centre[1] + self.radius * sin(angle)

    def place(self, point: Point) -> float:
        """Of the point of the circle in the direction of `point`; a little below 0 just before the start.

        0 for an arc of which nothing is left.
        """
        if not self.sweep:
            return 0.0
        angle = atan2(point[1] - self.centre[1], point[0] - self.centre[0])
        passed = ((angle - self.begin) * self.turn) % tau
        size = abs(self.sweep)
        beyond = passed - size
        if beyond > SAME / self.radius and tau - passed < beyond:
            passed -= tau
        return passed / size

    def part(self, begin: float, end: float) -> Arc:
        return self._replace(begin=self.begin + self.sweep * begin, sweep=self.sweep * (end - begin))

    def parallel(self, left: float) -> Arc:
        """The arc at this distance to the left, mm; its radius must stay above 0."""
        return self._replace(radius=self.radius - self.turn * left)

    def distance(self, point: Point) -> float:
        """To the nearest point of the arc."""
        if 0.0 <= self.place(point) <= 1.0:
            return abs(distance(point, self.centre) - self.radius)
        return min(distance(point, self.start), distance(point, self.end))


Shape = Line | Arc


def distance(a: Point, b: Point) -> float:
    return hypot(b[0] - a[0], b[1] - a[1])


def turn_between(before: Vector, behind: Vector) -> float:
    """Angle from one direction to another, radians, above 0 to the left; π for the opposite one."""
    cross = before[0] * behind[1] - before[1] * behind[0]
    along = before[0] * behind[0] + before[1] * behind[1]
    angle = atan2(cross, along)
    return pi if angle == -pi else angle


def arc_through(centre: Point, start: Point, sweep: float) -> Arc:
    """From `start` about `centre`."""
    begin = atan2(start[1] - centre[1], start[0] - centre[0])
    return Arc(centre, distance(centre, start), begin, sweep)


def moved_start(shape: Shape, start: Point) -> Shape:
    """The same with a start that is elsewhere by rounding, or along a line."""
    if isinstance(shape, Line):
        return Line(start, shape.end)
    place = shape.place(start)
    return shape.part(place if place < 0.5 or abs(shape.sweep) < pi else place - tau / abs(shape.sweep), 1.0)


def moved_end(shape: Shape, end: Point) -> Shape:
    """The same with an end that is elsewhere by rounding, or along a line."""
    if isinstance(shape, Line):
        return Line(shape.start, end)
    place = shape.place(end)
    return shape.part(0.0, place if place > 0.5 or abs(shape.sweep) < pi else place + tau / abs(shape.sweep))


def intersections(a: Shape, b: Shape) -> list[tuple[float, float]]:
    """Places on `a` and `b` of the points that both have, within SAME of their ends."""
    found = [(a.place(point), b.place(point)) for point in _crossings(a, b)]
    return [(_within(first, a), _within(second, b)) for first, second in found if _on(first, a) and _on(second, b)]


def _on(place: float, shape: Shape) -> bool:
    slack = SAME / shape.length
    return -slack <= place <= 1.0 + slack


def _within(place: float, shape: Shape) -> float:
    return min(1.0, max(0.0, place))


def _crossings(a: Shape, b: Shape) -> list[Point]:
    """Points of the endless lines and full circles."""
    if isinstance(a, Line):
        return _lines(a, b) if isinstance(b, Line) else _line_and_circle(a, b)
    return _line_and_circle(b, a) if isinstance(b, Line) else _circles(a, b)


PARALLEL: Final = 1e-12
"""Sine of an angle below which lines have no point of their own."""


def _lines(a: Line, b: Line) -> list[Point]:
    (x, y), (u, v) = a.first_direction, b.first_direction
    sine = x * v - y * u
    if abs(sine) < PARALLEL:
        return []
    along = ((b.start[0] - a.start[0]) * v - (b.start[1] - a.start[1]) * u) / sine
    return [(a.start[0] + along * x, a.start[1] + along * y)]


def _line_and_circle(line: Line, circle: Arc) -> list[Point]:
    (x, y), (u, v) = line.first_direction, circle.centre
    along = (u - line.start[0]) * x + (v - line.start[1]) * y
    foot = line.start[0] + along * x, line.start[1] + along * y
    aside = distance(foot, circle.centre)
    half = _half_chord(circle.radius, aside)
    return [] if half is None else [(foot[0] + way * x, foot[1] + way * y) for way in (-half, half)]


def _circles(a: Arc, b: Arc) -> list[Point]:
    """The common chord stands at (d² + r² - s²) / 2d from the first centre, at right angles to the line of centres."""
    apart = distance(a.centre, b.centre)
    if apart < PARALLEL * (a.radius + b.radius):
        return []
    x, y = (b.centre[0] - a.centre[0]) / apart, (b.centre[1] - a.centre[1]) / apart
    along = (apart + (a.radius - b.radius) * (a.radius + b.radius) / apart) / 2.0
    half = _half_chord(a.radius, abs(along))
    if half is None:
        return []
    foot = a.centre[0] + along * x, a.centre[1] + along * y
    return [(foot[0] - way * y, foot[1] + way * x) for way in (-half, half)]


TOUCHING: Final = 1e-9
"""mm: a circle that is missed by less is touched."""


def _half_chord(radius: float, aside: float) -> float | None:
    """Half of the chord at this distance from the centre; None if it misses the circle."""
    if aside > radius + TOUCHING:
        return None
    return sqrt(max(0.0, (radius - aside) * (radius + aside)))


def comes_nearer(shape: Shape, other: Shape, least: float) -> bool:
    """Whether a point of `shape` is nearer to `other` than `least` (mm).

    If both of its ends are not, it crosses one of the curves at that distance: the parallels and circles about the
    ends. Of two lines that do not cross, one has the nearest point at its end.
    """
    if min(other.distance(shape.start), other.distance(shape.end)) < least:
        return True
    if isinstance(shape, Line) and isinstance(other, Line):
        return min(shape.distance(other.start), shape.distance(other.end)) < least or bool(intersections(shape, other))
    curves: list[Shape] = [Arc(point, least, 0.0, tau) for point in (other.start, other.end)]
    for left in (least, -least):
        if isinstance(other, Line) or other.radius - other.turn * left > SAME:
            curves.append(other.parallel(left))
    return any(intersections(shape, curve) for curve in curves)


SAMPLES: Final = 64


def nearest(shape: Shape, other: Shape) -> float:
    """Smallest distance of points of `shape` to `other`, mm; for texts."""
    samples = min(other.distance(shape.point(index / SAMPLES)) for index in range(SAMPLES + 1))
    return min(samples, shape.distance(other.start), shape.distance(other.end))
