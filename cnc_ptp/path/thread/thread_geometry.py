"""The geometry of a thread: each axis over the angle φ (deg) by which the spindle has turned since its start.

A block is a straight line; over its angle w the axes go by q = m·w + c·w²/2 with the slope m and, where the lead
changes, the bend c. At a joint m and c change; in a zone of the length L that lies symmetrically around it, the
polynomial of fifth degree that has q, q1 and q2 of both sides at its ends takes their place. Where only m changes, by
Δm, it is

    q1 = m + Δm·(3x² - 2x³)     q2 = Δm·6x(1 - x)/L     q3 = Δm·(6 - 12x)/L²     x: part of the zone

and a change Δc of the bend adds at most 9·Δc/L to q3. Outside of the zone the axes are exactly on the lines.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence
from math import inf, sqrt
from typing import Final, NamedTuple

from cnc_ptp.motion import Limits
from cnc_ptp.motion.limits import LARGEST_LIMIT
from cnc_ptp.nc.canonical import Thread
from cnc_ptp.path.geometry import AxisLimits
from cnc_ptp.path.shape import AxisState, Shape

RESERVE: Final = 1.2
"""Multiple of the speed at the start up to which the axes pass a joint within their limits."""
TURN: Final = 360.0
SMALLEST_ZONE: Final = 0.1
"""deg; derivatives over a smaller one would be those of rounding."""
ZONE_SHARE: Final = 0.7
"""Of acceleration and jerk of an axis in a zone; the rest is for following the spindle."""


class Block(NamedTuple):
    """A block of a thread: angle and axes at its start, m (mm/deg) and c (mm/deg²) of each axis, zone there (deg)."""

    begin: float
    start: tuple[float, ...]
    slopes: tuple[float, ...]
    bends: tuple[float, ...]
    zone: float

    def shape(self, way: float) -> list[Shape]:
        """q, q1, q2, q3 of each axis at `way` deg behind its start, without zones."""
        return [
            (q + way * (m + 0.5 * c * way), m + c * way, c, 0.0)
            for q, m, c in zip(self.start, self.slopes, self.bends, strict=True)
        ]


class ThreadGeometry:
    """Straight blocks over the angle, one appended behind the other.

    end      angle at the end of the last block
    target   positions of the axes there
    """

    def __init__(self, start: Sequence[float], limits: Sequence[AxisLimits], path_axes: Sequence[int]) -> None:
        self._limits, self._path_axes = limits, path_axes
        self._blocks: list[Block] = []
        self._begins: list[float] = []
        self.end = 0.0
        self.target = tuple(start)

    def append(self, target: tuple[float, ...], thread: Thread, speed: float) -> None:
        """A block; at its joint the axes keep their limits up to `RESERVE` · `speed`."""
        slopes, bends = slopes_and_bends(self.target, target, thread)
        zone = self._zone(slopes, bends, speed * RESERVE) if self._blocks else 0.0
        self._blocks.append(Block(self.end, self.target, slopes, bends, zone))
        self._begins.append(self.end)
        self.end += thread.angle
        self.target = tuple(target)

    def pop(self) -> None:
        """Takes the last block back."""
        block = self._blocks.pop()
        self._begins.pop()
        self.end, self.target = block.begin, block.start

    def _zone(self, slopes: Sequence[float], bends: Sequence[float], speed: float) -> float:
        """Length of the zone that the axes need, with a = (1.5·|Δm|/L + |c|)·ω² and j = (6·|Δm|/L² + 9·|Δc|/L)·ω³."""
        longest = 0.0
        last, square = self._blocks[-1], speed * speed
        before = last.shape(self.end - last.begin)
        for (_, m, c, _), slope, bend, axis in zip(before, slopes, bends, self._limits, strict=True):
            change, bent = abs(slope - m), abs(bend - c)
            weakest = ZONE_SHARE * min(axis.acceleration, axis.deceleration)
            left = max(weakest - max(abs(c), abs(bend)) * square, 0.1 * weakest)
            longest = max(longest, 1.5 * change * square / left)
            jerk, by_slope, by_bend = ZONE_SHARE * axis.jerk, 6.0 * change * square * speed, 9.0 * bent * square * speed
            longest = max(longest, (by_bend + sqrt(by_bend * by_bend + 4.0 * jerk * by_slope)) / (2.0 * jerk))
        return max(longest, SMALLEST_ZONE) if longest else 0.0

    def __len__(self) -> int:
        return len(self._blocks)

    def begin_of(self, block: int) -> float:
        """Angle at which a block begins; that of the end behind the last one."""
        return self._blocks[block].begin if block < len(self._blocks) else self.end

    def zone_of(self, block: int) -> float:
        """Length of the zone around its begin; 0 at both ends of the thread."""
        return self._blocks[block].zone if block < len(self._blocks) else 0.0

    def start_of(self, block: int) -> tuple[float, ...]:
        """The axes where a block starts; the target behind the last one."""
        return self._blocks[block].start if block < len(self._blocks) else self.target

    def slopes_of(self, block: int) -> list[float]:
        """Largest |mm per deg| of each axis."""
        angle = self.begin_of(block + 1) - self._blocks[block].begin
        slopes, bends = self._blocks[block].slopes, self._blocks[block].bends
        return [max(abs(m), abs(m + c * angle)) for m, c in zip(slopes, bends, strict=True)]

    def fastest(self, blocks: Sequence[int]) -> float:
        """deg/s of φ up to which the velocities of the axes last on these blocks."""
        most = LARGEST_LIMIT
        for block in blocks:
            for slope, axis in zip(self.slopes_of(block), self._limits, strict=True):
                if slope:
                    most = min(most, axis.velocity / slope)
        return most

    def bends_of(self, block: int) -> tuple[float, ...]:
        """mm per deg² of each axis."""
        return self._blocks[block].bends

    def limits(self, blocks: Sequence[int], velocity: float, spared: Sequence[float]) -> Limits:
        """What the axes permit of φ' (here `velocity`), φ'' and φ''' on these blocks.

        `spared`: the part of the acceleration and jerk of each axis that is used for it.
        """
        acceleration = deceleration = jerk = inf
        for block in blocks:
            of_axes = zip(self.slopes_of(block), self._blocks[block].bends, self._limits, spared, strict=True)
            for slope, bend, axis, part in of_axes:
                if slope:
                    bent = abs(bend) * velocity
                    up = (part * axis.acceleration - bent * velocity) / slope
                    down = (part * axis.deceleration - bent * velocity) / slope
                    acceleration, deceleration = min(acceleration, up), min(deceleration, down)
                    jerk = min(jerk, (part * axis.jerk - 3.0 * bent * max(up, down)) / slope)
        return Limits(
            velocity, min(acceleration, LARGEST_LIMIT), min(deceleration, LARGEST_LIMIT), min(jerk, LARGEST_LIMIT)
        )

    def in_joint(self, begin: float, end: float) -> bool:
        """A part of the zone of a joint lies between two angles."""
        for block in self._blocks[self.block_at(begin) : self.block_at(end) + 2]:
            if block.begin - 0.5 * block.zone < end and begin < block.begin + 0.5 * block.zone:
                return True
        return False

    def block_at(self, angle: float) -> int:
        """Number of the block in which the axes are at an angle."""
        return max(0, bisect_right(self._begins, angle) - 1)

    def shape(self, angle: float) -> list[Shape]:
        """q, q1, q2, q3 of each axis at an angle; exactly the target at the end."""
        number = self.block_at(angle)
        block = self._blocks[number]
        way = angle - block.begin
        if angle >= self.end:
            end = block.shape(self.end - block.begin)
            return [(q, q1, q2, 0.0) for q, (_, q1, q2, _) in zip(self.target, end, strict=True)]
        if way < 0.5 * block.zone:
            return self._in_zone(number, way)
        if number + 1 < len(self._blocks):
            behind = self._blocks[number + 1]
            if behind.begin - angle < 0.5 * behind.zone:
                return self._in_zone(number + 1, angle - behind.begin)
        return block.shape(way)

    def _in_zone(self, number: int, way: float) -> list[Shape]:
        """`way`: deg from the joint, negative before it."""
        block, before = self._blocks[number], self._blocks[number - 1]
        size, half = block.zone, 0.5 * block.zone
        angle, x = block.begin - before.begin, way / size + 0.5
        shapes: list[Shape] = []
        for index, place in enumerate(block.start):
            c0, m, c = before.bends[index], block.slopes[index], block.bends[index]
            m0 = before.slopes[index] + c0 * angle
            begin = (-half * (m0 - 0.5 * c0 * half), m0 - c0 * half, c0)
            end = (half * (m + 0.5 * c * half), m + c * half, c)
            q, q1, q2, q3 = blend(begin, end, size, x)
            shapes.append((place + q, q1, q2, q3))
        return shapes

    def evaluate(self, angle: float, rate: float, gain: float, jerk: float) -> tuple[AxisState, ...]:
        """State of each axis at φ with φ', φ'', φ'''."""
        square = rate * rate
        cube, cross = square * rate, 3.0 * rate * gain
        return tuple(
            [
                (q, q1 * rate, q2 * square + q1 * gain, q3 * cube + q2 * cross + q1 * jerk)
                for q, q1, q2, q3 in self.shape(angle)
            ]
        )


def slopes_and_bends(
    start: Sequence[float], target: Sequence[float], thread: Thread
) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """mm per deg at the start, and mm per deg², of each axis in a block.

    With the relative change r of the lead in a revolution, Δq = m·(w + r·w²/720) and c = m·r/360.
    """
    rate = thread.change / thread.lead / TURN
    whole = thread.angle * (1.0 + 0.5 * rate * thread.angle)
    slopes = tuple([(end - begin) / whole for begin, end in zip(start, target, strict=True)])
    return slopes, tuple([m * rate for m in slopes])


def blend(begin: tuple[float, float, float], end: tuple[float, float, float], size: float, x: float) -> Shape:
    """The polynomial of fifth degree over `size` with q, q1, q2 of both ends, at its part x."""
    square = size * size
    d = end[0] - begin[0]
    v0, v1, a0, a1 = begin[1] * size, end[1] * size, begin[2] * square, end[2] * square
    c3 = 10.0 * d - 6.0 * v0 - 4.0 * v1 - 1.5 * a0 + 0.5 * a1
    c4 = -15.0 * d + 8.0 * v0 + 7.0 * v1 + 1.5 * a0 - a1
    c5 = 6.0 * d - 3.0 * v0 - 3.0 * v1 - 0.5 * a0 + 0.5 * a1
    return (
        begin[0] + x * (v0 + x * (0.5 * a0 + x * (c3 + x * (c4 + x * c5)))),
        (v0 + x * (a0 + x * (3.0 * c3 + x * (4.0 * c4 + x * 5.0 * c5)))) / size,
        (a0 + x * (6.0 * c3 + x * (12.0 * c4 + x * 20.0 * c5))) / square,
        (6.0 * c3 + x * (24.0 * c4 + x * 60.0 * c5)) / (square * size),
    )
