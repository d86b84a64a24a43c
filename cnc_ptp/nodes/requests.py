"""Service requests and action goals as arguments of commands."""

from __future__ import annotations

import math
from typing import Any

from cnc_ptp.machine.commands import Argument, Arguments


def given_arguments(known: Arguments, request: Any) -> dict[str, Any]:
    """The fields of a request without those that are left out: NaN, no text, and 0 where only more makes sense."""
    given = {name: getattr(request, name) for name in known if hasattr(request, name)}
    return {name: value for name, value in given.items() if not _is_left_out(known[name], value)}


def _is_left_out(argument: Argument, value: Any) -> bool:
    if argument.required:
        return False
    if isinstance(value, str):
        return value == ""
    return isinstance(value, float) and (math.isnan(value) or (argument.positive and value == 0.0))
