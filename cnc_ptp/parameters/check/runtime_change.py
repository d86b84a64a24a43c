"""Changes of a parameter while its node runs: which are possible and when, and what the others are answered."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

from cnc_ptp.errors import CncError
from cnc_ptp.parameters.check.control_notices import delays, denominators
from cnc_ptp.parameters.check.machine_checks import NODE_CHECKS
from cnc_ptp.parameters.declare import ids
from cnc_ptp.parameters.declare.declarations import Declaration, ParameterValue, dotted
from cnc_ptp.parameters.errors import AT_RUN_TIME
from cnc_ptp.parameters.read.messages import Notice
from cnc_ptp.parameters.read.parameter_set import Given, Parameter, ParameterSet
from cnc_ptp.parameters.read.sections import checked_entry
from cnc_ptp.parameters.read.source import Entry, Value
from cnc_ptp.parameters.read.values import BadValue, checked_value, shown
from cnc_ptp.parameters.view.by_name import parameter_by_name

MEMORY_IS_FIXED = 110641
NOT_WRITABLE = 23095
BAD_PARAMETER_VALUE = 23096
POINTS = ids.FRICT_COMP_MAX_POINTS
"""Table size for which memory is reserved at the start (TF5200 friction compensation 5.2.2)."""
NOW, STANDSTILL, START = "now", "standstill", "start"
"""Of `change` in the declarations."""
REASONS = {
    START: "it is taken over at start-up only, as the manual has it",
    "": "it is taken over at start-up only",
}


class Change(NamedTuple):
    """A change that is permitted: the parameter, its value, and all parameters of the node with it."""

    declaration: Declaration
    ros_name: str
    value: ParameterValue
    own: ParameterSet

    @property
    def at_once(self) -> bool:
        """Also while the axis moves."""
        return self.declaration.change_for(self.own.axis_type) == NOW


def changed(own: ParameterSet, name: str, wanted: Value) -> Change:
    """The parameters of a node with a new value of one, by P number (P-AXIS-00099, P-AXIS-00099.0) or name.

    Raises CncError 23095 for one that cannot change at run time, 23096 for a value that the machine file could not
    have either, 110641 for P-COMP-00062.
    """
    declaration, indexes, value = possible_change(own, name, wanted)
    ros_name = declaration.ros_name(indexes)
    new = replace(own, given={**own.given, ros_name: Given(value, AT_RUN_TIME)})
    for check in NODE_CHECKS[own.kind]:
        for problem in check(new):
            raise CncError(BAD_PARAMETER_VALUE, problem.text)
    return Change(declaration, ros_name, value, new)


def possible_change(own: ParameterSet, name: str, wanted: Value) -> Parameter:
    """A parameter that can change at run time, with its new value in its type; not compared with others.

    Raises CncError as `changed` does.
    """
    try:
        found = parameter_by_name(own, name)
    except CncError as error:
        raise CncError(NOT_WRITABLE, error.reason) from None
    declaration = found.declaration
    refuse_fixed(own, declaration)
    try:
        value = checked_value(declaration, listed(declaration, wanted), declaration.unit_for(own.axis_type))
    except BadValue as error:
        reason = f"{declaration.id} {declaration.list_style_name(found.indexes)}: {error.text}"
        raise CncError(BAD_PARAMETER_VALUE, reason) from None
    return found._replace(value=value)


def refuse_fixed(own: ParameterSet, declaration: Declaration) -> None:
    """Raises 23095, and 110641 for P-COMP-00062, where a parameter does not change while the node runs."""
    when = declaration.change_for(own.axis_type)
    if when in (NOW, STANDSTILL):
        return
    what = f"{declaration.id} ({declaration.name}) cannot be written at run time"
    number = MEMORY_IS_FIXED if declaration.id == POINTS else NOT_WRITABLE
    raise CncError(number, f"{what}, {REASONS[when]}")


def listed(declaration: Declaration, wanted: Value) -> Value:
    """A number of a command, which is a float, as the list would have it."""
    whole = isinstance(wanted, float) and wanted.is_integer() and declaration.type != "float"
    return int(wanted) if whole else wanted  # type: ignore[arg-type]


def corrections(change: Change, cycle_time: float) -> Iterator[Notice]:
    """What is used instead of the new value, with the vendor's number (70348, 70349, 110465, 110473)."""
    for notice in (*delays(change.own, cycle_time), *denominators(change.own)):
        if notice.parameter.startswith(change.declaration.id):
            yield notice


# answers of ROS


def start_refusal(parameters: ParameterSet, ros_name: str, wanted: Value) -> str:
    """Why a node cannot start with a value that ROS gives it; empty if it is that of the machine file."""
    entry = Entry(dotted(ros_name), wanted, parameters.place)
    try:
        value = checked_entry(entry, parameters.node, parameters.kind, parameters.axis_type)
    except BadValue as error:
        return error.text
    own = {parameter.ros_name: parameter.value for parameter in parameters.parameters()}
    if entry.name not in own:
        return "it is not in the machine file, from which all nodes and the recording take it"
    if own[entry.name] != value:
        return f"it is {shown(own[entry.name])} in the machine file, from which all nodes and the recording take it"
    return ""


def change_refusal(parameters: ParameterSet, ros_name: str, wanted: Value) -> CncError | None:
    """Why ROS cannot give a parameter another value: 23095, 23096, 110641; None if the unit may be asked."""
    where, fixed = f"{parameters.kind} {parameters.node}", parameters.catalogue.by_id[POINTS]
    effect = "nothing was changed, set it in the machine file and start again"
    if ros_name == fixed.ros_name(()) and fixed.belongs_to(parameters.kind):
        name, value = fixed.list_style_name(()), parameters.value(POINTS)
        text = f"{name} = {value} ({POINTS}) cannot be changed to {wanted} after start-up"
        return CncError(MEMORY_IS_FIXED, f"{where}: {text}; {effect}")
    try:
        possible_change(parameters, ros_name, wanted)
    except CncError as error:
        return CncError(error.number, f"{where}: {error.reason}; nothing was changed")
    return None
