"""The motion along the path in time that a velocity plan amounts to.

Where y(u) is a parabola the acceleration is linear in u: u'' = b/2 + k·(u - u0) with k = c/2. In time, with z = k·t²:

    u - u0 = v·t·S(z) + b/2·t²·C(z)        S(z) = sinh(√z)/√z        C(z) = (cosh(√z) - 1)/z
    u'     = v·(1 + z·C(z)) + b/2·t·S(z)   for z < 0 with sin and cos

and from one end of a piece to the other t = 2w·atanh(√r)/√r with w = Δu/(v0 + v1) and r = k·w². Jerk: u''' = k·u'.
From rest and to rest the path takes a cell with constant jerk.
"""

from __future__ import annotations

from bisect import bisect_right
from math import atan, atanh, cos, cosh, sin, sinh, sqrt
from typing import Final

from cnc_ptp.motion.setpoints import MotionState
from cnc_ptp.path.lookahead.velocity_plan import MovingStart, VelocityPlan

SERIES: Final = 0.01
"""|z| up to which S, C and atanh are series; the next term is then below the rounding."""
FROM_REST, TO_REST, BETWEEN = 0, 1, 2


class PathPiece:
    """One piece: `duration` s from u with velocity v and acceleration a; `growth`: k, or the jerk at rest."""

    __slots__ = ("acceleration", "begin", "duration", "growth", "kind", "u", "velocity")

    def __init__(
        self, begin: float, u: float, velocity: float, acceleration: float, growth: float, duration: float, kind: int
    ) -> None:
        self.begin, self.u, self.velocity, self.acceleration = begin, u, velocity, acceleration
        self.growth, self.duration, self.kind = growth, duration, kind

    def state_after(self, t: float) -> MotionState:
        """(u, u', u'', u''') t seconds after the piece begins."""
        if self.kind != BETWEEN:
            jerk = self.growth
            acceleration = self.acceleration + jerk * t
            velocity = self.velocity + t * (self.acceleration + 0.5 * jerk * t)
            u = self.u + t * (self.velocity + t * (0.5 * self.acceleration + t * (jerk / 6.0)))
            return u, velocity, acceleration, jerk
        k = self.growth
        s, c = circular(k * t * t)
        distance = t * (self.velocity * s + self.acceleration * t * c)
        velocity = self.velocity * (1.0 + k * t * t * c) + self.acceleration * t * s
        return self.u + distance, velocity, self.acceleration + k * distance, k * velocity


def circular(z: float) -> tuple[float, float]:
    """S(z) and C(z)."""
    if -SERIES < z < SERIES:
        s = 1.0 + z / 6.0 * (1.0 + z / 20.0 * (1.0 + z / 42.0 * (1.0 + z / 72.0 * (1.0 + z / 110.0))))
        c = 0.5 + z / 24.0 * (1.0 + z / 30.0 * (1.0 + z / 56.0 * (1.0 + z / 90.0 * (1.0 + z / 132.0))))
        return s, c
    if z > 0.0:
        root = sqrt(z)
        return sinh(root) / root, (cosh(root) - 1.0) / z
    root = sqrt(-z)
    return sin(root) / root, (1.0 - cos(root)) / -z


def duration_between(distance: float, before: float, after: float, k: float) -> float:
    """Seconds for a distance from velocity `before` to `after` with u'' linear in u."""
    w = distance / (before + after)
    r = k * w * w
    if -SERIES < r < SERIES:
        part = r * (1.0 / 3.0 + r * (0.2 + r * (1.0 / 7.0 + r * (1.0 / 9.0 + r * (1.0 / 11.0 + r / 13.0)))))
        return 2.0 * w * (1.0 + part)
    if r > 0.0:
        root = sqrt(min(r, LARGEST_RATIO))
        return 2.0 * w * atanh(root) / root
    root = sqrt(-r)
    return 2.0 * w * atan(root) / root


LARGEST_RATIO: Final = 1.0 - 1e-12


class PathProfile:
    """Pieces of a plan in time, one after the other, to rest.

    duration   s at which the path is at rest
    """

    def __init__(self, pieces: list[PathPiece]) -> None:
        self._pieces = pieces
        self._starts = [piece.begin for piece in pieces]
        last = pieces[-1]
        self.duration = last.begin + last.duration

    def state_at(self, t: float) -> MotionState:
        """(u, u', u'', u''') at time t; before the first piece as at its start."""
        piece = self._pieces[max(0, bisect_right(self._starts, t) - 1)]
        return piece.state_after(max(0.0, t - piece.begin))

    def piece_and_next(self, t: float) -> tuple[PathPiece, PathPiece | None]:
        """The piece that is active at t, and the one behind it."""
        index = max(0, bisect_right(self._starts, t) - 1)
        return self._pieces[index], self._pieces[index + 1] if index + 1 < len(self._pieces) else None


def pieces_of(plan: VelocityPlan, start: MovingStart, time: float) -> list[PathPiece]:
    """A piece for each cell; the first begins at `time`."""
    cells, places, squares = plan
    pieces: list[PathPiece] = []
    slope = (squares[1] - squares[0]) / (places[1] - places[0])
    square = squares[1] - slope * 0.5 * cells[1].length
    if start.square > 0.0:
        square, slope = start.square, start.slope
    velocity = sqrt(square)
    if start.square <= 0.0:
        pieces.append(rest_piece(time, cells[0].begin, cells[0].length, velocity))
        time += pieces[0].duration
    for index in range(1, len(cells) - 1):
        cell = cells[index]
        following = (squares[index + 1] - squares[index]) / (places[index + 1] - places[index])
        after = sqrt(max(0.0, squares[index] + following * 0.5 * cell.length))
        k = 0.5 * (following - slope) / cell.length
        duration = duration_between(cell.length, velocity, after, k)
        pieces.append(PathPiece(time, cell.begin, velocity, 0.5 * slope, k, duration, BETWEEN))
        time += duration
        velocity, slope = after, following
    pieces.append(stop_piece(time, cells[-1].begin, cells[-1].length, velocity))
    return pieces


def rest_piece(begin: float, u: float, distance: float, velocity: float) -> PathPiece:
    """From rest with constant jerk: `distance` = j·t³/6, `velocity` = j·t²/2."""
    duration = 3.0 * distance / velocity
    return PathPiece(begin, u, 0.0, 0.0, 2.0 * velocity / (duration * duration), duration, FROM_REST)


def stop_piece(begin: float, u: float, distance: float, velocity: float) -> PathPiece:
    """To rest with constant jerk, the mirror image."""
    duration = 3.0 * distance / velocity
    jerk = 2.0 * velocity / (duration * duration)
    return PathPiece(begin, u, velocity, -jerk * duration, jerk, duration, TO_REST)
