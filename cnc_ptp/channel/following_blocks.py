"""The blocks behind the active one: which of them the path may go through without a stop."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Container
from itertools import islice

from cnc_ptp.channel.block_stream import NO_BLOCKS, BlockStream
from cnc_ptp.channel.function_output import FunctionOutput
from cnc_ptp.channel.waits import Moment
from cnc_ptp.nc.canonical import (
    BUSY,
    CanonicalBlock,
    CircularMove,
    ExplicitSynchronisation,
    LinearMove,
    Motion,
    led_by_spindle,
)
from cnc_ptp.nc.faults import ProgramError
from cnc_ptp.nc.measuring import measures


class FollowingBlocks:
    """Takes blocks from the stream, and looks ahead in it.

    busy   the interpreter has not found the next block yet
    """

    def __init__(self, functions: FunctionOutput, waits: Callable[[], Container[Moment]]) -> None:
        """`waits`: the moments before which the path has to stop."""
        self._functions, self._waits = functions, waits
        self.optional_stop = False
        """M01 stops like M00."""
        self.stream = NO_BLOCKS
        self.busy = False
        self._active: CanonicalBlock | None = None
        self._ahead: deque[CanonicalBlock] = deque()
        self._accepted = 0
        """Blocks of `_ahead` that belong to the active path."""
        self._shown = 0
        self._fault: ProgramError | None = None
        """A fault behind the blocks that are known: it counts when the path gets there."""

    def begin(self, stream: BlockStream) -> None:
        """A program starts."""
        self.stream = stream
        self._active, self._fault = None, None
        self._ahead.clear()
        self._accepted = 0

    def take(self) -> CanonicalBlock | None:
        """The next block, which is the active one then; as BlockStream.next. Raises ProgramError."""
        if self._ahead:
            block: CanonicalBlock | None = self._ahead.popleft()
            self._accepted = max(0, self._accepted - 1)
        elif self._fault is not None:
            raise self._fault
        else:
            block = self.stream.next()
        self._active = block
        return block

    def peek(self) -> LinearMove | CircularMove | None:
        """The next motion; None if the path stops before it, or (`busy`) while it is not known."""
        self.busy = False
        place = self._accepted
        before = self._ahead[place - 1] if place else self._active
        if before is None or self._stops(before) or self._functions.goes_out_behind(before):
            return None
        waits = self._waits()
        if any(moment in waits for moment in LATER_WAITS):
            return None
        while True:
            block = self._block(place)
            if block is None or not self._functions.without_stop(block) or self._synchronises(block, place, waits):
                return None
            place += 1
            if measures(block.motion):
                return None
            if isinstance(block.motion, (LinearMove, CircularMove)):
                self._shown = place
                return block.motion
            if block.motion is not None or self._stops(block):
                return None

    def awaits_next(self, motion: Motion | None) -> bool:
        """The path may continue behind `motion`, but with what is not known yet."""
        if not isinstance(motion, (LinearMove, CircularMove)):
            return False
        if motion.transition.stops and not led_by_spindle(motion):
            return False
        return self.peek() is None and self.busy

    def accept(self) -> None:
        """The path continues with the motion that `peek` has shown."""
        self._accepted = self._shown

    def _stops(self, block: CanonicalBlock) -> bool:
        """The program stops behind the block."""
        return block.stop not in ("", "M01") or (block.stop == "M01" and self.optional_stop)

    def _synchronises(self, block: CanonicalBlock, place: int, waits: Container[Moment]) -> bool:
        """#EXPL SYN with something to wait for."""
        if not any(isinstance(function, ExplicitSynchronisation) for function in block.functions):
            return False
        return Moment.EXPLICIT in waits or any(map(self._functions.waits_late, islice(self._ahead, place)))

    def _block(self, place: int) -> CanonicalBlock | None:
        if place < len(self._ahead):
            return self._ahead[place]
        if self._fault is not None:
            return None
        try:
            block = self.stream.next()
        except ProgramError as fault:
            self._fault = fault
            return None
        if block is BUSY:
            self.busy = True
            return None
        if block is not None:
            self._ahead.append(block)
        return block


LATER_WAITS = (Moment.AFTER, Moment.NEXT_MOTION, Moment.NEXT_CUT)
"""Waits that hold the next motion; those that are fulfilled meanwhile cost a stop, too."""
