"""Commands as people type them: `move_absolute target=100 velocity=50`, `mdi "G1 X10 F500"`, `axes=[x, y]`."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import yaml

from cnc_ptp.errors import CncError
from cnc_ptp.plc.scenario import SWITCH_WORDS, read_value
from cnc_ptp.protocol.commands import (
    BAD_ARGUMENT,
    COMMANDS,
    Argument,
    Arguments,
    check_arguments,
    check_sendable,
    current_names,
)

SWITCHES = SWITCH_WORDS | {"true": True, "false": False}
PATHS = ("file", "program")
"""Arguments that name a file; the node that reads it has another working directory."""


def read_arguments(kind: str, unit: str, command: str, words: Sequence[str], known: Arguments) -> dict[str, Any]:
    """The arguments that the `words` give, checked against `known`. Raises CncError 22001.

    A word without a name goes to the one argument that the command must have.
    """
    where = f"{kind} {unit}".rstrip() + f": {command} refused"
    texts: dict[str, str] = {}
    for word in words:
        name, text = _split(where, word, known)
        if name in texts:
            raise CncError(BAD_ARGUMENT, f"argument '{name}' is given twice", "nothing was sent", where=where)
        texts[name] = text
    texts = current_names(kind, command, texts) if kind in COMMANDS else texts
    arguments = {name: _value(name, text, known[name]) if name in known else text for name, text in texts.items()}
    check_arguments(where, known, arguments)
    check_sendable(where, known, arguments)
    return arguments


def _split(where: str, word: str, known: Arguments) -> tuple[str, str]:
    """Name and text of a word."""
    name, separator, text = word.partition("=")
    if separator and re.fullmatch(r"[a-z_][a-z_0-9]*", name):
        return name, text
    required = [name for name, argument in known.items() if argument.required]
    if len(required) != 1:
        names = ", ".join(known) or "none"
        reason = f"'{word}' has no name; write name=value. Known: {names}"
        raise CncError(BAD_ARGUMENT, reason, "nothing was sent", where=where)
    return required[0], word


def _value(name: str, text: str, argument: Argument) -> Any:
    """The text as what the argument is; unchanged if it is no such thing, for the check to report."""
    try:
        if argument.kind == "number":
            return float(text)
        if argument.kind == "integer":
            return int(text, 0)
        if argument.kind in ("rows", "files"):
            return read_value(text)
    except (ValueError, yaml.YAMLError):
        return text
    if argument.kind == "switch":
        return SWITCHES.get(text.lower(), text)
    return str(Path(text).absolute()) if name in PATHS else text
