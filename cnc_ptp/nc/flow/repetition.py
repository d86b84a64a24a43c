"""Loops without an end: a state that comes again, and limits of what a program repeats.

A program is a function of its state alone as long as it reads nothing of the run. When it jumps back to a line with the
same state as before, it does so for ever. One former state is enough to find that (Brent 1980): that of jump 1, 2, 4,
8 … is kept until the next of them, and each jump in between is compared with it. So a loop is found before it has been
run through three times; the error stands at its outermost jump, which comes next. A loop that counts without an end
never has the same state: it ends at the limits.
"""

from __future__ import annotations

from typing import Final

from cnc_ptp.nc.canonical import Source
from cnc_ptp.nc.expressions.values import Values
from cnc_ptp.nc.flow import flow_faults
from cnc_ptp.nc.modal_state import ModalState
from cnc_ptp.nc.program import Limits

LINES_FOR_A_REPEAT: Final = 10
"""Repeated lines that may be executed for each time that lines may be repeated."""
MOST_COMPARED: Final = 50_000_000
"""Values that are compared in all; a program with large arrays is left to the limits."""

NO_JUMP: Final = (1 << 60, 0)


class Repetition:
    """What a program has repeated since its start."""

    def __init__(self, limits: Limits) -> None:
        self._most = limits.repeats
        self._repeats = self._lines = self._blocks = 0
        self._jumps = 0
        """Since the interpreter has read the run."""
        self._next = 1
        """The jump at which the state is kept."""
        self._here: tuple[object, ...] = ()
        """What else the state at that jump is: the line that comes next, the calls, the last N word."""
        self._compared = 0
        self._outermost = NO_JUMP
        """The jump since then that surrounds the others."""
        self._endless = NO_JUMP
        """The one that has no end."""
        self._state = ModalState()
        self._values: Values | None = None

    def repeat(self, source: Source) -> None:
        """A jump back or a call. Raises ProgramError 21578."""
        self._repeats += 1
        if self._repeats > self._most:
            raise flow_faults.LOOP_LIMIT.at(source, what="repeated lines", limit=self._most)

    def line(self, source: Source) -> None:
        """A line is executed that was before. Raises ProgramError 21578."""
        self._lines += 1
        if self._lines > LINES_FOR_A_REPEAT * self._most:
            limit = LINES_FOR_A_REPEAT * self._most
            raise flow_faults.LOOP_LIMIT.at(source, what="executed repeated lines", limit=limit)

    def blocks(self, count: int, source: Source) -> None:
        """Such a line has made blocks. Raises ProgramError 21578."""
        self._blocks += count
        if self._blocks > self._most:
            raise flow_faults.LOOP_LIMIT.at(source, what="made blocks of repeated lines", limit=self._most)

    def jump(self, jump: tuple[int, int], here: tuple[object, ...], values: Values, source: Source) -> None:
        """A jump back. Raises ProgramError 21583.

        `jump`: calls above it, and by how many lines it leads back, negative; `here`: all of the state that is not in
        `values`.
        """
        before = self._values
        if jump < self._outermost:
            self._outermost = jump
        if before is not None and self._here == here:
            self._compared += 1 + len(values.parameters) + values.count
            if values.same_as(before) and values.state == self._state:
                self._endless = self._outermost
        if jump == self._endless:
            raise flow_faults.ENDLESS.at(source)
        self._jumps += 1
        if self._jumps == self._next and self._compared < MOST_COMPARED:
            self._next *= 2
            self._here, self._state, self._outermost = here, values.state.copy(), NO_JUMP
            self._values = values.copy(self._state)
        elif self._jumps == self._next:
            self._values = None

    def forget(self) -> None:
        """The interpreter reads what only the run knows: what comes next does not follow from the state."""
        self._values = None
        self._jumps, self._next, self._endless = 0, 1, NO_JUMP
