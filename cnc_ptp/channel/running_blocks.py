"""The blocks of a program that is interpreted while it runs, and what is needed to come to the same place again.

An interpreter in the middle of a program cannot be stored: it stands within loops of functions. So it is made again
from the state in which the program started, and gives as many blocks as it had given, with the same answers in between.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

from cnc_ptp.channel.block_stream import RunAnswer, RunSource
from cnc_ptp.channel.program_check import ProgramCheck, ProgramState
from cnc_ptp.channel.program_start import ProgramStart
from cnc_ptp.nc.block_search import StartPoint
from cnc_ptp.nc.canonical import CanonicalBlock
from cnc_ptp.nc.faults import ProgramError
from cnc_ptp.nc.flow.sections import Program

MOST_ANSWERS: Final = 100_000
"""Waits of one program that are remembered. One that has more is not stored, or it would need ever more memory."""


class RunningBlocks(RunSource):
    """An iterator over the blocks of one start of a program.

    state       of the interpreter; it changes with each block
    before      the state in which the program started
    asked       how many blocks were asked for
    ended       nothing follows: the program was finished, or had a fault
    forgotten   there were more answers than are remembered
    """

    def __init__(
        self,
        check: ProgramCheck,
        program: Program,
        start: tuple[float, ...],
        state: ProgramState,
        unreferenced: tuple[str, ...],
        point: StartPoint | None,
    ) -> None:
        """As ProgramCheck.running; `point`: the program begins there."""
        self.check, self.program, self.start, self.unreferenced, self.point = check, program, start, unreferenced, point
        self.before, self.state = state.copy(), state
        self.asked = 0
        self.ended = self.forgotten = False
        self.block_skip = check.block_skip
        """As it was when the first block was asked for."""
        self.answers: list[RunAnswer] = []
        begin = None if point is None else ProgramStart(point, program)
        self._blocks: Iterator[CanonicalBlock] = check.running(program, start, state, unreferenced, begin)

    def __iter__(self) -> RunningBlocks:
        return self

    def __next__(self) -> CanonicalBlock:
        """Raises ProgramError, StopIteration."""
        if not self.asked:
            self.block_skip = self.check.block_skip
        self.asked += 1
        try:
            return next(self._blocks)
        except (ProgramError, StopIteration):
            self.ended = True
            self.answers = []
            raise

    def give(self, answer: RunAnswer) -> None:
        """What the next blocks may read."""
        if not self.ended:
            self.forgotten = self.forgotten or len(self.answers) >= MOST_ANSWERS
            if self.forgotten:
                self.answers = []
            else:
                self.answers.append(answer._replace(asked=self.asked))
        self._take(answer)

    def _take(self, answer: RunAnswer) -> None:
        values = self.state.values
        values.actual, values.position, values.touch = answer.actual, answer.position, answer.touch
        values.timers, values.override = dict(answer.timers), answer.override

    def repeat(self, asked: int, answers: list[RunAnswer], block_skip: int) -> None:
        """Goes to where `asked` blocks had been asked for and the `answers` given. Raises what the program raises."""
        skip_now, self.check.block_skip = self.check.block_skip, block_skip
        try:
            for answer in answers:
                self._go_to(answer.asked)
                self.give(answer)
            self._go_to(asked)
        finally:
            self.check.block_skip = skip_now
            self.block_skip = block_skip

    def _go_to(self, asked: int) -> None:
        while self.asked < asked:
            next(self)
