"""State machines as tables of named transitions: the units take them, the documents draw them."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

from cnc_ptp.protocol.axis_states import AxisStateCode, state_name


class Transition(NamedTuple):
    """From one of the states `sources` to `target`; `cause` is the label of the arrow in diagrams."""

    cause: str
    sources: frozenset[AxisStateCode]
    target: AxisStateCode


def transition(cause: str, *sources: AxisStateCode, to: AxisStateCode) -> Transition:
    """From each of `sources`."""
    return Transition(cause, frozenset(sources), to)


def state_diagram(transitions: Iterable[Transition]) -> str:
    """A Mermaid diagram with one arrow for each pair of states; labelled with its causes in the order of the table."""
    causes: dict[tuple[AxisStateCode, AxisStateCode], list[str]] = {}
    for cause, sources, target in transitions:
        for source in sorted(sources):
            known = causes.setdefault((source, target), [])
            known += [cause] if cause not in known else []
    arrows = [
        f"    {state_name(source)} --> {state_name(target)}: {', '.join(texts)}"
        for (source, target), texts in sorted(causes.items())
        if source is not target
    ]
    return "\n".join(["```mermaid", "stateDiagram-v2", *arrows, "```"])
