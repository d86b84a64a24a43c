"""Buffer modes of PLCopen: when a command acts that meets an active one."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from cnc_ptp.protocol.commands import COMMANDS
from cnc_ptp.protocol.unit import PLC

ABORTING = "aborting"
BUFFERED = "buffered"
SPINDLE_MODES: Mapping[str, Mapping[str, Any]] = {ABORTING: {}, BUFFERED: {"source": PLC}}
"""A spindle carries out the commands of the source `plc` one after the other, all others at once."""


def mode_arguments(kind: str, command: str, mode: str) -> Mapping[str, Any] | None:
    """The mode as arguments of a command; None where a spindle does not have it."""
    if kind == "spindle":
        return SPINDLE_MODES.get(mode)
    if mode == ABORTING and "buffer_mode" not in COMMANDS[kind].get(command, {}):
        return {}
    return {"buffer_mode": mode}
