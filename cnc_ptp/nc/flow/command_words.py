"""Words of a # command: keywords, options in brackets, lists, axes with values."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Final

from cnc_ptp.nc.expressions.nodes import Constant, Node
from cnc_ptp.nc.expressions.reader import ExpressionReader
from cnc_ptp.nc.faults import ProgramError
from cnc_ptp.nc.flow import flow_faults as faults
from cnc_ptp.nc.flow.lines import Line

_STRAY = re.compile(r"\[\S*|[^\s\]]+")
AXES: Final = "ABCQUVWXYZ"


class Words:
    """The words of a command as they are read."""

    def __init__(self, line: Line, text: str, end: int, command: str, syntax: str) -> None:
        self.reader = ExpressionReader(text, line.source, end)
        self.line, self.command, self.syntax = line, command, syntax

    @property
    def at_end(self) -> bool:
        return self.reader.skip_blanks() >= len(self.reader.line.rstrip())

    def takes(self, *keywords: str) -> str:
        """The keyword that is next; empty if none of them is."""
        begin = self.reader.skip_blanks()
        word = self.reader.word()
        if word not in keywords:
            return ""
        self.reader.at = begin + len(word)
        return word

    def require_end(self) -> None:
        if not self.at_end:
            raise self.stray()

    def stray(self) -> ProgramError:
        if self.at_end:
            return self.missing("a value")
        at = self.reader.skip_blanks()
        found = _STRAY.match(self.reader.line, at)
        word = found[0] if found is not None else self.reader.line[at:].split()[0]
        return faults.COMMAND_SYNTAX.at(self.line.source, at + 1, word=word, command=self.command, syntax=self.syntax)

    def missing(self, what: str) -> ProgramError:
        column = min(self.reader.skip_blanks(), len(self.reader.line)) + 1
        return faults.COMMAND_VALUE.at(self.line.source, column, command=self.command, missing=what, syntax=self.syntax)

    def options(self, *names: str) -> dict[str, Node]:
        """`[ANGLE=30 CENTER1=10]`, empty without a bracket."""
        begin = self.reader.skip_blanks()
        if not self.reader.line.startswith("[", begin):
            return {}
        return self.bracket((), names)[1]

    def bracket(
        self, keywords: Sequence[str], names: Sequence[str], positions: str = ""
    ) -> tuple[str, dict[str, Node]]:
        """`[DEV PATH_DEV=0.01 TRACK_DEV=5]`: a keyword, if there is one, and options in any order.

        `positions`: letters of axes whose positions are options, too: X10, X=10.
        """
        opened = self.reader.skip_blanks()
        if not self.reader.follows("["):
            raise self.stray()
        keyword = self.takes(*keywords)
        found: dict[str, Node] = {}
        while not self.reader.follows("]"):
            self.reader.follows(",")
            if self.at_end:
                self.reader.close(opened)
            letter = self.reader.line[self.reader.skip_blanks()]
            if letter in positions and letter not in found:
                self.reader.at = self.reader.skip_blanks() + 1
                self.reader.follows("=")
                found[letter] = self.reader.expression()
                continue
            name = self.takes(*[each for each in names if each not in found])
            if not name or not self.reader.follows("="):
                raise self.stray()
            found[name] = self.reader.expression()
        return keyword, found

    def items(self) -> list[Node | None]:
        """`[10, , 5]`: values with gaps; the bracket is next."""
        found: list[Node | None] = []
        opened = self.reader.skip_blanks()
        self.reader.follows("[")
        while True:
            at = self.reader.skip_blanks()
            gap = self.reader.line[at : at + 1] in (",", "]")
            found.append(None if gap else self.reader.expression())
            if not self.reader.follows(","):
                break
        self.reader.close(opened)
        return found

    def axes(self, *, alone: bool = False) -> list[tuple[str, Node, int]]:
        """`X10 Y=P1`: axis, value, column; with `alone` the value may be missing."""
        found: list[tuple[str, Node, int]] = []
        while not self.at_end:
            begin = self.reader.skip_blanks()
            character = self.reader.line[begin]
            if character not in AXES:
                raise self.stray()
            self.reader.at = begin + 1
            self.reader.follows("=")
            missing = self.at_end or self.reader.line[self.reader.at] in AXES
            value = Constant(begin + 1, 0.0) if alone and missing else self.reader.expression()
            found.append((character, value, begin + 1))
        return found
