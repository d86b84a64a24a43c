"""The arguments of records: anybody on the graph may publish one."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from cnc_ptp.protocol.blocks import CommandRecord, arguments_of


def record_arguments(record: CommandRecord) -> Mapping[str, Any]:
    """By name; none where they are no JSON object."""
    if not isinstance(record.arguments, str):
        return record.arguments
    try:
        return arguments_of(record.arguments)
    except (ValueError, RecursionError):
        return {}
