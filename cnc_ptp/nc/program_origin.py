"""What a program was read from, so that it can be read again."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from cnc_ptp.nc.flow.sections import Program
from cnc_ptp.nc.parser import parse_program
from cnc_ptp.nc.program import Vocabulary
from cnc_ptp.nc.streamed_program import stream_program


class Origin(NamedTuple):
    """All that decides what a program is.

    files     the texts of the programs that it may call, by name
    cycles    which of them G80 … G89 call
    streamed  it is read while it is executed
    manual    a manual block, which may also call what the program `loaded` may call
    """

    text: str
    file: str
    files: Mapping[str, str]
    cycles: Mapping[str, str]
    vocabulary: Vocabulary
    streamed: bool
    manual: bool = False
    loaded: Program | None = None


def read_origin(origin: Origin) -> Program:
    """The program. Raises its first ProgramError."""
    text, file, files, cycles, vocabulary, streamed, manual, loaded = origin
    program: Program
    if streamed:
        program = stream_program(text, file, files=files, cycles=cycles, vocabulary=vocabulary)
    else:
        library = None if loaded is None else loaded.library
        program = parse_program(
            text, file, mdi=manual, files=files, cycles=cycles, library=library, vocabulary=vocabulary
        )
    program.origin = origin
    return program
