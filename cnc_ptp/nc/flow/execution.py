"""Executes the lines of a program: which line is next, through conditions, loops, jumps and subroutines."""

from __future__ import annotations

import re
from typing import Final, NamedTuple

from cnc_ptp.errors import Value
from cnc_ptp.nc import faults
from cnc_ptp.nc.block_search import BlockSearch
from cnc_ptp.nc.canonical import Source
from cnc_ptp.nc.coordinates.placement import refresh
from cnc_ptp.nc.expressions.expression_faults import PARAMETER_UNSET
from cnc_ptp.nc.expressions.values import Scalar, Values, Variable
from cnc_ptp.nc.faults import ProgramError
from cnc_ptp.nc.flow import flow_faults
from cnc_ptp.nc.flow.calls import check_arguments
from cnc_ptp.nc.flow.lines import Call, Flow, Line
from cnc_ptp.nc.flow.repetition import Repetition
from cnc_ptp.nc.flow.sections import Program
from cnc_ptp.nc.flow.structures import Place, Structure
from cnc_ptp.nc.modal_state import ModalState
from cnc_ptp.nc.program import Limits, NcBlock

EVALUATE: Final = ("$IF", "$SWITCH", "$ENDFOR")
"""Statements that evaluate what other lines of their structure say."""
MODAL_BLOCK: Final = "MODAL_BLOCK"


READS_STATE: Final = re.compile(r"V\s*\.\s*(?:A|G|RTG|SPDL_PROG)\s*\.", re.ASCII | re.IGNORECASE)
"""Readable state, which blocks before the line have changed."""
ENDLESS: Final = (faults.CALL_DEPTH.number, flow_faults.LOOP_LIMIT.number, flow_faults.ENDLESS.number)
"""Nothing comes behind them."""
ALL_LINES: Final = 1 << 60


class Pending(NamedTuple):
    """A call that is due as soon as execution is at this depth again."""

    call: Call
    line: Line
    depth: int
    repeats: int = 1


class Frame:
    """Where a subroutine was called, and what its caller had."""

    def __init__(self, program: Program, number: int, offset: int, repeated: int, source: Source, call: Call) -> None:
        self.program, self.number, self.offset, self.repeated = program, number, offset, repeated
        self.source, self.name, self.column = source, call.name, call.column
        self.local: dict[str, Variable] = {}
        self.cycle: dict[str, Variable] = {}
        self.arguments: dict[str, Scalar] = {}
        self.modal: ModalState | None = None
        """The modal state to come back to, after a cycle."""


PAUSE: Final = NcBlock(Source("", 0, 0, ""), (), {})
"""In place of a block: the path must stand before the next line, which reads what only the run knows."""
COMPUTES: Final = NcBlock(Source("", 0, 0, ""), (), {})
"""In place of a block: many lines had none."""
FOUND: Final = NcBlock(Source("", 0, 0, ""), (), {})
"""In place of a block: the place that was looked for is reached."""
LINES_AT_ONCE: Final = 5000
"""Lines that are executed before the caller has its turn again."""


class Execution(Flow):
    """The line that is next and how it came there."""

    def __init__(
        self,
        program: Program,
        values: Values,
        *,
        limits: Limits,
        block_skip: int = 0,
        search: BlockSearch | None = None,
    ) -> None:
        super().__init__(values)
        self._search = search
        self.program, self.limits, self.block_skip = program, limits, block_skip
        self.number, self.offset = program.main.line, program.main.offset
        self.frames: list[Frame] = []
        self.calls: tuple[str, ...] = ()
        """From where the active subroutine was called, the innermost first."""
        self.ended = False
        self.moved = False
        """The last block had a motion; who resolves it says so."""
        self.blocks = 0
        """Canonical blocks of the last block; who resolves it says so."""
        self._repetition = Repetition(limits)
        self._repeated = 0
        """Lines up to this one have been executed before, within the active call."""
        self._entered: set[tuple[str, int]] = set()
        """Files and first lines of subroutines that have been called."""
        self._line: Line | None = None
        """Of the last block, until what follows it has been done."""
        self._depth = 0
        """Calls above the last block."""
        self._returns = False
        """The last block ends its subroutine."""
        self._pending: list[Pending] = []
        """Calls that are due, the next one last."""
        self._paused = -1
        self._read: Line | None = None
        """The line that was looked at last."""
        self.uncertain = False
        """Blocks were left out: it ends before a line that reads the state."""
        self.reads_unknown = False
        """It has ended so."""
        self._modal: Call | None = None
        """The call that follows each motion or block."""
        self._modal_line: Line | None = None
        self._modal_depth = 0

    # the next block

    def next_block(self) -> NcBlock | None:
        """The next block with words, PAUSE, COMPUTES, FOUND, or None at the end of the program. Raises ProgramError."""
        if self._line is not None:
            self._after_block(self._line)
        lines = 0
        while True:
            lines += 1
            if lines > LINES_AT_ONCE:
                return COMPUTES
            if self._pending and self._pending[-1].depth == len(self.frames):
                if self._pauses(self._pending[-1].call.synchronises, -2):
                    return PAUSE
                due = self._pending.pop()
                if due.repeats > 1:
                    self._pending.append(due._replace(repeats=due.repeats - 1))
                self._enter(due.call, due.line)
                continue
            if self.ended:
                return None
            if self.offset < 0:
                self._end_of_section()
                continue
            if self.program.streamed and not self.program.ready(self.number):
                return COMPUTES
            line = self.program.line(self.number, self.offset)
            if line.header:
                self._end_of_section()
                continue
            if self._search is not None and self._search.meets(line.source):
                self._search = None
                return FOUND
            if line.skip & self.block_skip:
                self.number, self.offset = line.next_number, line.next_offset
                continue
            self._read = line
            if self.number <= self._repeated:
                self._repetition.line(line.source)
            if self.uncertain and READS_STATE.search(line.source.text):
                self.ended = self.reads_unknown = True
                return None
            if line.error is not None:
                raise line.error
            if self._pauses(line.synchronises or self._structure_waits(line), self.number):
                self.values.source = line.source
                return PAUSE
            self.number, self.offset = line.next_number, line.next_offset
            if line.source.block_number:
                self.values.block_number = line.source.block_number
            block = line.block
            if line.statement is not None:
                self.values.source = line.source
                block = line.statement.run(self, line)
            if block is not None:
                self._line, self._depth = line, len(self.frames)
                self._returns = block.flow == "return"
                self.ended = block.flow == "end"
                return block
            if line.call is not None:
                self._pending.append(Pending(line.call, line, len(self.frames), line.call.count))

    @property
    def at_end(self) -> bool:
        """The line that was looked at last ends the program or subroutine."""
        return self._read is not None and self._read.flow != ""

    def skip(self, error: ProgramError) -> bool:
        """Leaves out the line that has just raised; False if it decides which lines follow, or about their values."""
        line = self._read
        if line is None or (error.file, error.line) != (line.source.file, line.source.line) or error.number in ENDLESS:
            return False
        if line.control is not None or line.jump or line.call is not None:
            return False
        if line.error is not None and self.program.vocabulary.may_decide(line.source):
            return False
        if line.statement is not None and not line.statement.independent:
            return False
        self.number, self.offset = line.next_number, line.next_offset
        return True

    def _pauses(self, needed: bool, place: int) -> bool:
        """Whether the path must stand before what follows; once for each time that it is executed."""
        if needed and self._paused != place:
            self._paused = place
            self.forget()
            return True
        self._paused = -1
        return False

    def _structure_waits(self, line: Line) -> bool:
        """A condition or an end value that this line evaluates is in another line, and only the run knows it."""
        if line.control is None or line.control.keyword not in EVALUATE:
            return False
        structure = self.program.structure_of.get(line.number)
        return structure is not None and structure.synchronises

    def _after_block(self, line: Line) -> None:
        """What follows a block when it has been resolved: the end of its subroutine, a modal call, its own call."""
        self._line = None
        if self.blocks and line.number <= self._repeated:
            self._repetition.blocks(self.blocks, line.source)
        if self._returns:
            self._returns = False
            self.leave(line)
        if line.call is not None:
            self._pending.append(Pending(line.call, line, self._depth, line.call.count))
        modal, modal_line = self._modal, self._modal_line
        if modal is not None and modal_line is not None and self._depth == self._modal_depth:
            due = line.call is None if modal.modal == MODAL_BLOCK else self.moved
            if due:
                self._pending.append(Pending(modal, modal_line, self._depth))

    def _end_of_section(self) -> None:
        """Without M29 or M30: the subroutine returns, the main program ends."""
        if self.frames:
            self._return()
        else:
            self.program.require_end()
            self.ended = True

    # jumps

    def structure(self, line: Line) -> Structure:
        return self.program.structure_of[line.number]

    def go(self, place: Place) -> None:
        self.number, self.offset = place

    def back(self, place: Place, line: Line) -> None:
        self._repetition.repeat(line.source)
        self._repeated = max(self._repeated, line.number)
        calls = len(self.frames)
        here = (place.line, self.frames[-1] if calls else None, self._modal, self.values.block_number)
        self._repetition.jump((calls, place.line - line.number), here, self.values, line.source)
        self.number, self.offset = place

    def jump(self, line: Line) -> None:
        place = self.program.targets[line.number]
        if isinstance(place, ProgramError):
            raise place
        if place.line <= line.number:
            self.back(place, line)
        self.number, self.offset = place

    def forget(self) -> None:
        """What comes next does not follow from the state alone: the interpreter gets what only the run knows."""
        self._repetition.forget()

    # subroutines

    def _enter(self, call: Call, line: Line) -> None:
        """Calls a subroutine: arguments are evaluated with the values of the caller."""
        if call.modal and self._modal is not call:
            self._modal, self._modal_line, self._modal_depth = call, line, len(self.frames)
        depth = len(self.frames) + 1
        if depth > self.limits.call_depth:
            limit = self.limits.call_depth
            raise faults.CALL_DEPTH.at(line.source, call.column, name=call.name, depth=depth, limit=limit)
        self._repetition.repeat(line.source)
        program, place = self.program.called(call, line.source)
        if call.arguments:
            check_arguments(call, line.source, program, place)
        values = self.values
        values.source = line.source
        arguments = {name: node.scalar(values) for name, node in call.arguments.items()}
        frame = Frame(self.program, self.number, self.offset, self._repeated, line.source, call)
        frame.local, frame.cycle, frame.arguments = values.local, values.cycle, values.arguments
        if call.cycle:
            frame.modal = values.state.copy()
        self.program = program
        self.number, self.offset = place
        section = (program.file, place.line)
        self._repeated = ALL_LINES if section in self._entered else 0
        self._entered.add(section)
        self.frames.append(frame)
        self.calls = (f"{line.source.file} line {line.source.line}", *self.calls)
        values.inherited = values.cycle
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
        self.calls = self.calls[1:]
        if len(self.frames) < self._modal_depth:
            self.end_modal_call()
        self.program, self.number, self.offset = frame.program, frame.number, frame.offset
        self._repeated = frame.repeated
        self.values.leave(frame.local, frame.cycle, frame.arguments)
        self.values.inherited = self.frames[-1].cycle if self.frames else {}
        self.values.level = len(self.frames) + 1
        if frame.modal is not None:
            self.values.state.restore(frame.modal)
            refresh(self.values.channel, self.values.state)


def with_calls(error: ProgramError, execution: Execution) -> ProgramError:
    """The error with its call stack; a parameter that a call does not give is an error of the call."""
    calls = list(execution.calls)
    name = str(error.values.get("name", ""))
    if execution.frames and error.number == PARAMETER_UNSET.number and name.startswith("@"):
        frame = execution.frames[-1]
        words: dict[str, Value] = {"call": frame.name, "name": name, "file": error.file, "line": error.line}
        error = flow_faults.ARGUMENT_MISSING.at(frame.source, frame.column, **words)
        calls.pop(0)
    error.calls = calls
    return error
