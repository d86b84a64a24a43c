"""Times of a program that is known before it runs: how far it is, and how long it will still take.

Motions and dwells count (`TimeEstimate`); how long spindles and the PLC let the path wait is not known before.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final, NamedTuple

from cnc_ptp.channel.time_estimate import TimeEstimate
from cnc_ptp.nc.canonical import CanonicalBlock, CircularMove, LinearMove, led_by_spindle
from cnc_ptp.path.path_motion import PathMotion

NOT_KNOWN: Final = -1.0


class BlockTimes:
    """Seconds of motion (at override 100 %) and of dwell from each block to the end: element n is that before block n.

    Motions with G166 and threads count as dwells: the override has no effect on them.
    There is one element more than blocks that are known; `total` blocks are in the program, None: not known.
    """

    def __init__(self, motion: list[float], dwell: list[float], total: int | None) -> None:
        self.motion, self.dwell, self.total = motion, dwell, total
        known = len(motion) - 1
        self._factor = total / known if total is not None and known else 1.0
        """The blocks that are not kept are taken to be like those that are."""

    def left(self, blocks_done: int) -> tuple[float, float]:
        """Motion and dwell, s, when so many blocks are finished."""
        known = len(self.motion) - 1
        if self.total is None or self.total <= known:
            place = min(blocks_done, known)
            return self.motion[place], self.dwell[place]
        share = max(0.0, 1.0 - blocks_done / self.total) * self._factor
        return self.motion[0] * share, self.dwell[0] * share


def block_times(
    estimate: TimeEstimate, blocks: Sequence[CanonicalBlock], start: Sequence[float], total: int | None
) -> BlockTimes:
    """Times of blocks that begin at `start` (mm, deg)."""
    of_motion, of_dwell = [0.0], [0.0]
    for block, seconds in zip(reversed(blocks), reversed(estimate.seconds(blocks, start)), strict=True):
        motion = block.motion
        scaled = isinstance(motion, (LinearMove, CircularMove)) and not motion.full_override
        scaled = scaled and not led_by_spindle(motion)
        of_motion.append(of_motion[-1] + (seconds if scaled else 0.0))
        of_dwell.append(of_dwell[-1] + (0.0 if scaled else seconds))
    return BlockTimes(of_motion[::-1], of_dwell[::-1], total)


NO_TIMES: Final = BlockTimes([0.0], [0.0], 0)


class Progress(NamedTuple):
    """`share` of the program's time that has passed, 0 … 1; `time_left` in s at the present override."""

    share: float
    time_left: float


class ProgramProgress:
    """Where a program is in its time.

    Without a total number of blocks its share is that of the lines of its file, and never decreases.
    """

    def __init__(self, times: BlockTimes, lines: int) -> None:
        """`lines` of the program's file."""
        self._times, self._lines = times, lines
        self.now = Progress(0.0, NOT_KNOWN)
        self._override = -1.0
        """That of the last update."""

    def end(self, *, finished: bool) -> None:
        """The program has been carried out, or was aborted where it was."""
        self.now = Progress(1.0 if finished else self.now.share, 0.0)

    def update(self, blocks_done: int, path: PathMotion, line: int, *, begun: bool) -> None:
        """`begun`: the motion of the next block is active or has finished; `line`: of the program's file."""
        if self._times.total is None:
            reached = min(1.0, (line - 1) / max(1, self._lines))
            self.now = Progress(max(self.now.share, reached), NOT_KNOWN)
            return
        motion, dwell = self._times.left(blocks_done + begun)
        before, dwell_before = self._times.left(blocks_done)
        active, active_dwell = (before - motion) * path.part_to_go, (dwell_before - dwell) * path.part_to_go
        whole = self._times.left(0)
        total = whole[0] + whole[1]
        blocks = blocks_done / max(1, self._times.total)
        share = 1.0 - (motion + dwell + active + active_dwell) / total if total > 0.0 else blocks
        if path.runs_through:
            time_left = _at_override(motion + active, path.override, dwell + active_dwell)
        elif path.time_to_go < 0.0:
            time_left = NOT_KNOWN
        else:
            time_left = _at_override(motion, path.override, dwell + path.time_to_go)
        self.now = Progress(min(1.0, max(self.now.share, share)), self._less(time_left, path.override))

    def _less(self, time_left: float, override: float) -> float:
        """At the same override no more than before: where the path runs through, the end of a block may move."""
        before = self.now.time_left
        same, self._override = override == self._override, override
        return min(before, time_left) if same and min(before, time_left) >= 0.0 else time_left


def _at_override(motion: float, override: float, fixed: float) -> float:
    """Seconds for a motion at an override, with what it has no effect on."""
    if motion <= 0.0:
        return fixed
    return motion / override + fixed if override > 0.0 else NOT_KNOWN
