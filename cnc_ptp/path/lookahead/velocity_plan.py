"""Plans the velocity along a path: as fast as the axes permit, with limited jerk, to rest at its end.

The plan is y = u'² for each cell. Within a cell y(u) is a parabola, whose tangents at both ends meet in its middle at
this y (a quadratic B-spline): y and dy/du are continuous, so are velocity and acceleration. In the first and in the
last cell the path takes constant jerk from rest and to rest.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Final, NamedTuple

from cnc_ptp.path.lookahead.passes import one_pass
from cnc_ptp.path.lookahead.path_cell import PathCell
from cnc_ptp.path.lookahead.peaks import bends, round_peaks

ROUNDS: Final = 16
"""Plans with lower limits where one was exceeded, before the whole plan is slowed down."""
ROUNDINGS: Final = 3
"""Peaks are rounded with the bend that the velocities of the rounding before permit: too strongly at first, then not
enough, then from velocities that are a little too high, which is never too little."""
EXCESS: Final = 1e-9
"""Part of a limit that counts as rounding."""
BELOW: Final = 1e-7
"""Part of a limit by which a lowered plan aims below it: without it the last rounds only come nearer and nearer."""
ROOM: Final = 1e-7
"""Part of y, and of the bend, by which a moving start may miss what the path permits through rounding."""
MARGIN: Final = 1.02
"""Factor on y as planned before, up to which a path that slows down may still get."""
REST_POINT: Final = 0.25
"""Part of the first cell after which the tangent at its end leaves y = 0."""


class MovingStart(NamedTuple):
    """The state in which a plan begins: at u, y = `square`, dy/du = `slope`; at rest if y is 0."""

    u: float
    square: float = 0.0
    slope: float = 0.0


class VelocityPlan(NamedTuple):
    """y of the cells (`squares`), at `places`: their middles; at rest the foot of the tangent."""

    cells: list[PathCell]
    places: list[float]
    squares: list[float]


def plan_velocity(
    cells: list[PathCell], start: MovingStart, override: float, delay: int = 0, before: float = 0.0
) -> VelocityPlan | None:
    """Plan from the start to rest at the end of the last cell; None if the start is too fast for that.

    At least three cells. From rest the first one takes the path up from there; a moving start has one without length in
    its place. The feed counts from cell `delay` on: what is faster at the start slows down before it.
    `before`: the override with which the cells were planned.
    """
    moving = start.square > 0.0
    caps = caps_of(cells, override, delay, before)
    places = places_of(cells, moving=moving)
    squares: list[float] | None = None
    worst = 0.0
    for _ in range(ROUNDS):
        squares = highest(cells, places, caps, start)
        if squares is None:
            return None
        excesses = exceeded(cells, places, squares, start)
        worst = max(excesses)
        if worst <= 1.0 + EXCESS:
            return VelocityPlan(cells, places, squares)
        lower(cells, caps, squares, excesses, keep=delay == 0)
    if moving or squares is None:
        return None
    while worst > 1.0 + EXCESS:
        squares = [square / worst for square in squares]
        worst = max(exceeded(cells, places, squares, start))
    return VelocityPlan(cells, places, squares)


def caps_of(cells: list[PathCell], override: float, delay: int, before: float) -> list[float]:
    """Largest y of each cell: that of its neighbours counts, too, as y is nearly theirs at the ends of the cell.

    Before cell `delay` what was planned before may be kept, though it is above the feed; but not more
    than the feed with which it was planned.
    """
    caps = with_neighbours([min(cell.limit, cell.feed * override * override) for cell in cells])
    if delay > 0:
        former = with_neighbours([min(cell.limit, cell.feed * before * before) for cell in cells])
        for index, cell in enumerate(cells[:delay]):
            kept = min(cell.limit, MARGIN * cell.planned, max(cell.planned, former[index]))
            caps[index] = max(caps[index], kept)
    return caps


def with_neighbours(own: list[float]) -> list[float]:
    """The smallest of each value and those beside it."""
    caps = list(own)
    for index in range(1, len(own)):
        caps[index] = min(caps[index], own[index - 1])
        caps[index - 1] = min(caps[index - 1], own[index])
    return caps


def places_of(cells: list[PathCell], *, moving: bool) -> list[float]:
    """Where y of each cell is on its tangents."""
    places = [cell.middle for cell in cells]
    if not moving:
        places[0] = cells[0].begin + REST_POINT * cells[0].length
    places[-1] = cells[-1].end - REST_POINT * cells[-1].length
    return places


def highest(cells: list[PathCell], places: list[float], caps: list[float], start: MovingStart) -> list[float] | None:
    """The largest y under all limits; None if the start cannot be continued like that."""
    moving = start.square > 0.0
    forward = one_pass(cells, caps, start.square, start.slope, braking=False)
    backward = one_pass(cells[::-1], caps[::-1], 0.0, 0.0, braking=True)[::-1]
    if moving and not 0.0 <= forward[1] <= min(backward[1], caps[1]) * (1.0 + ROOM):
        return None
    lowest = [min(forward[index], backward[index]) for index in range(len(cells))]
    first = 0
    if moving:
        first = 1
        lowest[0], lowest[1] = forward[0], forward[1]
    squares = lowest
    bend: list[float] = []
    for _ in range(ROUNDINGS):
        bend = bends(cells, places, squares)
        squares = round_peaks(places, lowest, bend, first)
    if moving:
        after = (squares[2] - squares[1]) / (places[2] - places[1])
        if after < start.slope - bend[1] * (1.0 + ROOM) - ROOM * abs(start.slope):
            return None
    return squares


def exceeded(cells: list[PathCell], places: list[float], squares: list[float], start: MovingStart) -> list[float]:
    """For each cell the largest part of a limit that the plan takes in it."""
    parts = [0.0] * len(cells)
    before = (squares[1] - squares[0]) / (places[1] - places[0])
    square = squares[1] - before * 0.5 * cells[1].length
    if start.square > 0.0:
        before, square = start.slope, start.square
    else:
        parts[0] = excess_at_rest(cells[0], square, before)
    for index in range(1, len(cells) - 1):
        cell = cells[index]
        after = (squares[index + 1] - squares[index]) / (places[index + 1] - places[index])
        ahead = squares[index] + after * 0.5 * cell.length
        bend = (after - before) / cell.length
        parts[index] = max(cell.excess(square, before, bend), cell.excess(ahead, after, bend))
        if bend < 0.0 and cell.loads:  # between them y and b are below the parabola's control point, not below the ends
            parts[index] = max(parts[index], cell.excess(squares[index], 0.5 * (before + after), bend))
        before, square = after, ahead
    parts[-1] = excess_at_rest(cells[-1], square, before)
    return parts


def excess_at_rest(cell: PathCell, square: float, slope: float) -> float:
    """The same for a cell at rest, with the constant jerk 2v³/(9u²): u''' = c·u'/2."""
    return cell.excess(square, slope, 4.0 * square / (9.0 * cell.length * cell.length))


def lower(cells: list[PathCell], caps: list[float], squares: list[float], excesses: list[float], *, keep: bool) -> None:
    """Lowers the limits where one was exceeded, and of the neighbours; `keep`: not below what was planned before."""
    for index, excess in enumerate(excesses):
        if excess > 1.0 + EXCESS:
            part = (excess + BELOW) ** -0.7
            for near in range(max(index - 1, 0), min(index + 2, len(cells))):
                caps[near] = min(caps[near], max(squares[near] * part, cells[near].planned if keep else 0.0))


def earliest(count: int, plan_at: Callable[[int], VelocityPlan | None]) -> VelocityPlan | None:
    """The plan of the first number 1 … `count` for which there is one, if there is one for all behind it, too."""
    low, high, found = 0, 1, plan_at(1)
    while found is None and high < count:
        low, high = high, min(2 * high, count)
        found = plan_at(high)
    if found is None:
        return None
    while high - low > 1:
        middle = (low + high) // 2
        plan = plan_at(middle)
        if plan is None:
            low = middle
        else:
            high, found = middle, plan
    return found


def stop_soon(cells: list[PathCell], start: MovingStart, before: float) -> VelocityPlan | None:
    """To rest at the end of the first cell at which that is possible; the feed with `before` counts."""
    last = len(cells) - 1

    def stop_at(cell: int) -> VelocityPlan | None:
        return plan_velocity(cells[: min(cell + 1, last) + 1], start, 0.0, len(cells), before)

    return earliest(last, stop_at)
