"""Panels of a unit over time, by kind of unit, each with its fields of the unit's block."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from cnc_ptp.plots.colours import BLUE, GREEN, PURPLE, RED, TEAL, YELLOW, Pair
from cnc_ptp.protocol.blocks import AxisBlock, SpindleBlock
from cnc_ptp.recording.blocks import kind_of


@dataclass(frozen=True, slots=True)
class Panel:
    """One panel: its height in points, its fields and their colours.

    `fields` are set value and actual value, or one value alone. `at_end`: the last value is written at the right, and
    not the extremes. `with_override`: the override is drawn as the velocity that it asks for. `fine`: small values are
    shown in µm.
    """

    height: float
    fields: tuple[str, ...]
    colours: Pair
    at_end: bool = False
    with_override: bool = False
    fine: bool = False


@dataclass(frozen=True, slots=True)
class UnitKind:
    """A kind of unit: its columns, those that say whether it moves and lags, its panels, and the usual ones of them."""

    columns: tuple[str, ...]
    motion: str
    lag: str
    panels: Mapping[str, Panel]
    usual: tuple[str, ...]


def columns(block: type[AxisBlock | SpindleBlock]) -> tuple[str, ...]:
    """Fields of a block with one number per cycle: those of the states; the others are of the block as a whole."""
    return tuple(kind_of(block).columns)


AXIS = {
    "position": Panel(110.0, ("set_position", "actual_position"), BLUE, at_end=True),
    "velocity": Panel(130.0, ("set_velocity", "actual_velocity"), GREEN, with_override=True),
    "acceleration": Panel(110.0, ("set_acceleration", "actual_acceleration"), RED),
    "jerk": Panel(90.0, ("set_jerk",), PURPLE),
    "following error": Panel(80.0, ("following_error",), YELLOW, fine=True),
    "command velocity": Panel(90.0, ("command_velocity",), BLUE),
    "feedforward": Panel(90.0, ("feedforward_velocity",), PURPLE),
    "additive velocity": Panel(90.0, ("additive_velocity",), PURPLE),
    "additive torque": Panel(90.0, ("additive_torque",), RED),
    "friction current": Panel(90.0, ("friction_current",), RED),
    "torque": Panel(110.0, ("actual_torque",), TEAL),
}
SPINDLE = {
    "speed": Panel(130.0, ("set_speed_rpm", "actual_speed_rpm"), GREEN, with_override=True),
    "acceleration": Panel(110.0, ("set_acceleration_deg_s2",), RED),
    "position": Panel(110.0, ("set_position_deg", "actual_position_deg"), BLUE, at_end=True),
    "following error": Panel(80.0, ("following_error_deg",), YELLOW),
}
UNIT_KINDS = {
    "axis": UnitKind(
        columns(AxisBlock),
        "set_velocity",
        "following_error",
        AXIS,
        ("position", "velocity", "acceleration", "following error"),
    ),
    "spindle": UnitKind(
        columns(SpindleBlock),
        "set_speed_rpm",
        "following_error_deg",
        SPINDLE,
        ("speed", "acceleration", "following error"),
    ),
}
