"""The tools of a channel as the kernel uses them: compensation data by D number (P-TOOL), in mm and deg."""

from collections.abc import Mapping, Sequence
from typing import Final, NamedTuple

from cnc_ptp.parameters.declare import ids
from cnc_ptp.parameters.read.parameter_set import ParameterSet
from cnc_ptp.parameters.view.channel_members import Sets, rotary_axes

INCH: Final = 25.4
ONLY_LIMITS: Final = (ids.WZ_LOG_AX_NR_SPDL, ids.WZ_VB_MIN, ids.WZ_VB_MAX, ids.WZ_A_MAX)
"""What a tool permits to its spindle: records with nothing else make no tool table."""


class Tool(NamedTuple):
    """Compensation data of one D number; mm, for rotary axes deg.

    number        T number of the tool
    offsets, wear one value for each axis of the channel, empty for none; wear is added to the offsets
    orientation   position of the cutter of a turning tool, 1 to 9, 0 for none
    type          0 milling (drills too), 1 turning, 2 grinding, 3 wire
    fixed         the tool keeps its direction in the machine, whatever #CS is on (P-TOOL-00010)
    values        for programs (P-TOOL-00007)
    spindle       logical axis number of the spindle that gets its limits, 0 for none
    """

    number: int = 0
    length: float = 0.0
    radius: float = 0.0
    offsets: tuple[float, ...] = ()
    wear_length: float = 0.0
    wear_radius: float = 0.0
    wear: tuple[float, ...] = ()
    orientation: int = 0
    type: int = 0
    fixed: bool = False
    valid: bool = True
    values: tuple[float, ...] = ()
    name: str = ""
    spindle: int = 0


class ToolTable(NamedTuple):
    """The tools of a channel by D number, each once.

    present   the machine file has a tool table: T without a record is an error
    complete  there are no other tools: D without a record is an error; False where no machine file is known
    with_t    T selects the data of the same number too (P-CHAN-00014)
    at_once   the block of the D word moves all axes that it changes (P-CHAN-00100)
    """

    tools: Mapping[int, Tool] = {}
    present: bool = False
    with_t: bool = False
    at_once: bool = False
    complete: bool = False


NO_TOOLS: Final = ToolTable()


def tool_table(channel: ParameterSet, sets: Sets) -> ToolTable:
    """The records wz[i] of a channel, also those of its tool file."""
    rotary = rotary_axes(channel, sets)
    return ToolTable(
        {number: tool_of(channel, number, rotary) for number in channel.used_indexes("wz") if number},
        has_table(channel),
        bool(channel.value(ids.EINRECHNEN_MIT_T)),
        bool(channel.value(ids.MOVE_TOOL_OFFSETS_DIRECTLY)),
        complete=True,
    )


def has_table(channel: ParameterSet) -> bool:
    """The file names one with tools, or has a record with more than limits for its spindle."""
    records = (channel.find(name).declaration.id for name in channel.given if name.startswith("wz."))
    return bool(channel.text(ids.WERKZ_DATA)) or any(number not in ONLY_LIMITS for number in records)


def tool_of(channel: ParameterSet, number: int, rotary: Sequence[bool]) -> Tool:
    inch = channel.number(ids.WZ_MASS_EINHEIT, number) == 1

    def length(parameter: str, *indexes: int) -> float:
        return channel.kernel(parameter, number, *indexes) * (INCH if inch else 1.0)

    def by_axis(parameter: str) -> tuple[float, ...]:
        kernel = channel.kernel
        return tuple(
            kernel(parameter, number, axis) if turns else length(parameter, axis) for axis, turns in enumerate(rotary)
        )

    values = channel.used_indexes(f"wz.{number}.param")
    return Tool(
        number=int(channel.number(ids.WZ_T_NUMBER, number)) or number,
        length=length(ids.WZ_LAENGE),
        radius=length(ids.WZ_RADIUS),
        offsets=by_axis(ids.WZ_AX_VERSATZ),
        wear_length=length(ids.WZ_WEAR_LENGTH),
        wear_radius=length(ids.WZ_WEAR_RADIUS),
        wear=by_axis(ids.WZ_WEAR),
        orientation=int(channel.number(ids.WZ_SRK_LAGE, number)),
        type=int(channel.number(ids.WZ_TYP, number)),
        fixed=bool(channel.value(ids.WZ_TOOL_FIXED, number)),
        valid=bool(channel.value(ids.WZ_GUELTIG, number)),
        values=tuple(
            float(channel.number(ids.WZ_PARAM, number, place)) for place in range(max(values, default=-1) + 1)
        ),
        name=channel.text(ids.WZ_NAME, number),
        spindle=int(channel.number(ids.WZ_LOG_AX_NR_SPDL, number)),
    )
