"""A machine file with other values of some parameters."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import yaml

from cnc_ptp.errors import CncError
from cnc_ptp.parameters.read.named_files import split_files, with_files
from cnc_ptp.yaml_text import PARSER, WRITER

BAD_CHANGE = 26153


def changed_text(text: str, changes: Sequence[str]) -> str:
    """The text of a machine with `changes`: unit.parameter=value each, as in x.getriebe.0.kv=8000.

    Names and values are checked when it is loaded. Raises CncError 26153 for another form and an unknown unit.
    """
    text, files = split_files(text)
    content = yaml.load(text, PARSER)
    for change in changes:
        name, equals, value = change.partition("=")
        unit, dot, parameter = name.strip().partition(".")
        if not (equals and dot and parameter and value.strip()):
            raise refused(change, "is not of the form unit.parameter=value, as x.getriebe.0.kv=8000")
        section = content.get(f"/{unit}") or content.get(unit)
        if not isinstance(section, dict):
            known = ", ".join(str(each).removeprefix("/") for each in content)
            raise refused(change, f"names the unit '{unit}', which the machine does not have. Known: {known}")
        put(section.setdefault("ros__parameters", {}), parameter.split("."), yaml.load(value, PARSER))
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


def refused(change: str, reason: str) -> CncError:
    return CncError(BAD_CHANGE, f"--set '{change}' {reason}", "nothing was computed")
