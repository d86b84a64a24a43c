"""One line of a program as it was read: its words, its statement, where the next line is."""

from __future__ import annotations

from abc import ABC, abstractmethod

from cnc_ptp.nc.canonical import Source
from cnc_ptp.nc.expressions.nodes import Node
from cnc_ptp.nc.expressions.values import Values
from cnc_ptp.nc.faults import ProgramError
from cnc_ptp.nc.flow.structures import Control, Place, Structure
from cnc_ptp.nc.program import NcBlock


class Flow(ABC):
    """What statements may do with the order of execution; `values` are those of the program."""

    def __init__(self, values: Values) -> None:
        self.values = values

    @abstractmethod
    def structure(self, line: Line) -> Structure:
        """The structure that the statement of a line opens, divides, closes or leaves."""

    @abstractmethod
    def go(self, place: Place) -> None:
        """Forward."""

    @abstractmethod
    def back(self, place: Place, line: Line) -> None:
        """To the next turn of a loop."""

    @abstractmethod
    def jump(self, line: Line) -> None:
        """To the label of the line's $GOTO."""

    @abstractmethod
    def leave(self, line: Line) -> None:
        """M17, M29, $RETURN: back to the caller."""

    @abstractmethod
    def end_modal_call(self) -> None:
        """#DISABLE MODAL CYCLE, and the end of the subroutine that has ordered it."""


class Statement(ABC):
    """What a line does besides, or in place of, fixed words.

    `independent`: it sets no value and does not decide which line is next, so that a check may leave it out.
    """

    def __init__(self, column: int, *, independent: bool = False) -> None:
        self.column, self.independent = column, independent

    @abstractmethod
    def run(self, execution: Flow, line: Line) -> NcBlock | None:
        """Executes it; a block that it returns is executed as if its words had been written with numbers."""


class Call:
    """A call of a subroutine at the end of its line: `name`, of this file (`local`) or of another one.

    `arguments`: @ parameters by name; `cycle`: the called program leaves the modal state as it was; `modal`: "" once,
    "MODAL_MOVE" after each motion, "MODAL_BLOCK" after each block; `count`: how often; `by_code`: `name` is G80 to G89.
    """

    def __init__(
        self,
        name: str,
        column: int,
        arguments: dict[str, Node],
        *,
        local: bool,
        cycle: bool,
        modal: str,
        count: int = 1,
        by_code: bool = False,
    ) -> None:
        self.name, self.column, self.arguments = name, column, arguments
        self.local, self.cycle, self.modal, self.count = local, cycle, modal, count
        self.by_code = by_code
        self.synchronises = False
        """Its arguments read what only the run knows."""


class Line:
    """A line: `number` from 1, `next_number` and `next_offset` of the line behind it (offset -1: there is none).

    block         its words, if all of them are numbers
    statement     else what it does
    call          the subroutine that it calls when its block is finished
    control       its control statement, for the structure of the program
    jump          label of its $GOTO
    flow          "end" or "return" if its words end the program or subroutine
    label         "N100" or "[NAME]", a place to jump to
    skip          bit of its skip level, 0: never skipped
    error         the syntax error of the line, raised when it is reached
    synchronises  the path must stand before it is executed, because it reads what only the run knows
    comment       a comment over several lines begins
    header        it begins a program or subroutine
    """

    def __init__(self, number: int, source: Source, next_number: int, next_offset: int) -> None:
        self.number, self.source = number, source
        self.next_number, self.next_offset = next_number, next_offset
        self.block: NcBlock | None = None
        self.statement: Statement | None = None
        self.call: Call | None = None
        self.control: Control | None = None
        self.jump, self.jump_column = "", 0
        self.label = ""
        self.label_column = 0
        self.skip = 0
        self.error: ProgramError | None = None
        self.synchronises = False
        self.flow = ""
        self.header = False
        self.comment = False

    @property
    def does_something(self) -> bool:
        """It is more than a comment or a label."""
        return self.block is not None or self.statement is not None or self.call is not None
