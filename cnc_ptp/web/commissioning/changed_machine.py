"""A machine file with other values, beside the one that it was made of."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import yaml

from cnc_ptp.errors import CncError
from cnc_ptp.parameters import complete_text, load_machine
from cnc_ptp.web.numbers import MACHINE_FILE_EXISTS

NAME = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_.-]{0,79}\.yaml")
HEAD = "# Made of {name} by the web face, with values that were identified. Comments are in that file.\n"
NOT_WRITTEN = "nothing was written"


def write_changed(machine: Path, values: str, name: str) -> Path:
    """`values`: lines of a machine file; `name` of the new file.

    Raises CncError 26254 for a name that is not possible or taken, ParameterError for values that the machine cannot
    have.
    """
    if NAME.fullmatch(name) is None:
        reason = f"'{name[:80]}' is no name of a machine file: letters, digits, _ . - and .yaml"
        raise CncError(MACHINE_FILE_EXISTS, reason, NOT_WRITTEN)
    file = machine.resolve().parent / name
    text = HEAD.format(name=machine.name) + changed_text(machine.read_text(encoding="utf-8"), values)
    load_machine(complete_text(text, str(file)), str(file))
    try:
        with file.open("x", encoding="utf-8") as stream:
            stream.write(text)
    except FileExistsError:
        raise CncError(MACHINE_FILE_EXISTS, f"{name} is there already", f"{NOT_WRITTEN}; give another name") from None
    except OSError as error:
        raise CncError(MACHINE_FILE_EXISTS, f"{name} cannot be written: {error.strerror}", NOT_WRITTEN) from None
    return file


def changed_text(text: str, values: str) -> str:
    return yaml.safe_dump(merged(yaml.safe_load(text), yaml.safe_load(values)), sort_keys=False, allow_unicode=True)


def merged(old: Any, new: Any) -> Any:
    """The values of `new`, and those of `old` where it has none."""
    if not isinstance(old, dict) or not isinstance(new, dict):
        return new
    keys = [*old, *(key for key in new if key not in old)]
    return {key: merged(old.get(key), new[key]) if key in new else old[key] for key in keys}
