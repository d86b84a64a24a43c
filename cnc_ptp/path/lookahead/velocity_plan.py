"""Plans the velocity along a path: as fast as the axes permit, with limited jerk, to rest at its end.

The plan is y = u'² at the nodes. Between the middles of the cells y(u) is a parabola, whose tangents there are the
straight lines between the nodes (a quadratic B-spline): y and dy/du are continuous, so are velocity and acceleration.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Final, NamedTuple

from cnc_ptp.path.lookahead.nodes import PathNode
from cnc_ptp.path.lookahead.passes import REST_POINT, one_pass
from cnc_ptp.path.lookahead.peaks import bends, round_peaks

ROUNDS: Final = 8
"""Plans with lower limits where one was exceeded, before the whole plan is slowed down."""
ROUNDINGS: Final = 3
"""Peaks are rounded with the bend that the velocities of the rounding before permit: too strongly at first, then not
enough, then from velocities that are a little too high, which is never too little."""
EXCESS: Final = 1e-9
"""Part of a limit that counts as rounding."""
ROOM: Final = 1e-7
"""Part of y, and of the bend, by which a moving start may miss what the path permits through rounding."""


class MovingStart(NamedTuple):
    """The state in which a plan begins: at u, y = `square`, dy/du = `slope`; at rest if y is 0."""

    u: float
    square: float = 0.0
    slope: float = 0.0


class VelocityPlan(NamedTuple):
    """y at the nodes (`squares`); `places`: where the straight lines between the nodes begin and end.

    They are the nodes themselves, except at rest, from which y does not rise on a straight line.
    """

    nodes: Sequence[PathNode]
    places: Sequence[float]
    squares: Sequence[float]


def plan_velocity(
    nodes: Sequence[PathNode], start: MovingStart, override: float, delay: int = 0
) -> VelocityPlan | None:
    """Plan from the first node, at `start.u`, to rest at the last; None if the start is too fast for that.

    At least three nodes. The feed counts from node `delay` on: what is faster at the start slows down before it.
    """
    moving = start.square > 0.0
    squares: list[float] | None = None
    worst = 0.0
    caps = [caps_of(node, override if index >= delay else None) for index, node in enumerate(nodes)]
    places, widths = polygon(nodes, moving=moving)
    for _ in range(ROUNDS):
        squares = highest(nodes, places, widths, caps, start)
        if squares is None:
            return None
        excesses = exceeded(nodes, places, widths, squares, moving)
        worst = max(excesses)
        if worst <= 1.0 + EXCESS:
            return VelocityPlan(nodes, places, squares)
        lower(nodes, caps, squares, excesses)
    if moving or squares is None:
        return None
    while worst > 1.0 + EXCESS:
        squares = [square / worst for square in squares]
        worst = max(exceeded(nodes, places, widths, squares, moving))
    return VelocityPlan(nodes, places, squares)


def caps_of(node: PathNode, override: float | None) -> float:
    return node.limit if override is None else min(node.limit, node.feed * override * override)


def polygon(nodes: Sequence[PathNode], *, moving: bool) -> tuple[list[float], list[float]]:
    """Where the straight lines between the nodes begin, and the width over which each node bends them."""
    places = [node.u for node in nodes]
    count = len(nodes)
    widths = [0.0] * count
    for index in range(1, count - 1):
        widths[index] = 0.5 * (places[index + 1] - places[index - 1])
    if moving:
        widths[1] += 0.5 * (places[1] - places[0])
    else:
        places[0] += REST_POINT * (places[1] - places[0])
    places[-1] -= REST_POINT * (places[-1] - nodes[-2].u)
    return places, widths


def highest(
    nodes: Sequence[PathNode],
    places: Sequence[float],
    widths: Sequence[float],
    caps: Sequence[float],
    start: MovingStart,
) -> list[float] | None:
    """The largest y under all limits; None if the start cannot be continued like that."""
    moving = start.square > 0.0
    forward = one_pass(nodes, caps, start.square, start.slope, braking=False)
    backward = one_pass(nodes[::-1], caps[::-1], 0.0, 0.0, braking=True)[::-1]
    if moving and not 0.0 <= forward[1] <= min(backward[1], caps[1]) * (1.0 + ROOM):
        return None
    lowest = [min(pair) for pair in zip(forward, backward, strict=True)]
    first = 0
    if moving:
        first = 1
        lowest[0], lowest[1] = forward[0], forward[1]
    squares = lowest
    for _ in range(ROUNDINGS):
        bend = bends(nodes, places, widths, squares)
        squares = round_peaks(places, lowest, bend, first)
    if moving:
        after = (squares[2] - squares[1]) / (places[2] - places[1])
        if after < start.slope - bend[1] * (1.0 + ROOM) - ROOM * abs(start.slope):
            return None
    return squares


def exceeded(
    nodes: Sequence[PathNode], places: Sequence[float], widths: Sequence[float], squares: Sequence[float], moving: bool
) -> list[float]:
    """For each node the largest part of a limit that the plan takes around it."""
    parts = [0.0] * len(nodes)
    before = (squares[1] - squares[0]) / (places[1] - places[0])
    square = squares[1] - before * (places[1] - 0.5 * (nodes[0].u + nodes[1].u))
    if moving:
        square = squares[0]
    else:
        parts[0] = excess_at_rest(nodes[0], nodes[1], square, before)
    for index in range(1, len(nodes) - 1):
        after = (squares[index + 1] - squares[index]) / (places[index + 1] - places[index])
        ahead = squares[index] + after * (0.5 * (nodes[index].u + nodes[index + 1].u) - places[index])
        bend = (after - before) / widths[index]
        node = nodes[index]
        parts[index] = max(node.excess(square, before, bend), node.excess(ahead, after, bend))
        before, square = after, ahead
    parts[-1] = excess_at_rest(nodes[-1], nodes[-2], square, before)
    return parts


def excess_at_rest(rest: PathNode, other: PathNode, square: float, slope: float) -> float:
    """The same for the half cell at rest, with constant jerk 2v³/(9u²): u''' = c·u'/2."""
    half = 0.5 * (other.u - rest.u)
    return rest.excess(square, slope, 4.0 * square / (9.0 * half * half))


def lower(nodes: Sequence[PathNode], caps: list[float], squares: Sequence[float], excesses: Sequence[float]) -> None:
    """Lowers the limits where one was exceeded, and of the neighbours; not below what was planned there before."""
    for index, excess in enumerate(excesses):
        if excess > 1.0 + EXCESS:
            part = excess**-0.7
            for near in range(max(index - 1, 0), min(index + 2, len(nodes))):
                caps[near] = min(caps[near], max(squares[near] * part, nodes[near].planned))


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


def stop_soon(nodes: Sequence[PathNode], start: MovingStart) -> VelocityPlan | None:
    """To rest at the first node at which that is possible; the feed does not count any more."""
    last = len(nodes) - 1

    def stop_at(node: int) -> VelocityPlan | None:
        return plan_velocity(nodes[: min(node + 1, last) + 1], start, 0.0, len(nodes))

    return earliest(last, stop_at)
