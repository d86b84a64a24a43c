"""Machine file -> MachineParameters: read, check every value and values against each other, or refuse, saying all."""

import difflib
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from cnc_ptp.parameters import checks, errors, views
from cnc_ptp.parameters.declarations import (
    AXIS_LETTERS,
    Catalogue,
    Declaration,
    ParameterValue,
    catalogue,
    split_indexes,
)
from cnc_ptp.parameters.errors import ParameterError, Place, Problem
from cnc_ptp.parameters.parameter_set import AXIS_TYPES, Given, ParameterSet
from cnc_ptp.parameters.source import Entry, Section, read_sections
from cnc_ptp.parameters.values import BadValue, checked_value, shown
from cnc_ptp.parameters.views import MachineParameters

RESERVED_NAMES = ("machine", "plc", "clock", "recorder", "player", "events", "commands", "parameter_events", "rosout")


def read_machine(path: str | Path) -> MachineParameters:
    """The machine of a file; raises ParameterError (25017 when it cannot be read)."""
    try:
        text = Path(path).read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, "strerror", None) or "it is not UTF-8 text"
        problem = Problem(errors.UNREADABLE, Place(str(path), 1, 1), f"machine file cannot be read, {reason}")
        raise ParameterError([problem]) from error
    return load_machine(text, str(path))


def load_machine(text: str, file: str) -> MachineParameters:
    """The machine that the text of a ROS parameters file describes; `file` is for messages. Raises ParameterError."""
    sections, problems = read_sections(text, file)
    if any(problem.error_id == errors.SYNTAX for problem in problems):
        raise ParameterError(problems)
    machine_section = next((section for section in sections if section.node == "machine"), None)
    if machine_section is None:
        missing = "section /machine is missing, it says which channels, axes and spindles exist"
        raise ParameterError([*problems, Problem(errors.NO_MACHINE, Place(file, 1, 1), missing)])
    machine = checked_section(machine_section, "machine", problems)
    units = list_units(machine, problems)
    problems += sections_without_unit(sections, units)
    by_name = {section.node: section for section in sections}
    sets = {
        node: checked_section(by_name.get(node, Section(node, machine.place)), kind, problems)
        for node, kind in units.items()
    }
    number_units(sets)
    problems += checks.check_machine(sets)
    if problems:
        raise ParameterError(problems)
    return views.machine_view(machine, sets)


def list_units(machine: ParameterSet, problems: list[Problem]) -> dict[str, str]:
    """Node name -> kind, as /machine lists them."""
    units: dict[str, str] = {}
    for number, kind in (("P-MACH-00004", "channel"), ("P-MACH-00005", "axis"), ("P-MACH-00006", "spindle")):
        for name in (name.lstrip("/") for name in machine.names(number)):
            trouble = name_trouble(name, units)
            if trouble:
                where = subject(machine.catalogue.by_id[number], (), "machine")
                text = f"{where}: unit name {shown(name)} {trouble}"
                problems.append(Problem(errors.UNIT_NAME, machine.where(number), text))
            else:
                units[name] = kind
    return units


def name_trouble(name: str, units: Mapping[str, str]) -> str:
    if name in units:
        return "is given twice"
    if name in RESERVED_NAMES:
        return "is taken by another node"
    if not (name.isascii() and name.isidentifier() and name == name.lower()):
        return "must be small letters, digits and _, a letter first"
    return ""


def sections_without_unit(sections: Sequence[Section], units: Mapping[str, str]) -> Iterator[Problem]:
    for section in sections:
        if section.node != "machine" and section.node not in units:
            known = ", ".join(f"/{name}" for name in units) or "none"
            text = f"section /{section.node} has no unit in /machine (units: {known})"
            yield Problem(errors.NO_UNIT, section.place, text + suggestion(section.node, units))


def checked_section(section: Section, kind: str, problems: list[Problem]) -> ParameterSet:
    """The section as a ParameterSet of all values that are right; what is wrong goes to `problems`."""
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
    declaration = catalogue().by_id["P-AXIS-00018"]
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
        raise BadValue(errors.UNKNOWN_NAME, unknown_name(entry.name, node, kind))
    where = subject(declaration, indexes, node)
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


def subject(declaration: Declaration, indexes: tuple[int, ...], node: str) -> str:
    """'axis list, P-AXIS-00099 getriebe[0].kv of /x'."""
    return f"{declaration.list_name} list, {declaration.id} {declaration.list_style_name(indexes)} of /{node}"


def unknown_name(ros_name: str, node: str, kind: str) -> str:
    """Text for a name that the node's lists do not have, with the nearest one, or the nodes that have it."""
    lists = catalogue()
    key, _ = split_indexes(ros_name)
    text = f"{kind} /{node} has no parameter {shown(ros_name)}"
    owners = [other for other, keys in lists.by_key.items() if key in keys]
    if owners:
        declaration = lists.by_key[owners[0]][key]
        return f"{text}, {declaration.id} belongs to {' and '.join(owners)} nodes"
    return f"{text}{nearest(lists, key, kind)}"


def nearest(lists: Catalogue, key: str, kind: str) -> str:
    known = lists.by_key[kind]
    names = {name: entry for entry in known.values() for name in (entry.key, *entry.misprints)}
    close = difflib.get_close_matches(key[:100], names, n=1, cutoff=0.6)
    if not close:
        return ""
    declaration = names[close[0]]
    return f", did you mean {declaration.name} ({declaration.id})?"


def suggestion(name: str, names: Mapping[str, str]) -> str:
    close = difflib.get_close_matches(name[:100], names, n=1, cutoff=0.5)
    return f", did you mean /{close[0]}?" if close else ""


def number_units(sets: dict[str, ParameterSet]) -> None:
    """Gives units without P-AXIS-00016 the smallest free logical axis numbers, axes first."""
    axes = [parameters for parameters in sets.values() if parameters.kind in ("axis", "spindle")]
    taken = {parameters.value("P-AXIS-00016") for parameters in axes if parameters.is_given("P-AXIS-00016")}
    free = (number for number in range(1, 65535) if number not in taken)
    for parameters in axes:
        if not parameters.is_given("P-AXIS-00016"):
            implied = {**parameters.implied, "kopf.achs_nr": next(free)}
            sets[parameters.node] = ParameterSet(
                parameters.node, parameters.kind, parameters.place, parameters.given, implied, parameters.invalid
            )
