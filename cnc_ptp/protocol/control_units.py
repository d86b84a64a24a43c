"""The control units of the HLI as data: what an external PLC may take over from others, object by object.

The one place that says which there are, which values they have, whether they act by level or by edge, and which command
of a unit they stand for. Units carry them out (protocol/overlay.py), plc/hli checks messages against it, the reference
docs/hli_objects.md is made from it. Source: TF5200 spindle 2.4, 2.9; TX1250 2.1, 2.2; public HLI documentation.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

SWITCH, PERCENT, NUMBER = "switch", "percent", "number"
"""Kinds of values: 0 or 1; 0 to the largest override of the unit; a whole number from 0 on."""


@dataclass(frozen=True, slots=True)
class ControlUnit:
    """One control unit of an object.

    Level: its value acts as long as it is there. Edge: a rising edge of the PLC's command carries out `command` once.
    """

    name: str
    value: str
    command: str
    """What carries its value out; of an edge: what that commands."""
    asked_by: str = ""
    """Command and argument by which others ask for the same, `power.enabled`; empty: only the PLC gives it."""
    initial: float = 0.0
    """What acts while nobody has asked for anything."""
    largest: float = 1.0
    """Of a number."""
    edge: bool = False
    holds_back: float | None = None
    """The value that keeps something from moving: only a PLC takes it back, also from one that has fallen silent."""
    either: bool = False
    """Acts while the PLC or somebody else wants it: no overlay switches it off."""


def level(name: str, command: str, asked_by: str = "") -> ControlUnit:
    return ControlUnit(name, SWITCH, command, asked_by)


def hold(name: str, command: str, asked_by: str, *, either: bool = False) -> ControlUnit:
    """On, it holds back."""
    return ControlUnit(name, SWITCH, command, asked_by, holds_back=1.0, either=either)


def enable(name: str, command: str, asked_by: str = "") -> ControlUnit:
    """Off, it holds back."""
    return ControlUnit(name, SWITCH, command, asked_by, initial=1.0, holds_back=0.0)


def number(name: str, command: str, asked_by: str, largest: float) -> ControlUnit:
    return ControlUnit(name, NUMBER, command, asked_by, largest=largest)


def edge(name: str) -> ControlUnit:
    return ControlUnit(name, SWITCH, name, name, edge=True)


OVERRIDE = (
    ControlUnit("override", PERCENT, "set_override", "set_override.percent", initial=100.0),
    ControlUnit("override_valid", SWITCH, "set_override", initial=1.0),
)
ENABLES = (
    enable("controller_enable", "power", "power.enabled"),
    enable("drive_ready", "power"),
)
EMERGENCY_STOP = hold("emergency_stop", "set_emergency_stop", "set_emergency_stop.enabled", either=True)
RESET = edge("reset")

CONTROL_UNITS: Mapping[str, tuple[ControlUnit, ...]] = {
    "axis": (
        hold("feed_hold", "set_feed_release", "feed_hold.enabled"),
        *OVERRIDE,
        *ENABLES,
        enable("feed_enable_forward", "set_feed_release", "set_feed_release.forward"),
        enable("feed_enable_backward", "set_feed_release", "set_feed_release.backward"),
        EMERGENCY_STOP,
        RESET,
    ),
    "spindle": (
        hold("feed_hold", "feed_hold", "feed_hold.enabled"),
        *OVERRIDE,
        *ENABLES,
        level("stop_at_program_end", "stop_at_program_end", "stop_at_program_end.enabled"),
        EMERGENCY_STOP,
        RESET,
        edge("gear_changed"),
    ),
    "channel": (
        hold("feed_hold", "feed_hold", "feed_hold.enabled"),
        *OVERRIDE,
        number("single_block", "single_block", "single_block.mode", largest=2.0),
        level("optional_stop", "optional_stop", "optional_stop.enabled"),
        number("block_skip", "block_skip", "block_skip.level", largest=float(2**10 - 1)),
        EMERGENCY_STOP,
        RESET,
        edge("start"),
        edge("measuring_event"),
    ),
    "plc": (),
}
"""Kind of unit -> its control units."""

SINGLE_BLOCK_MODES = ("", "block", "motion")
"""By value of the control unit."""


def unit_of(kind: str, name: str) -> ControlUnit | None:
    """The control unit of that name, None where there is none."""
    return next((unit for unit in CONTROL_UNITS[kind] if unit.name == name), None)
