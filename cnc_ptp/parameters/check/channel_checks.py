"""A channel against the axes and spindles of the machine: each listed unit exists, fits and has a unique name.

Each check yields Problems; those of gears, couplings and tools are in channel_spindle_checks.py.
"""

from collections.abc import Iterator, Sequence

from cnc_ptp.parameters import errors
from cnc_ptp.parameters.check.channel_spindle_checks import SPINDLE_LIST_CHECKS
from cnc_ptp.parameters.check.offset_checks import OFFSET_CHECKS
from cnc_ptp.parameters.declare import ids
from cnc_ptp.parameters.errors import Problem
from cnc_ptp.parameters.read.messages import problem
from cnc_ptp.parameters.read.parameter_set import ParameterSet
from cnc_ptp.parameters.view.channel_members import ChannelAxisEntry, Sets, axis_entries, is_path_axis, spindle_entries


def channel_axes(channel: ParameterSet, sets: Sets) -> Iterator[Problem]:
    """Each listed axis exists, is a path axis, is listed once, has a unique name."""
    entries = axis_entries(channel, sets)
    yield from listed_units(channel, entries, ids.ACHSE_LOG_ACHS_NR, ids.ACHSE_BEZEICHNUNG, sets)


def channel_spindles(channel: ParameterSet, sets: Sets) -> Iterator[Problem]:
    """The same for spindles."""
    entries = spindle_entries(channel, sets)
    yield from listed_units(channel, entries, ids.SPINDEL_LOG_ACHS_NR, ids.SPINDEL_BEZEICHNUNG, sets)


def listed_units(
    channel: ParameterSet, entries: Sequence[ChannelAxisEntry], number: str, name: str, sets: Sets
) -> Iterator[Problem]:
    wants_spindle = number == ids.SPINDEL_LOG_ACHS_NR
    names: dict[str, ChannelAxisEntry] = {}
    numbers: dict[int, ChannelAxisEntry] = {}
    for entry in entries:
        if entry.indexes and not channel.is_invalid(number, *entry.indexes):
            text, error_id = unit_trouble(entry, wants_spindle, sets, numbers)
            if text:
                yield problem(channel, error_id, number, entry.indexes, text)
        yield from name_trouble(channel, entry, name, names)


def unit_trouble(
    entry: ChannelAxisEntry, wants_spindle: bool, sets: Sets, numbers: dict[int, ChannelAxisEntry]
) -> tuple[str, int]:
    if entry.number == 0:
        return "no logical axis number is given", errors.NO_SUCH_AXIS
    if entry.plc_control:
        return plc_spindle_trouble(entry, numbers)
    if entry.node is None:
        known = ", ".join(
            f"{int(unit.number(ids.KOPF_ACHS_NR))} /{unit.node}" for unit in sets.values() if unit.kind != "channel"
        )
        text = f"value {entry.number} is not a logical axis number of the machine ({known or 'none'})"
        return text, errors.NO_SUCH_AXIS
    unit = sets[entry.node]
    if is_path_axis(unit) == wants_spindle:
        kinds = ("a path axis", "a spindle") if wants_spindle else ("a spindle", "a path axis")
        return f"value {entry.number} is /{entry.node}, {kinds[0]} cannot be {kinds[1]}", errors.AXIS_TYPE
    if numbers.setdefault(entry.number, entry) is not entry:
        return f"value {entry.number} is listed twice in the channel", errors.DUPLICATE_NUMBER
    return "", 0


def plc_spindle_trouble(entry: ChannelAxisEntry, numbers: dict[int, ChannelAxisEntry]) -> tuple[str, int]:
    """A spindle that the PLC moves through the channel has a number that no unit has (TF5200 spindle 2.2.2.2)."""
    if entry.node is not None:
        rule = "a spindle with P-CHAN-00069 (plc_control) has a number of its own"
        return f"value {entry.number} is /{entry.node}, {rule}", errors.DUPLICATE_NUMBER
    if numbers.setdefault(entry.number, entry) is not entry:
        return f"value {entry.number} is listed twice in the channel", errors.DUPLICATE_NUMBER
    return "", 0


def name_trouble(
    channel: ParameterSet, entry: ChannelAxisEntry, name: str, names: dict[str, ChannelAxisEntry]
) -> Iterator[Problem]:
    """A program name has the right first letter (a name made of the node name may not) and is used once."""
    text = wrong_name(entry, name) or used_twice(entry, names)
    if text:
        place = channel.where(name, *entry.indexes) if entry.indexes else channel.place
        yield Problem(errors.UNIT_NAME, place, f"channel /{channel.node}: {text}")


def wrong_name(entry: ChannelAxisEntry, name: str) -> str:
    spindle = name == ids.SPINDEL_BEZEICHNUNG
    letters, listed_as = ("S", "spindel[i]") if spindle else ("ABCUVWXYZQ", "gruppe[i].achse[j]")
    if entry.plc_control and not entry.own_name:
        return f"a spindle with P-CHAN-00069 (plc_control) has no node name: give {listed_as}.bezeichnung"
    if entry.name and entry.name[0] not in letters:
        rule = f"the first letter must be one of {', '.join(letters)}: give {listed_as}.bezeichnung"
        return f"/{entry.node} would be called {entry.name}, {rule}"
    return ""


def used_twice(entry: ChannelAxisEntry, names: dict[str, ChannelAxisEntry]) -> str:
    """The main spindle has two names: its own one is used as soon as another spindle is the main spindle."""
    for used in (entry.name, entry.own_name):
        if used and names.setdefault(used, entry) is not entry:
            return f"program name {used} is used twice"
    return ""


def c_axis_name(channel: ParameterSet, sets: Sets) -> Iterator[Problem]:
    """The C axis has a name of its own, and a spindle."""
    name = channel.text(ids.DEFAULT_AX_NAME_OF_SPINDLE)
    if not name:
        return
    if any(entry.name == name for entry in axis_entries(channel, sets)):
        text = f"value {name} is the name of an axis of the channel (P-CHAN-00006)"
        yield problem(channel, errors.CONTRADICTION, ids.DEFAULT_AX_NAME_OF_SPINDLE, (), text)
    elif not spindle_entries(channel, sets):
        text = f"value {name}, but the channel has no spindle"
        yield problem(channel, errors.CONTRADICTION, ids.DEFAULT_AX_NAME_OF_SPINDLE, (), text)


def axis_count(channel: ParameterSet, sets: Sets) -> Iterator[Problem]:
    for group in channel.used_indexes("gruppe"):
        count = len(channel.used_indexes(f"gruppe.{group}.achse"))
        value = channel.number(ids.GRUPPE_ACHS_ANZAHL, group)
        if channel.is_given(ids.GRUPPE_ACHS_ANZAHL, group) and value != count:
            text = f"value {value}, but {count} axes are listed (achse[j])"
            yield problem(channel, errors.COUNT, ids.GRUPPE_ACHS_ANZAHL, (group,), text)


def spindle_count(channel: ParameterSet, sets: Sets) -> Iterator[Problem]:
    count = len(channel.used_indexes("spindel"))
    value = channel.number(ids.SPDL_ANZAHL)
    if value != count and not channel.is_invalid(ids.SPDL_ANZAHL) and (count or channel.is_given(ids.SPDL_ANZAHL)):
        text = f"value {value}, but {count} spindles are listed (spindel[i])"
        yield problem(channel, errors.COUNT, ids.SPDL_ANZAHL, (), text)


def main_spindle(channel: ParameterSet, sets: Sets) -> Iterator[Problem]:
    listed = [int(channel.number(ids.SPINDEL_LOG_ACHS_NR, index)) for index in channel.used_indexes("spindel")]
    number = int(channel.number(ids.MAIN_SPINDLE_AX_NR))
    if number in listed or channel.is_invalid(ids.MAIN_SPINDLE_AX_NR) or not (listed or number):
        return
    numbers = ", ".join(map(str, listed)) or "none"
    given = f"value {number} is" if number else "no value is given, it must be"
    text = f"{given} {'not one' if number else 'one'} of the channel's spindles ({numbers})"
    yield problem(channel, errors.MAIN_SPINDLE, ids.MAIN_SPINDLE_AX_NR, (), text)


CHANNEL_CHECKS = (
    channel_axes,
    channel_spindles,
    axis_count,
    spindle_count,
    main_spindle,
    c_axis_name,
    *SPINDLE_LIST_CHECKS,
    *OFFSET_CHECKS,
)
