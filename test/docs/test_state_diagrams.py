"""State diagrams of the documents against the tables of transitions."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path
from types import ModuleType

from cnc_ptp.axis import transitions as axis_transitions
from cnc_ptp.protocol.axis_states import AxisStateCode, state_name
from cnc_ptp.protocol.transitions import Transition
from cnc_ptp.spindle import transitions as spindle_transitions

DOCS = Path(__file__).parents[2] / "docs"
DIAGRAM = re.compile(r"```mermaid\nstateDiagram-v2\n(.*?)```", re.DOTALL)


def table(module: ModuleType) -> list[Transition]:
    """The transitions of a module, without faults, which lead from everywhere to ErrorStop."""
    named = (value for value in vars(module).values() if isinstance(value, Transition))
    return [transition for transition in named if transition.target is not AxisStateCode.ERROR_STOP]


def arrows(transitions: Sequence[Transition]) -> list[str]:
    """One arrow for each pair of states, with its causes in the order of the table."""
    causes: dict[tuple[AxisStateCode, AxisStateCode], list[str]] = {}
    for cause, sources, target in transitions:
        for source in sources - {target}:
            causes.setdefault((source, target), []).append(cause)
    return [f"{state_name(a)} --> {state_name(b)}: {', '.join(texts)}" for (a, b), texts in sorted(causes.items())]


def diagrams(page: str) -> list[list[str]]:
    found = DIAGRAM.findall((DOCS / page).read_text(encoding="utf-8"))
    return [[line.strip() for line in text.splitlines()] for text in found]


def test_the_diagram_of_an_axis_is_its_table() -> None:
    assert diagrams("ptp.md") == [arrows(table(axis_transitions))]


def test_the_diagrams_of_a_spindle_are_its_table() -> None:
    """Without Disabled and ErrorStop; Stopping has the arrows of Standstill."""
    left_out = {AxisStateCode.DISABLED, AxisStateCode.ERROR_STOP}
    stop = {AxisStateCode.STOPPING: AxisStateCode.STANDSTILL}
    pairs = {(stop.get(s, s), stop.get(t.target, t.target)) for t in table(spindle_transitions) for s in t.sources}
    known = {(state_name(a), state_name(b)) for a, b in pairs if a != b and not {a, b} & left_out}
    shown = [line.split(": ")[0].split(" --> ") for lines in diagrams("spindles.md") for line in lines]
    assert len(shown) > 20
    assert {(a, b) for a, b in shown if a != b and "ErrorStop" not in (a, b)} == known
