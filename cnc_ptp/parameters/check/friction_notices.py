"""Notices about friction tables that compensate something other than their author may expect, or nothing."""

from __future__ import annotations

from collections.abc import Iterator

from cnc_ptp.parameters.declare import ids
from cnc_ptp.parameters.read.messages import Notice, notice
from cnc_ptp.parameters.read.parameter_set import ParameterSet
from cnc_ptp.parameters.view.control_view import friction_parameters, torque_scale
from cnc_ptp.parameters.view.encoder import uses_feed_constant

ENTRIES = ids.FRICT_COMP_TABLE_ENTRIES
CURRENT = ids.TABLE_OUT


def friction_notices(parameters: ParameterSet) -> Iterator[Notice]:
    """All notices of one axis, if its compensation is permitted and has a mode."""
    if not friction_parameters(parameters).active:
        return
    if parameters.number(ids.FRICT_COMP_SCALING_FACTOR) == 0:
        yield notice(parameters, ids.FRICT_COMP_SCALING_FACTOR, (), "value 0 scales all currents of the table to 0")
        return
    yield from entries_without_use(parameters)
    yield from currents_not_given(parameters)
    yield from currents_with_the_friction(parameters)
    yield from currents_above_the_motor(parameters)


def entries_without_use(parameters: ParameterSet) -> Iterator[Notice]:
    """Entries of the file beyond the number of entries in use."""
    entries = int(parameters.number(ENTRIES))
    unused = [index for index in parameters.used_indexes("frict_comp.table") if index >= entries]
    if unused:
        listed = ", ".join(f"table[{index}]" for index in unused)
        yield notice(parameters, ENTRIES, (), f"value {entries} leaves {listed} unused")


def currents_not_given(parameters: ParameterSet) -> Iterator[Notice]:
    for index in range(int(parameters.number(ENTRIES))):
        if not parameters.is_given(CURRENT, index):
            yield notice(parameters, ids.TABLE_IN, (index,), f"its current {CURRENT} is not given, 0 is used")


def currents_with_the_friction(parameters: ParameterSet) -> Iterator[Notice]:
    """A positive current drives forwards, so only a positive one compensates friction."""
    for index, current in enumerate(friction_parameters(parameters).currents):
        if current < 0:
            text = f"current {current:g} is negative, it brakes like the friction"
            yield notice(parameters, CURRENT, (index,), text)


def currents_above_the_motor(parameters: ParameterSet) -> Iterator[Notice]:
    """More torque than P-AXIS-00392, the stall torque of the motor, if the file gives it."""
    scale, most = torque_scale(parameters), parameters.number(ids.ANTR_ACC_REFERENCE_VALUE)
    if not scale or not parameters.is_given(ids.ANTR_ACC_REFERENCE_VALUE):
        return
    unit = "N" if parameters.axis_type == "T" and not uses_feed_constant(parameters) else "Nm"
    for index, current in enumerate(friction_parameters(parameters).currents):
        torque = abs(current) / scale
        if torque > most:
            text = f"current {current:g} is {torque:g} {unit}, above the {most:g} {unit} of the motor (P-AXIS-00392)"
            yield notice(parameters, CURRENT, (index,), text)
