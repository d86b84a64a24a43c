"""Objects that are made again instead of stored: programs from their text, their blocks from their beginning."""

from __future__ import annotations

from typing import Any

from cnc_ptp.channel.listed_blocks import ListedBlocks, ProgramBegin
from cnc_ptp.channel.running_blocks import RunningBlocks
from cnc_ptp.nc.faults import ProgramError
from cnc_ptp.nc.flow.sections import Program
from cnc_ptp.nc.program_origin import Origin, read_origin
from cnc_ptp.nc.streamed_program import StreamedProgram


def program_parts(program: Program) -> tuple[Any, ...] | None:
    """What `program_again` takes; None for a program that no channel has read."""
    if not isinstance(program.origin, Origin):
        return None
    return (program.origin, program.place())


def program_again(origin: Origin, reached: int) -> Program:
    program = read_origin(origin)
    if isinstance(program, StreamedProgram):
        program.go_to(reached)
    return program


def interpreter_parts(blocks: RunningBlocks) -> tuple[Any, ...] | None:
    """What `interpreter_again` takes; None when too much has happened since its program began."""
    if blocks.forgotten:
        return None
    given = (blocks.check, blocks.program, blocks.start, blocks.before, blocks.unreferenced, blocks.point)
    return (*given, blocks.asked, blocks.answers, blocks.block_skip)


def interpreter_again(*parts: Any) -> RunningBlocks:
    """One that has given as many blocks. Raises ProgramError if the program has another course now."""
    *given, asked, answers, block_skip = parts
    check, program, start, before, unreferenced, point = given
    blocks = RunningBlocks(check, program, start, before, unreferenced, point)
    blocks.repeat(asked, answers, block_skip)
    return blocks


def list_parts(blocks: ListedBlocks) -> tuple[Any, ...]:
    """What `list_again` takes."""
    return (blocks.begin, blocks.taken)


def list_again(begin: ProgramBegin, taken: int) -> ListedBlocks:
    """One that has given as many blocks. Raises ProgramError, StopIteration if the program has another course now."""
    blocks = ListedBlocks(begin, begin.known_blocks().blocks)
    for _ in range(taken):
        next(blocks)
    return blocks


def is_open(blocks: object) -> bool:
    """An interpreter that has something to give."""
    return isinstance(blocks, RunningBlocks) and not blocks.ended


AGAIN = {"program": program_again, "interpreter": interpreter_again, "list of blocks": list_again}
FAULTS = (ProgramError, StopIteration)
