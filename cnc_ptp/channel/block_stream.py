"""The blocks of a running program: from a list, or interpreted one after the other while the program runs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from cnc_ptp.nc.canonical import CanonicalBlock
from cnc_ptp.nc.expressions.values import Values
from cnc_ptp.nc.interpreter import awaits_path
from cnc_ptp.nc.measuring import Touch


class BlockStream:
    """Hands out block after block; the sequence asks for one when it has finished the one before."""

    def __init__(self, blocks: Iterator[CanonicalBlock], total: int | None, values: Values | None) -> None:
        """`total`: number of blocks if it is known; `values` of the interpreter if it runs with the program."""
        self._blocks, self._total, self._values = blocks, total, values
        self.awaited = False
        """The interpreter needs the positions of the axes for the next block."""
        self.done = 0
        """Blocks that are finished."""

    @classmethod
    def of(cls, blocks: Sequence[CanonicalBlock]) -> BlockStream:
        """A program of which every block is known."""
        return cls(iter(blocks), len(blocks), None)

    def give(
        self,
        actual: tuple[float, ...],
        position: tuple[float, ...],
        timers: Mapping[int, float],
        touch: Touch | None = None,
    ) -> None:
        """Actual and set positions of the axes at this instant, the timers that were read (ms), how a measuring run
        has ended.
        """
        if self._values is not None:
            self._values.actual, self._values.position, self._values.touch = actual, position, touch
            self._values.timers = dict(timers)

    def next(self) -> CanonicalBlock | None:
        """The next block, BUSY while the interpreter computes, or None at the end of the program.

        Raises ProgramError for a fault that only the run shows.
        """
        block = next(self._blocks, None)
        self.awaited = block is not None and awaits_path(block)
        return block

    def end(self) -> None:
        """The program has been carried out to its end."""
        self._total = self.done

    @property
    def total(self) -> int:
        """Blocks of the program; one more than are finished while their number is not known."""
        return self.done + 1 if self._total is None else self._total


NO_BLOCKS = BlockStream.of(())
