"""Other values of some parameters: named, checked, and written into the text of a machine."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import yaml

from cnc_ptp import yaml_text
from cnc_ptp.errors import CncError, nearest_name
from cnc_ptp.parameters.declare.declarations import Declaration, ParameterValue
from cnc_ptp.parameters.loader import Changes
from cnc_ptp.parameters.read.named_files import split_files, with_files
from cnc_ptp.parameters.read.source import Value
from cnc_ptp.parameters.read.values import BadValue, checked_value
from cnc_ptp.parameters.view.by_name import UNKNOWN_PARAMETER, parameter_by_name
from cnc_ptp.parameters.view.machine_view import MachineParameters
from cnc_ptp.yaml_text import WRITER

BAD_CHANGE = 26153


@dataclass(frozen=True, slots=True)
class ChosenParameter:
    """A parameter of a unit of a machine; `subject` names it in messages, `dimension` is that of its values."""

    unit: str
    ros_name: str
    declaration: Declaration
    subject: str
    dimension: str

    def checked(self, value: Value) -> ParameterValue:
        """A value in the type of the parameter. Raises BadValue beyond its limits."""
        return checked_value(self.declaration, value, self.dimension)


def choose_parameter(name: str, machine: MachineParameters) -> ChosenParameter | None:
    """That of `unit.parameter`, named as in machine files, in the lists or by its number; None for another form.

    Raises CncError 22169 for an unknown unit or parameter.
    """
    unit, dot, parameter = name.strip().removeprefix("/").partition(".")
    if not (dot and parameter):
        return None
    own = machine.sets.get(unit)
    if own is None:
        raise CncError(UNKNOWN_PARAMETER, f"the machine has no unit '{unit}'{nearest_name(unit, machine.sets)}")
    found = parameter_by_name(own, parameter)
    dimension = found.declaration.unit_for(own.axis_type)
    subject = found.declaration.subject(found.indexes, unit)
    return ChosenParameter(unit, found.ros_name, found.declaration, subject, dimension)


def read_changes(texts: Sequence[str], machine: MachineParameters) -> Changes:
    """Of `unit.parameter=value` each, as x.getriebe.0.kv=8000. Raises CncError 26153."""
    changes: dict[str, dict[str, ParameterValue]] = {}
    for text in texts:
        name, _, value = text.partition("=")
        try:
            parameter = choose_parameter(name, machine) if value.strip() else None
        except CncError as error:
            raise refused(text, f": {error.reason}") from None
        if parameter is None:
            raise refused(text, " is not of the form unit.parameter=value, as x.getriebe.0.kv=8000")
        try:
            checked, own = parameter.checked(read_value(value)), changes.setdefault(parameter.unit, {})
        except BadValue as error:
            raise refused(text, f": {parameter.subject}: {error.text}") from None
        if parameter.ros_name in own:
            raise refused(text, f": {parameter.subject} is given twice")
        own[parameter.ros_name] = checked
    return changes


def read_value(text: str) -> Any:
    """A number, or what a machine file would have; None for what neither is."""
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            continue
    try:
        return yaml_text.load(text)
    except yaml.YAMLError:
        return None


def refused(text: str, reason: str) -> CncError:
    return CncError(BAD_CHANGE, f"--set '{text}'{reason}", "nothing was computed")


def changed_text(text: str, changes: Changes) -> str:
    """The text of a machine from which `load_machine` makes what it makes of `text` with `changes`."""
    text, files = split_files(text)
    content = yaml_text.load(text)
    for unit, values in changes.items():
        section = content.get(f"/{unit}") or content[unit]
        for name, value in values.items():
            put(section.setdefault("ros__parameters", {}), name.split("."), value)
    return with_files(yaml.dump(content, Dumper=WRITER, sort_keys=False, allow_unicode=True), files)


def put(tree: dict[str, Any], steps: list[str], value: object) -> None:
    """Puts a value to the end of a path, wherever the file has the name in one piece or in several."""
    for length in range(len(steps), 0, -1):
        name = ".".join(steps[:length])
        key = next((key for key in tree if str(key) == name), None)
        if key is not None and length < len(steps) and isinstance(tree[key], dict):
            put(tree[key], steps[length:], value)
            return
        if key is not None and length == len(steps):
            tree[key] = value
            return
    tree[".".join(steps)] = value
