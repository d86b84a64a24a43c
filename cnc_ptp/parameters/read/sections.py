"""A section of a machine file -> ParameterSet: each name is declared for the node, each value fits its declaration."""

from cnc_ptp.errors import did_you_mean, nearest
from cnc_ptp.parameters import errors
from cnc_ptp.parameters.declare import ids
from cnc_ptp.parameters.declare.declarations import (
    AXIS_LETTERS,
    Catalogue,
    ParameterValue,
    catalogue,
    split_indexes,
)
from cnc_ptp.parameters.errors import Problem
from cnc_ptp.parameters.read.parameter_set import AXIS_TYPES, Given, ParameterSet
from cnc_ptp.parameters.read.source import Entry, Section
from cnc_ptp.parameters.read.values import BadValue, checked_value, shown


def checked_section(section: Section, kind: str, problems: list[Problem]) -> ParameterSet:
    """The section as a ParameterSet of all valid values; the others go to `problems`."""
    implied: dict[str, ParameterValue] = {"kenngr.achs_typ": "ACHSTYP_SPINDEL"} if kind == "spindle" else {}
    letter = section_axis_type(section, kind)
    given: dict[str, Given] = {}
    invalid = set()
    for entry in section.entries:
        try:
            given[entry.name] = Given(checked_entry(entry, section.node, kind, letter), entry.place)
        except BadValue as error:
            problems.append(Problem(error.error_id, entry.place, error.text))
            if error.error_id in (errors.WRONG_TYPE, errors.OUT_OF_RANGE):
                invalid.add(entry.name)
    return ParameterSet(section.node, kind, section.place, given, implied, frozenset(invalid))


def section_axis_type(section: Section, kind: str) -> str:
    """T, R or S of an axis or spindle section; a wrong achs_typ counts as not given."""
    if kind not in ("axis", "spindle"):
        return ""
    value: ParameterValue = "ACHSTYP_SPINDEL" if kind == "spindle" else "ACHSTYP_TRANSLATOR"
    declaration = catalogue().by_id[ids.KENNGR_ACHS_TYP]
    for entry in section.entries:
        if entry.name == declaration.key:
            try:
                value = checked_value(declaration, entry.value, "")
            except BadValue:
                break
    return AXIS_TYPES[str(value)]


def checked_entry(entry: Entry, node: str, kind: str, letter: str) -> ParameterValue:
    """The value of one entry; raises BadValue with the whole text of the problem."""
    key, indexes = split_indexes(entry.name)
    declaration = catalogue().by_key[kind].get(key)
    if declaration is None:
        raise BadValue(errors.UNKNOWN_NAME, unknown_name(entry.name, f"/{node}", kind))
    where = declaration.subject(indexes, node)
    for index, array in zip(indexes, catalogue().sizes(declaration), strict=True):
        if index >= array.size:
            raise BadValue(errors.INDEX, f"{where}: index {shown(index)} is outside 0 to {array.size - 1}")
    if letter and letter not in declaration.axes:
        fitting = " and ".join(AXIS_LETTERS[axis] for axis in declaration.axes)
        text = f"{where}: only {fitting} have this parameter, /{node} is one of the {AXIS_LETTERS[letter]}"
        raise BadValue(errors.UNKNOWN_NAME, text)
    try:
        return checked_value(declaration, entry.value, declaration.unit_for(letter))
    except BadValue as error:
        raise BadValue(error.error_id, f"{where}: {error.text}") from None


def unknown_name(ros_name: str, node: str, kind: str) -> str:
    """Text for a name that the node's lists do not have, with the nearest one, or the nodes that have it.

    `node`: the name of the unit, in a file with the slash of its section.
    """
    lists = catalogue()
    key, _ = split_indexes(ros_name)
    text = f"{kind} {node} has no parameter {shown(ros_name)}"
    owners = [other for other, keys in lists.by_key.items() if key in keys]
    if owners:
        declaration = lists.by_key[owners[0]][key]
        return f"{text}, {declaration.id} belongs to {' and '.join(owners)} nodes"
    return f"{text}{nearest_parameter(lists, key, kind)}"


def nearest_parameter(lists: Catalogue, key: str, kind: str) -> str:
    known = lists.by_key[kind]
    names = {name: entry for entry in known.values() for name in (entry.key, *entry.misprints)}
    return did_you_mean([f"{names[name].name} ({names[name].id})" for name in nearest(key, names)])
