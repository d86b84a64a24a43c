"""Times of a program that is known before it runs: how far it is, and how long it will still take.

`block_times` is the one place that knows how long the motions of a program take. Motions and dwells count; how long
spindles and the PLC let the path wait is not known before.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final, NamedTuple

from cnc_ptp.errors import CncError
from cnc_ptp.nc.canonical import CanonicalBlock, CircularMove, Dwell, LinearMove
from cnc_ptp.path.path_motion import PathMotion

NOT_KNOWN: Final = -1.0


class BlockTimes:
    """Seconds of motion (at override 100 %) and of dwell from each block to the end: element n is that before block n.

    Motions with G166 count as dwells: the override has no effect on them.
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
    path: PathMotion, blocks: Sequence[CanonicalBlock], start: Sequence[float], total: int | None
) -> BlockTimes:
    """Times of blocks that begin at `start` (mm, deg): each motion from rest to rest, as `path` would plan it.

    A motion that cannot be planned takes no time: it is a fault when the path reaches it.
    """
    of_motion, of_dwell = [0.0], [0.0]
    durations: list[tuple[float, float]] = []
    position = tuple(start)
    for block in blocks:
        motion = block.motion
        if isinstance(motion, Dwell):
            durations.append((0.0, motion.seconds))
        elif isinstance(motion, (LinearMove, CircularMove)):
            seconds = _duration(path, motion, position)
            durations.append((0.0, seconds) if motion.full_override else (seconds, 0.0))
            position = motion.target
        else:
            durations.append((0.0, 0.0))
    for moving, dwelling in reversed(durations):
        of_motion.append(of_motion[-1] + moving)
        of_dwell.append(of_dwell[-1] + dwelling)
    return BlockTimes(of_motion[::-1], of_dwell[::-1], total)


def _duration(path: PathMotion, motion: LinearMove | CircularMove, start: tuple[float, ...]) -> float:
    try:
        return path.duration(motion, start)
    except CncError:
        return 0.0


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
        self.now = Progress(0.0, 0.0)

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
        active = ((before + dwell_before) - (motion + dwell)) * path.part_to_go
        whole = self._times.left(0)
        total = whole[0] + whole[1]
        blocks = blocks_done / max(1, self._times.total)
        share = 1.0 - (motion + dwell + active) / total if total > 0.0 else blocks
        self.now = Progress(min(1.0, max(0.0, share)), _time_left(motion, dwell, path))


def _time_left(motion: float, dwell: float, path: PathMotion) -> float:
    if path.time_to_go < 0.0 or (motion > 0.0 and path.override == 0.0):
        return NOT_KNOWN
    return path.time_to_go + dwell + (motion / path.override if motion > 0.0 else 0.0)
