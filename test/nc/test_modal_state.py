"""Copies of the modal state: nothing is left out, and nothing of the copy changes the state."""

from __future__ import annotations

from dataclasses import fields

import pytest

from cnc_ptp.nc.coordinates.coordinates import Coordinates
from cnc_ptp.nc.modal_state import ModalState, SpindleModes
from cnc_ptp.nc.tools.tool_state import ToolState

PARTS = {Coordinates: ("coordinates",), ToolState: ("tool",), SpindleModes: ("spindle",)}


def marked(kind: type) -> object:
    """With another value in each field: a mapping, or something that is like nothing else."""
    state = kind()
    for field in fields(kind):
        value = getattr(state, field.name)
        if isinstance(value, dict):
            setattr(state, field.name, {field.name: field.name})
        elif type(value) in PARTS:
            setattr(state, field.name, marked(type(value)))
        else:
            setattr(state, field.name, f"{field.name} of {kind.__name__}")
    return state


@pytest.mark.interpreted
@pytest.mark.parametrize("kind", [ModalState, Coordinates, ToolState, SpindleModes])
def test_a_copy_has_every_field(kind: type) -> None:
    """Each has a text that no other field has; compiled classes take no texts for numbers."""
    state = marked(kind)
    copy = state.copy()
    for field in fields(kind):
        value, copied = getattr(state, field.name), getattr(copy, field.name)
        if type(value) not in PARTS:
            assert copied == value, field.name


def test_mappings_of_a_copy_are_its_own() -> None:
    state = ModalState()
    copy = state.copy()
    copy.speeds["S"] = 1.0
    copy.spindle.gears["S"] = 2
    copy.coordinates.unit = 25.4
    copy.tool.d = 5
    assert (state.speeds, state.spindle.gears, state.coordinates.unit, state.tool.d) == ({}, {}, 1.0, 0)
