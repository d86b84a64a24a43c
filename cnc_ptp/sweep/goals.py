"""Goals: arithmetic over the columns of a run, `max(following_error.x)`; read by a white list, never run as code."""

from __future__ import annotations

import ast
import operator
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final, NamedTuple

import numpy as np
import numpy.typing as npt

from cnc_ptp.errors import CncError, did_you_mean, nearest
from cnc_ptp.machine.wiring import unit_kinds
from cnc_ptp.parameters import MachineParameters
from cnc_ptp.protocol.blocks import AxisBlock, ChannelBlock, SpindleBlock
from cnc_ptp.protocol.commands import is_finite
from cnc_ptp.recording.blocks import kind_of
from cnc_ptp.sweep.faults import BAD_GOAL, NOTHING

Floats = npt.NDArray[np.float64]
Value = float | Floats
LONGEST = 500
MAXIMISE = "max:"
BLOCKS: Final = {"axis": AxisBlock, "spindle": SpindleBlock, "channel": ChannelBlock}
DEVIATIONS: Final = ("following_error", "following_error_deg")
"""Signals that count by their magnitude: an error to either side is one."""
TIMES: Final = ("program_time", "run_time")
"""Numbers of a run, in s: a program was under way; all of it."""
OPERATORS: Final[Mapping[type, Callable[..., Any]]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: np.divide,
    ast.Pow: np.power,
    ast.USub: operator.neg,
    ast.UAdd: operator.pos,
}


class Signal(NamedTuple):
    """A value per cycle of a unit."""

    unit: str
    field: str


def _all(*values: Value) -> Floats:
    return np.concatenate([np.ravel(value) for value in values])


FUNCTIONS: Final[Mapping[str, Callable[..., Value]]] = {
    "max": lambda *values: float(_all(*values).max()),
    "min": lambda *values: float(_all(*values).min()),
    "mean": lambda value: float(np.mean(value)),
    "rms": lambda value: float(np.sqrt(np.mean(np.square(value)))),
    "std": lambda value: float(np.std(value)),
    "last": lambda value: float(np.ravel(value)[-1]),
    "abs": np.abs,
}
"""All but abs make a number of a signal; max and min take several."""
SEVERAL: Final = ("max", "min")


@dataclass(frozen=True)
class Goal:
    """A number of each run. `text` as it was given, `expression` of it without `max:`."""

    text: str
    maximise: bool
    expression: ast.expr
    signals: Mapping[str, Signal]
    """By their text in the expression."""

    @property
    def label(self) -> str:
        return self.text.removeprefix(MAXIMISE).strip()

    @property
    def sign(self) -> float:
        """With which the value is to become small."""
        return -1.0 if self.maximise else 1.0

    def value(self, columns: Mapping[Signal, Floats], times: Mapping[str, float]) -> float:
        """Of the columns (n,) of a run. Raises CncError 26179 where it is not finite."""
        names: dict[str, Value] = {**times, **{text: columns[signal] for text, signal in self.signals.items()}}
        for text, signal in self.signals.items():
            if signal.field in DEVIATIONS:
                names[text] = np.abs(names[text])
        with np.errstate(all="ignore"):
            value = float(_evaluate(self.expression, names))
        if not np.isfinite(value):
            raise CncError(BAD_GOAL, f"{self.label} is {value}, not a finite number", where="--goal")
        return value


def _evaluate(node: ast.expr, names: Mapping[str, Value]) -> Any:
    if isinstance(node, ast.Constant):
        return np.float64(node.value)  # type: ignore[arg-type]
    if isinstance(node, (ast.Name, ast.Attribute)):
        return names[ast.unparse(node)]
    if isinstance(node, ast.BinOp):
        return OPERATORS[type(node.op)](_evaluate(node.left, names), _evaluate(node.right, names))
    if isinstance(node, ast.UnaryOp):
        return OPERATORS[type(node.op)](_evaluate(node.operand, names))
    assert isinstance(node, ast.Call) and isinstance(node.func, ast.Name)
    return FUNCTIONS[node.func.id](*(_evaluate(part, names) for part in node.args))


def read_goals(texts: Sequence[str], machine: MachineParameters) -> list[Goal]:
    """Raises CncError 26179 for a goal that is not possible, or is given twice."""
    goals = [read_goal(text.strip(), machine) for text in texts]
    if not goals:
        raise CncError(BAD_GOAL, "there is no goal, as max(following_error.x)", NOTHING, where="--goal")
    labels = [goal.label for goal in goals]
    for label in labels:
        if labels.count(label) > 1:
            raise CncError(BAD_GOAL, f"'{label}' is given twice", NOTHING, where="--goal")
    return goals


def read_goal(text: str, machine: MachineParameters) -> Goal:
    """`max:` in front: the value is to become large. Raises CncError 26179."""
    body = text.removeprefix(MAXIMISE).strip()
    if len(body) > LONGEST:
        raise CncError(BAD_GOAL, f"a goal has {len(body)} characters, at most {LONGEST}", NOTHING, where="--goal")
    try:
        with warnings.catch_warnings(action="ignore"):  # of Python, about numbers like 1_a
            expression = ast.parse(body, mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        raise bad(body, "is no expression, as max(following_error.x)") from None
    reader = _Reader(body, machine)
    if reader.is_signal(expression):
        raise bad(body, f"is a value for each cycle, not a number: max({body}), rms({body}) …")
    return Goal(text, text.startswith(MAXIMISE), expression, reader.signals)


class _Reader:
    """Walks through an expression: all of it must be on the white list."""

    def __init__(self, text: str, machine: MachineParameters) -> None:
        self._text = text
        self._fields = {unit: fields_of(kind) for unit, kind in unit_kinds(machine).items() if kind in BLOCKS}
        self.signals: dict[str, Signal] = {}

    def is_signal(self, node: ast.expr) -> bool:
        """Whether it is a value per cycle, and not one number. Raises CncError 26179 for what is not permitted."""
        if isinstance(node, ast.Constant) and type(node.value) in (int, float):
            if not is_finite(node.value):
                raise bad(self._text, "has a number beyond 1.8e308")
            return False
        if isinstance(node, ast.Name):
            return self._name(node)
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
            return self._signal(node.value.id, node.attr)
        if isinstance(node, ast.BinOp) and type(node.op) in OPERATORS:
            sides = [self.is_signal(node.left), self.is_signal(node.right)]
            return any(sides)
        if isinstance(node, ast.UnaryOp) and type(node.op) in OPERATORS:
            return self.is_signal(node.operand)
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
            return self._call(node, node.func.id)
        raise bad(self._text, f"has '{ast.unparse(node)}', which a goal cannot have")

    def _call(self, node: ast.Call, name: str) -> bool:
        if name not in FUNCTIONS:
            known = f", only {', '.join(FUNCTIONS)}"
            raise bad(self._text, f"has the function {name}, which does not exist{known}{_meant(name, FUNCTIONS)}")
        if node.keywords or not node.args or (len(node.args) > 1 and name not in SEVERAL):
            raise bad(self._text, f"gives {name} {len(node.args)} values, it takes {'some' if name in SEVERAL else 1}")
        of_signal = [self.is_signal(part) for part in node.args]
        return name == "abs" and of_signal[0]

    def _name(self, node: ast.Name) -> bool:
        """A time of the run, or a field that one unit alone has."""
        if node.id in TIMES:
            return False
        units = [unit for unit, fields in self._fields.items() if node.id in fields]
        if len(units) == 1:
            self.signals[node.id] = Signal(units[0], node.id)
            return True
        if units:
            several = f"has {node.id} without its unit: {' or '.join(f'{node.id}.{unit}' for unit in units)}"
            raise bad(self._text, several)
        known = {*TIMES, *(name for fields in self._fields.values() for name in fields)}
        raise bad(self._text, f"has '{node.id}', which a run does not have{_meant(node.id, known)}")

    def _signal(self, field: str, unit: str) -> bool:
        """following_error.x: a field of a unit."""
        if field in self._fields and unit in self._fields[field]:
            raise bad(self._text, f"has {field}.{unit}; the signal is written {unit}.{field}")
        if unit not in self._fields:
            raise bad(self._text, f"has {field}.{unit}: the machine has no unit '{unit}'{_meant(unit, self._fields)}")
        if field not in self._fields[unit]:
            reason = f"has {field}.{unit}: {unit} has no signal '{field}'{_meant(field, self._fields[unit])}"
            raise bad(self._text, reason)
        self.signals[f"{field}.{unit}"] = Signal(unit, field)
        return True


def fields_of(kind: str) -> tuple[str, ...]:
    """Fields of a unit's block with one number per cycle."""
    return tuple(kind_of(BLOCKS[kind]).columns)


def _meant(name: str, known: Any) -> str:
    return did_you_mean(nearest(name, known))


def bad(text: str, reason: str) -> CncError:
    return CncError(BAD_GOAL, f"'{text}' {reason}", NOTHING, where="--goal")
