"""Executes the lines of a program: which line is next, through conditions, loops, jumps and subroutines."""

from __future__ import annotations

from typing import Final, NamedTuple

from cnc_ptp.nc import faults
from cnc_ptp.nc.canonical import Source
from cnc_ptp.nc.coordinates.placement import refresh
from cnc_ptp.nc.expressions.values import Scalar, Values, Variable
from cnc_ptp.nc.faults import ProgramError
from cnc_ptp.nc.flow import flow_faults
from cnc_ptp.nc.flow.lines import Call, Flow, Line
from cnc_ptp.nc.flow.sections import Program
from cnc_ptp.nc.flow.structures import Place, Structure
from cnc_ptp.nc.program import ModalState, NcBlock


class Limits(NamedTuple):
    """`call_depth`: subroutines within each other; `repeats`: lines that are jumped back to, and calls, in all."""

    call_depth: int = 20
    repeats: int = 1_000_000


MODAL_BLOCK: Final = "MODAL_BLOCK"


class Frame:
    """Where a subroutine was called, and what its caller had."""

    def __init__(self, program: Program, number: int, offset: int, source: Source, name: str) -> None:
        self.program, self.number, self.offset = program, number, offset
        self.source, self.name = source, name
        self.local: dict[str, Variable] = {}
        self.cycle: dict[str, Variable] = {}
        self.arguments: dict[str, Scalar] = {}
        self.modal: ModalState | None = None
        """The modal state to come back to, after a cycle."""


PAUSE: Final = NcBlock(Source("", 0, 0, ""), (), {})
"""In place of a block: the path must stand before the next line, which reads what only the run knows."""
COMPUTES: Final = NcBlock(Source("", 0, 0, ""), (), {})
"""In place of a block: many lines had none."""
LINES_AT_ONCE: Final = 5000
"""Lines that are executed before the caller has its turn again."""


class Execution(Flow):
    """The line that is next and how it came there."""

    def __init__(self, program: Program, values: Values, *, limits: Limits, block_skip: int = 0) -> None:
        super().__init__(values)
        self.program, self.limits, self.block_skip = program, limits, block_skip
        self.number, self.offset = program.main.line, program.main.offset
        self.frames: list[Frame] = []
        self.ended = False
        self._repeats = 0
        self._call: Call | None = None
        self._line: Line | None = None
        self._depth = 0
        """Calls above the last block."""
        self._paused = -1
        self._modal: Call | None = None
        """The call that follows each motion or block."""
        self._modal_line: Line | None = None
        self._modal_depth = 0
        self.moved = False
        """The last block had a motion; who resolves it says so."""

    # the next block

    def next_block(self) -> NcBlock | None:
        """The next block with words, PAUSE, COMPUTES, or None at the end of the program. Raises ProgramError."""
        call, line = self._call, self._line
        if line is not None:
            self._call = self._line = None
            if call is not None:
                self._enter(call, line)
            elif self._modal is not None and self._modal_line is not None and self._modal_due:
                self._enter(self._modal, self._modal_line)
        lines = 0
        while not self.ended:
            lines += 1
            if lines > LINES_AT_ONCE:
                return COMPUTES
            if self.offset < 0:
                self._end_of_section()
                continue
            line = self.program.line(self.number, self.offset)
            if line.header:
                self._end_of_section()
                continue
            if line.skip & self.block_skip:
                self.number, self.offset = line.next_number, line.next_offset
                continue
            if line.error is not None:
                raise line.error
            if line.synchronises and self._paused != self.number:
                self._paused = self.number
                self.values.source = line.source
                return PAUSE
            self._paused = -1
            self.number, self.offset = line.next_number, line.next_offset
            block = line.block
            if line.statement is not None:
                self.values.source = line.source
                block = line.statement.run(self, line)
            if block is not None:
                self._line, self._call, self._depth = line, line.call, len(self.frames)
                self._follow(block, line)
                return block
            if line.call is not None:
                self._enter(line.call, line)
        return None

    @property
    def _modal_due(self) -> bool:
        """The modal call follows the last block: not within itself, and not after a block without a motion."""
        assert self._modal is not None
        return self._depth == self._modal_depth and (self.moved or self._modal.modal == MODAL_BLOCK)

    def _follow(self, block: NcBlock, line: Line) -> None:
        """What a block does to the order of execution, when it has been executed."""
        if block.flow == "end":
            self.ended = True
        elif block.flow == "return":
            self.leave(line)
        if block.source.block_number:
            self.values.block_number = block.source.block_number

    def _end_of_section(self) -> None:
        """Without M29 or M30: the subroutine returns, the main program ends."""
        if self.frames:
            self._return()
        else:
            self.ended = True

    # jumps

    def structure(self, line: Line) -> Structure:
        return self.program.structure_of[line.number]

    def go(self, place: Place) -> None:
        self.number, self.offset = place

    def back(self, place: Place, line: Line) -> None:
        self._count_repeat(line)
        self.number, self.offset = place

    def jump(self, line: Line) -> None:
        place = self.program.targets[line.number]
        if isinstance(place, ProgramError):
            raise place
        if place.line <= line.number:
            self._count_repeat(line)
        self.number, self.offset = place

    def _count_repeat(self, line: Line) -> None:
        self._repeats += 1
        if self._repeats > self.limits.repeats:
            raise flow_faults.LOOP_LIMIT.at(line.source, limit=self.limits.repeats)

    # subroutines

    def _enter(self, call: Call, line: Line) -> None:
        """Calls a subroutine: arguments are evaluated with the values of the caller."""
        if call.modal and self._modal is not call:
            self._modal, self._modal_line, self._modal_depth = call, line, len(self.frames)
        depth = len(self.frames) + 1
        if depth > self.limits.call_depth:
            limit = self.limits.call_depth
            raise faults.CALL_DEPTH.at(line.source, call.column, name=call.name, depth=depth, limit=limit)
        self._count_repeat(line)
        values = self.values
        values.source = line.source
        arguments = {name: node.scalar(values) for name, node in call.arguments.items()}
        frame = Frame(self.program, self.number, self.offset, line.source, call.name)
        frame.local, frame.cycle, frame.arguments = values.local, values.cycle, values.arguments
        if call.cycle:
            frame.modal = values.state.copy()
        self.program, place = self.program.called(call, line.source)
        self.number, self.offset = place
        self.frames.append(frame)
        values.local, values.cycle, values.arguments = {}, dict(values.cycle), arguments
        values.level = len(self.frames) + 1

    def end_modal_call(self) -> None:
        self._modal = self._modal_line = None
        self._modal_depth = 0

    def leave(self, line: Line) -> None:
        if not self.frames:
            raise faults.RETURN_IN_MAIN.at(line.source, 1, word=line.source.text.strip())
        self._return()

    def _return(self) -> None:
        frame = self.frames.pop()
        if len(self.frames) < self._modal_depth:
            self.end_modal_call()
        self.program, self.number, self.offset = frame.program, frame.number, frame.offset
        self.values.leave(frame.local, frame.cycle, frame.arguments)
        self.values.level = len(self.frames) + 1
        if frame.modal is not None:
            self.values.state.restore(frame.modal)
            refresh(self.values.channel, self.values.state)

    @property
    def calls(self) -> list[str]:
        """From where the active subroutine was called, the innermost first."""
        return [f"{frame.source.file} line {frame.source.line}" for frame in reversed(self.frames)]


def with_calls(error: ProgramError, execution: Execution) -> ProgramError:
    """The error with its call stack."""
    error.calls = execution.calls
    return error
