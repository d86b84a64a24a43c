"""The two passes over the cells: how fast the path can be at most when it comes from its start, and for its end.

Both follow the limits of the cells from below. Where these fall, the other pass decides; where they rise again, a pass
sets out from the lowest point with an acceleration of 0, so that the bottom of a valley is round.

Here and where the plan is checked, lists are declared as such and min and max have two arguments: all of it runs for
each cell several times, and only these are compiled without calls into Python.
"""

from __future__ import annotations

from math import cbrt, sqrt

from cnc_ptp.path.lookahead.path_cell import SMALLEST_SQUARE, PathCell


def from_rest(first: PathCell, second: PathCell, *, braking: bool) -> float:
    """Largest y at the end of the first cell, which takes constant jerk from rest.

    u = j·t³/6 and y = (j·t²/2)², so y = j^⅔·(6u)^(4/3)/4 and a = 2y/(3u).
    """
    length = first.length
    jerk = 0.5 * bend_at(first, second, 0.0, 1.0, 0.0)
    square = min(square_from_rest(jerk, length), min(first.limit, second.limit))
    square = min(square, 1.5 * length * permitted(first, second, 0.0, 0.0, braking))
    while square > SMALLEST_SQUARE and 3.0 * length * permitted(first, second, 0.0, square, braking) < square:
        square *= 0.5  # what a tight curve needs of the acceleration grows with y
    square = min(square, 1.5 * length * permitted(first, second, 0.0, square, braking))
    slope = slope_from_rest(square, length)
    jerk = 0.5 * sqrt(square) * bend_at(first, second, 0.0, square, -slope if braking else slope)
    return min(square, square_from_rest(jerk, length))


def bend_at(first: PathCell, second: PathCell, lowest: float, highest: float, slope: float) -> float:
    """Largest rise of b in both cells, up to b = `slope`."""
    slopes = (0.0, slope)
    return min(first.bending(lowest, highest, slopes, True), second.bending(lowest, highest, slopes, True))


def square_from_rest(jerk: float, distance: float) -> float:
    """y after a distance with constant jerk from rest."""
    root = cbrt(jerk)
    six = cbrt(6.0 * distance)
    return 0.25 * root * root * six * six * six * six


def slope_from_rest(square: float, distance: float) -> float:
    """dy/du there."""
    return 4.0 * square / (3.0 * distance)


def one_pass(cells: list[PathCell], caps: list[float], square: float, slope: float, *, braking: bool) -> list[float]:
    """y of each cell, coming from the first: from rest if `square` is 0, else from y = `square` with dy/du = `slope`.

    `braking`: the cells are in reverse order, so that the pass brakes for the last one of the path.
    """
    count = len(cells)
    squares = [0.0] * count
    if square > 0.0:
        squares[0] = square
    else:
        square = from_rest(cells[0], cells[1], braking=braking)
        slope = slope_from_rest(square, cells[0].length)
    squares[1] = square + slope * 0.5 * cells[1].length
    if squares[0] == 0.0 and squares[1] > caps[1]:
        slope *= caps[1] / squares[1]
        squares[1] = caps[1]
    share = 1.0
    for index in range(1, count - 1):
        here, there = cells[index], cells[index + 1]
        before = squares[index]
        distance = 0.5 * (here.length + there.length)
        slope = steepest_slope(here, there, before, slope, share * here.length, braking)
        share = 1.0
        after = before + slope * distance
        if after > caps[index + 1]:
            after = caps[index + 1]
            slope = (after - before) / distance
            if slope < 0.0:
                slope, share = 0.0, 0.5  # the other pass bends the other half of the valley
        elif after <= 0.0:
            after = 0.5 * before
            slope = (after - before) / distance
        squares[index + 1] = after
    return squares


def steepest_slope(here: PathCell, there: PathCell, square: float, slope: float, width: float, braking: bool) -> float:
    """dy/du behind a cell: it may grow by c times the `width`, and to twice the acceleration.

    What is permitted depends on the velocity that is reached with it, so it is found in two steps from above.
    """
    half = 0.5 * here.length
    sign = -1.0 if braking else 1.0
    behind = square - slope * half
    steepest = slope + here.bending(square, square, (sign * slope, sign * slope), True) * width
    steepest = min(steepest, 2.0 * permitted(here, there, square, square, braking))
    ahead = min(square + steepest * half, max(here.limit, there.limit))
    lowest, highest = min(square, min(behind, ahead)), max(square, max(behind, ahead))
    bend = here.bending(max(0.0, lowest), highest, (sign * slope, sign * steepest), True)
    steepest = min(steepest, slope + bend * width)
    return min(steepest, 2.0 * permitted(here, there, lowest, highest, braking))


def permitted(here: PathCell, there: PathCell, lowest: float, highest: float, braking: bool) -> float:
    """Largest acceleration at the end that two cells share."""
    return min(here.acceleration(lowest, highest, braking), there.acceleration(lowest, highest, braking))
