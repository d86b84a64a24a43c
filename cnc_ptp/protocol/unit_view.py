"""View of a unit for people: state, position, speed and more from its newest block."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from cnc_ptp.protocol.axis_states import REST_STATES, AxisStateCode, StatusBit, state_name
from cnc_ptp.protocol.channel_states import ChannelStateCode


@dataclass(frozen=True, slots=True)
class UnitView:
    """One unit at the end of a block; None and empty where its kind has no such thing."""

    name: str
    kind: str
    state: str
    busy: bool
    """It moves, turns, or runs a program."""
    settled: bool
    """It is at a standstill, turns at the commanded speed, or has no active program."""
    override: float
    error_id: int
    cycle: int
    """The cycle after the last one of the block."""
    stamp: float
    """Of the block, s since 1970."""
    position: float | None = None
    unit: str = ""
    """mm or deg."""
    speed: float | None = None
    speed_unit: str = ""
    following_error: float | None = None
    stopped: bool = False
    """The last motion or program was stopped before its end."""
    line: int = 0
    blocks_done: int = 0
    blocks_total: int = 0
    progress: float = 0.0
    """Of a program, 0 … 1."""
    time_left: float = 0.0
    """Of a program, s; below 0 if it is not known."""


def view_of(name: str, kind: str, block: Any, *, rotary: bool = False, stamp: float = 0.0) -> UnitView:
    """`block`: AxisBlock, SpindleBlock or ChannelBlock; `rotary` for an axis in degrees; `stamp` of its message, s."""
    common: dict[str, Any] = {
        "name": name,
        "kind": kind,
        "override": block.override_percent[-1],
        "error_id": block.error_id[-1],
        "cycle": block.first_cycle + block.count,
        "stamp": stamp,
    }
    return VIEWS[kind](block, common, "deg" if rotary else "mm")


def _axis_view(block: Any, common: dict[str, Any], unit: str) -> UnitView:
    state, speed = AxisStateCode(block.state[-1]), block.set_velocity[-1]
    busy = speed != 0.0 or state not in REST_STATES
    in_target = bool(block.status_bits[-1] & StatusBit.IN_TARGET_POSITION)
    return UnitView(
        **common,
        state=state_name(state),
        busy=busy,
        settled=not busy and (block.actual_velocity[-1] == 0.0 or in_target),
        position=block.actual_position[-1],
        unit=unit,
        speed=block.actual_velocity[-1],
        speed_unit=f"{unit}/s",
        following_error=block.following_error[-1],
        stopped=bool(block.status_bits[-1] & StatusBit.HAS_BEEN_STOPPED),
    )


def _spindle_view(block: Any, common: dict[str, Any], unit: str) -> UnitView:
    state, speed = AxisStateCode(block.state[-1]), block.set_speed_rpm[-1]
    busy = speed != 0.0 or state not in REST_STATES
    turns = state == AxisStateCode.CONTINUOUS_MOTION and block.speed_reached[-1]
    return UnitView(
        **common,
        state=state_name(state),
        busy=busy,
        settled=not block.gear_change_active[-1] and (turns or not busy),
        position=block.actual_position_deg[-1],
        unit="deg",
        speed=block.actual_speed_rpm[-1],
        speed_unit="rpm",
        following_error=block.following_error_deg[-1],
    )


def _channel_view(block: Any, common: dict[str, Any], unit: str) -> UnitView:
    return UnitView(
        **common,
        state=ChannelStateCode(block.state[-1]).name.capitalize(),
        busy=not block.done,
        settled=block.done,
        speed=block.path_velocity[-1] * 60.0,
        speed_unit="mm/min",
        line=block.line[-1],
        blocks_done=block.blocks_done,
        blocks_total=block.blocks_total,
        progress=block.progress,
        time_left=block.time_left,
        stopped=block.done and block.blocks_done < block.blocks_total,
    )


VIEWS = {"channel": _channel_view, "axis": _axis_view, "spindle": _spindle_view}
"""By kind of unit, in the order in which people look at them."""
