"""Errors of a machine file: one number per kind, one line per problem, all problems in one exception."""

from collections.abc import Callable, Sequence
from typing import NamedTuple, Protocol, TypeVar

from cnc_ptp.errors import CncError

SYNTAX = 25001  # not YAML, or not the shape of a ROS parameters file
DUPLICATE_KEY = 25002  # the same section or parameter twice
NO_MACHINE = 25003  # section /machine is missing
NO_UNIT = 25004  # a section that /machine does not know
UNKNOWN_NAME = 25005  # no list has this parameter, or not for this node
INDEX = 25006  # array index outside the array
WRONG_TYPE = 25007  # text for a number and the like
OUT_OF_RANGE = 25008  # below, above, none of the choices, wrong form
CONTRADICTION = 25009  # the limit is another parameter
DUPLICATE_NUMBER = 25010  # logical axis number given twice
AXIS_TYPE = 25011  # spindle as path axis, path axis as spindle
COUNT = 25012  # spdl_anzahl, achs_anzahl against the number listed
MAIN_SPINDLE = 25013  # no main spindle among the spindles of a channel
NO_SUCH_AXIS = 25014  # the channel names a number that no unit has
UNIT_NAME = 25015  # names of units, axes and spindles
RESOLUTION = 25016  # encoder resolution zero or given twice
UNREADABLE = 25017  # the file cannot be read
UNKNOWN_PARAMETER = 25018  # looked up in the reference
DENOMINATOR = 25019  # a denominator is zero
TELEGRAM = 25020  # objects of a telegram, drive type and operation mode
LIST_FOLDER = 25040  # a folder of lists that is none, or has no list
LIST_KIND = 25041  # a list of the wrong kind, or one that cannot be told
LIST_TEXT = 25042  # encoding or characters of a list
LIST_LINE = 25043  # the form of a line of a list
LIST_UNIT = 25044  # the axis or channel that a list is for
LIST_OUTPUT = 25045  # the result exists already or cannot be written
LIST_VALUE = 25046  # a value or comment that a list cannot hold

EFFECT = "the node does not start"
"""Of a machine file that a node reads."""


class Place(NamedTuple):
    """Position in a machine file, line and column from 1."""

    file: str
    line: int
    column: int

    def __str__(self) -> str:
        return f"{self.file}:{self.line}:{self.column}"


AT_RUN_TIME = Place("", 0, 0)
"""Of a value that a command has written."""


class Problem(NamedTuple):
    """One thing that is wrong, and where."""

    error_id: int
    place: Place
    text: str

    def __str__(self) -> str:
        return self.line(EFFECT)

    def line(self, effect: str) -> str:
        """With what does not happen now."""
        return f"{self.place}: {self.text}; {effect}"


class Numbered(Protocol):
    """One thing that is wrong; its text is a line."""

    @property
    def error_id(self) -> int: ...


Kind = TypeVar("Kind", bound=Numbered)


def one_line_each(problems: Sequence[Kind], text: Callable[[Kind], str] = str) -> str:
    """The text of an error that has several problems: the number of the first is its own, the others begin theirs."""
    first, *others = problems
    return "\n".join([text(first), *(f"P-ERR-{problem.error_id} {text(problem)}" for problem in others)])


class ParameterError(CncError):
    """A machine file that no node and no command accepts; `problems` has all of them, in the order of the file.

    The message has one line per problem, each with file, line and column. The error number is that of the first
    problem, the following lines begin with their own.
    """

    def __init__(self, problems: Sequence[Problem], effect: str = EFFECT) -> None:
        """`effect`: what does not happen now."""
        self.problems = tuple(sorted(problems, key=lambda problem: problem.place))
        self._effect = effect
        super().__init__(self.problems[0].error_id, one_line_each(self.problems, lambda problem: problem.line(effect)))

    def meaning(self, effect: str) -> "ParameterError":
        return ParameterError(self.problems, effect)

    def __reduce__(self) -> tuple[type["ParameterError"], tuple[tuple[Problem, ...], str]]:
        return type(self), (self.problems, self._effect)
