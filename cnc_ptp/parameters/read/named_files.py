"""Files that a machine file names: zero offsets, clamp positions, tools; their names are relative to the machine file.

Their texts stand behind that of the machine file, each behind a line that names it, so that one text holds all that a
recording needs.
"""

import re
from collections.abc import Mapping
from typing import Final, NamedTuple

from cnc_ptp.parameters import errors
from cnc_ptp.parameters.declare import ids
from cnc_ptp.parameters.declare.declarations import Declaration, catalogue
from cnc_ptp.parameters.errors import Place, Problem
from cnc_ptp.parameters.read.messages import problem
from cnc_ptp.parameters.read.parameter_set import ParameterSet
from cnc_ptp.parameters.read.source import read_sections

PARAMETERS: Final = (ids.WERKZ_DATA, ids.NULLP_DATA, ids.PZV_DATA)
"""Those that name a file."""
_BEGIN = re.compile(r"^--- # file of the machine: (.+)\n", re.MULTILINE)


class NamedFile(NamedTuple):
    """A file that a machine file names, and where; `subject`: the parameter, for errors."""

    name: str
    place: Place
    subject: str


def named_files(text: str, file: str) -> list[NamedFile]:
    """The files that the text of a machine file names and does not hold yet."""
    declared = {catalogue().by_id[number].key: catalogue().by_id[number] for number in PARAMETERS}
    if not any(key in text for key in declared) or _BEGIN.search(text):
        return []
    sections, _ = read_sections(text, file)
    return [
        NamedFile(entry.value, entry.place, declared[entry.name].subject((), section.node))
        for section in sections
        for entry in section.entries
        if entry.name in declared and isinstance(entry.value, str) and entry.value
    ]


def with_files(text: str, files: Mapping[str, str]) -> str:
    """The text of a machine file with those of the files that it names."""
    parts = [text if text.endswith("\n") or not files else f"{text}\n"]
    parts += [f"--- # file of the machine: {name}\n{content}\n" for name, content in files.items()]
    return "".join(parts)


def split_files(text: str) -> tuple[str, dict[str, str]]:
    """The text of the machine file alone, and by name those of its files."""
    machine, *rest = _BEGIN.split(text)
    return machine, {name: content.removesuffix("\n") for name, content in zip(rest[::2], rest[1::2], strict=True)}


def file_text(
    channel: ParameterSet, parameter: str, files: Mapping[str, str], problems: list[Problem]
) -> tuple[str, str] | None:
    """Name and text of the file that a parameter of a channel names; None without one."""
    name = channel.text(parameter)
    if name and name not in files:
        problems.append(problem(channel, errors.UNREADABLE, parameter, (), f"the text of file {name} is missing"))
        return None
    return (name, files[name]) if name else None


def given_before(
    channel: ParameterSet, declaration: Declaration, indexes: tuple[int, ...], place: Place
) -> Problem | None:
    """What is wrong with a value in a file when the machine file gives it, too."""
    other = channel.given.get(declaration.ros_name(indexes))
    if other is None:
        return None
    text = f"{declaration.subject(indexes, channel.node)}: is given twice, also in {other.place}"
    return Problem(errors.DUPLICATE_KEY, place, text)
