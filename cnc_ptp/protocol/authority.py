"""Which commands a unit takes from a source that the machine file closes it to: those that bring it to rest."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any, Final

from cnc_ptp.errors import CncError
from cnc_ptp.parameters.declare.declarations import catalogue
from cnc_ptp.parameters.view.authority import CLOSED_TO
from cnc_ptp.protocol.blocks import Command
from cnc_ptp.protocol.commands import INTERNAL

NOT_AUTHORISED: Final = 26218
STOPS: Final[dict[str, frozenset[str]]] = {
    "axis": frozenset({"stop", "halt", "emergency_stop", "halt_superimposed", "compensation_stop"}),
    "spindle": frozenset({"stop"}),
    "channel": frozenset({"reset"}),
    "plc": frozenset(),
}
"""Kind of unit -> commands that bring something to rest, whatever their arguments."""
STOP_BLOCKS: Final = frozenset({"MC_Stop", "MC_Halt"})
"""The function blocks that do so."""
HOLDS: Final = frozenset({"feed_hold", "emergency_stop"})
"""Commands, and control units of the PLC, that hold something while they are on."""
ANSWERS: Final = frozenset({"acknowledge", "gear_changed"})
"""What a unit waits for: no command of its own."""
ALWAYS: Final = (INTERNAL - {"begin_trajectory", "follow_path"}) | ANSWERS | {"stop_all", "hold_stop"}
"""Commands that are open to everybody: what machine and run need of each other, and stops."""


def is_open(kind: str, command: str, arguments: Mapping[str, Any]) -> bool:
    """Every source may give it, because it brings to rest, or moves nothing."""
    if command in ALWAYS or command in STOPS[kind]:
        return True
    if command == "overlay":
        return arguments.get("control_unit") in HOLDS and holds_or_gives_back(arguments)
    if command == "power":
        return arguments.get("enabled") is False
    if command == "jog":
        return arguments.get("velocity") == 0.0
    return command in HOLDS and arguments.get("enabled") is True


def holds_or_gives_back(overlay: Mapping[str, Any]) -> bool:
    """Of a control unit that holds. An overlay that does not hold would take away the hold of somebody else."""
    return overlay.get("enabled") is False or overlay.get("value") == 1.0


def closed_to(
    kind: str, unit: str, command: str, arguments: Mapping[str, Any], *, source: str, closed: Collection[str]
) -> CncError | None:
    """Why a unit does not take a command from `source`; None if it does. `closed`: sources that it is closed to."""
    if source not in closed or is_open(kind, command, arguments):
        return None
    parameter = catalogue().by_id[CLOSED_TO[source]]
    reason = f"the machine file closes it to {source} ({parameter.name}, {parameter.id})"
    where = f"{kind} {unit}: {command} refused"
    return CncError(NOT_AUTHORISED, reason, "nothing was changed", where=where)


def require_axes_open(command: Command, closed: Mapping[str, Collection[str]], source: str) -> None:
    """A trajectory is a command to the PLC; whoever gives it has to be allowed to command each of its axes.

    `closed`: unit -> sources that it is closed to. Raises CncError 26218.
    """
    if command.command != "follow_trajectory":
        return
    for axis in command.arguments.get("axes", ()):
        error = closed_to("axis", str(axis), command.command, {}, source=source, closed=closed.get(str(axis), ()))
        if error is not None:
            where = f"plc {command.target}: {command.command} refused"
            raise CncError(NOT_AUTHORISED, f"axis {axis}: {error.reason}", error.effect, where=where)
