"""View of a channel's program for people: what its blocks of numbers do not say."""

from __future__ import annotations

from typing import NamedTuple


class ProgramView(NamedTuple):
    """The active line of a channel; after the end of its program the last one.

    program   file of the loaded program, "" none
    manual    manual blocks are active
    file      file of the line
    text      of the line
    calls     from where its subroutine was called, the innermost first
    """

    program: str
    manual: bool
    file: str
    text: str
    calls: tuple[str, ...]
