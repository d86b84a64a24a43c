"""Rounds the peaks of y(u) from below, so that the acceleration of the path changes with limited jerk.

The largest curve below K whose curvature is at least -c: with C'' = c it is conv(K + C) - C, where conv is the lower
convex hull. K is the smaller one of the two passes; its valleys are round already.
"""

from __future__ import annotations

from cnc_ptp.path.lookahead.path_cell import PathCell


def bends(cells: list[PathCell], places: list[float], squares: list[float]) -> list[float]:
    """Change of dy/du that each inner cell permits at the velocities `squares`."""
    found = [0.0] * len(cells)
    for index in range(1, len(cells) - 1):
        before = (squares[index] - squares[index - 1]) / (places[index] - places[index - 1])
        after = (squares[index + 1] - squares[index]) / (places[index + 1] - places[index])
        half = 0.5 * cells[index].length
        highest = squares[index] + max(0.0, max(after, -before)) * half
        lowest = max(0.0, squares[index] + min(0.0, min(after, -before)) * half)
        found[index] = cells[index].bending(lowest, highest, (before, after), False) * cells[index].length
    return found


def round_peaks(places: list[float], squares: list[float], bend: list[float], first: int) -> list[float]:
    """y of each cell with rounded peaks, from cell `first` on, which keeps its y."""
    count = len(squares)
    raised = [0.0] * count
    slopes = [0.0] * count
    for index in range(first, count - 1):
        slopes[index] = (slopes[index - 1] + bend[index]) if index > first else 0.0
        raised[index + 1] = raised[index] + slopes[index] * (places[index + 1] - places[index])
    corners = [first]
    for index in range(first + 1, count):
        while len(corners) > 1 and not is_below(places, squares, raised, corners[-2], corners[-1], index):
            corners.pop()
        corners.append(index)
    rounded = list(squares)
    for number in range(len(corners) - 1):
        begin, end = corners[number], corners[number + 1]
        if end > begin + 1:
            slope = chord(places, squares, raised, begin, end)
            for index in range(begin + 1, end):
                distance = places[index] - places[begin]
                rounded[index] = squares[begin] + slope * distance - (raised[index] - raised[begin])
    return rounded


def chord(places: list[float], squares: list[float], raised: list[float], begin: int, end: int) -> float:
    """Slope of K + C from one cell to another."""
    rise = squares[end] - squares[begin] + (raised[end] - raised[begin])
    return rise / (places[end] - places[begin])


def is_below(places: list[float], squares: list[float], raised: list[float], begin: int, middle: int, end: int) -> bool:
    """The middle one is a corner of the hull: it is below the chord of its neighbours."""
    return chord(places, squares, raised, begin, middle) < chord(places, squares, raised, middle, end)
