"""Descriptors with which a node declares its parameters in ROS, without rclpy."""

import math
from typing import NamedTuple

from cnc_ptp.parameters.declare.declarations import Declaration, Limit, Number, ParameterValue
from cnc_ptp.parameters.declare.ranges import range_text
from cnc_ptp.parameters.read.parameter_set import ParameterSet


class RosDescriptor(NamedTuple):
    """One ROS parameter. `type` is int, float, bool, string or strings; limits are None without a range, and inclusive.

    If a limit is another parameter, it is that parameter's value.
    """

    ros_name: str
    value: ParameterValue
    type: str
    minimum: Number | None
    maximum: Number | None
    unit: str
    text: str
    number: str
    read_only: bool
    constraints: str
    """Range and choices in words, for `additional_constraints`."""

    @property
    def description(self) -> str:
        """For the `description` of rcl_interfaces/ParameterDescriptor."""
        return f"{self.number} [{self.unit}] {self.text}" if self.unit else f"{self.number} {self.text}"


def ros_descriptors(parameters: ParameterSet) -> list[RosDescriptor]:
    """Every parameter of a node, in the order of the declarations."""
    return [
        RosDescriptor(
            ros_name=parameter.ros_name,
            value=parameter.value,
            type=parameter.declaration.type,
            minimum=bound(parameters, parameter.declaration, parameter.indexes, upper=False),
            maximum=bound(parameters, parameter.declaration, parameter.indexes, upper=True),
            unit=parameter.declaration.unit_for(parameters.axis_type or "T"),
            text=parameter.declaration.text,
            number=parameter.declaration.id,
            read_only=parameter.declaration.change_for(parameters.axis_type) not in ("now", "standstill"),
            constraints=range_text(parameter.declaration),
        )
        for parameter in parameters.parameters()
    ]


def bound(
    parameters: ParameterSet, declaration: Declaration, indexes: tuple[int, ...], *, upper: bool
) -> Number | None:
    """The tightest limit as an inclusive one; an `unset` value outside the range widens it, as ROS would refuse it."""
    if declaration.type not in ("int", "float") or declaration.choices:
        return choice_bound(declaration, upper=upper)
    limits = declaration.upper if upper else declaration.lower
    bounds = [inclusive(parameters, declaration, limit, indexes, upper=upper) for limit in limits]
    if not bounds:
        return None
    tightest = min(bounds) if upper else max(bounds)
    if isinstance(declaration.unset, (int, float)):
        return max(tightest, declaration.unset) if upper else min(tightest, declaration.unset)
    return tightest


def inclusive(
    parameters: ParameterSet, declaration: Declaration, limit: Limit, indexes: tuple[int, ...], *, upper: bool
) -> Number:
    value = parameters.number(limit.value, *indexes) if isinstance(limit.value, str) else limit.value
    if limit.inclusive:
        return value
    step = -1 if upper else 1
    return value + step if declaration.type == "int" else math.nextafter(value, step * math.inf)


def choice_bound(declaration: Declaration, *, upper: bool) -> Number | None:
    """Smallest or largest of numeric choices, None for text."""
    if declaration.type not in ("int", "float"):
        return None
    choices = [*declaration.choices, *([declaration.unset] if declaration.unset is not None else [])]
    extreme: Number = max(choices) if upper else min(choices)
    return extreme
