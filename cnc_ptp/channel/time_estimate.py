"""How long each block of a program takes at override 100 %, found before it runs.

The path is run in thought, with the look-ahead of the run. Of a program that would take too much computing for that,
windows are run; the blocks between them take as much longer than in a sketch (at their feed, with ramps where the path
stops) as those of the windows before.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import acos, ceil, sqrt
from typing import Final

from cnc_ptp.channel.block_stream import BlockStream
from cnc_ptp.channel.following_blocks import FollowingBlocks
from cnc_ptp.channel.function_output import FunctionOutput
from cnc_ptp.channel.waits import Moment
from cnc_ptp.errors import CncError
from cnc_ptp.nc.canonical import CanonicalBlock, CircularMove, Dwell, HomeAxes, LinearMove
from cnc_ptp.path.linked_path import can_follow, taps
from cnc_ptp.path.lookahead.parts import CELL_TIME
from cnc_ptp.path.motion_plan import Plan
from cnc_ptp.path.path_motion import PathMotion

Motion = LinearMove | CircularMove | Dwell | HomeAxes
BUDGET: Final = 10_000.0
"""Cost of what is planned, in blocks."""
COST_PER_SECOND: Final = 125.0
"""Blocks that cost as much as a second of motion, which the look-ahead divides into cells of 8 ms."""
SHORT: Final = 1_500.0
"""Cost of a program up to which its cells are as short as those of the run."""
LONG_CELL: Final = 0.008
"""s of the longest cell in other programs."""
LONG: Final = 5.0
"""s of a motion from which on its time in the sketch is good enough."""
WINDOW: Final = 1_000.0
"""Cost of a window."""
CORNER: Final = 0.6
"""rad from which on a smooth curve has a corner."""
KINK: Final = 0.05
"""rad from which on the path stops where there is no curve."""
NO_DIRECTION: Final[list[float]] = []
EDGE: Final = 0.15
"""Part of a window at either end that does not count: the path sets out from rest there, and stops."""


class TimeEstimate:
    """Times of blocks, as `path` would run them; `functions` say where it stops."""

    def __init__(self, path: PathMotion, functions: FunctionOutput) -> None:
        self._path = path
        self._following = FollowingBlocks(functions, no_waits)
        self._cell_time = CELL_TIME

    def seconds(self, blocks: Sequence[CanonicalBlock], start: Sequence[float]) -> list[float]:
        """Of each block in turn, motions and dwells; they begin at `start` (mm, deg).

        A motion that cannot be planned takes no time: it is a fault when the path reaches it.
        """
        places = places_of(blocks, tuple(start))
        nominal = self._sketch(blocks, places)
        costs = [cost(block, seconds) for block, seconds in zip(blocks, nominal, strict=True)]
        whole = sum(costs)
        self._cell_time = CELL_TIME if whole <= SHORT else LONG_CELL
        every = ceil(whole / BUDGET)
        if every <= 1:
            return self._planned(blocks, places, nominal)
        return self._sampled(blocks, places, nominal, costs, every)

    def _sampled(
        self,
        blocks: Sequence[CanonicalBlock],
        places: Sequence[tuple[float, ...]],
        nominal: Sequence[float],
        costs: Sequence[float],
        every: int,
    ) -> list[float]:
        """One window of `every` is planned."""
        seconds: list[float] = []
        factor, number = 1.0, 0
        while len(seconds) < len(blocks):
            begin = len(seconds)
            end = end_of_window(costs, begin)
            if number % every == 0:
                planned = self._planned(blocks[begin:end], places[begin:end], nominal[begin:end])
                factor = lengthening(blocks[begin:end], planned, nominal[begin:end], factor)
            for index in range(begin, end):
                moves = isinstance(blocks[index].motion, (LinearMove, CircularMove))
                seconds.append(nominal[index] * factor if moves else nominal[index])
            number += 1
        return seconds

    def _planned(
        self, blocks: Sequence[CanonicalBlock], places: Sequence[tuple[float, ...]], nominal: Sequence[float]
    ) -> list[float]:
        """Of blocks that begin at rest, and behind which the path stops; long ones are not run through."""
        seconds: list[float] = []
        begin = 0
        for index, block in enumerate(blocks):
            if is_long(block, nominal[index]):
                seconds += self._run(blocks[begin:index], places[begin:index])
                seconds.append(nominal[index])
                begin = index + 1
        return seconds + self._run(blocks[begin:], places[begin:])

    def _run(self, blocks: Sequence[CanonicalBlock], places: Sequence[tuple[float, ...]]) -> list[float]:
        """Of blocks between two stops of the path."""
        seconds: list[float] = []
        self._following.begin(BlockStream.of(blocks))
        while (block := self._following.take()) is not None:
            motion = block.motion
            if isinstance(motion, (LinearMove, CircularMove)):
                seconds += self._of_path(motion, places[len(seconds)])
            else:
                seconds.append(motion.seconds if isinstance(motion, Dwell) else 0.0)
        return seconds

    def _of_path(self, motion: LinearMove | CircularMove, start: tuple[float, ...]) -> list[float]:
        """Of a motion and of the blocks behind it up to the next stop."""
        try:
            first, *others = self._path.durations(motion, start, self._following, self._cell_time)
        except CncError:
            return [0.0]
        seconds = [first]
        for duration in others:
            while True:
                block = self._following.take()
                assert block is not None
                if block.motion is not None:
                    break
                seconds.append(0.0)
            seconds.append(duration)
        return seconds

    def _sketch(self, blocks: Sequence[CanonicalBlock], places: Sequence[tuple[float, ...]]) -> list[float]:
        """Seconds of each block at its feed, and half of a ramp more for each end at which the path stops."""
        seconds = [block.motion.seconds if isinstance(block.motion, Dwell) else 0.0 for block in blocks]
        last, last_plan, last_direction = -1, None, NO_DIRECTION
        stop = 1.0
        for index, block in enumerate(blocks):
            motion = block.motion
            if motion is None:
                continue
            plan = self._plan(motion, places[index])
            on_axes = plan if isinstance(motion, (LinearMove, CircularMove)) and not taps(motion) else None
            before = blocks[last].motion if last >= 0 else None
            if last_plan is not None:
                begins = NO_DIRECTION if on_axes is None else direction(on_axes, 0.0)
                slow = slowing(before, motion, turn(last_direction, begins))
                seconds[last] = between(last_plan, stop, slow)
                stop = slow
            last, last_plan = index, plan
            last_direction = NO_DIRECTION if on_axes is None else direction(on_axes, on_axes.element.length)
            if plan is None:
                stop = 1.0
        if last_plan is not None:
            seconds[last] = between(last_plan, stop, 1.0)
        return seconds

    def _plan(self, motion: Motion, start: tuple[float, ...]) -> Plan | None:
        if not isinstance(motion, (LinearMove, CircularMove)):
            return None
        try:
            return self._path.plan(motion, start)
        except CncError:
            return None


def direction(plan: Plan, u: float) -> list[float]:
    """Derivatives of the axes at a place of the element."""
    return [shape[1] for shape in plan.element.shape(u)] if plan.element.length > 0.0 else NO_DIRECTION


def turn(before: list[float], behind: list[float]) -> float:
    """rad between two directions; 0 without one."""
    if not before or not behind:
        return 0.0
    size = sqrt(product(before, before) * product(behind, behind))
    return acos(max(-1.0, min(1.0, product(before, behind) / size)))


def product(one: list[float], other: list[float]) -> float:
    """Of two vectors."""
    total = 0.0
    for index, value in enumerate(one):
        total += value * other[index]
    return total


def slowing(before: Motion | None, motion: Motion, angle: float) -> float:
    """How much of a stop there is between two motions: 0 none, 1 an exact stop."""
    if not isinstance(before, (LinearMove, CircularMove)) or not isinstance(motion, (LinearMove, CircularMove)):
        return 1.0
    if not can_follow(before, motion):
        return 1.0
    transition = before.transition
    if transition.smoothing is not None:
        return 1.0 if angle > CORNER else 0.0
    if transition.contour is not None:
        return min(1.0, angle)
    return 1.0 if angle > KINK else 0.0


def between(plan: Plan, begin: float, end: float) -> float:
    """Seconds of a motion with so much of a stop at either end."""
    at_feed = plan.duration_at_feed
    part = 0.5 * (begin + end)
    return at_feed + part * (plan.duration - at_feed) if part > 0.0 else at_feed


def no_waits() -> tuple[Moment, ...]:
    """The path stops where the program wants it."""
    return ()


def places_of(blocks: Sequence[CanonicalBlock], start: tuple[float, ...]) -> list[tuple[float, ...]]:
    """Where each block begins."""
    places: list[tuple[float, ...]] = []
    for block in blocks:
        places.append(start)
        if isinstance(block.motion, (LinearMove, CircularMove)):
            start = block.motion.target
    return places


def cost(block: CanonicalBlock, seconds: float) -> float:
    """Of planning a block, in blocks."""
    if not isinstance(block.motion, (LinearMove, CircularMove)):
        return 0.0
    return 1.0 if is_long(block, seconds) else 1.0 + COST_PER_SECOND * seconds


def is_long(block: CanonicalBlock, seconds: float) -> bool:
    """A motion of which the ramps are a small part."""
    return seconds > LONG and isinstance(block.motion, (LinearMove, CircularMove))


def end_of_window(costs: Sequence[float], begin: int) -> int:
    """Behind the last block of the window that begins with block `begin`."""
    total, end = 0.0, begin
    while end < len(costs) and total < WINDOW:
        total += costs[end]
        end += 1
    return end


def lengthening(
    blocks: Sequence[CanonicalBlock], planned: Sequence[float], nominal: Sequence[float], otherwise: float
) -> float:
    """How much longer the motions of a window take than in the sketch; its edges do not count."""
    moves = [n for n, block in enumerate(blocks) if isinstance(block.motion, (LinearMove, CircularMove))]
    edge = int(EDGE * len(moves))
    counted = moves[edge : len(moves) - edge]
    at_feed = sum([nominal[n] for n in counted])
    return sum([planned[n] for n in counted]) / at_feed if at_feed > 0.0 else otherwise
