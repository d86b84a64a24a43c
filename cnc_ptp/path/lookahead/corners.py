"""Corners of a path: a curve with continuous direction and curvature in place of a kink or a jump of the curvature.

Element A is left at the distance dA before the corner, B is met at dB behind it (path length on lines and arcs). In
between are three cubic pieces of the same length h = (dA + dB)/3. Their parameter u is that of A and B, so that q, q1
and q2 are continuous everywhere and q3 has a limit. For each axis, with q = y0, q1 = s0, q2 = M0 where A is left, y3,
s3, M3 where B is met, and M1, M2 at the two joints,

    M1 + M2 = (s3 - s0)/h - (M0 + M3)/2
    2·M1 + M2 = (y3 - y0 - 3h·s0)/h² - 4/3·M0 - M3/6

The curve depends linearly on A and B, and where they are one cubic it is that cubic. So it deviates from them, measured
at equal u, by the jumps of q1, q2, q3 in the corner and by the fourth derivative of arcs:

    deviation <= c1·d·|Δq1| + c2·d²·|Δq2| + c3·d³·|Δq3| + c4·d⁴·(|q4| of A + |q4| of B)        d = max(dA, dB)

where each c is the largest that its part becomes along the curve. Between two lines it is exactly 13/72·d·|Δq1|.

With an interim point (POS) there is such a curve on each of its sides, as long as its chord, l1 and l2. Direction s and
M at the point y are those of two polynomials of fourth degree with continuous q, q1, q2, which the manual has there:

    d1 = y - y0 - s0·l1 - M0·l1²/2        d2 = y - y3 + s3·l2 - M3·l2²/2
    s·(6/l1 + 6/l2) = 12·d1/l1² - 12·d2/l2² + 6·s0/l1 + 6·s3/l2 + 5·(M0 - M3)
    M = -12·d1/l1² + 6·(s - s0)/l1 - 5·M0
"""

from __future__ import annotations

from collections.abc import Sequence
from math import asin, cbrt, degrees, inf, pi, sqrt
from typing import Final

from cnc_ptp.kinematics.kinematics import Kinematics, Point
from cnc_ptp.nc.contour import DIST, POS, Contour
from cnc_ptp.path.cubic import Cubic
from cnc_ptp.path.geometry import NEGLIGIBLE_MM, Arc, AxisLimits, Line
from cnc_ptp.path.lookahead.spans import Curve, Span, whole
from cnc_ptp.path.shape import Shape
from cnc_ptp.path.transformed_span import positions

Parts = tuple[float, float, float, float]
"""c1 … c4, or these times what they belong to."""

Corner = tuple[Span, list[Span], Span]
"""What is left of A, the curve, and what is left of B."""

EVEN: Parts = (13.0 / 72.0, 0.00473278, 1.0 / 144.0, 0.0058)
"""dA = dB."""
UNEVEN: Parts = (2.0 / 9.0, 0.022093, 1.0 / 144.0, 0.0058)
"""Any dA and dB."""
SHARPEST_DEG: Final = 170.0
"""Change of direction above which the path stops in the corner."""
LEAST_DISTANCE: Final = 1e-6
"""mm; a shorter curve is none."""
ROUNDING: Final = 1e-9
"""Part of a direction, and of a curvature, by which it may change without being a jump."""
KINK_SHARE: Final = 0.5
"""Part of the jerk of an axis that a kink may take; half of it each where velocity and acceleration step."""
LARGEST_BULGE: Final = 0.5
"""Part of the larger of two unequal distances by which the curve may leave the path; between two lines it never does.

Without it, a long distance on one side would carry the curvature of a small arc on the other far out.
"""
STEPS: Final = 8
"""Newton steps to the largest distance; the first value is at most four times that."""


def corner(a: Span, b: Span, contour: Contour, path_axes: Sequence[int], most: float = inf) -> Corner | None:
    """What is left of A, the curve, and what is left of B; without a curve where nothing jumps.

    `most`: mm of B that the curve may take.

    The first piece belongs to the block of A, the others to that of B. None if there can be no curve: the path reverses
    or rests on one side, a block is too short, the angle is above MAX_ANGLE, or an axis beside those of the path has a
    kink and there is no TRACK_DEV. With an interim point also if it is where the path is left or met, or if the curve
    would leave the room of the axes.
    """
    end, start = a.shape(a.length), b.shape(0.0)
    kinks, jumps = direction_jumps(end, start), curvature_jumps(end, start)
    if not any(kinks) and not any(jumps):
        return a, [], b
    angle = angle_between(end, start, path_axes)
    if angle > SHARPEST_DEG or (0.0 < contour.max_angle < angle and both_lines(a, b)):
        return None
    others = [axis for axis in range(len(end)) if axis not in path_axes]
    if (contour.track_dev <= 0.0 or contour.mode == POS) and any(
        kinks[axis] > 0.0 or jumps[axis] > 0.0 for axis in others
    ):
        return None
    before, after = distances(a, b, contour, path_axes, end, start, most)
    if min(before, after) < LEAST_DISTANCE and contour.mode != POS:
        return None
    left, met = a.end - before, b.begin + after
    first = Span(a.element, a.begin, left if left - a.begin > NEGLIGIBLE_MM else a.begin, a.block)
    last = Span(b.element, met if b.end - met > NEGLIGIBLE_MM else b.end, b.end, b.block)
    if contour.mode == POS:
        middle = [contour.point[axis] if axis in path_axes else start[axis][0] for axis in range(len(start))]
        halves = through(first.shape(first.length), last.shape(0.0), middle, path_axes)
        if halves is None or not all(piece.within(contour.room) for piece in halves):
            return None
        return first, [whole(piece, a.block if index < 3 else b.block) for index, piece in enumerate(halves)], last
    length = a.end - first.end + (last.begin - b.begin)
    pieces = curve(first.shape(first.length), last.shape(0.0), length)
    return first, [whole(piece, b.block if index else a.block) for index, piece in enumerate(pieces)], last


def kink_square(
    a: Span,
    b: Span,
    limits: Sequence[AxisLimits],
    cycle_time: float,
    kinematics: Kinematics | None = None,
    near: Point = (),
) -> float:
    """Largest y = u'² at which the corner from A to B can be passed as it is; inf where nothing jumps.

    `kinematics`: A and B are Cartesian, and `near` is a machine position beside them.

    A jump of the velocity of an axis within one cycle T takes the jerk Δv/T² and the acceleration Δv/T, one of its
    acceleration the jerk Δa/T. Together they may take half the jerk of the axis: |Δq1|·u' <= J·T²/2 or
    |Δq2|·u'² <= J·T/2; and half its acceleration: |Δq1|·u' <= A·T/2. `quiet_limits` leaves that free beside the kink.
    """
    end, start = a.shape(a.length), b.shape(0.0)
    if kinematics is not None:
        end = kinematics.shape(end, near)
        start = kinematics.shape(start, positions(end))
    square = inf
    for kink, bend, axis in zip(direction_jumps(end, start), curvature_jumps(end, start), limits, strict=True):
        share = 0.5 * KINK_SHARE if kink and bend else KINK_SHARE
        if kink:
            velocity = share * strength(axis, cycle_time) * cycle_time / kink
            square = min(square, velocity * velocity)
        if bend:
            square = min(square, share * axis.jerk * cycle_time / bend)
    return square


def strength(axis: AxisLimits, cycle_time: float) -> float:
    """Largest acceleration that an axis can build up in one cycle."""
    return min(axis.jerk * cycle_time, axis.acceleration, axis.deceleration)


def quiet_limits(axes: Sequence[AxisLimits], cycle_time: float) -> list[AxisLimits]:
    """What the axes may take near a kink that is passed, so that both together stay within their limits."""
    quiet: list[AxisLimits] = []
    for axis in axes:
        step = KINK_SHARE * strength(axis, cycle_time)
        jerk = (1.0 - KINK_SHARE) * axis.jerk
        quiet.append(AxisLimits(axis.velocity, axis.acceleration - step, axis.deceleration - step, jerk))
    return quiet


def direction_jumps(end: Sequence[Shape], start: Sequence[Shape]) -> list[float]:
    """|Δq1| of each axis; 0 within the rounding."""
    return [jump(q1, p1, max(1.0, abs(q1), abs(p1))) for (_, q1, _, _), (_, p1, _, _) in zip(end, start, strict=True)]


def curvature_jumps(end: Sequence[Shape], start: Sequence[Shape]) -> list[float]:
    """|Δq2| of each axis; 0 within the rounding."""
    scale = max([max(abs(q2), abs(p2)) for (_, _, q2, _), (_, _, p2, _) in zip(end, start, strict=True)])
    return [jump(q2, p2, scale) for (_, _, q2, _), (_, _, p2, _) in zip(end, start, strict=True)]


def jump(before: float, after: float, scale: float) -> float:
    """|after - before|; 0 within the rounding of values of the size `scale`."""
    size = abs(after - before)
    return size if size > ROUNDING * scale else 0.0


def both_lines(a: Span, b: Span) -> bool:
    """MAX_ANGLE counts between lines only."""
    return isinstance(a.element, Line) and isinstance(b.element, Line)


def angle_between(end: Sequence[Shape], start: Sequence[Shape], path_axes: Sequence[int]) -> float:
    """Change of direction of the path, deg; that of all axes where the path axes rest on one side.

    180 if nothing moves on one side.
    """
    for axes in (path_axes, range(len(end))):
        before = sqrt(sum([end[axis][1] ** 2 for axis in axes]))
        after = sqrt(sum([start[axis][1] ** 2 for axis in axes]))
        if before > 0.0 and after > 0.0:
            chord = sqrt(sum([(start[axis][1] / after - end[axis][1] / before) ** 2 for axis in axes]))
            return 2.0 * degrees(asin(min(1.0, 0.5 * chord)))
    return 180.0


def distances(
    a: Span, b: Span, contour: Contour, path_axes: Sequence[int],
    end: Sequence[Shape], start: Sequence[Shape], most: float,
) -> tuple[float, float]:  # fmt: skip
    """dA and dB, of which dB is at most `most`. If one of two equal ones has to be shorter, both are."""
    before, after = room(a, contour), min(room(b, contour), most)
    if contour.mode == POS:
        return min(before, contour.pre_dist), min(after, contour.post_dist)
    parts = EVEN
    if contour.mode == DIST and contour.pre_dist != contour.post_dist:
        parts = UNEVEN
        before, after = min(before, contour.pre_dist), min(after, contour.post_dist)
        bulge = LARGEST_BULGE * max(before, after)
        limit = largest_distance(deviation(a, b, end, start, path_axes, parts), bulge)
        before, after = shortened(before, after, limit)
    else:
        wanted = contour.pre_dist
        if contour.mode != DIST:
            wanted = largest_distance(deviation(a, b, end, start, path_axes, parts), contour.path_dev)
        before = after = min(before, after, wanted)
    if contour.track_dev > 0.0:
        for axis in range(len(end)):
            if axis not in path_axes:
                limit = largest_distance(deviation(a, b, end, start, (axis,), parts), contour.track_dev)
                before, after = shortened(before, after, limit)
    return before, after


def shortened(before: float, after: float, limit: float) -> tuple[float, float]:
    """Both distances in their ratio, neither above the limit."""
    larger = max(before, after)
    return (before, after) if larger <= limit else (before * limit / larger, after * limit / larger)


def room(span: Span, contour: Contour) -> float:
    """Largest distance within an element: half of what REMAIN_PART leaves, and 90 deg of an arc."""
    element = span.element
    largest = min(span.length, 0.5 * element.length * (1.0 - 0.01 * contour.remain_part))
    if isinstance(element, Arc):
        largest = min(largest, 0.5 * pi / abs(element.rate))
    return largest


def deviation(
    a: Span, b: Span, end: Sequence[Shape], start: Sequence[Shape], axes: Sequence[int], parts: Parts
) -> Parts:
    """Factors of d, d², d³, d⁴ in the largest deviation of the axes together."""
    first = second = third = fourth = 0.0
    for axis in axes:
        _, q1, q2, q3 = end[axis]
        _, p1, p2, p3 = start[axis]
        first += (p1 - q1) ** 2
        second += (p2 - q2) ** 2
        third += (p3 - q3) ** 2
        fourth += (fourth_derivative(a.element, axis) + fourth_derivative(b.element, axis)) ** 2
    c1, c2, c3, c4 = parts
    return c1 * sqrt(first), c2 * sqrt(second), c3 * sqrt(third), c4 * sqrt(fourth)


def fourth_derivative(element: Curve, axis: int) -> float:
    """Largest |q4| of an axis."""
    return element.fourth_derivative(axis) if isinstance(element, Arc) else 0.0


def largest_distance(factors: Parts, tolerance: float) -> float:
    """The d at which the deviation is `tolerance`; inf if there is none.

    Newton's method from above: the sum of powers is convex and grows.
    """
    first, second, third, fourth = factors
    d = inf
    if first > 0.0:
        d = min(d, tolerance / first)
    if second > 0.0:
        d = min(d, sqrt(tolerance / second))
    if third > 0.0:
        d = min(d, cbrt(tolerance / third))
    if fourth > 0.0:
        d = min(d, sqrt(sqrt(tolerance / fourth)))
    if d == inf:
        return d
    for _ in range(STEPS):
        excess = d * (first + d * (second + d * (third + d * fourth))) - tolerance
        if excess <= 0.0:
            break
        d -= excess / (first + d * (2.0 * second + d * (3.0 * third + 4.0 * d * fourth)))
    return d


def curve(before: Sequence[Shape], after: Sequence[Shape], length: float) -> list[Cubic]:
    """Three cubic pieces of the same length with q, q1, q2 of `before` at the first end, of `after` at the other."""
    h = length / 3.0
    half, sixth = 0.5 * h, h * h / 6.0
    pieces: tuple[list[Shape], list[Shape], list[Shape]] = ([], [], [])
    for (y0, s0, m0, _), (y3, s3, m3, _) in zip(before, after, strict=True):
        both = (s3 - s0) / h - 0.5 * (m0 + m3)
        m1 = (y3 - y0 - length * s0) / (h * h) - (8.0 * m0 + m3) / 6.0 - both
        m2 = both - m1
        s1 = s0 + half * (m0 + m1)
        y1 = y0 + h * s0 + sixth * (2.0 * m0 + m1)
        pieces[0].append((y0, s0, m0, (m1 - m0) / h))
        pieces[1].append((y1, s1, m1, (m2 - m1) / h))
        pieces[2].append((y1 + h * s1 + sixth * (2.0 * m1 + m2), s1 + half * (m1 + m2), m2, (m3 - m2) / h))
    return [Cubic(shape, h) for shape in pieces]


def through(
    before: Sequence[Shape], after: Sequence[Shape], point: Sequence[float], path_axes: Sequence[int]
) -> list[Cubic] | None:
    """Two curves that meet at a point, three pieces each; None if it is the end of one of them."""
    l1 = sqrt(sum([(point[axis] - before[axis][0]) ** 2 for axis in path_axes]))
    l2 = sqrt(sum([(after[axis][0] - point[axis]) ** 2 for axis in path_axes]))
    if min(l1, l2) < LEAST_DISTANCE:
        return None
    middle: list[Shape] = []
    for (y0, s0, m0, _), (y3, s3, m3, _), y in zip(before, after, point, strict=True):
        d1 = (y - y0 - s0 * l1 - 0.5 * m0 * l1 * l1) / (l1 * l1)
        d2 = (y - y3 + s3 * l2 - 0.5 * m3 * l2 * l2) / (l2 * l2)
        s = (12.0 * (d1 - d2) + 6.0 * (s0 / l1 + s3 / l2) + 5.0 * (m0 - m3)) / (6.0 / l1 + 6.0 / l2)
        middle.append((y, s, 6.0 * (s - s0) / l1 - 12.0 * d1 - 5.0 * m0, 0.0))
    return curve(before, middle, l1) + curve(middle, after, l2)
