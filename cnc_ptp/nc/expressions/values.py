"""Values that expressions read and assignments change: P parameters and self-defined variables."""

from math import floor
from typing import Final

from cnc_ptp.errors import nearest_name
from cnc_ptp.nc.canonical import Source, number
from cnc_ptp.nc.expressions import expression_faults as faults
from cnc_ptp.nc.faults import Fault, ProgramError
from cnc_ptp.nc.measuring import Measured, Touch
from cnc_ptp.nc.modal_state import ModalState
from cnc_ptp.nc.program import Channel

Scalar = float | str

LARGEST_PARAMETER: Final = 9999
"""P0 ... P9999."""
LARGEST_VALUE: Final = 999_999_999.0
"""Of a word: nine digits."""
LONGEST_TEXT: Final = 1000
"""Characters of a text in a variable."""
MOST_VALUES: Final = 100_000
"""Values of all self-defined variables and arrays of a channel together."""

LOCAL: Final = "V.L."
"""Of one subroutine call."""
CYCLE: Final = "V.CYC."
"""Of a cycle and the subroutines that it calls."""
PROGRAM: Final = "V.P."
"""Of a main program."""
SHARED: Final = "V.S."
"""Of the channel, from one program to the next."""
SCOPES: Final = (PROGRAM, LOCAL, SHARED, CYCLE)

NO_SOURCE: Final = Source("", 0, 0, "")


def in_words(count: int, singular: str) -> str:
    """1 index, 2 indices."""
    plural = {"index": "indices"}.get(singular, f"{singular}s")
    return f"{count} {singular if count == 1 else plural}"


def shown(value: Scalar) -> str:
    """As a program would write it."""
    return f'"{value}"' if isinstance(value, str) else number(value)


INTEGERS: Final = {
    "BOOLEAN": (0.0, 1.0),
    "SGN08": (-128.0, 127.0),
    "UNS08": (0.0, 255.0),
    "SGN16": (-32768.0, 32767.0),
    "UNS16": (0.0, 65535.0),
    "SGN32": (-2147483648.0, 2147483647.0),
    "UNS32": (0.0, 4294967295.0),
}
"""Types of integers with their ranges; a value is rounded to the nearest one."""


class Variable:
    """A self-defined variable or an array: its values in the order of the last index.

    `type` of #VAR, "" for none; `longest` text.
    """

    def __init__(
        self, name: str, dimensions: tuple[int, ...], values: list[Scalar], type: str = "", longest: int = 0
    ) -> None:
        self.name, self.dimensions, self.values = name, dimensions, values
        self.type, self.longest = type, longest or LONGEST_TEXT
        self.is_text = isinstance(values[0], str)

    def copy(self) -> "Variable":
        return Variable(self.name, self.dimensions, list(self.values), self.type, self.longest)


class Values:
    """All values of a channel's program, and the line that uses them."""

    def __init__(self, channel: Channel, state: ModalState) -> None:
        self.channel, self.state = channel, state
        self.source = NO_SOURCE
        """The active line, for faults."""
        self.block_number = 0
        """The last N word."""
        self.level = 1
        """1 in the main program, one more for each call."""
        self.actual: tuple[float, ...] = ()
        """Positions of the axes at the last synchronisation."""
        self.position: tuple[float, ...] = ()
        """Their set positions then, which a homing or a measuring run has changed."""
        self.override = 100.0
        """Of the path then, percent; 0 with a feed hold."""
        self.touch: Touch | None = None
        """How the last measuring run has ended."""
        self.measured: dict[int, Measured] = {}
        """Results of measuring runs by axis."""
        self.timers: dict[int, float] = {}
        """V.G.TIMER, ms."""
        self.parameters: dict[int, float] = {}
        self.arrays: frozenset[int] = frozenset()
        """Numbers of the P parameters that are arrays; these are in `program`."""
        self.program: dict[str, Variable] = {}
        self.shared: dict[str, Variable] = {}
        self.local: dict[str, Variable] = {}
        self.cycle: dict[str, Variable] = {}
        self.inherited: dict[str, Variable] = {}
        """V.CYC. of the callers, which are also in `cycle`."""
        self.arguments: dict[str, Scalar] = {}
        """What a call has given its subroutine, by name (@P1)."""
        self.count = 0
        """Values of all variables that are there."""

    def copy(self, state: ModalState) -> "Values":
        """Independent, with the copy of the modal state, so that a refused MDI text changes nothing."""
        other = Values(self.channel, state)
        other.parameters, other.arrays = dict(self.parameters), self.arrays
        other.timers = dict(self.timers)
        other.measured = dict(self.measured)
        other.arguments = dict(self.arguments)
        other.program, other.shared = copies(self.program), copies(self.shared)
        other.local, other.cycle = copies(self.local), copies(self.cycle)
        other.count = self.count
        return other

    def same_as(self, other: "Values") -> bool:
        """Whether a program would have the same blocks with both."""
        scopes = ((self.program, other.program), (self.shared, other.shared), (self.local, other.local))
        return (
            self.parameters == other.parameters
            and self.arguments == other.arguments
            and all(same_variables(mine, others) for mine, others in (*scopes, (self.cycle, other.cycle)))
        )

    def begin_program(self) -> None:
        """What belongs to one program begins anew; V.S. stays."""
        self.parameters, self.program, self.local, self.cycle, self.arguments = {}, {}, {}, {}, {}
        self.arrays = frozenset()
        self.count = sum(len(variable.values) for variable in self.shared.values())

    def scope(self, name: str) -> dict[str, Variable]:
        """The variables among which `name` (V.P.DEPTH, or P10 for an array) is."""
        if name.startswith((PROGRAM, "P")):
            return self.program
        if name.startswith(LOCAL):
            return self.local
        return self.shared if name.startswith(SHARED) else self.cycle

    def fault(self, fault: Fault, column: int, **values: float | str) -> ProgramError:
        return fault.at(self.source, column, **values)

    def bounded(self, value: float, column: int, word: str) -> float:
        """A value that may be as large as a word with its digits. Raises ProgramError 21441."""
        if not -LARGEST_VALUE <= value <= LARGEST_VALUE:
            words = {"value": number(value), "limit": number(LARGEST_VALUE)}
            raise self.fault(faults.VALUE_RANGE, column, word=word, **words)
        return value

    def variable(self, name: str, column: int) -> Variable:
        found = self.scope(name).get(name)
        if found is None and name.startswith("P"):
            raise self.fault(faults.ARRAY_UNDECLARED, column, name=name)
        if found is None:
            nearest = nearest_name(name, list(self.scope(name)))
            raise self.fault(faults.VARIABLE_UNKNOWN, column, name=name, nearest=nearest)
        return found

    def declare(
        self,
        name: str,
        dimensions: tuple[int, ...],
        values: list[Scalar],
        column: int,
        type: str = "",
        longest: int = 0,
    ) -> None:
        """Makes a variable. Raises ProgramError 21443 for an array P10 beside a parameter P10."""
        self.reserve(len(values), name, column)
        if name.startswith("P"):
            if int(name[1:]) in self.parameters:
                raise self.fault(faults.PARAMETER_AND_ARRAY, column, name=name)
            self.arrays |= {int(name[1:])}
        self.count += len(values)
        self.scope(name)[name] = Variable(name, dimensions, values, type, longest)

    def conforming(self, variable: Variable, value: Scalar, column: int) -> Scalar:
        """The value as the variable holds it. Raises ProgramError for one that it does not take."""
        if isinstance(value, str) != variable.is_text:
            kind, other = ("text", "number") if variable.is_text else ("number", "text")
            raise self.fault(faults.TYPE_CHANGE, column, name=variable.name, kind=kind, other=other)
        if isinstance(value, str):
            if len(value) > variable.longest:
                words = {"length": len(value), "limit": variable.longest}
                raise self.fault(faults.TEXT_TOO_LONG, column, name=variable.name, **words)
            return value
        limits = INTEGERS.get(variable.type)
        if limits is None:
            return value
        nearest = floor(value + 0.5)
        if not limits[0] <= nearest <= limits[1]:
            words_ = {"type": variable.type, "low": f"{limits[0]:.0f}", "high": f"{limits[1]:.0f}"}
            raise self.fault(faults.VALUE_OF_TYPE, column, name=variable.name, value=number(value), **words_)
        return float(nearest)

    def reserve(self, count: int, name: str, column: int) -> None:
        """Raises ProgramError 21434 if there is no room for so many values."""
        if self.count + count > MOST_VALUES:
            raise self.fault(faults.TOO_MANY_VARIABLES, column, name=name, count=self.count + count, limit=MOST_VALUES)

    def delete(self, name: str, column: int) -> None:
        scope = self.scope(name)
        if name not in scope:
            raise self.fault(faults.DELETED_UNKNOWN, column, name=name, nearest=nearest_name(name, list(scope)))
        if scope is self.cycle and name in self.inherited:
            raise self.fault(faults.DELETED_OF_CALLER, column, name=name)
        self.count -= len(scope[name].values)
        del scope[name]
        if name.startswith("P"):
            self.arrays -= {int(name[1:])}

    def leave(self, local: dict[str, Variable], cycle: dict[str, Variable], arguments: dict[str, Scalar]) -> None:
        """Back to the values of the caller."""
        self.count -= sum(len(variable.values) for variable in self.local.values())
        own = [variable for name, variable in self.cycle.items() if name not in cycle]
        self.count -= sum(len(variable.values) for variable in own)
        self.local, self.cycle, self.arguments = local, cycle, arguments

    def require_parameter(self, index: int, column: int) -> None:
        """Raises ProgramError 21431 for P10 without an index if it is an array."""
        if index in self.arrays:
            self.place(self.program[f"P{index}"], [], column)

    def place(self, variable: Variable, indices: list[float], column: int) -> int:
        """Where the element of an array is among its values."""
        wanted = len(variable.dimensions)
        if len(indices) != wanted:
            if not wanted:
                raise self.fault(faults.NOT_AN_ARRAY, column, name=variable.name)
            if not indices:
                raise self.fault(faults.INDEX_MISSING, column, name=variable.name, wanted=in_words(wanted, "index"))
            words = {"wanted": in_words(wanted, "index"), "given": str(len(indices))}
            raise self.fault(faults.INDEX_COUNT, column, name=variable.name, **words)
        place = 0
        for index, size in zip(indices, variable.dimensions, strict=True):
            if index != int(index):
                raise self.fault(faults.NOT_INTEGER, column, what=f"the index of {variable.name}", value=number(index))
            if not 0.0 <= index < size:
                values = {"index": number(index), "limit": str(size - 1)}
                raise self.fault(faults.INDEX_RANGE, column, name=variable.name, **values)
            place = place * size + int(index)
        return place

    def assign(self, name: str, indices: list[float], value: Scalar, column: int) -> None:
        """Gives a variable a value; one that is not an array is declared by that."""
        scope = self.scope(name)
        found = scope.get(name)
        if found is not None and not indices and not found.dimensions:
            plain = not found.type and isinstance(value, float) and not found.is_text
            found.values[0] = value if plain else self.conforming(found, value, column)
            return
        if found is None and not indices:
            self.declare(name, (), [value], column)
            return
        variable = self.variable(name, column)
        conforming = self.conforming(variable, value, column)
        variable.values[self.place(variable, indices, column)] = conforming


def copies(variables: dict[str, Variable]) -> dict[str, Variable]:
    return {name: variable.copy() for name, variable in variables.items()}


def same_variables(a: dict[str, Variable], b: dict[str, Variable]) -> bool:
    """Whether both have the same names with the same values."""
    return a.keys() == b.keys() and all(
        (one.dimensions, one.values) == (b[name].dimensions, b[name].values) for name, one in a.items()
    )
