"""Refusals by number and values: the texts themselves are tested in test/wording."""

from __future__ import annotations

from typing import Any

from cnc_ptp.protocol.blocks import CommandRecord

Refused = tuple[int, dict[str, Any]]


def refused(number: int, /, **values: Any) -> Refused:
    """What the bench is to say of a refusal with this number and all values of its text."""
    return number, values


def refusal_of(record: CommandRecord) -> Refused:
    assert not record.accepted
    return record.error_id, dict(record.values)


def attributes(thing: object) -> dict[str, Any]:
    """All that an object holds, also an object of a compiled class, which has no __dict__."""
    names = [name for name in dir(thing) if not name.startswith("__")]
    return {name: value for name in names if not callable(value := getattr(thing, name))}
