"""Answers of a node to a change of a parameter, at its start or while it runs."""

from cnc_ptp.errors import CncError
from cnc_ptp.parameters.declare import ids
from cnc_ptp.parameters.declare.declarations import dotted
from cnc_ptp.parameters.read.parameter_set import ParameterSet
from cnc_ptp.parameters.read.sections import checked_entry
from cnc_ptp.parameters.read.source import Entry, Value
from cnc_ptp.parameters.read.values import BadValue, shown

MEMORY_IS_FIXED = 110641
POINTS = ids.FRICT_COMP_MAX_POINTS
"""Table size for which memory is reserved at the start (TF5200 friction compensation 5.2.2)."""


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


def change_refusal(parameters: ParameterSet, ros_name: str, wanted: object) -> CncError | None:
    """The error 110641 for a change of P-COMP-00062; None for all others, which are simply read-only."""
    declaration = parameters.catalogue.by_id[POINTS]
    if ros_name != declaration.ros_name(()) or not declaration.belongs_to(parameters.kind):
        return None
    name, value = declaration.list_style_name(()), parameters.value(POINTS)
    text = f"{name} = {value} ({POINTS}) cannot be changed to {wanted} after start-up"
    effect = "nothing was changed, set it in the machine file and start again"
    return CncError(MEMORY_IS_FIXED, f"{parameters.kind} {parameters.node}: {text}; {effect}")
