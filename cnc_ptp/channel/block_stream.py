"""The blocks of a running program: from a list, or interpreted one after the other while the program runs."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections import deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Final, NamedTuple

from cnc_ptp.nc.awaited import awaits_path
from cnc_ptp.nc.canonical import BUSY, CanonicalBlock
from cnc_ptp.nc.faults import ProgramError
from cnc_ptp.nc.measuring import Touch

BUFFER: Final = 1000
"""Blocks that are interpreted ahead, before the path asks for them."""


class RunAnswer(NamedTuple):
    """What the interpreter got to know when it had asked for so many blocks."""

    asked: int
    actual: tuple[float, ...]
    position: tuple[float, ...]
    timers: tuple[tuple[int, float], ...]
    touch: Touch | None
    override: float


class RunSource(ABC):
    """An interpreter that runs with the program: an iterator that gets to know what only the run knows."""

    @abstractmethod
    def __iter__(self) -> RunSource: ...

    @abstractmethod
    def __next__(self) -> CanonicalBlock:
        """Raises ProgramError, StopIteration."""

    @abstractmethod
    def give(self, answer: RunAnswer) -> None:
        """What the next blocks may read."""


class BlockStream:
    """Hands out block after block; the sequence asks for one when it has finished the one before.

    A program that is interpreted while it runs has a number of blocks for each cycle. What the path does not take of
    them at once is kept for later, so that all depends on cycles alone.

    awaited   the interpreter needs the positions of the axes for the next block
    done      blocks that are finished
    read      characters of the program's text up to there, if they are counted
    """

    def __init__(
        self,
        blocks: Iterator[CanonicalBlock] | RunSource,
        total: int | None,
        blocks_per_cycle: int = 0,
        place: Callable[[], int] | None = None,
    ) -> None:
        """`total`: number of blocks if it is known.

        `blocks_per_cycle`: 0 is no limit. `place` in the text that the interpreter has reached.
        """
        self._blocks, self._total = blocks, total
        self._for_cycle, self._place = blocks_per_cycle, place
        self._left = 0
        """Blocks that may still be interpreted in this cycle block."""
        self._ahead: deque[CanonicalBlock] = deque()
        self._places: deque[int] = deque()
        self._fault: ProgramError | None = None
        """What the interpreter has found behind the blocks that are ahead."""
        self._ended = False
        self.awaited = False
        self.done = 0
        self.read = 0

    @classmethod
    def of(cls, blocks: Sequence[CanonicalBlock]) -> BlockStream:
        """A program of which every block is known."""
        return cls(iter(blocks), len(blocks))

    @property
    def running(self) -> RunSource | None:
        """The interpreter that runs with the program, if one does."""
        return self._blocks if isinstance(self._blocks, RunSource) else None

    @property
    def fill(self) -> float:
        """How full the buffer is, 0 … 1; 1.0 when all the rest of the program is in it."""
        return 1.0 if self._complete else len(self._ahead) / BUFFER

    @property
    def _complete(self) -> bool:
        return not self._for_cycle or self._ended or self._fault is not None

    def begin_cycles(self, count: int) -> None:
        """So many cycles are computed now."""
        self._left = count * self._for_cycle

    def look_ahead(self) -> None:
        """Interprets what the cycles have left, as far as the buffer and what is known before the run permit."""
        while self._left > 0 and not self._complete and len(self._ahead) < BUFFER:
            if self.awaited or (self._ahead and awaits_path(self._ahead[-1])):
                return
            self._interpret()

    def give(
        self,
        actual: tuple[float, ...],
        position: tuple[float, ...],
        timers: Mapping[int, float],
        touch: Touch | None = None,
        override: float = 100.0,
    ) -> None:
        """Actual and set positions of the axes at this instant, the timers that were read (ms), how a measuring run
        has ended; the override of the path (percent).
        """
        running = self.running
        if running is not None:
            running.give(RunAnswer(0, actual, position, tuple(timers.items()), touch, override))

    def next(self) -> CanonicalBlock | None:
        """The next block, BUSY while the interpreter computes, or None at the end of the program.

        Raises ProgramError for a fault that only the run shows.
        """
        if not self._for_cycle:
            block = next(self._blocks, None)
            self.awaited = block is not None and awaits_path(block)
            return block
        if not self._ahead and not self._complete and self._left > 0:
            self._interpret()
        if self._ahead:
            block = self._ahead.popleft()
            self.awaited = awaits_path(block)
            return block
        if self._fault is not None:
            raise self._fault
        return None if self._ended else BUSY

    def _interpret(self) -> None:
        """One block more, or a computation of which none has come yet, which takes all that is left of the cycles."""
        try:
            block = next(self._blocks, None)
        except ProgramError as fault:
            self._fault = fault
            return
        if block is None:
            self._ended = True
        elif block is BUSY:
            self._left = 0
        else:
            self._left -= 1
            self._ahead.append(block)
            if self._place is not None:
                self._places.append(self._place())

    def finish_block(self) -> None:
        """A block has been carried out."""
        self.done += 1
        if self._places:
            self.read = self._places.popleft()

    def end(self) -> None:
        """The program has been carried out to its end."""
        self._total = self.done

    @property
    def total(self) -> int:
        """Blocks of the program; one more than are finished while their number is not known."""
        return self.done + 1 if self._total is None else self._total


NO_BLOCKS = BlockStream.of(())
