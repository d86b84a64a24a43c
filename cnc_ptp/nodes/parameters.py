"""ROS parameters of a node: the whole list of its unit, read-only, each with descriptor."""

from __future__ import annotations

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

from cnc_ptp.parameters import MachineParameters, ParameterSet, RosDescriptor, ros_descriptors
from cnc_ptp.parameters.runtime_change import change_refusal

TYPES = {
    "int": ParameterType.PARAMETER_INTEGER,
    "float": ParameterType.PARAMETER_DOUBLE,
    "bool": ParameterType.PARAMETER_BOOL,
    "string": ParameterType.PARAMETER_STRING,
    "strings": ParameterType.PARAMETER_STRING_ARRAY,
}


def declare_parameters(node: Node, machine: MachineParameters, name: str) -> None:
    """Declares the parameters of unit `name` as the machine file has them; `ros2 param describe` shows the rest."""
    entries = ros_descriptors(machine.raw(name))
    parameters: list[Any] = [(entry.ros_name, _value(entry), _descriptor(entry)) for entry in entries]
    node.declare_parameters("", parameters, ignore_override=True)


def refused_change(own: ParameterSet, wanted: Iterable[Any]) -> SetParametersResult | None:
    """The answer to a change that is refused for a reason of its own; None where "read-only" says all."""
    for parameter in wanted:
        error = change_refusal(own, parameter.name, parameter.value)
        if error is not None:
            return SetParametersResult(successful=False, reason=str(error))
    return None


def _value(entry: RosDescriptor) -> Any:
    return list(entry.value) if entry.type == "strings" else entry.value


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
