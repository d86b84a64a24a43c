"""The blocks of a program of which every block is known, and what is needed to make the same list again.

A state stores where a program began instead of its blocks: they may be a hundred thousand.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from cnc_ptp.channel.program_check import KnownBlocks, ProgramCheck, ProgramState
from cnc_ptp.channel.program_start import ProgramStart
from cnc_ptp.nc.block_search import StartPoint
from cnc_ptp.nc.canonical import CanonicalBlock
from cnc_ptp.nc.flow.sections import Program


class ProgramBegin(NamedTuple):
    """Where and in which state a program begins, as ProgramCheck.known_blocks.

    point       the program begins there
    block_skip  the levels that are skipped
    """

    check: ProgramCheck
    program: Program
    start: tuple[float, ...]
    before: ProgramState
    unreferenced: tuple[str, ...]
    point: StartPoint | None
    block_skip: int

    def known_blocks(self) -> KnownBlocks:
        """The blocks from here on. Raises ProgramError and the errors of ProgramStart."""
        begin = None if self.point is None else ProgramStart(self.point, self.program)
        skip_now, self.check.block_skip = self.check.block_skip, self.block_skip
        try:
            return self.check.known_blocks(self.program, self.start, self.before.copy(), self.unreferenced, begin)
        finally:
            self.check.block_skip = skip_now


class ListedBlocks:
    """An iterator over them.

    taken   how many it has given
    """

    def __init__(self, begin: ProgramBegin, blocks: list[CanonicalBlock]) -> None:
        self.begin = begin
        self.taken = 0
        self._blocks, self._count = blocks, len(blocks)

    def __iter__(self) -> Iterator[CanonicalBlock]:
        return self

    def __next__(self) -> CanonicalBlock:
        """Raises StopIteration."""
        if self.ended:
            raise StopIteration
        block = self._blocks[self.taken]
        self.taken += 1
        if self.ended:
            self._blocks = []
        return block

    @property
    def ended(self) -> bool:
        """All were taken."""
        return self.taken == self._count
