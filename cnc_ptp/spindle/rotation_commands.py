"""Endless rotation of a spindle: M03, M04, S, M05, override. Source: TF5200 spindle 2.3.1, 2.4."""

from __future__ import annotations

from collections import deque

from cnc_ptp.parameters.declare import ids
from cnc_ptp.parameters.list_units import DEG_S_PER_RPM
from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.axis_states import state_name
from cnc_ptp.protocol.spindle_states import SpindleMode
from cnc_ptp.spindle.faults import (
    AGAINST_PREFERRED_DIRECTION,
    BAD_OVERRIDE,
    BAD_SPEED,
    BAD_TOOL_LIMITS,
    SPEED_LIMITED,
    SPEED_TOO_HIGH,
)
from cnc_ptp.spindle.procedure import DIRECTIONS, Procedure, Step
from cnc_ptp.spindle.procedures import Procedures
from cnc_ptp.spindle.spindle import Spindle
from cnc_ptp.spindle.tool_limits import ToolLimits

LIMIT_RANGES = {
    "max_speed_rpm": (1e-3 / DEG_S_PER_RPM, 2e6 / DEG_S_PER_RPM, ids.WZ_VB_MAX),
    "min_speed_rpm": (0.0, 2e6 / DEG_S_PER_RPM, ids.WZ_VB_MIN),
    "max_acceleration": (1.0, 1e8, ids.WZ_A_MAX),
}
"""Permitted range of tool limits: rpm, °/s²."""


class RotationCommands:
    """`start`, `set_speed`, `stop`, override, limits of the tool, and the stop at the program end."""

    def __init__(self, spindle: Spindle, procedures: Procedures) -> None:
        self._spindle = spindle
        self._procedures = procedures
        self.stops_at_program_end = False

    def do_start(self, cycle: int, *, direction: str, speed_rpm: float) -> str | None:
        """M03 (cw) or M04 (ccw) at `speed_rpm`. Refusals 24001–24003; 60254 puts the spindle into ErrorStop."""
        spindle = self._spindle
        spindle.require_ready("start")
        check_speed(spindle, "start", speed_rpm)
        check_direction(spindle, "start", cycle, direction)
        spindle.rotate(cycle, DIRECTIONS[direction] * speed_rpm * DEG_S_PER_RPM)
        return self._limited(cycle, speed_rpm)

    def do_set_speed(self, cycle: int, *, speed_rpm: float) -> str | None:
        """An S word alone: a new speed in the same direction; without effect while the spindle does not rotate."""
        spindle = self._spindle
        check_speed(spindle, "set_speed", speed_rpm)
        if spindle.state != S.CONTINUOUS_MOTION:
            return f"spindle {spindle.name}: set_speed without effect in {state_name(spindle.state)}"
        sign = 1.0 if spindle.mode == SpindleMode.CW else -1.0
        spindle.rotate(cycle, sign * speed_rpm * DEG_S_PER_RPM)
        return self._limited(cycle, speed_rpm)

    def _limited(self, cycle: int, speed_rpm: float) -> str | None:
        """The warning for a speed that the tool does not permit."""
        limits, speed = self._spindle.limits, speed_rpm * DEG_S_PER_RPM
        used = abs(limits.endless(speed))
        if used == speed:
            return None
        bound = "above the maximum" if used < speed else "below the minimum"
        used_rpm = used / DEG_S_PER_RPM
        text = f"speed {speed_rpm} rpm is {bound} of the tool, {used_rpm:g} rpm is used"
        return self._spindle.warn(cycle, SPEED_LIMITED, text, speed=speed_rpm, corrected=used_rpm)

    def do_stop(self, cycle: int, *, homes: bool = True) -> None:
        """M05: down to speed 0; a spindle that turns and has exceeded the control limit homes before it stops.

        Without `homes`, at an abort or reset, nothing is homed and a spindle at a standstill keeps its position. During
        a gear change by the PLC the spindle is at a standstill; it stays there afterwards.
        """
        spindle = self._spindle
        if spindle.work.gear_request:
            spindle.work.forget_rotation()
            return
        if spindle.state in (S.ERROR_STOP, S.DISABLED) or (spindle.state == S.STANDSTILL and not homes):
            return
        turns = spindle.state == S.CONTINUOUS_MOTION and spindle.motion(cycle)[1] != 0.0
        if turns and homes and spindle.reference_lost and spindle.parameters.automatic_homing:
            self._procedures.start(cycle, Procedure("stop", deque([Step.SEARCH, Step.HALT])))
        else:
            spindle.stop(cycle)

    def check_override(self, command: str, percent: float) -> None:
        """Raises 24006 for an override that the spindle does not have."""
        limit = self._spindle.parameters.max_override_percent
        if not 0.0 <= percent <= limit:
            reason = f"percent = {percent} is not within 0 ... {limit:g} (P-AXIS-00109)"
            self._spindle.refuse(command, BAD_OVERRIDE, reason, percent=percent, limit=limit)

    def do_set_override(self, cycle: int, *, percent: float) -> str | None:
        """Override of endless rotation and positioning, 0 … P-AXIS-00109 %; the speed stays within the limits."""
        spindle = self._spindle
        self.check_override("set_override", percent)
        if percent == spindle.override_percent:
            return None
        spindle.override_percent = float(percent)
        return self._override_changed(cycle, f"override {percent} %")

    def do_suppress_override(self, cycle: int, *, enabled: bool) -> str | None:
        """G167: the override has no effect (100 %) until G167 is switched off again."""
        if enabled == self._spindle.override_suppressed:
            return None
        self._spindle.override_suppressed = enabled
        return self._override_changed(cycle, f"override suppression {'on' if enabled else 'off'}")

    def do_feed_hold(self, cycle: int, *, enabled: bool) -> str | None:
        """HLI: down to speed 0 on the ramp, and on again when the hold is off; G167 does not suppress it."""
        if enabled == self._spindle.feed_held:
            return None
        self._spindle.feed_held = enabled
        return self._override_changed(cycle, f"feed hold {'on' if enabled else 'off'}")

    def _override_changed(self, cycle: int, what: str) -> str | None:
        spindle = self._spindle
        if spindle.state == S.CONTINUOUS_MOTION:
            spindle.apply_speed(cycle)
        elif spindle.state == S.DISCRETE_MOTION and not self._procedures.replan(cycle):
            return f"spindle {spindle.name}: {what} does not change the active positioning (brake phase)"
        return None

    def do_set_limits(
        self,
        cycle: int,
        *,
        max_speed_rpm: float | None = None,
        min_speed_rpm: float | None = None,
        max_acceleration: float | None = None,
    ) -> None:
        """Limits of a tool (P-TOOL-00013 … 00015), from standstill on; the rest is unlimited. Refused: 24018."""
        spindle = self._spindle
        given = {"max_speed_rpm": max_speed_rpm, "min_speed_rpm": min_speed_rpm, "max_acceleration": max_acceleration}
        for name, value in given.items():
            low, high, parameter = LIMIT_RANGES[name]
            if value is not None and not low <= value <= high:
                reason = f"{name} = {value} is not within {low:g} ... {high:g} ({parameter})"
                spindle.refuse("set_limits", BAD_TOOL_LIMITS, reason, argument=name, value=value, low=low, high=high)
        if min_speed_rpm is not None and max_speed_rpm is not None and min_speed_rpm > max_speed_rpm:
            reason = f"min_speed_rpm = {min_speed_rpm} is above max_speed_rpm = {max_speed_rpm}"
            spindle.refuse("set_limits", BAD_TOOL_LIMITS, reason, low=min_speed_rpm, high=max_speed_rpm)
        none = ToolLimits()
        self._take(
            cycle,
            ToolLimits(
                none.max_speed if max_speed_rpm is None else max_speed_rpm * DEG_S_PER_RPM,
                none.min_speed if min_speed_rpm is None else min_speed_rpm * DEG_S_PER_RPM,
                none.max_acceleration if max_acceleration is None else float(max_acceleration),
            ),
        )

    def do_reset_limits(self, cycle: int) -> None:
        """The limits of the gear alone, from standstill on."""
        self._take(cycle, ToolLimits())

    def _take(self, cycle: int, limits: ToolLimits) -> None:
        self._spindle.next_tool = limits
        self._spindle.take_tool(cycle)

    def do_stop_at_program_end(self, cycle: int, *, enabled: bool) -> None:
        """HLI: the channel is to stop the spindle at the end of its program (2.4.3)."""
        self.stops_at_program_end = enabled


def check_speed(spindle: Spindle, command: str, speed_rpm: float) -> None:
    """Raises 24001 and 24002."""
    if speed_rpm < 0.0:
        reason = f"speed {speed_rpm} rpm must not be negative; the direction is cw or ccw"
        spindle.refuse(command, BAD_SPEED, reason, speed=speed_rpm)
    limit_rpm = spindle.gear.max_speed / DEG_S_PER_RPM
    if speed_rpm > limit_rpm:
        gear = f" of gear {spindle.gear.stage}" if len(spindle.parameters.gears) > 1 else ""
        reason = f"speed {speed_rpm} rpm is above the maximum {limit_rpm:g} rpm{gear} (P-AXIS-00212)"
        spindle.refuse(command, SPEED_TOO_HIGH, reason, speed=speed_rpm, limit=limit_rpm, gear=spindle.gear.stage)


def check_direction(spindle: Spindle, command: str, cycle: int, direction: str) -> None:
    """60254 for a direction against the preferred one: refused, and the spindle goes into ErrorStop."""
    preferred = spindle.parameters.preferred_direction
    if preferred and DIRECTIONS.get(direction, preferred) != preferred:
        word = "positive" if preferred > 0 else "negative"
        reason = f"{direction} contradicts the preferred direction of rotation (P-AXIS-00224, P-AXIS-00031: {word})"
        spindle.fail(command, cycle, AGAINST_PREFERRED_DIRECTION, reason, direction=direction, preferred=word)
