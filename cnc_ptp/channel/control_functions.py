"""Feedforward and compensations of a program as commands for the nodes of axes and spindles.

They are functions without synchronisation: they go out with the next block of cycles, and nothing waits for spindles.
The next motion of the path starts in that block at the earliest, with what they have switched in the axes.
"""

from __future__ import annotations

from typing import Any

from cnc_ptp.nc.canonical import AxisFeedforward, ControlFunction, MachineData, SpindleFeedforward
from cnc_ptp.parameters import ChannelParameters
from cnc_ptp.protocol.blocks import Command


def control_commands(channel: ChannelParameters, function: ControlFunction) -> list[Command]:
    """One command for each axis or spindle of the function."""
    if isinstance(function, AxisFeedforward):
        return _axis_feedforward(channel, function)
    if isinstance(function, SpindleFeedforward):
        node = next(spindle.node for spindle in channel.spindles if spindle.name == function.spindle)
        return [_set_feedforward(node, function.on, function.weight)]
    if isinstance(function, MachineData):
        place = place_of(channel, function.axis)
        arguments = {"parameter": function.parameter, "value": function.value, "by_path": True}
        return [Command(channel.axes[place].node, "write_parameter", arguments)]
    node = next(axis.node for axis in channel.axes if axis.name == function.axis)
    return [Command(node, "set_friction_compensation", {"enabled": function.on})]


def place_of(channel: ChannelParameters, axis: str) -> int:
    """Index of an axis by its name in programs or its logical number; -1 for one that the channel does not have."""
    return next((n for n, each in enumerate(channel.axes) if axis in (each.name, str(each.number))), -1)


def reset_commands(channel: ChannelParameters) -> list[Command]:
    """Program start: feedforward off and weights 100 % (TF5200 feedforward 3)."""
    nodes = [axis.node for axis in channel.axes] + [spindle.node for spindle in channel.spindles if spindle.node]
    return [Command(node, "reset_feedforward", {}) for node in nodes]


def _axis_feedforward(channel: ChannelParameters, function: AxisFeedforward) -> list[Command]:
    weights = dict(function.weights)
    concerned = [axis for axis in channel.axes if function.on is not None or axis.name in weights]
    return [_set_feedforward(axis.node, function.on, weights.get(axis.name)) for axis in concerned]


def _set_feedforward(node: str, on: bool | None, weight: float | None) -> Command:
    arguments: dict[str, Any] = {"enabled": on, "weight_percent": weight}
    return Command(node, "set_feedforward", {name: value for name, value in arguments.items() if value is not None})
