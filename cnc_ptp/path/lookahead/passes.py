"""The two passes over the nodes: how fast the path can be at most when it comes from its start, and for its end.

Both follow the limits of the nodes from below. Where these fall, the other pass decides; where they rise again, a pass
sets out from the lowest point with an acceleration of 0, so that the bottom of a valley is round.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import cbrt, sqrt
from typing import Final

from cnc_ptp.path.lookahead.nodes import PathNode

REST_POINT: Final = 0.125
"""From rest with constant jerk over half a cell: y is then as on a straight line over u that begins after this part of
the cell (its tangent in the middle of the cell)."""
REST_SHARE: Final = 3.0 / 7.0
"""y in the middle of the first cell against y at its end."""


def from_rest(first: PathNode, second: PathNode, *, braking: bool) -> float:
    """Largest y at the end of the first cell, of which the first half takes constant jerk from rest.

    u = j·t³/6 and y = (j·t²/2)², so y = j^⅔·(6u)^(4/3)/4 and a = 2y/(3u).
    """
    half = 0.5 * abs(second.u - first.u)
    bend = min(first.bending(1.0, 0.0), second.bending(1.0, 0.0))
    square = square_from_rest(0.5 * bend, half)
    square = min(square, 1.5 * half * min(first.acceleration(square, braking), second.acceleration(square, braking)))
    slope = 4.0 * square / (3.0 * half)
    bend = min(first.bending(square, slope), second.bending(square, slope))
    return min(square, square_from_rest(0.5 * sqrt(square) * bend, half)) / REST_SHARE


def square_from_rest(jerk: float, distance: float) -> float:
    """y after a distance with constant jerk from rest."""
    root = cbrt(jerk)
    six = cbrt(6.0 * distance)
    return 0.25 * root * root * six * six * six * six


def one_pass(
    nodes: Sequence[PathNode], caps: Sequence[float], square: float, slope: float, *, braking: bool
) -> list[float]:
    """y at each node, coming from the first: from rest if `square` is 0, else from y = `square` with dy/du = `slope`.

    `braking`: the nodes are in reverse order, so that the pass brakes for the last one of the path.
    """
    count = len(nodes)
    squares = [0.0] * count
    cell = abs(nodes[1].u - nodes[0].u)
    if square > 0.0:
        squares[0] = square
        squares[1] = square + slope * cell
        width = cell
    else:
        squares[1] = min(from_rest(nodes[0], nodes[1], braking=braking), caps[1])
        slope = squares[1] / ((1.0 - REST_POINT) * cell)
        width = 0.5 * cell
    for index in range(1, count - 1):
        here, there = nodes[index], nodes[index + 1]
        before = squares[index]
        cell = abs(there.u - here.u)
        width += 0.5 * cell
        steepest = steepest_slope(here, there, before, slope, cell, width, caps[index], braking)
        after = before + steepest * cell
        slope = steepest
        if after > caps[index + 1]:
            after = caps[index + 1]
            slope = (after - before) / cell
            if slope < 0.0:
                following = abs(nodes[index + 2].u - there.u) if index + 2 < count else cell
                slope = -0.25 * (cell + following) * there.bending(after, 0.0)
        elif after <= 0.0:
            after = 0.5 * before
            slope = (after - before) / cell
        squares[index + 1] = after
        width = 0.5 * cell
    return squares


def steepest_slope(
    here: PathNode,
    there: PathNode,
    square: float,
    slope: float,
    cell: float,
    width: float,
    cap: float,
    braking: bool,
) -> float:
    """dy/du in the cell behind a node: it may grow by c times the width of the node, and to twice the acceleration.

    What is permitted depends on the velocity that is reached with it, so it is found in two steps from above.
    """
    behind = square - slope * (width - 0.5 * cell)
    steepest = slope + here.bending(square, abs(slope)) * width
    steepest = min(steepest, 2.0 * here.acceleration(square, braking), 2.0 * there.acceleration(square, braking))
    highest = max(square, behind, min(square + 0.5 * steepest * cell, max(cap, there.limit)))
    bend = here.bending(highest, max(abs(slope), abs(steepest)))
    steepest = min(steepest, slope + bend * width)
    return min(steepest, 2.0 * here.acceleration(highest, braking), 2.0 * there.acceleration(highest, braking))
