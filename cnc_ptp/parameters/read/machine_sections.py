"""The sections of a whole machine: the units that /machine lists, and the parameters of each."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

from cnc_ptp.errors import did_you_mean, nearest
from cnc_ptp.parameters import errors
from cnc_ptp.parameters.declare import ids
from cnc_ptp.parameters.errors import ParameterError, Place, Problem
from cnc_ptp.parameters.read.messages import problem
from cnc_ptp.parameters.read.parameter_set import ParameterSet
from cnc_ptp.parameters.read.sections import checked_section
from cnc_ptp.parameters.read.source import Section, read_sections
from cnc_ptp.parameters.read.values import shown

RESERVED_NAMES = ("machine", "plc", "clock", "recorder", "player", "events", "commands", "parameter_events", "rosout")


def read_parameters(text: str, file: str) -> tuple[ParameterSet, dict[str, ParameterSet], list[Problem]]:
    """The parameters of /machine, those of its units by node name, and what is wrong with their names and values.

    Raises ParameterError if the text is not a ROS parameters file, or has no section /machine.
    """
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
    return machine, sets, problems


def list_units(machine: ParameterSet, problems: list[Problem]) -> dict[str, str]:
    """Node name -> kind, as /machine lists them."""
    units: dict[str, str] = {}
    for number, kind in ((ids.CHANNELS, "channel"), (ids.AXES, "axis"), (ids.SPINDLES, "spindle")):
        for name in (name.lstrip("/") for name in machine.names(number)):
            trouble = name_trouble(name, units)
            if trouble:
                text = f"unit name {shown(name)} {trouble}"
                problems.append(problem(machine, errors.UNIT_NAME, number, (), text))
            else:
                units[name] = kind
    return units


def name_trouble(name: str, units: Mapping[str, str]) -> str:
    if name in units:
        return "is given twice"
    if name in RESERVED_NAMES:
        return "is taken by another node"
    if not (name.isascii() and name.isidentifier() and name == name.lower()):
        return "must be lower-case letters, digits and _, beginning with a letter"
    return ""


def sections_without_unit(sections: Sequence[Section], units: Mapping[str, str]) -> Iterator[Problem]:
    for section in sections:
        if section.node != "machine" and section.node not in units:
            known = ", ".join(f"/{name}" for name in units) or "none"
            text = f"section /{section.node} has no unit in /machine (units: {known})"
            close = [f"/{name}" for name in nearest(section.node, units, cutoff=0.5)]
            yield Problem(errors.NO_UNIT, section.place, text + did_you_mean(close))


def number_units(sets: dict[str, ParameterSet]) -> None:
    """Gives units without P-AXIS-00016 the smallest free logical axis numbers, axes first."""
    axes = [parameters for parameters in sets.values() if parameters.kind in ("axis", "spindle")]
    taken = {parameters.value(ids.KOPF_ACHS_NR) for parameters in axes if parameters.is_given(ids.KOPF_ACHS_NR)}
    free = (number for number in range(1, 65535) if number not in taken)
    for parameters in axes:
        if not parameters.is_given(ids.KOPF_ACHS_NR):
            implied = {**parameters.implied, "kopf.achs_nr": next(free)}
            sets[parameters.node] = replace(parameters, implied=implied)
