"""The arguments of records: anybody on the graph may publish one."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from cnc_ptp.plc.program.references import WRITE_PARAMETER
from cnc_ptp.protocol.blocks import CommandRecord, arguments_of


def record_arguments(record: CommandRecord) -> Mapping[str, Any]:
    """By name; none where they are no JSON object."""
    if not isinstance(record.arguments, str):
        return record.arguments
    try:
        return arguments_of(record.arguments)
    except (ValueError, RecursionError):
        return {}


def written_parameter(record: CommandRecord) -> tuple[str, float | str | bool] | None:
    """Name and value of a parameter that a record says was written; None for any other record."""
    if record.command != WRITE_PARAMETER or not record.accepted:
        return None
    given = record_arguments(record)
    name, value = given.get("parameter"), given.get("value")
    return (name, value) if isinstance(name, str) and isinstance(value, (int, float, str)) else None
