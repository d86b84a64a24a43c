"""Threads of a program that is known before it runs: whether run-up, joints, run-out and the retract have their room.

The speed is the programmed one. What only the run knows (a spindle of the PLC, an override) is checked when the thread
starts.
"""

from __future__ import annotations

from collections.abc import Sequence

from cnc_ptp.errors import CncError
from cnc_ptp.nc.awaited import awaits_path
from cnc_ptp.nc.canonical import CanonicalBlock, CircularMove, LinearMove, Source
from cnc_ptp.nc.faults import ProgramError
from cnc_ptp.path.thread.retract import Retract
from cnc_ptp.path.thread.thread_check import ThreadSettings, checked_geometry, with_retract, words_of

RETRACT_BEYOND_LIMIT = 22089
Point = tuple[float, ...]


class ThreadReading:
    """Takes the blocks one by one; a thread is checked as a whole behind its last one.

    here  end of the last motion
    """

    def __init__(self, settings: ThreadSettings, limits: Sequence[tuple[float, float]], start: Sequence[float]) -> None:
        """`limits`: the soft limits of each axis, mm; `start` of the program."""
        self._settings, self._limits = settings, limits
        self.here = self._begin = tuple(start)
        self._motions: list[LinearMove] = []
        self._source = Source("", 0, 0, "")
        self._unsure = False
        """Only the run knows whether the path stops for a function of the blocks of the thread."""

    def take(self, block: CanonicalBlock) -> None:
        """Raises ProgramError 22082 to 22084, 22088, 22089 for the thread that ends before this block."""
        motion, here = block.motion, self.here
        if isinstance(motion, (LinearMove, CircularMove)):
            self.here = motion.target
        if isinstance(motion, LinearMove) and motion.thread is not None:
            if self._motions and not self._continued_by(motion):
                self.finish()
            if self._unsure:
                self._motions = []
            elif not self._motions:
                self._begin, self._source = here, block.source
                self._motions = [motion]
            else:
                self._motions.append(motion)
        elif motion is not None:
            self.finish()
        if block.stop not in ("", "M01") or awaits_path(block):
            self.finish()
        elif self._motions and (block.functions or block.stop):
            self._unsure = True

    def leave_out(self, block: CanonicalBlock) -> None:
        """A block that has an error of its own already; so has its thread."""
        if isinstance(block.motion, (LinearMove, CircularMove)):
            self.here = block.motion.target
        self._motions, self._unsure = [], False

    def _continued_by(self, motion: LinearMove) -> bool:
        last, thread = words_of(self._motions[-1]), words_of(motion)
        return (last.spindle, last.offset, last.speed) == (thread.spindle, thread.offset, thread.speed)

    def finish(self) -> None:
        """The thread ends here. Raises as `take`."""
        motions, self._motions, self._unsure = self._motions, [], False
        speed = abs(words_of(motions[0]).speed) if motions else 0.0
        try:
            if motions:
                settings = with_retract(self._settings, motions[0])
                self._require_retract(settings.retract, [self._begin, *[motion.target for motion in motions]])
            if speed:
                checked_geometry(settings, self._begin, motions, speed)
        except CncError as error:
            source = self._source
            raise ProgramError(error.number, error.reason, source, source.column("G33"), **error.values) from None

    def _require_retract(self, retract: Retract | None, points: Sequence[Point]) -> None:
        """Raises CncError 22089 if the tool could not leave the thread everywhere."""
        if retract is None:
            return
        low, high = self._limits[retract.axis]
        ends = [point[retract.axis] + retract.way for point in points]
        for end, limit in ((min(ends), low), (max(ends), high)):
            if end < low or end > high:
                way = f"axis {retract.name} could not retract by {retract.way:g} mm from the thread"
                reason = f"{way}: {end:g} mm lies beyond the soft limit {limit:g} mm"
                raise CncError(RETRACT_BEYOND_LIMIT, reason, end=end, limit=limit, retract=retract.way)
