"""The axes and spindles of a channel, and their names in NC programs."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

from cnc_ptp.parameters.declare import ids
from cnc_ptp.parameters.read.parameter_set import ParameterSet

Sets = Mapping[str, ParameterSet]
COUPLING_GROUP = 0
"""The group that programs can enable."""
SPINDLES = 1
"""P-CHAN-00061: the pair consists of spindles."""


@dataclass(frozen=True, slots=True)
class ChannelAxisEntry:
    """An axis or spindle of a channel.

    `name` is for programs; `node` is None if no unit has the logical `number`; `indexes` are those in the channel
    list, empty for a unit that the channel has without listing it. `own_name`: that of a spindle while it is not the
    main spindle. `plc_control`: a spindle without a unit, the PLC moves it (P-CHAN-00069).
    """

    name: str
    node: str | None
    number: int
    indexes: tuple[int, ...]
    own_name: str = ""
    plc_control: bool = False


def is_path_axis(parameters: ParameterSet) -> bool:
    return parameters.kind == "axis"


def axis_entries(channel: ParameterSet, sets: Sets) -> list[ChannelAxisEntry]:
    """The axes of a channel in the order of gruppe[i].achse[j]; one that lists none gets all that no other lists."""
    listed = list(listed_axes(channel, sets))
    if listed:
        return listed
    others = (other for other in sets.values() if other.kind == "channel" and other is not channel)
    taken = {entry.node for other in others for entry in listed_axes(other, sets)}
    return [unlisted(unit) for unit in sets.values() if is_path_axis(unit) and unit.node not in taken]


def rotary_axes(channel: ParameterSet, sets: Sets) -> list[bool]:
    """Whether each axis of a channel is rotary."""
    return [entry.node is not None and sets[entry.node].axis_type == "R" for entry in axis_entries(channel, sets)]


def listed_axes(channel: ParameterSet, sets: Sets) -> Iterator[ChannelAxisEntry]:
    for group in channel.used_indexes("gruppe"):
        for axis in channel.used_indexes(f"gruppe.{group}.achse"):
            number = int(channel.number(ids.ACHSE_LOG_ACHS_NR, group, axis))
            unit = unit_with(number, sets)
            name = channel.text(ids.ACHSE_BEZEICHNUNG, group, axis) or program_name(unit)
            yield ChannelAxisEntry(name, unit.node if unit else None, number, (group, axis))


def spindle_entries(channel: ParameterSet, sets: Sets) -> list[ChannelAxisEntry]:
    """The spindles of a channel in the order of spindel[i]; a channel that lists none gets all of the machine.

    The name of the main spindle is P-CHAN-00053 (S if that is empty), whatever its own name.
    """
    entries = list(listed_spindles(channel, sets)) or [
        unlisted(unit) for unit in sets.values() if unit.kind == "spindle"
    ]
    main = main_spindle_number(channel, entries)
    main_name = channel.text(ids.MAIN_SPINDLE_NAME) or "S"
    return [replace(entry, name=main_name) if main and entry.number == main else entry for entry in entries]


def listed_spindles(channel: ParameterSet, sets: Sets) -> Iterator[ChannelAxisEntry]:
    for index in channel.used_indexes("spindel"):
        number = int(channel.number(ids.SPINDEL_LOG_ACHS_NR, index))
        unit = unit_with(number, sets)
        name = channel.text(ids.SPINDEL_BEZEICHNUNG, index) or program_name(unit)
        plc_control = bool(channel.number(ids.SPINDEL_PLC_CONTROL, index))
        yield ChannelAxisEntry(name, unit.node if unit else None, number, (index,), name, plc_control)


def main_spindle_number(channel: ParameterSet, entries: list[ChannelAxisEntry]) -> int:
    """Logical number of the main spindle: P-CHAN-00051, or the first one if no spindles are listed; 0 for none."""
    if entries and not entries[0].indexes and not channel.is_given(ids.MAIN_SPINDLE_AX_NR):
        return entries[0].number
    return int(channel.number(ids.MAIN_SPINDLE_AX_NR))


def coupled_spindle_pairs(channel: ParameterSet) -> list[tuple[int, int, int]]:
    """(index of the pair, slave, master) by logical number: the pairs of spindles in coupling group 0."""
    pairs = channel.used_indexes(f"synchro_data.koppel_gruppe.{COUPLING_GROUP}.paar")
    return [
        (
            pair,
            int(channel.number(ids.PAAR_LOG_ACHS_NR_SLAVE, COUPLING_GROUP, pair)),
            int(channel.number(ids.PAAR_LOG_ACHS_NR_MASTER, COUPLING_GROUP, pair)),
        )
        for pair in pairs
        if channel.number(ids.PAAR_MODE, COUPLING_GROUP, pair) == SPINDLES
    ]


def unit_with(number: int, sets: Sets) -> ParameterSet | None:
    units = (unit for unit in sets.values() if unit.kind != "channel")
    return next((unit for unit in units if number and unit.number(ids.KOPF_ACHS_NR) == number), None)


def unlisted(unit: ParameterSet) -> ChannelAxisEntry:
    name = program_name(unit)
    return ChannelAxisEntry(name, unit.node, int(unit.number(ids.KOPF_ACHS_NR)), (), name)


def program_name(unit: ParameterSet | None) -> str:
    """The program name of a unit that has none from the channel: P-AXIS-00297 or the node name in capitals."""
    return (unit.text(ids.KOPF_LOG_ACHS_NAME) or unit.node.upper()) if unit else ""
