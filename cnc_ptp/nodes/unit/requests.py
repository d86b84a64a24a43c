"""Service requests and action goals as arguments of commands."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

from cnc_ptp.protocol.commands import NEEDS_SOMETHING, Argument, Arguments

RUN_OVER = 26115
NOT_BEGUN = 26207
NOT_GIVEN = 1e300
"""Default of the fields that would move something as 0: an empty request is refused, or means none."""


def given_arguments(known: Arguments, request: Any) -> dict[str, Any]:
    """The fields of a request without those that are left out: NaN, no text, and 0 where it must be above 0.

    A field `has_<name>` says whether `<name>` counts.
    """
    given = {name: plain(known[name], getattr(request, name)) for name in known if hasattr(request, name)}
    return {
        name: value
        for name, value in given.items()
        if getattr(request, f"has_{name}", True) and not _is_left_out(known[name], value)
    }


def plain(argument: Argument, value: Any) -> Any:
    """Arrays of a message as the lists of a command; a TrajectoryPoint as its row."""
    return [row_of(each) for each in value] if argument.kind == "rows" and isinstance(value, Iterable) else value


def row_of(value: Any) -> Any:
    """Time, positions and what is given of velocities and accelerations; other values as they are."""
    if not hasattr(value, "positions"):
        return value
    given = [[*each] for each in (value.velocities, value.accelerations)]
    return [value.time, [*value.positions], *(given if given[1] else given[:1] if given[0] else [])]


def objection(command: str, known: Arguments, request: Any) -> str:
    """Why a request cannot be meant so; empty if it can."""
    if command in NEEDS_SOMETHING and not given_arguments(known, request):
        return f"nothing is given; {NEEDS_SOMETHING[command]}"
    return contradiction(known, request)


def contradiction(known: Arguments, request: Any) -> str:
    """The contradiction between a field `has_<name>` of a request and <name>; empty if there is none."""
    for name in known:
        says = getattr(request, f"has_{name}", None)
        if says is None:
            continue
        value = getattr(request, name)
        if says and _is_left_out(known[name], value):
            return f"has_{name} is true and {name} is not given"
        if not says and known[name].kind != "switch" and not _is_left_out(known[name], value):
            return f"{name} = {value} is given and has_{name} is false"
    return ""


def _is_left_out(argument: Argument, value: Any) -> bool:
    if value == NOT_GIVEN:
        return True
    if argument.required:
        return False
    if isinstance(value, (str, list)):
        return not value
    return (argument.positive and value == 0) or (isinstance(value, float) and math.isnan(value))
