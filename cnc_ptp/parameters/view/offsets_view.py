"""Zero offsets and clamp positions of a channel."""

from collections.abc import Mapping
from typing import Final, NamedTuple

from cnc_ptp.parameters.declare import ids
from cnc_ptp.parameters.read.parameter_set import ParameterSet

Values = tuple[float, ...]
"""One for each axis of the channel in its order, mm or deg."""


class OffsetTables(NamedTuple):
    """The offsets that the machine file gives.

    zero       by index, 1 is G54
    inactive   places of the axes for which a zero offset does not count, by its index
    names      of zero offsets
    default    index of the zero offset at program start
    g53        index 0 is a zero offset, too
    clamp      clamp positions by index
    """

    zero: Mapping[int, Values] = {}
    inactive: Mapping[int, frozenset[int]] = {}
    names: Mapping[int, str] = {}
    default: int = 0
    g53: bool = False
    clamp: Mapping[int, Values] = {}


NO_OFFSET_TABLES: Final = OffsetTables()


def offset_tables(channel: ParameterSet, axes: int) -> OffsetTables:
    """The offsets of a channel with so many axes."""
    indexes = channel.used_indexes("np_grp")
    inactive = {
        index: frozenset(axis for axis in range(axes) if channel.number(ids.ACHSE_INAKTIV, index, axis))
        for index in indexes
    }
    names = {index: channel.text(ids.NP_GRP_BEZEICHNUNG, index) for index in indexes}
    return OffsetTables(
        zero={index: values_of(channel, ids.ACHSE_VERSCH, index, axes) for index in indexes},
        inactive={index: places for index, places in inactive.items() if places},
        names={index: name for index, name in names.items() if name},
        default=int(channel.number(ids.DEFAULT_INDEX)),
        g53=bool(channel.number(ids.G53_VERFUEGBAR)),
        clamp={index: values_of(channel, ids.ACHSE_VERSATZ, index, axes) for index in channel.used_indexes("pzv_grp")},
    )


def values_of(channel: ParameterSet, number: str, index: int, axes: int) -> Values:
    return tuple(channel.kernel(number, index, axis) for axis in range(axes))
