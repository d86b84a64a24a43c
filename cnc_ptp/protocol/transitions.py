"""State machines as tables of named transitions."""

from __future__ import annotations

from typing import NamedTuple

from cnc_ptp.protocol.axis_states import AxisStateCode


class Transition(NamedTuple):
    """From one of the states `sources` to `target`; `cause` is the label of the arrow in diagrams."""

    cause: str
    sources: frozenset[AxisStateCode]
    target: AxisStateCode


def transition(cause: str, *sources: AxisStateCode, to: AxisStateCode) -> Transition:
    """From each of `sources`."""
    return Transition(cause, frozenset(sources), to)
