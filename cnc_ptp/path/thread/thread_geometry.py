"""The geometry of a thread: each axis over the angle φ (deg) by which the spindle has turned since its start.

A block is a straight line over its angle. At a joint the slope of each axis changes; a zone of the length L lies
symmetrically around it, in which the slope goes from m to m + Δm by the smoothstep S(x) = 3x² - 2x³ of its part x:

    q1 = m + Δm·S(x)     q2 = Δm·6x(1 - x)/L     q3 = Δm·(6 - 12x)/L²     q = line + Δm·L·(x³ - x⁴/2)

S is symmetric, so outside of the zone the axes are exactly on the lines of the blocks.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence
from math import hypot, inf, sqrt
from typing import Final, NamedTuple

from cnc_ptp.motion import Limits
from cnc_ptp.motion.limits import LARGEST_LIMIT
from cnc_ptp.path.geometry import AxisLimits
from cnc_ptp.path.shape import AxisState, Shape

RESERVE: Final = 1.2
"""Multiple of the speed at the start up to which the axes pass a joint within their limits."""
ZONE_SHARE: Final = 0.8
"""Of acceleration and jerk of an axis in a zone; the rest is for following the spindle."""


class Block(NamedTuple):
    """A block of a thread: angle and axes at its begin, mm per deg of each axis, the zone around its begin (deg)."""

    begin: float
    start: tuple[float, ...]
    slopes: tuple[float, ...]
    zone: float


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

    def append(self, target: tuple[float, ...], angle: float, speed: float) -> None:
        """A block that takes `angle` (deg); at its joint the axes keep their limits up to `RESERVE` · `speed`."""
        pairs = zip(self.target, target, strict=True)
        slopes = tuple([(end - begin) / angle for begin, end in pairs])
        zone = self._zone(slopes, speed * RESERVE) if self._blocks else 0.0
        self._blocks.append(Block(self.end, self.target, slopes, zone))
        self._begins.append(self.end)
        self.end += angle
        self.target = tuple(target)

    def pop(self) -> None:
        """Takes the last block back."""
        block = self._blocks.pop()
        self._begins.pop()
        self.end, self.target = block.begin, block.start

    def _zone(self, slopes: Sequence[float], speed: float) -> float:
        """Length of the zone that the axes need: a = 1.5·|Δm|·ω²/L, j = 6·|Δm|·ω³/L²."""
        longest = 0.0
        for before, behind, axis in zip(self._blocks[-1].slopes, slopes, self._limits, strict=True):
            change = abs(behind - before)
            weakest = ZONE_SHARE * min(axis.acceleration, axis.deceleration)
            longest = max(longest, 1.5 * change * speed * speed / weakest)
            longest = max(longest, sqrt(6.0 * change * speed * speed * speed / (ZONE_SHARE * axis.jerk)))
        return longest

    def __len__(self) -> int:
        return len(self._blocks)

    def begin_of(self, block: int) -> float:
        """Angle at which a block begins; that of the end behind the last one."""
        return self._blocks[block].begin if block < len(self._blocks) else self.end

    def zone_of(self, block: int) -> float:
        """Length of the zone around its begin; 0 at both ends of the thread."""
        return self._blocks[block].zone if block < len(self._blocks) else 0.0

    def slopes_of(self, block: int) -> tuple[float, ...]:
        """mm per deg of each axis."""
        return self._blocks[block].slopes

    def rate_of(self, block: int) -> float:
        """mm of path per deg."""
        slopes = self._blocks[block].slopes
        return hypot(*[slopes[axis] for axis in self._path_axes]) or hypot(*slopes)

    def limits(self, blocks: Sequence[int], velocity: float, spared: Sequence[float]) -> Limits:
        """What the axes permit of φ' (here `velocity`), φ'' and φ''' on these blocks.

        `spared`: the part of the acceleration and jerk of each axis that is used for it.
        """
        acceleration = deceleration = jerk = inf
        for block in blocks:
            for slope, axis, part in zip(self._blocks[block].slopes, self._limits, spared, strict=True):
                if slope:
                    acceleration = min(acceleration, part * axis.acceleration / abs(slope))
                    deceleration = min(deceleration, part * axis.deceleration / abs(slope))
                    jerk = min(jerk, part * axis.jerk / abs(slope))
        return Limits(
            velocity, min(acceleration, LARGEST_LIMIT), min(deceleration, LARGEST_LIMIT), min(jerk, LARGEST_LIMIT)
        )

    def block_at(self, angle: float) -> int:
        """Number of the block in which the axes are at an angle."""
        return max(0, bisect_right(self._begins, angle) - 1)

    def shape(self, angle: float) -> list[Shape]:
        """q, q1, q2, q3 of each axis at an angle; exactly the target at the end."""
        if angle >= self.end:
            slopes = self._blocks[-1].slopes
            return [(q, q1, 0.0, 0.0) for q, q1 in zip(self.target, slopes, strict=True)]
        number = self.block_at(angle)
        block = self._blocks[number]
        way = angle - block.begin
        if way < 0.5 * block.zone:
            return self._in_zone(number, way)
        if number + 1 < len(self._blocks):
            behind = self._blocks[number + 1]
            if behind.begin - angle < 0.5 * behind.zone:
                return self._in_zone(number + 1, angle - behind.begin)
        return [(q + m * way, m, 0.0, 0.0) for q, m in zip(block.start, block.slopes, strict=True)]

    def _in_zone(self, number: int, way: float) -> list[Shape]:
        """`way`: deg from the joint, negative before it."""
        block, before = self._blocks[number], self._blocks[number - 1].slopes
        size = block.zone
        x = way / size + 0.5
        square = x * x
        bulge = size * square * x * (1.0 - 0.5 * x)
        shapes: list[Shape] = []
        for q, m, behind in zip(block.start, before, block.slopes, strict=True):
            change = behind - m
            shapes.append(
                (
                    q + m * way + change * bulge,
                    m + change * square * (3.0 - 2.0 * x),
                    change * 6.0 * x * (1.0 - x) / size,
                    change * (6.0 - 12.0 * x) / (size * size),
                )
            )
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
