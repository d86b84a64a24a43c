"""PLC overlay: an external PLC takes values of a unit over from everybody else (services, topics, programs, scenario).

While the PLC serves a control unit (`enable_w`), its command acts; what others ask for is shown as `request`,
remembered, and acts again when the PLC gives the control unit back. Source: public HLI documentation, control unit.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from cnc_ptp.protocol.blocks import ControlUnitState
from cnc_ptp.protocol.control_units import CONTROL_UNITS, SINGLE_BLOCK_MODES, ControlUnit

HELD_BY_PLC = 26160
"""Warning: what was asked for waits until the PLC gives the control unit back."""
SERVED_BY_PLC = 26161
"""Refusal: only the PLC carries this out now."""
TAKEN_FROM_PLC = 26180
"""Warning: what was asked for acts, instead of what a PLC that has fallen silent had commanded."""
Kept = tuple[float | None, str, bool]
"""What a PLC commands of a control unit (None: it does not serve it), its name, whether it has fallen silent."""


class Overlay:
    """The control units of one unit: what others ask for, what the PLC commands, who it is."""

    def __init__(self, kind: str) -> None:
        self._units = {unit.name: unit for unit in CONTROL_UNITS[kind]}
        self._levels = {unit.name: unit.initial for unit in CONTROL_UNITS[kind] if not unit.edge}
        """What others ask for."""
        self._commands: dict[str, float] = {}
        """What the PLC commands, by the control units that it serves."""
        self._holders: dict[str, str] = {}
        self._silent: set[str] = set()
        """Control units that a PLC had served until it fell silent."""
        self._pending: set[str] = set()
        """Edges that others have asked for while the PLC serves them."""
        self._done = {unit.name: 0 for unit in CONTROL_UNITS[kind] if unit.edge}
        """How often the PLC had an edge carried out."""
        self._changed = set(self._units)
        self.full_override = 100.0
        """What acts while `override_valid` is off."""

    def __contains__(self, name: object) -> bool:
        return name in self._units

    def __getitem__(self, name: str) -> ControlUnit:
        return self._units[name]

    @property
    def names(self) -> list[str]:
        return list(self._units)

    def begin(self, name: str, value: float) -> None:
        """What acts at the start."""
        self._levels[name] = value

    def value(self, name: str) -> float:
        """What acts now."""
        asked, command = self._levels.get(name, 0.0), self._commands.get(name)
        if command is None:
            return asked
        return max(asked, command) if self._units[name].either else command

    def holder(self, name: str) -> str | None:
        """The PLC that serves a control unit, None if none does."""
        return self._holders.get(name)

    def is_silent(self, name: str) -> bool:
        """The PLC that had served a control unit has fallen silent; its value holds."""
        return name in self._silent

    # what others ask for

    def asked(self, command: str, arguments: Mapping[str, Any]) -> dict[str, float]:
        """The control units of which a command of others changes the request; empty for any other command."""
        if command == "single_block":
            return {"single_block": float(SINGLE_BLOCK_MODES.index(mode_of(arguments)))}
        if command == "block_skip":
            return {"block_skip": self._levels_skipped(arguments)}
        return {
            unit.name: float(arguments[argument])
            for unit in self._units.values()
            for by, _, argument in [unit.asked_by.partition(".")]
            if by == command and argument in arguments
        }

    def _levels_skipped(self, arguments: Mapping[str, Any]) -> float:
        bit, mask = 1 << arguments.get("level", 1) - 1, int(self._levels["block_skip"])
        return float(mask | bit if arguments["enabled"] else mask & ~bit)

    def ask(self, requests: Mapping[str, float]) -> dict[str, float]:
        """Remembers what others ask for; what they have asked for before."""
        before = {name: self._levels[name] for name in requests}
        self._levels.update(requests)
        self._changed.update(requests)
        return before

    def served_edge(self, command: str) -> ControlUnit | None:
        """The control unit that the PLC serves, for a command that is one of its edges."""
        unit = self._units.get(command)
        return unit if unit is not None and unit.edge and command in self._holders else None

    def note_request(self, name: str) -> None:
        """Somebody has asked for an edge that the PLC serves."""
        self._pending.add(name)
        self._changed.add(name)

    def taken_back(self, requests: Mapping[str, float]) -> list[str]:
        """The control units that others take back with their requests from a PLC that has fallen silent.

        Also those that only a PLC gives and that have a part in the same command, but nothing that holds back.
        """
        commands = {self._units[name].command for name in requests}
        return [
            name
            for name in self._units
            if name in self._silent
            and (name in requests or not self._units[name].asked_by)
            and self._units[name].command in commands
            and self._commands[name] != self._units[name].holds_back
        ]

    # what the PLC does

    def serve(self, name: str, command: float, holder: str, *, silent: bool = False) -> Kept:
        """The PLC serves a control unit from now on, with this command; what was before, for `restore`.

        `silent`: it has fallen silent; the command holds until others ask for another one.
        """
        before = self._kept(name)
        self._commands[name], self._holders[name] = command, holder
        (self._silent.add if silent else self._silent.discard)(name)
        self._changed.add(name)
        return before

    def give_back(self, name: str) -> Kept:
        """What others ask for acts again; edges that they have asked for are forgotten."""
        before = self._kept(name)
        self._commands.pop(name, None)
        self._holders.pop(name, None)
        self._silent.discard(name)
        self._pending.discard(name)
        self._changed.add(name)
        return before

    def _kept(self, name: str) -> Kept:
        return self._commands.get(name), self._holders.get(name, ""), name in self._silent

    def restore(self, name: str, before: Kept) -> None:
        command, holder, silent = before
        if command is None:
            self.give_back(name)
        else:
            self.serve(name, command, holder, silent=silent)

    def carried_out(self, name: str) -> None:
        """An edge of the PLC."""
        self._done[name] += 1
        self._pending.discard(name)
        self._changed.add(name)

    # what acts

    def arguments(self, command: str) -> dict[str, Any]:
        """The arguments with which a command carries out what acts now."""
        if command == "set_override":
            return {"percent": self.value("override") if self.value("override_valid") else self.full_override}
        if command == "power":
            return {"enabled": bool(self.value("controller_enable") and self.value("drive_ready"))}
        if command == "set_feed_release":
            runs = not self.value("feed_hold")
            released = {side: self.value(f"feed_enable_{side}") for side in ("forward", "backward")}
            return {side: bool(runs and value) for side, value in released.items()}
        if command == "single_block":
            mode = SINGLE_BLOCK_MODES[int(self.value(command))]
            return {"enabled": True, "mode": mode} if mode else {"enabled": False}
        if command == "block_skip":
            return {"levels": int(self.value(command))}
        return {"enabled": bool(self.value("emergency_stop" if command == "set_emergency_stop" else command))}

    def news(self) -> list[ControlUnitState]:
        """The control units of which anything has changed since the last call, in the order of the table."""
        if not self._changed:
            return []
        changed, self._changed = self._changed, set()
        return [self._state(name) for name in self._units if name in changed]

    def _state(self, name: str) -> ControlUnitState:
        holder = self._holders.get(name)
        if self._units[name].edge:
            request, state = float(name in self._pending), float(self._done[name])
        else:
            request, state = self._levels[name], self.value(name)
        return ControlUnitState(name, holder is not None, request, state, holder or "")


def mode_of(arguments: Mapping[str, Any]) -> str:
    """The mode that a command `single_block` asks for, empty for none."""
    return str(arguments.get("mode", "block")) if arguments["enabled"] else ""
