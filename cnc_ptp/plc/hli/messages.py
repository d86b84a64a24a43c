"""A control message of the HLI as the PLC unit reads it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

from cnc_ptp.parameters.list_units import DEG_S_PER_RPM
from cnc_ptp.plc.hli.external_commands import STOPS
from cnc_ptp.protocol.control_units import CONTROL_UNITS, EMERGENCY_STOP

HLI_UNITS = 1
"""`units` of a control message: integers of the HLI."""
PER_PERCENT = 10.0
PER_LENGTH = 1e4
"""0.1 µm per mm, 0.0001 ° per °."""
PER_SPEED = 1e3
"""µm/s per mm/s, 0.001 °/s per °/s."""

PER_UNIT: Mapping[str, float] = {
    "position": PER_LENGTH,
    "activation_position": PER_LENGTH,
    "velocity": PER_SPEED,
    "speed": PER_SPEED * DEG_S_PER_RPM,
    "min_speed": PER_SPEED * DEG_S_PER_RPM,
    "weight": PER_PERCENT,
}
"""Field of an external command -> how many of its HLI units are 1 mm, °, mm/s, rpm, %."""


class ControlMessage(NamedTuple):
    """What a PLC commands of one object: the fields of <Kind>HliControl.msg."""

    source: str
    sequence: int
    valid: bool
    units: Mapping[str, tuple[bool, float]]
    """Control unit -> enable_w, command_w; overrides in percent."""
    external: Mapping[str, float] = {}
    """Fields of the external command in SI units; empty of a channel."""
    serves_functions: bool = False
    """A channel: the PLC acknowledges its functions."""
    acknowledged: tuple[int, ...] = ()

    @property
    def semaphore(self) -> bool:
        return bool(self.external and self.external["semaphore"])

    @property
    def commands(self) -> bool:
        """It serves anything, or has an external command."""
        return self.serves_functions or self.semaphore or any(enabled for enabled, _ in self.units.values())


def control_message(kind: str, source: str, fields: Mapping[str, Any]) -> ControlMessage:
    """Of the fields of a message by dotted name (`override.command_w`)."""
    hli = fields["units"] == HLI_UNITS
    units = {
        unit.name: (bool(fields[f"{unit.name}.enable_w"]), float(fields[f"{unit.name}.command_w"]))
        for unit in CONTROL_UNITS[kind]
    }
    if hli:
        enabled, permille = units["override"]
        units["override"] = enabled, permille / PER_PERCENT
    external: dict[str, float] = {}
    if "external.semaphore" in fields:
        external = {name.partition(".")[2]: fields[name] for name in fields if name.startswith("external.")}
        if hli:
            in_si(external)
    done = fields.get("acknowledge.done_w", ())
    return ControlMessage(
        source,
        fields["sequence"],
        bool(fields["valid"]),
        units,
        external,
        bool(fields.get("acknowledge.enable_w", False)),
        tuple(number for number in done if number),
    )


def in_si(external: dict[str, float]) -> None:
    """Numbers of the HLI become mm, °, mm/s, rpm, %."""
    for name in external.keys() & PER_UNIT:
        external[name] /= PER_UNIT[name]


def stops_of(kind: str, message: ControlMessage) -> dict[str, dict[str, Any]]:
    """What brings the object to rest: names of commands and their arguments."""
    stops: dict[str, dict[str, Any]] = {}
    enabled, wanted = message.units[EMERGENCY_STOP.name]
    if enabled and wanted:
        stops[EMERGENCY_STOP.command] = {"enabled": True}
    if message.semaphore:
        command = STOPS[kind].get(int(message.external["type"]))
        if command is not None:
            stops[command] = {}
    return stops
