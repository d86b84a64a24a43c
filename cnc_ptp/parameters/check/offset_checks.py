"""Zero offsets, clamp positions and tools against the axes of their channel."""

from collections.abc import Iterator

from cnc_ptp.parameters import errors
from cnc_ptp.parameters.declare import ids
from cnc_ptp.parameters.errors import Problem
from cnc_ptp.parameters.read.messages import problem
from cnc_ptp.parameters.read.parameter_set import ParameterSet
from cnc_ptp.parameters.view.channel_members import Sets, axis_entries

OF_AXES = (ids.ACHSE_VERSCH, ids.ACHSE_INAKTIV, ids.ACHSE_VERSATZ, ids.WZ_AX_VERSATZ, ids.WZ_WEAR)
"""Parameters of an offset or a tool for an axis."""


def offset_axes(channel: ParameterSet, sets: Sets) -> Iterator[Problem]:
    """The channel has the axis of each value."""
    names = [entry.name for entry in axis_entries(channel, sets)]
    axes = f"{len(names)} axes ({', '.join(names)})" if len(names) != 1 else f"1 axis ({names[0]})"
    for ros_name in channel.given:
        declaration, indexes, _ = channel.find(ros_name)
        if declaration.id in OF_AXES and indexes[1] >= len(names):
            text = f"there is no axis {indexes[1]}, the channel has {axes}, the first one is 0"
            yield problem(channel, errors.INDEX, declaration.id, indexes, text)


def offset_of_g53(channel: ParameterSet, sets: Sets) -> Iterator[Problem]:
    """Values of index 0 need P-ZERO-00001."""
    if channel.number(ids.G53_VERFUEGBAR):
        return
    for axis in channel.used_indexes("np_grp.0.achse"):
        if channel.is_given(ids.ACHSE_VERSCH, 0, axis) and channel.number(ids.ACHSE_VERSCH, 0, axis):
            text = "G53 selects no offset; give P-ZERO-00001 (g53_verfuegbar) = 1 if it shall"
            yield problem(channel, errors.CONTRADICTION, ids.ACHSE_VERSCH, (0, axis), text)


OFFSET_CHECKS = (offset_axes, offset_of_g53)
