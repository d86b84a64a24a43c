"""Positioning and homing of a spindle: M19, G74. Source: TF5200 spindle 2.3.2, 2.7."""

from __future__ import annotations

from collections import deque

from cnc_ptp.parameters.list_units import DEG_S_PER_RPM, LARGEST_POSITION
from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.spindle.faults import (
    BAD_POSITION,
    BAD_SPEED,
    HOMING_FROM_MOTION,
    NO_POSITION_VALUE,
    NO_REFERENCE,
    SENSORLESS,
    SPEED_LIMITED,
)
from cnc_ptp.spindle.procedure import Procedure, Step
from cnc_ptp.spindle.procedures import Procedures
from cnc_ptp.spindle.rotation_commands import check_direction, check_speed
from cnc_ptp.spindle.spindle import Spindle

NEEDS_REFERENCE = (
    "the spindle has no reference point and does not home automatically (P-AXIS-00015 0x100); home it first (G74)"
)


class PositionCommands:
    """`orient` and `home`."""

    def __init__(self, spindle: Spindle, procedures: Procedures) -> None:
        self._spindle = spindle
        self._procedures = procedures

    def do_orient(
        self, cycle: int, *, position_deg: float, speed_rpm: float | None = None, direction: str = ""
    ) -> str | None:
        """M19: to `position_deg` modulo a turn, with P-AXIS-00209 where no speed is given.

        Refused with 24001–24003, 24006 and 70252; 60254 and 24007 (no reference) put the spindle into ErrorStop.
        """
        spindle = self._spindle
        spindle.require_ready("orient")
        if not abs(position_deg) <= LARGEST_POSITION:
            reason = f"position {position_deg} deg is not within ±{LARGEST_POSITION} deg"
            spindle.refuse("orient", BAD_POSITION, reason, position=position_deg, limit=LARGEST_POSITION)
        if speed_rpm is not None:
            check_speed(spindle, "orient", speed_rpm)
            if speed_rpm == 0.0:
                reason = "speed 0 rpm must be greater than 0 for a positioning"
                spindle.refuse("orient", BAD_SPEED, reason, speed=speed_rpm)
        self._require_position("orient")
        check_direction(spindle, "orient", cycle, direction)
        require_reference(spindle, "orient", cycle)
        speed = spindle.gear.positioning_speed if speed_rpm is None else speed_rpm * DEG_S_PER_RPM
        procedure = Procedure(
            "orient", deque([Step.POSITION]), goal=float(position_deg), speed=speed, direction=direction
        )
        self._procedures.start(cycle, procedure)
        return slower_positioning(spindle, cycle, speed)

    def _require_position(self, command: str) -> None:
        if not self._spindle.parameters.has_position:
            reason = "the spindle has no actual position (P-AXIS-00320, P-SIM-00050) and cannot be positioned"
            self._spindle.refuse(command, SENSORLESS, reason)

    def do_home(self, cycle: int) -> None:
        """G74: turns until the zero pulse comes, then an exact stop. Refused with 24003, 24008 and 24009."""
        spindle = self._spindle
        spindle.require_ready("home")
        if not spindle.parameters.has_position:
            reason = "the spindle has no actual position (P-AXIS-00320, P-SIM-00050) and cannot be homed"
            spindle.refuse("home", NO_POSITION_VALUE, reason)
        if not spindle.parameters.automatic_homing and spindle.state != S.STANDSTILL:
            reason = "the drive homes the spindle from standstill only (P-AXIS-00015 0x100); stop it first"
            spindle.refuse("home", HOMING_FROM_MOTION, reason)
        self._procedures.start(cycle, Procedure("home", deque([Step.SEARCH, Step.HALT])))


def require_reference(spindle: Spindle, command: str, cycle: int) -> None:
    """Raises 24007, and the spindle is in ErrorStop, without a reference point and automatic homing."""
    spindle.watch_loop(cycle, spindle.motion(cycle)[1])
    if not (spindle.referenced or spindle.parameters.automatic_homing):
        spindle.fail(command, cycle, NO_REFERENCE, NEEDS_REFERENCE)


def slower_positioning(spindle: Spindle, cycle: int, speed: float) -> str | None:
    """The warning for a positioning speed in °/s that tool or control limit do not permit."""
    limits = spindle.limits
    used = limits.max_positioning_speed
    if speed <= used:
        return None
    rpm, used_rpm = speed / DEG_S_PER_RPM, used / DEG_S_PER_RPM
    bound = "maximum of the tool" if used == limits.max_speed else f"control limit {used_rpm:g} rpm (P-AXIS-00220)"
    reason = f"speed {rpm:g} rpm is above the {bound}, {used_rpm:g} rpm is used"
    return spindle.warn(cycle, SPEED_LIMITED, reason, speed=rpm, corrected=used_rpm)
