"""Machine file -> MachineParameters: read, check each value and values against each other, or report all problems."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from cnc_ptp.parameters import errors
from cnc_ptp.parameters.check.machine_checks import check_machine
from cnc_ptp.parameters.check.machine_notices import machine_notices, notices_without_view
from cnc_ptp.parameters.declare import ids
from cnc_ptp.parameters.declare.declarations import ParameterValue
from cnc_ptp.parameters.errors import ParameterError, Place, Problem
from cnc_ptp.parameters.read.machine_sections import read_parameters
from cnc_ptp.parameters.read.messages import Notice
from cnc_ptp.parameters.read.named_files import named_files, split_files, with_files
from cnc_ptp.parameters.read.offset_files import with_offsets
from cnc_ptp.parameters.read.parameter_set import Given, ParameterSet
from cnc_ptp.parameters.read.tool_file import with_tools
from cnc_ptp.parameters.view.channel_members import Sets, axis_entries, rotary_axes
from cnc_ptp.parameters.view.machine_view import MachineParameters, machine_view

Changes = Mapping[str, Mapping[str, ParameterValue]]
NO_CHANGES: Changes = {}


def read_machine(path: str | Path) -> MachineParameters:
    """The machine of a file; raises ParameterError (25017 when it or a file that it names cannot be read)."""
    return load_machine(machine_text(path), str(path))


def machine_text(path: str | Path) -> str:
    """The text of a machine file with those of the files that it names: all that makes the machine.

    Raises ParameterError 25017 for one that cannot be read.
    """
    file = str(path)
    return complete_text(read_text(Path(path), Place(file, 1, 1), "machine file"), file)


def complete_text(text: str, file: str) -> str:
    """As `machine_text`, of a machine file that was read already. Raises ParameterError 25017 for another file."""
    files = {
        named.name: read_text(Path(file).parent / named.name, named.place, f"{named.subject}: file {named.name}")
        for named in named_files(text, file)
    }
    return with_files(text, files)


def machine_files(path: str | Path) -> list[Path]:
    """The files that a machine file names, whether they are there or not; none if it cannot be read."""
    try:
        text = Path(path).read_text(encoding="utf-8")
    except (OSError, ValueError):
        return []
    return [Path(path).parent / named.name for named in named_files(text, str(path))]


def read_text(path: Path, place: Place, what: str) -> str:
    try:
        return path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError, ValueError) as error:
        reason = getattr(error, "strerror", None) or "it is not UTF-8 text"
        raise ParameterError([Problem(errors.UNREADABLE, place, f"{what} cannot be read, {reason}")]) from error


def load_machine(
    text: str, file: str, origin: Callable[[Place], Place] | None = None, changes: Changes = NO_CHANGES
) -> MachineParameters:
    """The machine that the text of `machine_text` describes; `file` is for messages. Raises ParameterError.

    `origin` gives the place that messages name instead of one in the text, if that was made of other files. `changes`:
    checked values by node and ROS name that count instead of those of the text.
    """
    text, files = split_files(text)
    machine, sets, problems = read_parameters(text, file)
    machine = changed_values(machine, changes.get("machine", {}))
    sets = {node: changed_values(parameters, changes.get(node, {})) for node, parameters in sets.items()}
    if origin:
        sets = {node: placed(parameters, origin) for node, parameters in sets.items()}
    for node, parameters in sets.items():
        if parameters.kind == "channel":
            sets[node] = with_tables(parameters, sets, files, problems)
    problems += check_machine(machine, sets)
    if problems:
        raise ParameterError(problems)
    return machine_view(machine, sets, tuple(machine_notices(machine, sets)), Path(file).parent)


def changed_values(parameters: ParameterSet, values: Mapping[str, ParameterValue]) -> ParameterSet:
    """The parameters with other values of some; their places stay those of the file."""
    given = dict(parameters.given)
    for name, value in values.items():
        given[name] = Given(value, given[name].place if name in given else parameters.place)
    return replace(parameters, given=given) if values else parameters


def placed(parameters: ParameterSet, origin: Callable[[Place], Place]) -> ParameterSet:
    """The parameters with the places where they come from."""
    given = {name: entry._replace(place=origin(entry.place)) for name, entry in parameters.given.items()}
    return replace(parameters, given=given, place=origin(parameters.place))


def examine_machine(text: str, file: str) -> tuple[list[Problem], list[Notice]]:
    """Everything that there is to say about a machine at once.

    Of a unit with problems, and of channels beside one, only the notices that need no other value. Raises
    ParameterError for a text that is no parameters file.
    """
    text, files = split_files(text)
    machine, sets, problems = read_parameters(text, file)
    for node, parameters in sets.items():
        if parameters.kind == "channel":
            sets[node] = with_tables(parameters, sets, files, problems)
    problems += check_machine(machine, sets)
    sound = sets if not problems else {node: axis for node, axis in sets.items() if is_sound(axis, sets, problems)}
    notices = list(machine_notices(machine, sound))
    for parameters in (sets[node] for node in sets if node not in sound):
        notices += notices_without_view(parameters, machine.kernel(ids.CYCLE_TIME_US))
    return sorted(problems, key=lambda problem: problem.place), notices


def is_sound(parameters: ParameterSet, sets: Sets, problems: Sequence[Problem]) -> bool:
    """An axis or spindle whose section has no problem in it; channels depend on all of them."""
    begins = sorted(other.place.line for other in sets.values() if other.place.line > parameters.place.line)
    end = begins[0] if begins else math.inf
    touched = any(parameters.place.line <= problem.place.line < end for problem in problems)
    return parameters.kind != "channel" and not touched


def with_tables(channel: ParameterSet, sets: Sets, files: Mapping[str, str], problems: list[Problem]) -> ParameterSet:
    """The channel with the zero offsets, clamp positions and tools of its files."""
    axes = [entry.name for entry in axis_entries(channel, sets)]
    channel = with_offsets(channel, axes, files, problems)
    return with_tools(channel, axes, rotary_axes(channel, sets), files, problems)
