"""Zero offsets and clamp positions against the axes of their channel."""

from collections.abc import Iterator

from cnc_ptp.parameters import errors
from cnc_ptp.parameters.declare import ids
from cnc_ptp.parameters.errors import Problem
from cnc_ptp.parameters.read.messages import problem
from cnc_ptp.parameters.read.parameter_set import ParameterSet
from cnc_ptp.parameters.view.channel_members import Sets, axis_entries

OF_AXES = {"np_grp": (ids.ACHSE_VERSCH, ids.ACHSE_INAKTIV), "pzv_grp": (ids.ACHSE_VERSATZ,)}


def offset_axes(channel: ParameterSet, sets: Sets) -> Iterator[Problem]:
    """The channel has the axis of each value."""
    names = [entry.name for entry in axis_entries(channel, sets)]
    axes = f"{len(names)} axes ({', '.join(names)})" if len(names) != 1 else f"1 axis ({names[0]})"
    for array, parameters in OF_AXES.items():
        for index in channel.used_indexes(array):
            for axis in channel.used_indexes(f"{array}.{index}.achse"):
                for parameter in parameters:
                    if axis >= len(names) and channel.is_given(parameter, index, axis):
                        text = f"there is no axis {axis}, the channel has {axes}, the first one is 0"
                        yield problem(channel, errors.INDEX, parameter, (index, axis), text)


def offset_of_g53(channel: ParameterSet, sets: Sets) -> Iterator[Problem]:
    """Values of index 0 need P-ZERO-00001."""
    if channel.number(ids.G53_VERFUEGBAR):
        return
    for axis in channel.used_indexes("np_grp.0.achse"):
        if channel.is_given(ids.ACHSE_VERSCH, 0, axis) and channel.number(ids.ACHSE_VERSCH, 0, axis):
            text = "G53 selects no offset; give P-ZERO-00001 (g53_verfuegbar) = 1 if it shall"
            yield problem(channel, errors.CONTRADICTION, ids.ACHSE_VERSCH, (0, axis), text)


OFFSET_CHECKS = (offset_axes, offset_of_g53)
