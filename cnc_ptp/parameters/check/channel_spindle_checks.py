"""The spindles of a channel: one synchronisation type per function, a record for each gear, coupled pairs and tools of
spindles that the channel has.
"""

from collections.abc import Iterator

from cnc_ptp.parameters import errors
from cnc_ptp.parameters.declare import ids
from cnc_ptp.parameters.errors import Problem
from cnc_ptp.parameters.read.messages import problem
from cnc_ptp.parameters.read.parameter_set import ParameterSet
from cnc_ptp.parameters.view.channel_members import (
    COUPLING_GROUP,
    ChannelAxisEntry,
    Sets,
    coupled_spindle_pairs,
    main_spindle_number,
    spindle_entries,
)
from cnc_ptp.parameters.view.channel_view import GEAR_M_FUNCTIONS

SYNCHRONISATIONS = (
    ids.H_SYNCH,
    ids.M_SYNCH,
    ids.SPINDEL_M19_SYNCH,
    ids.SPINDEL_M3_SYNCH,
    ids.SPINDEL_M4_SYNCH,
    ids.SPINDEL_M5_SYNCH,
    ids.SPINDEL_S_SYNCH,
)
"""H functions, M functions, M19, M3, M4, M5, S."""


def one_synchronisation(channel: ParameterSet, sets: Sets) -> Iterator[Problem]:
    """A function goes out and is waited for in one way; PLC_INFO alone may be added (TF5200 spindle 2.5)."""
    for ros_name in channel.given:
        declaration, indexes, value = channel.find(ros_name)
        types = [name for name in str(value).split(" | ") if name not in ("PLC_INFO", "NO_SYNCH")]
        if declaration.id in SYNCHRONISATIONS and len(types) > 1:
            text = f"value {value} has {len(types)} synchronisation types, one is possible (PLC_INFO may be added)"
            yield problem(channel, errors.CONTRADICTION, declaration.id, indexes, text)


def gear_synchronisation(channel: ParameterSet, sets: Sets) -> Iterator[Problem]:
    """M40 to M45 wait before the motion, and only there, while they select gears (TF5200 spindle 2.8.2)."""
    if not channel.number(ids.MAIN_SPINDLE_GEAR_CHANGE):
        return
    for number in GEAR_M_FUNCTIONS:
        value = channel.text(ids.M_SYNCH, number)
        if value not in ("MVS_SVS", "NOT_VALID"):
            text = f"value {value} must be MVS_SVS, M{number} selects a gear (P-CHAN-00052)"
            yield problem(channel, errors.CONTRADICTION, ids.M_SYNCH, (number,), text)


def gear_records(channel: ParameterSet, sets: Sets) -> Iterator[Problem]:
    """Each gear stage of the main spindle has its record getriebe[j] in the list of the spindle."""
    entries = spindle_entries(channel, sets)
    main = main_spindle_number(channel, entries)
    entry = next((entry for entry in entries if entry.number == main), None)
    if not channel.number(ids.MAIN_SPINDLE_GEAR_CHANGE) or entry is None or entry.node is None or not entry.indexes:
        return
    records = {0, *sets[entry.node].used_indexes("getriebe")}
    for gear in channel.used_indexes(f"spindel.{entry.indexes[0]}.range_table"):
        where = (*entry.indexes, gear)
        if channel.number(ids.RANGE_TABLE_MAX_SPEED, *where) and gear not in records:
            text = f"gear stage M{GEAR_M_FUNCTIONS[gear]} has no record getriebe[{gear}] in the list of /{entry.node}"
            yield problem(channel, errors.CONTRADICTION, ids.RANGE_TABLE_MAX_SPEED, where, text)


def coupled_pairs(channel: ParameterSet, sets: Sets) -> Iterator[Problem]:
    """Pairs of spindles: both are in the channel, none follows itself or two masters, none is slave and master."""
    pairs = coupled_spindle_pairs(channel)
    entries = spindle_entries(channel, sets)
    slaves = [slave for _, slave, _ in pairs]
    for position, (pair, slave, master) in enumerate(pairs):
        for number, value in ((ids.PAAR_LOG_ACHS_NR_SLAVE, slave), (ids.PAAR_LOG_ACHS_NR_MASTER, master)):
            text = not_coupled(value, entries)
            if text:
                yield problem(channel, errors.NO_SUCH_AXIS, number, (COUPLING_GROUP, pair), text)
        if slave == master:
            text = f"value {slave} is its own master (P-CHAN-00037)"
            yield problem(channel, errors.CONTRADICTION, ids.PAAR_LOG_ACHS_NR_SLAVE, (COUPLING_GROUP, pair), text)
        elif slave in slaves[:position]:
            text = f"value {slave} is slave of two masters"
            yield problem(channel, errors.CONTRADICTION, ids.PAAR_LOG_ACHS_NR_SLAVE, (COUPLING_GROUP, pair), text)
        elif master in slaves:
            text = f"value {master} is slave and master in one coupling group"
            yield problem(channel, errors.CONTRADICTION, ids.PAAR_LOG_ACHS_NR_MASTER, (COUPLING_GROUP, pair), text)


def not_coupled(number: int, entries: list[ChannelAxisEntry]) -> str:
    """Why a number cannot be in a coupled pair of spindles; empty if it can."""
    entry = next((entry for entry in entries if entry.number == number), None)
    if entry is not None:
        return f"value {number} is a spindle with P-CHAN-00069 (plc_control)" if entry.plc_control else ""
    known = ", ".join(str(entry.number) for entry in entries) or "none"
    return f"value {number} is not one of the channel's spindles ({known})"


def tool_spindles(channel: ParameterSet, sets: Sets) -> Iterator[Problem]:
    """Tools limit spindles of the channel (P-TOOL-00012); 0 is none."""
    entries = spindle_entries(channel, sets)
    for tool in channel.used_indexes("wz"):
        number = int(channel.number(ids.WZ_LOG_AX_NR_SPDL, tool))
        text = not_coupled(number, entries) if number else ""
        if text:
            yield problem(channel, errors.NO_SUCH_AXIS, ids.WZ_LOG_AX_NR_SPDL, (tool,), text)


def tool_speeds(channel: ParameterSet, sets: Sets) -> Iterator[Problem]:
    """The lowest speed of a tool against the highest, if that is given; otherwise there is none."""
    for tool in channel.used_indexes("wz"):
        low, high = (channel.number(number, tool) for number in (ids.WZ_VB_MIN, ids.WZ_VB_MAX))
        if channel.is_given(ids.WZ_VB_MAX, tool) and low > high:
            text = f"value {low} is above the maximum {high} (0.001°/s) of P-TOOL-00014 wz[{tool}].vb_max"
            yield problem(channel, errors.CONTRADICTION, ids.WZ_VB_MIN, (tool,), text)


SPINDLE_LIST_CHECKS = (
    one_synchronisation,
    gear_synchronisation,
    gear_records,
    coupled_pairs,
    tool_spindles,
    tool_speeds,
)
