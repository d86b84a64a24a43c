"""State machines as tables of named transitions."""

from __future__ import annotations

from typing import NamedTuple

from cnc_ptp.protocol.axis_states import AxisStateCode

strict = False
"""True in tests: a transition from a state that its table does not name is a defect."""


class Transition(NamedTuple):
    """From one of the states `sources` to `target`; `cause` is the label of the arrow in diagrams."""

    cause: str
    sources: frozenset[AxisStateCode]
    target: AxisStateCode


def require_source(name: str, state: AxisStateCode, transition: Transition) -> None:
    """Raises AssertionError in strict runs when `transition` does not begin in `state`."""
    if strict and state not in transition.sources:
        raise AssertionError(f"{name}: no transition '{transition.cause}' from {state.name}")


def transition(cause: str, *sources: AxisStateCode, to: AxisStateCode) -> Transition:
    """From each of `sources`."""
    return Transition(cause, frozenset(sources), to)
