"""Who may give which command: roles, and commands that no page may give."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from cnc_ptp.errors import CncError, nearest_name
from cnc_ptp.protocol.authority import HOLDS, STOPS
from cnc_ptp.protocol.commands import COMMANDS, INTERNAL, OF_CHANNELS
from cnc_ptp.web.numbers import NOT_FROM_PAGES, WRONG_ROLE
from cnc_ptp.web.protocol import NOTHING

ROLES = ("viewer", "operator", "commissioner")
"""From the least to the most that somebody may do."""
NOT_FROM_PAGE_ARGUMENTS = frozenset({"file", "files", "source"}) | OF_CHANNELS
"""The server reads no file of its computer for a page: programs come from the program folder. And no page speaks for a
channel or the plc."""
OF_OTHERS: Mapping[str, frozenset[str]] = {
    "axis": frozenset({"jog", "overlay", "external_setpoints"}),
    "spindle": frozenset({"overlay"}),
    "channel": frozenset({"load", "overlay"}),
    "plc": frozenset({"serve", "set_life_sign", "stop_all", "abort"}),
}
"""Commands that have a message of their own (jog, load), or belong to the PLC and to whoever has started the run."""
OF_COMMISSIONERS: Mapping[str, frozenset[str]] = {
    "axis": frozenset(
        {
            "write_parameter",
            "write_drive_parameter",
            "read_drive_parameter",
            "set_position",
            "set_override_type",
            "set_feedforward",
            "reset_feedforward",
            "set_friction_compensation",
            "compensation_start",
            "external_enable",
            "external_disable",
            "set_feed_release",
        }
    ),
    "spindle": frozenset({"set_feedforward", "reset_feedforward", "set_limits", "reset_limits"}),
    "channel": frozenset(),
    "plc": frozenset({"set_input"}),
}


def refused_from_pages(kind: str, command: str) -> bool:
    return command in INTERNAL or command in OF_OTHERS[kind]


def is_stop(kind: str, command: str, arguments: Mapping[str, Any]) -> bool:
    """It stops something, or holds it: permitted to every operator, also without the command."""
    return command in STOPS[kind] or (command in HOLDS and arguments.get("enabled") is True)


def require_page_command(kind: str, unit: str, command: str, arguments: Mapping[str, Any]) -> None:
    """Raises CncError 26249 for a command, or an argument, that no page may give."""
    where = f"{kind} {unit}: {command} refused"
    if command in COMMANDS[kind] and refused_from_pages(kind, command):
        raise CncError(NOT_FROM_PAGES, "pages do not give this command", NOTHING, where=where)
    for name in NOT_FROM_PAGE_ARGUMENTS.intersection(arguments):
        raise CncError(NOT_FROM_PAGES, f"pages do not give the argument '{name}'", NOTHING, where=where)


def role_for(kind: str, command: str) -> str:
    """The least role that may give a command."""
    return "commissioner" if command in OF_COMMISSIONERS[kind] else "operator"


def require_role(what: str, user: str, role: str, needed: str) -> None:
    """Raises CncError 26235."""
    if ROLES.index(role) < ROLES.index(needed):
        reason = f"{what}: {user} is {role}; it takes the role {needed}"
        raise CncError(WRONG_ROLE, reason, NOTHING)


def require_known_role(role: str) -> None:
    """Raises ValueError for a role that there is not."""
    if role not in ROLES:
        raise ValueError(f"'{role}' is no role{nearest_name(role, ROLES)}; roles: {', '.join(ROLES)}")
