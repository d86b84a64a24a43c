"""A smooth curve along a polyline: a cubic spline whose control points are averages of the polyline.

The spline has knots t[k]; between two of them is a span. The control point that belongs to the knots t[k+1], t[k+2],
t[k+3] is the blossom of the parabola that fits the polyline best (least squares) over these two spans. With the
parabola A + B·y + C·y², y = -1 … 1 over them and y = b at the knot between, that is A + B·b/3 - C/3. Parabolas (and
cubics, where the spans are equal) come out as they are; rounded points are averaged.

The curve is marched from state to state: with q, q1, q2 at t[k] and the control point c, whose knots are a, b, d behind
t[k], the equation c = q + q1·(a + b + d)/3 + q2·(ab + ad + bd)/6 + q3·abd/6 gives q3 of the piece. The three last
control points come from the state at the end in the same way.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import inf, sqrt
from typing import Final

from cnc_ptp.errors import CncError
from cnc_ptp.path.lookahead.polyline import Point, Polyline

NOT_SMOOTHED = 22115

WINDOW: Final = 7
"""Spans that are known before pieces are given out."""
RESERVE: Final = 3
"""Good pieces that are kept back, so that finer spans behind them have room to begin."""
SHARE: Final = 0.9
"""Part of the deviation that is used, so that the curve can always be continued."""
FINEST: Final = 1.0 / 16.0
"""Spans shorter than this part of the path deviation may use nearly all of it."""
FINEST_SHARE: Final = 0.98
SHORTEST: Final = 1e-7
"""mm of a span; before that the curve is the polyline, but for rounding."""
LARGE_PART: Final = 0.2
"""A chord that takes more than this part of a span is checked at its quarters, too."""
LARGEST_RATIO: Final = 2.001
"""Of the lengths of neighbouring spans; 2 but for rounding."""
FEWEST: Final = 3
"""Spans of a curve with given states at both ends."""


class Tolerance:
    """What the curve may deviate from the polyline: over the path axes together, and for each other axis."""

    __slots__ = ("others", "path_axes", "path_dev", "track_dev")

    def __init__(self, axes: int, path_axes: Sequence[int], path_dev: float, track_dev: float) -> None:
        """`track_dev` 0: not limited."""
        self.path_axes = list(path_axes)
        self.others = [axis for axis in range(axes) if axis not in path_axes]
        self.path_dev = path_dev
        self.track_dev = track_dev if track_dev > 0.0 else inf


class KnotSpan:
    """From knot to knot, with the moments of the polyline there and the piece of the curve once it is known.

    piece   q, q1, q2, q3 at its first knot, four values for each axis
    part    largest part of the deviation that the piece takes
    """

    __slots__ = ("begin", "end", "moments", "part", "piece")

    def __init__(self, polyline: Polyline, begin: float, end: float) -> None:
        self.begin, self.end = begin, end
        self.moments = polyline.moments(begin, end)
        self.piece: list[float] = []
        self.part = 0.0

    @property
    def length(self) -> float:
        return self.end - self.begin


class SmoothCurve:
    """The curve from one corner (or the end of a line) to the next, while its points arrive.

    `direction`: q1 at the start; without it the start takes the direction of the polyline there.
    """

    def __init__(
        self, polyline: Polyline, tolerance: Tolerance, longest: float, direction: Sequence[float] | None
    ) -> None:
        self.polyline = polyline
        self._tolerance = tolerance
        self._longest = longest
        self._state: list[float] = []
        """q, q1, q2 at the first knot, three values for each axis."""
        self._free = direction is None
        if direction is not None:
            self._state = state_of(polyline.points[0], direction)
        self._spans: list[KnotSpan] = []
        self._good = 0
        """Pieces that have been found good."""
        self._step = longest
        self._begin = 0.0
        self._closing: list[float] | None = None

    @property
    def begin(self) -> float:
        """Place up to which pieces have been given out."""
        return self._begin

    def advance(self) -> list[KnotSpan]:
        """The pieces that do not depend on points to come."""
        ready: list[KnotSpan] = []
        last = self._spans[-1].end if self._spans else self._begin
        while self.polyline.end >= last + self._step:
            self._spans.append(KnotSpan(self.polyline, last, last + self._step))
            if len(self._spans) >= WINDOW:
                self._solve()
                ready += self._give_out(self._good - RESERVE)
            last = self._spans[-1].end
            self._step = self._next_step()
        return ready

    def close(self, direction: Sequence[float] | None) -> list[KnotSpan]:
        """All that is left. The curve ends at the last point, with that direction or that of the polyline there."""
        self._fill_up()
        self._closing = [] if direction is None else state_of(self.polyline.points[-1], direction)
        self._solve()
        return self._give_out(len(self._spans))

    # spans

    def _next_step(self) -> float:
        """Twice the last span while its curve is far within the deviation, then slowly more."""
        if self._good == 0:
            return min(self._step, self._spans[-1].length)
        checked = self._spans[self._good - 1]
        growth = 2.0 if checked.part < 0.05 else 1.5 if checked.part < 0.2 else 1.25
        return min(self._longest, 2.0 * self._spans[-1].length, growth * checked.length)

    def _fill_up(self) -> None:
        """Spans up to the end of the polyline, three at least."""
        end, spans = self.polyline.end, self._spans
        last = spans[-1].end if spans else self._begin
        if spans and end - last < 0.5 * spans[-1].length:
            last = spans.pop().begin
        count = max(1, int((end - last) / self._step + 0.999))
        step = (end - last) / count
        for number in range(count):
            begin = last + number * step
            spans.append(KnotSpan(self.polyline, begin, end if number == count - 1 else begin + step))
        while len(spans) < FEWEST:
            longest = max(range(len(spans)), key=lambda index: spans[index].length)
            self._divide(longest)
        self._good = max(0, min(self._good, len(spans) - count - 3))

    def _divide(self, index: int) -> None:
        span = self._spans[index]
        middle = 0.5 * (span.begin + span.end)
        self._spans[index : index + 1] = [
            KnotSpan(self.polyline, span.begin, middle),
            KnotSpan(self.polyline, middle, span.end),
        ]

    def _refine(self, index: int) -> int:
        """Divides a span, and its neighbours until none is more than twice as long as the next; returns the first."""
        span = self._spans[index]
        if span.length < SHORTEST:
            block, tolerance = self.polyline.blocks[self.polyline.chord_at(span.begin)], self._tolerance.path_dev
            raise CncError(
                NOT_SMOOTHED,
                f"the curve near block {block} deviates by {span.part:.3g} times the tolerance of {tolerance:g} mm, "
                "and cannot be made finer",
                "the path stops",
                block=block,
                part=span.part,
                tolerance=tolerance,
            )
        self._divide(index)
        self._balance_behind(index + 2)
        return self._balance_before(index)

    def _balance_behind(self, index: int) -> None:
        spans, divided = self._spans, index - 1
        while index < len(spans):
            if spans[index].length > LARGEST_RATIO * spans[index - 1].length:
                self._divide(index)
                divided = max(divided, index) + 1
            elif index > divided:
                return
            else:
                index += 1

    def _balance_before(self, first: int) -> int:
        """`first`: the first that was divided; returns what it is afterwards."""
        spans, index = self._spans, first - 1
        while index >= 0:
            if spans[index].length > LARGEST_RATIO * spans[index + 1].length:
                self._divide(index)
                first = min(first, index)
                index += 1
            elif index < first:
                return first
            else:
                index -= 1
        return first

    # the curve

    def _solve(self) -> None:
        """Marches and checks the pieces that depend on known spans alone; spans that deviate too far become finer."""
        index = self._good
        spans = self._spans
        while index < (len(spans) if self._closing is not None else len(spans) - 2):
            if index == 0 and self._free:
                self._state = self._free_state(0, 1)
            span = spans[index]
            state = self._state if index == 0 else end_state(spans[index - 1])
            self._march(index, state)
            span.part = self._deviation(span)
            finest = span.length < FINEST * self._tolerance.path_dev
            if span.part <= (FINEST_SHARE if finest else SHARE):
                index += 1
                continue
            first = self._refine(index)
            index = max(0, first - 2)
        self._good = index

    def _march(self, index: int, state: Sequence[float]) -> None:
        """The piece of a span that starts in `state`."""
        spans = self._spans
        last = len(spans) - 1
        begin = spans[index].begin
        a = spans[index].end - begin
        b = spans[min(index + 1, last)].end - begin
        d = spans[min(index + 2, last)].end - begin
        control = self._control(index)
        one, two, three = (a + b + d) / 3.0, (a * b + a * d + b * d) / 6.0, 6.0 / (a * b * d)
        piece: list[float] = []
        for axis in range(len(control)):
            q, q1, q2 = state[3 * axis], state[3 * axis + 1], state[3 * axis + 2]
            q3 = (control[axis] - q - q1 * one - q2 * two) * three
            piece.append(q)
            piece.append(q1)
            piece.append(q2)
            piece.append(q3)
        spans[index].piece = piece

    def _control(self, index: int) -> list[float]:
        """The control point of the three knots behind the first one of a span."""
        spans = self._spans
        last = len(spans) - 1
        if self._closing is None or index + 2 < last:
            return control_point(spans[index + 1], spans[index + 2])
        state = self._closing if self._closing else self._free_state(last, last - 1)
        end = spans[last].end
        before = 0.0
        for knot in range(index, index + 3):
            before += spans[min(knot, last)].end - end
        before /= 3.0
        return [state[3 * axis] + before * state[3 * axis + 1] for axis in range(len(state) // 3)]

    def _free_state(self, outer: int, inner: int) -> list[float]:
        """Position of the first (or last) point, direction of the parabola of the two spans there, no curvature."""
        spans, polyline = self._spans, self.polyline
        at_start = outer < inner
        one, other = (spans[outer], spans[inner]) if at_start else (spans[inner], spans[outer])
        fit = fitted(one, other)
        side = -1.0 if at_start else 1.0
        axes = len(fit) // 3
        direction = [fit[3 * axis + 1] + 2.0 * side * fit[3 * axis + 2] for axis in range(axes)]
        speed = norm(direction, self._tolerance.path_axes)
        if speed < 0.25 * (other.end - one.begin):
            index = 1 if at_start else len(polyline.points) - 1
            direction = [b - a for a, b in zip(polyline.points[index - 1], polyline.points[index], strict=True)]
            speed = norm(direction, self._tolerance.path_axes)
        return state_of(polyline.points[0 if at_start else -1], [value / speed for value in direction])

    def _give_out(self, count: int) -> list[KnotSpan]:
        if count <= 0:
            return []
        ready = self._spans[:count]
        self._state = end_state(ready[-1])
        self._free = False
        self._begin = ready[-1].end
        del self._spans[:count]
        self._good -= count
        return ready

    # the check

    def _deviation(self, span: KnotSpan) -> float:
        """Largest part of the deviation that a piece takes: at points, middles of chords, quarters of long ones."""
        places = self.polyline.places
        index = self.polyline.chord_at(span.begin)
        begin, end, last = span.begin, span.end, len(places) - 1
        worst = 0.0
        while index <= last:
            before, behind = places[index - 1], places[index]
            low, high = max(before, begin), min(behind, end)
            middle = 0.5 * (before + behind)
            if low <= middle <= high:
                worst = max(worst, self._miss(span, index, middle))
            if high == end or low == begin or high - low > LARGE_PART * (end - begin):
                for number in range(1, 4):
                    worst = max(worst, self._miss(span, index, low + 0.25 * number * (high - low)))
            worst = max(worst, self._miss(span, index, high))
            if behind >= end:
                break
            index += 1
        return worst

    def _miss(self, span: KnotSpan, index: int, u: float) -> float:
        """Part of the deviation between curve and polyline at u, which is on the chord with that index."""
        polyline, tolerance = self.polyline, self._tolerance
        before, behind = polyline.points[index - 1], polyline.points[index]
        low, high = polyline.places[index - 1], polyline.places[index]
        part = (u - low) / (high - low)
        x = u - span.begin
        half, sixth = 0.5 * x, x / 3.0
        piece = span.piece
        square = 0.0
        for axis in tolerance.path_axes:
            i = 4 * axis
            base = before[axis]
            curve = piece[i] + x * (piece[i + 1] + half * (piece[i + 2] + sixth * piece[i + 3]))
            miss = curve - base - (behind[axis] - base) * part
            square += miss * miss
        worst = sqrt(square) / tolerance.path_dev
        for axis in tolerance.others:
            i = 4 * axis
            base = before[axis]
            curve = piece[i] + x * (piece[i + 1] + half * (piece[i + 2] + sixth * piece[i + 3]))
            worst = max(worst, abs(curve - base - (behind[axis] - base) * part) / tolerance.track_dev)
        return worst


def fitted(one: KnotSpan, other: KnotSpan) -> list[float]:
    """A, B, C of the parabola A + B·y + C·y² that fits the polyline over two spans (y = -1 … 1); for each axis.

    From the moments by Legendre polynomials.
    """
    middle, half = 0.5 * (one.begin + other.end), 0.5 * (other.end - one.begin)
    rate1, rate2 = 0.5 * one.length / half, 0.5 * other.length / half
    shift1 = (0.5 * (one.begin + one.end) - middle) / half
    shift2 = (0.5 * (other.begin + other.end) - middle) / half
    found: list[float] = []
    first, second = one.moments, other.moments
    for place in range(0, len(first), 3):
        u0, u1, u2 = first[place], first[place + 1], first[place + 2]
        v0, v1, v2 = second[place], second[place + 1], second[place + 2]
        m0 = rate1 * u0 + rate2 * v0
        m1 = rate1 * (shift1 * u0 + rate1 * u1) + rate2 * (shift2 * v0 + rate2 * v1)
        m2 = rate1 * (shift1 * (shift1 * u0 + 2.0 * rate1 * u1) + rate1 * rate1 * u2)
        m2 += rate2 * (shift2 * (shift2 * v0 + 2.0 * rate2 * v1) + rate2 * rate2 * v2)
        bend = 1.25 * (3.0 * m2 - m0)
        found.append(0.5 * m0 - 0.5 * bend)
        found.append(1.5 * m1)
        found.append(1.5 * bend)
    return found


def control_point(one: KnotSpan, other: KnotSpan) -> list[float]:
    """The blossom of the fitted parabola at the three knots of two spans."""
    fit = fitted(one, other)
    between = (one.length - other.length) / (one.length + other.length)
    return [fit[i] + (fit[i + 1] * between - fit[i + 2]) / 3.0 for i in range(0, len(fit), 3)]


def end_state(span: KnotSpan) -> list[float]:
    """q, q1, q2 of each axis at the end of a piece."""
    piece, x = span.piece, span.end - span.begin
    state: list[float] = []
    for i in range(0, len(piece), 4):
        q, q1, q2, q3 = piece[i], piece[i + 1], piece[i + 2], piece[i + 3]
        state.append(q + x * (q1 + x * (0.5 * q2 + x * (q3 / 6.0))))
        state.append(q1 + x * (q2 + 0.5 * x * q3))
        state.append(q2 + x * q3)
    return state


def state_of(point: Point, direction: Sequence[float]) -> list[float]:
    """q, q1 and no curvature."""
    state: list[float] = []
    for q, q1 in zip(point, direction, strict=True):
        state.append(q)
        state.append(q1)
        state.append(0.0)
    return state


def norm(direction: Sequence[float], axes: Sequence[int]) -> float:
    square = 0.0
    for axis in axes:
        square += direction[axis] * direction[axis]
    return sqrt(square)
