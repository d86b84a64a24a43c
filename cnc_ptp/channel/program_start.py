"""Start of a program at a line or block: what comes before is interpreted without motion, then its state is made.

At the start the functions that are still in force go out, block by block in the order of the program. Then the axes go
with G00 from where they are to the point at which the block begins: the tool axis, which is perpendicular to the active
plane, first if it goes up (to greater positions), last if it goes down; the others at once. A straight way between two
points within the soft limits stays within them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Final, NoReturn

from cnc_ptp.channel.skipped_functions import SkippedFunctions
from cnc_ptp.errors import CncError
from cnc_ptp.nc.awaited import awaits_path
from cnc_ptp.nc.block_search import BlockSearch, StartPoint, base_name
from cnc_ptp.nc.canonical import (
    BEGIN,
    BUSY,
    CanonicalBlock,
    HomeAxes,
    LinearMove,
    OffsetReport,
    OrderedError,
    Source,
    number,
)
from cnc_ptp.nc.canonical_text import format_function
from cnc_ptp.nc.flow.lines import Line
from cnc_ptp.nc.flow.sections import Program
from cnc_ptp.nc.measuring import measures
from cnc_ptp.nc.modal_state import ModalState
from cnc_ptp.protocol.commands import BAD_ARGUMENT

NOT_FOUND: Final = 22040
NO_SUCH_PASS: Final = 22041
NEEDS_THE_RUN: Final = 22042
MEASURES: Final = 50718
FILE_NOT_CALLED: Final = 22043
ENDS_BEFORE: Final = 22044
TOOL_AXES: Final = {17: "Z", 18: "Y", 19: "X"}
NOTHING_STARTED: Final = "nothing was started"


class ProgramStart:
    """The start of one program at a start point; `blocks` hands out its blocks from there on.

    head     what is done before the block at which it begins, once that was reached
    found    the line at which it begins
    """

    def __init__(self, point: StartPoint, program: Program) -> None:
        """Raises CncError 22043 for a file that the program does not call."""
        self.point, self.program = point, program
        self._searched = called_program(point.file, program)
        self._search = BlockSearch(point, self._searched.file)
        self.head: list[CanonicalBlock] = []
        self.found: Source | None = None

    @property
    def search(self) -> BlockSearch:
        """For the interpreter."""
        return self._search

    def blocks(
        self,
        stream: Iterator[CanonicalBlock],
        start: tuple[float, ...],
        axes: Sequence[str],
        modal: ModalState,
        check_target: Callable[[tuple[float, ...], Source], None],
    ) -> Iterator[CanonicalBlock]:
        """The blocks of a `stream` that searches, without those before the start point.

        `start`: where the axes are (mm, deg), by name `axes`; `modal`: the state of the interpreter.
        Raises CncError 22040 … 22044, 50718.
        """
        skipped = SkippedFunctions()
        offsets: OffsetReport | None = None
        for block in stream:
            if block is BUSY:
                yield block
            elif block is BEGIN:
                break
            else:
                offsets = block.offsets or offsets
                self._skip(block, skipped)
        found = self._search.found
        if found is None:
            raise self._not_reached()
        self.found = found
        self.head = skipped.blocks()
        begin = modal.position if self._search.position is None else self._search.position
        if begin != start:
            check_target(begin, found)
        for target in way_points(start, begin, tool_axis(axes, modal.plane)):
            self.head.append(CanonicalBlock(found, (), LinearMove(target, True, 0.0), ""))
        if offsets is not None:
            first = self.head[0] if self.head else CanonicalBlock(found, (), None, "")
            self.head[:1] = [first._replace(offsets=offsets)]
        yield from self.head
        yield from stream

    def _skip(self, block: CanonicalBlock, skipped: SkippedFunctions) -> None:
        if awaits_path(block):
            source = block.source
            what = "homes axes" if isinstance(block.motion, HomeAxes) else "reads what only the run knows"
            what = "measures" if measures(block.motion) else what
            reason = f"line {source.line} '{source.text.strip()}' {what}, and it is before {self.point.name}"
            raise self._refused(MEASURES if measures(block.motion) else NEEDS_THE_RUN, reason, source.file)
        for function in block.functions:
            if isinstance(function, OrderedError) and function.severe:
                reason = f"{function.text} in line {block.source.line} ends it before {self.point.name}"
                raise self._refused(ENDS_BEFORE, reason, block.source.file)
        skipped.add(block)

    # what is done

    def lines(self, axes: Sequence[str], start: Sequence[float]) -> list[str]:
        """What is done at the start, step by step; `axes` by name, which are at `start` (mm, deg)."""
        steps = []
        position = start
        for block in (block for block in self.head if block.functions or block.motion):
            steps.append(_step(block, axes, position, self._searched.file))
            if isinstance(block.motion, LinearMove):
                position = block.motion.target
        found = self.found
        assert found is not None
        return [*steps, f"continues with line {found.line} '{found.text.strip()}'"]

    # errors

    def _refused(self, fault: int, reason: str, file: str) -> CncError:
        return CncError(fault, reason, NOTHING_STARTED, where=file)

    def _not_reached(self) -> CncError:
        """Why the start point was not reached: it does not exist, is not executed, or not as often."""
        point, search, file = self.point, self._search, self._searched.file
        if search.passes:
            times = "once" if search.passes == 1 else f"{search.passes} times"
            reason = f"{point.name} is passed {times}, there is no pass {point.pass_number}"
            return self._refused(NO_SUCH_PASS, reason, file)
        wanted = point.line or point.block_number
        below, above, exists, last = 0, 0, False, 0
        for line in all_lines(self._searched):
            value = line.number if point.line else line.source.block_number
            last = line.number if line.source.text else last
            exists = exists or value == wanted
            below = value if below < value < wanted else below
            above = value if value > wanted and (value < above or not above) else above
        if exists:
            reason = f"{point.name} is not executed; executed {self._nearest(search.below, search.above)}"
        elif point.line:
            reason = f"there is no line {point.line}: the last one is {last}"
        else:
            reason = f"there is no block N{point.block_number}; there {self._nearest(below, above)}"
        return self._refused(NOT_FOUND, reason, file)

    def _nearest(self, below: int, above: int) -> str:
        letter = "" if self.point.line else "N"
        known = [f"{letter}{value}" for value in (below, above) if value]
        what = "line" if self.point.line else "block"
        if not known:
            return f"is no {what} at all"
        return f"{'is' if len(known) == 1 else 'are'} {' and '.join(known)} next to it"


def called_program(file: str, program: Program) -> Program:
    """The program with this file name: the loaded one, or one that it may call. Raises CncError 22043."""
    if not file:
        return program
    programs = [program, *program.library.values()]
    for each in programs:
        if file in (each.file, base_name(each.file)):
            return each
    known = ", ".join(dict.fromkeys(base_name(each.file) for each in programs))
    reason = f"the program does not call a program '{file}'. Known: {known}"
    raise CncError(FILE_NOT_CALLED, reason, NOTHING_STARTED, where=program.file)


def tool_axis(axes: Sequence[str], plane: int) -> int:
    """Place of the axis that is perpendicular to the plane (17, 18, 19); -1 if the channel has none."""
    name = TOOL_AXES[plane]
    return list(axes).index(name) if name in axes else -1


def way_points(start: tuple[float, ...], target: tuple[float, ...], tool: int) -> list[tuple[float, ...]]:
    """The ends of the motions from `start` to `target`: `tool` goes up before the others, down after them."""
    if tool < 0:
        between = target
    elif target[tool] > start[tool]:
        between = (*start[:tool], target[tool], *start[tool + 1 :])
    else:
        between = (*target[:tool], start[tool], *target[tool + 1 :])
    return [point for point, before in ((between, start), (target, between)) if point != before]


def all_lines(program: Program) -> Iterator[Line]:
    """The lines of a file from first to last."""
    place, offset = 1, 0
    while offset >= 0:
        line = program.line(place, offset)
        yield line
        place, offset = line.next_number, line.next_offset


def _step(block: CanonicalBlock, axes: Sequence[str], start: Sequence[float], file: str) -> str:
    if isinstance(block.motion, LinearMove):
        ways = zip(axes, start, block.motion.target, strict=True)
        moved = ", ".join(f"{axis} {number(a)} to {number(b)}" for axis, a, b in ways if a != b)
        return f"G00: {moved}"
    where = "" if block.source.file == file else f" of {base_name(block.source.file)}"
    return f"line {block.source.line}{where}: {' '.join(format_function(function) for function in block.functions)}"


def start_point(
    line: int | None,
    block_number: int | None,
    in_program: str,
    pass_number: int | None,
    refuse: Callable[[str, int, str], NoReturn],
) -> StartPoint | None:
    """The place of a start that is not at the beginning of the program; `refuse` is called for a contradiction."""
    for name, value in (("line", line), ("block_number", block_number), ("pass_number", pass_number)):
        if value is not None and value < 1:
            refuse("start", BAD_ARGUMENT, f"{name} = {value} must be at least 1")
    if line is not None and block_number is not None:
        refuse("start", BAD_ARGUMENT, f"line = {line} and block_number = {block_number} are both given")
    if line is None and block_number is None:
        if in_program or pass_number is not None:
            name = "in_program" if in_program else "pass_number"
            refuse("start", BAD_ARGUMENT, f"{name} is given without line or block_number")
        return None
    return StartPoint(line or 0, block_number or 0, in_program, pass_number or 1)
