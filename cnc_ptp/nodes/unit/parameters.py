"""ROS parameters of a node: the whole list of its unit, each with descriptor; a few can be set while it runs."""

from __future__ import annotations

import json
from collections.abc import Iterable
from typing import Any

from rcl_interfaces.msg import (
    FloatingPointRange,
    IntegerRange,
    ParameterDescriptor,
    ParameterType,
    SetParametersResult,
)
from rclpy.node import Node
from rclpy.parameter import Parameter

from cnc_ptp.errors import CncError
from cnc_ptp.parameters import MachineParameters, ParameterSet, RosDescriptor, ros_descriptors
from cnc_ptp.parameters.check.runtime_change import change_refusal, start_refusal
from cnc_ptp.parameters.declare.declarations import dotted
from cnc_ptp.parameters.read.values import shown
from cnc_ptp.parameters.view.by_name import parameter_by_name
from cnc_ptp.protocol.blocks import Command, CommandRecord
from cnc_ptp.ros_arguments import REFUSED

TYPES = {
    "int": ParameterType.PARAMETER_INTEGER,
    "float": ParameterType.PARAMETER_DOUBLE,
    "bool": ParameterType.PARAMETER_BOOL,
    "string": ParameterType.PARAMETER_STRING,
    "strings": ParameterType.PARAMETER_STRING_ARRAY,
}
WRITE = "write_parameter"
BARE_WORDS = "ROS takes y, n, yes, no, on, off without quotes for true and false"


def declare_parameters(node: Node, machine: MachineParameters, name: str) -> None:
    """Declares the parameters of unit `name` as the machine file has them; `ros2 param describe` shows the rest."""
    require_machine_values(node, machine.raw(name))
    entries = ros_descriptors(machine.raw(name))
    parameters: list[Any] = [(entry.ros_name, _value(entry), _descriptor(entry)) for entry in entries]
    node.declare_parameters("", parameters, ignore_override=True)


def require_machine_values(node: Node, own: ParameterSet) -> None:
    """Raises CncError 26130 when ROS arguments give the node of a unit another value than the machine file does.

    All nodes of the machine, its recording and each replay have to know the same values.
    """
    for name, override in node._parameter_overrides.items():
        value = _given(override)
        reason = "" if node.has_parameter(name) else start_refusal(own, name, value)
        if reason and isinstance(value, bool):
            reason += f" ({BARE_WORDS})"
        if reason:
            raise _refused_value(node, name, override, reason)


def require_known_parameters(node: Node) -> None:
    """Raises CncError 26130 for parameters of the ROS arguments that the node does not have, and for simulated time."""
    for name, override in node._parameter_overrides.items():
        if not node.has_parameter(dotted(name)):
            raise _refused_value(node, name, override, "the node has no such parameter")
        if name == "use_sim_time" and override.value:
            raise _refused_value(node, name, override, "the time of all nodes is that of their clock node")


def _given(override: Any) -> Any:
    """The value as our own reader has it; ROS gives an empty list no type."""
    value = override.value
    return value if isinstance(value, bool | int | float | str) else tuple(value or ())


def _refused_value(node: Node, name: str, override: Any, reason: str) -> CncError:
    given = shown(_given(override))
    text = f"{node.get_name()}: parameter {name} = {given} of the ROS arguments is refused: {reason}"
    return CncError(REFUSED, text, "the node does not start")


def refused_change(own: ParameterSet, wanted: Iterable[Any]) -> SetParametersResult | None:
    """The answer to a change that no unit takes, with number and reason; those of ROS have neither."""
    for parameter in wanted:
        error = change_refusal(own, parameter.name, _given(parameter))
        if error is not None:
            return refusal(str(error))
    return None


def refusal(reason: str) -> SetParametersResult:
    return SetParametersResult(successful=False, reason=reason)


def write_command(unit: str, parameter: Any) -> Command:
    """The command with which a unit takes a new value; all that can change are numbers and switches."""
    return Command(unit, WRITE, {"parameter": parameter.name, "value": float(parameter.value)})


def written_parameter(own: ParameterSet, record: CommandRecord) -> Parameter[Any] | None:
    """The ROS parameter that an accepted command has written; None for other commands."""
    if record.command != WRITE or not record.accepted:
        return None
    arguments = json.loads(record.arguments_json)
    found = parameter_by_name(own, arguments["parameter"])
    kinds: dict[str, type] = {"int": int, "bool": bool, "float": float}
    return Parameter(found.ros_name, value=kinds[found.declaration.type](arguments["value"]))


def _value(entry: RosDescriptor) -> Any:
    return list(entry.value) if isinstance(entry.value, tuple) else entry.value


def _descriptor(entry: RosDescriptor) -> ParameterDescriptor:
    descriptor = ParameterDescriptor(
        name=entry.ros_name, type=TYPES[entry.type], description=entry.description, read_only=entry.read_only
    )
    low, high = entry.minimum, entry.maximum
    if low is None and high is None:
        return descriptor
    if entry.type == "int":
        low, high = (-(2**63) if low is None else int(low)), (2**63 - 1 if high is None else int(high))
        descriptor.integer_range = [IntegerRange(from_value=low, to_value=high, step=0)]
    elif entry.type == "float":
        low, high = (float("-inf") if low is None else float(low)), (float("inf") if high is None else float(high))
        descriptor.floating_point_range = [FloatingPointRange(from_value=low, to_value=high, step=0.0)]
    return descriptor
