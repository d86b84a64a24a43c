"""What refuses an import or export of lists: every problem with its line, all of them in one exception."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Final, NamedTuple

from cnc_ptp.errors import CncError
from cnc_ptp.parameters.errors import Place, one_line_each

NOTHING_WRITTEN: Final = "nothing was written"
SHOWN: Final = 100
"""Characters of a line that a message shows."""


class ListProblem(NamedTuple):
    """One thing that is wrong in a list: where, what, and what would mend it; `line` is its text."""

    error_id: int
    place: Place
    text: str
    line: str = ""

    def __str__(self) -> str:
        line = self.line if len(self.line) <= SHOWN else f"{self.line[: SHOWN - 3]}..."
        shown = f", in '{line}'" if line else ""
        return f"{self.place}: {self.text}{shown}; {NOTHING_WRITTEN}"


class ListError(CncError):
    """Lists that are not read, or a machine that is not written as lists; `problems` has all of them in order.

    The message has one line per problem. The error number is that of the first, the following begin with their own.
    """

    def __init__(self, problems: Iterable[ListProblem]) -> None:
        self.problems = tuple(sorted(set(problems), key=lambda problem: (problem.place, problem.error_id)))
        super().__init__(self.problems[0].error_id, one_line_each(self.problems))

    def __reduce__(self) -> tuple[type[ListError], tuple[tuple[ListProblem, ...]]]:
        return type(self), (self.problems,)
