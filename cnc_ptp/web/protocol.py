"""Messages between a page and the server (docs/web.md has the table)."""

from __future__ import annotations

import json
from collections.abc import Mapping
from math import isfinite
from typing import Any

from cnc_ptp.catalogue import entry
from cnc_ptp.errors import CncError
from cnc_ptp.web.numbers import BAD_MESSAGE

VERSION = 1
"""Of the protocol, in `hello`."""
LARGEST_MESSAGE = 1 << 20
"""Bytes of a message of a page."""
KINDS: Mapping[str, type | tuple[type, ...]] = {"text": str, "number": (int, float), "object": dict, "list": list}
NOTHING = "nothing was done"
SHOWN = 40
"""Characters of a wrong message that an error shows."""

Message = dict[str, Any]


def read_message(text: str) -> Message:
    """A message of a page: a JSON object with a type. Raises CncError 26233."""
    message = read_body(text)
    if not isinstance(message.get("type"), str):
        raise CncError(BAD_MESSAGE, f"message {text[:SHOWN]!r} has no type", NOTHING)
    return message


def read_body(text: str | bytes) -> Message:
    """A JSON object. Raises CncError 26233."""
    try:
        message = json.loads(text, parse_constant=refuse_constant)
    except (ValueError, RecursionError):
        raise CncError(BAD_MESSAGE, f"message {begin_of(text)!r} is not JSON", NOTHING) from None
    if not isinstance(message, dict):
        raise CncError(BAD_MESSAGE, f"message {begin_of(text)!r} is not an object", NOTHING)
    return message


def begin_of(text: str | bytes) -> str:
    return (text if isinstance(text, str) else text.decode(errors="replace"))[:SHOWN]


def refuse_constant(name: str) -> None:
    """NaN and Infinity are no JSON."""
    raise ValueError(name)


def field(message: Message, name: str, kind: str, default: Any = ...) -> Any:
    """A field of a message; `kind` of KINDS, or integer or switch. Raises CncError 26233."""
    value = message.get(name)
    if value is None and default is not ...:
        return default
    if value is None:
        raise CncError(BAD_MESSAGE, f"{message['type']}: {name} is missing", NOTHING)
    if not is_of_kind(value, kind):
        article = "an" if kind in ("object", "integer") else "a"
        raise CncError(BAD_MESSAGE, f"{message['type']}: {name} = {str(value)[:40]!r} is not {article} {kind}", NOTHING)
    return float(value) if kind == "number" else value  # JSON of a browser has 5 for 5.0, of which a ROS message dies


def is_of_kind(value: Any, kind: str) -> bool:
    if kind == "switch" or isinstance(value, bool):
        return kind == "switch" and isinstance(value, bool)
    if kind == "integer":
        return isinstance(value, int)
    if kind == "number":
        return isinstance(value, int | float) and abs(value) < 1e300 and isfinite(value)
    return isinstance(value, KINDS[kind])


def error_fields(error: CncError) -> Message:
    """What a page shows of an error: number, text, and cause and remedy of the catalogue."""
    return {**number_fields(error.number), "text": error.message}


def number_fields(number: int) -> Message:
    """Number, cause and remedy; the last two are empty for a number that the catalogue does not have."""
    known = entry(number) if number else None
    return {"number": number, "cause": known.cause if known else "", "remedy": known.remedy if known else ""}


def answer(message: Message, **fields: Any) -> Message:
    """A good answer to a message with an `id`."""
    return {"type": "answer", "id": message.get("id"), "ok": True, **fields}


def refusal(message: Message, error: CncError) -> Message:
    return {"type": "answer", "id": message.get("id"), "ok": False, **error_fields(error)}


def frame(message: Mapping[str, Any]) -> str:
    """As it is sent, in ASCII: half a character of a page cannot be sent otherwise. NaN and Infinity are null."""
    try:
        return json.dumps(message, separators=(",", ":"), allow_nan=False)
    except ValueError:
        return json.dumps(without_nan(message), separators=(",", ":"))


def without_nan(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {name: without_nan(each) for name, each in value.items()}
    if isinstance(value, list | tuple):
        return [without_nan(each) for each in value]
    return None if isinstance(value, float) and not isfinite(value) else value


def difference(now: Mapping[str, Mapping[str, Any]], before: Mapping[str, Mapping[str, Any]]) -> Message:
    """The fields of `now` that are not as in `before`, group by group."""
    changes = {
        name: {field: value for field, value in fields.items() if before.get(name, {}).get(field, ...) != value}
        for name, fields in now.items()
    }
    return {name: fields for name, fields in changes.items() if fields}
