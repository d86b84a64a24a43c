"""Positioning, homing and gear change of a spindle: M19, G74, M40 … M45. Source: TF5200 spindle 2.3.2, 2.7, 2.8.2."""

from __future__ import annotations

from collections import deque

from cnc_ptp.parameters.list_units import DEG_S_PER_RPM, LARGEST_POSITION
from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.spindle.faults import (
    BAD_POSITION,
    BAD_SPEED,
    HOMING_FROM_MOTION,
    NO_GEAR_CHANGE,
    NO_POSITION_VALUE,
    NO_REFERENCE,
    NO_SUCH_GEAR,
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
    """`orient`, `home`, `select_gear` and `gear_changed`."""

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
        self._require_reference("orient", cycle)
        speed = spindle.gear.positioning_speed if speed_rpm is None else speed_rpm * DEG_S_PER_RPM
        procedure = Procedure(
            "orient", deque([Step.POSITION]), goal=float(position_deg), speed=speed, direction=direction
        )
        self._procedures.start(cycle, procedure)
        return self._slower(cycle, speed)

    def _slower(self, cycle: int, speed: float) -> str | None:
        """The warning for a positioning speed in °/s that tool or control limit do not permit."""
        limits = self._spindle.limits
        used = limits.max_positioning_speed
        if speed <= used:
            return None
        rpm, used_rpm = speed / DEG_S_PER_RPM, f"{used / DEG_S_PER_RPM:g} rpm"
        bound = "maximum of the tool" if used == limits.max_speed else f"control limit {used_rpm} (P-AXIS-00220)"
        return self._spindle.warn(cycle, SPEED_LIMITED, f"speed {rpm:g} rpm is above the {bound}, {used_rpm} is used")

    def _require_position(self, command: str) -> None:
        if not self._spindle.parameters.has_position:
            reason = "the spindle has no actual position (P-AXIS-00320, P-SIM-00050) and cannot be positioned"
            self._spindle.refuse(command, SENSORLESS, reason)

    def _require_reference(self, command: str, cycle: int) -> None:
        spindle = self._spindle
        spindle.watch_loop(cycle, spindle.motion(cycle)[1])
        if not (spindle.referenced or spindle.parameters.automatic_homing):
            spindle.fail(command, cycle, NO_REFERENCE, NEEDS_REFERENCE)

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

    def do_select_gear(self, cycle: int, *, stage: int, resume: bool = True) -> str | None:
        """M40 … M45: to the change position in rapid traverse, then the PLC changes the gear (`gear_changed`).

        An endless rotation resumes after that, unless `resume` is False: then the commander decides how to continue.
        No effect for the gear in use. Refused with 24003 and 24014; 24007 as for `orient`.
        """
        spindle = self._spindle
        spindle.require_ready("select_gear")
        if stage not in spindle.parameters.gears:
            known = ", ".join(map(str, spindle.parameters.gears))
            reason = f"gear {stage} has no record getriebe[i]; known are: {known}"
            spindle.refuse("select_gear", NO_SUCH_GEAR, reason, gear=stage)
        if stage == spindle.gear.stage:
            return f"spindle {spindle.name}: gear {stage} is selected already"
        rotation = spindle.programmed_speed if resume and spindle.state == S.CONTINUOUS_MOTION else 0.0
        procedure = Procedure("select_gear", deque([Step.HALT, Step.SHIFT]), stage=stage, resume=rotation)
        if spindle.parameters.has_position:
            self._require_reference("select_gear", cycle)
            procedure.steps[0] = Step.POSITION
            procedure.goal, procedure.speed = spindle.gear.change_position, spindle.gear.positioning_speed
        self._procedures.start(cycle, procedure)
        return self._slower(cycle, procedure.speed)

    def do_gear_changed(self, cycle: int) -> str | None:
        """The PLC has changed the gear; a previous endless rotation resumes. Refused with 24015."""
        spindle = self._spindle
        if not spindle.work.gear_request:
            spindle.refuse("gear_changed", NO_GEAR_CHANGE, "no gear change waits for its acknowledgement")
        procedure = self._procedures.gear_changed(cycle)
        if not procedure.resume:
            return None
        if abs(procedure.resume) > spindle.gear.max_speed:
            rpm, limit = abs(procedure.resume) / DEG_S_PER_RPM, spindle.gear.max_speed / DEG_S_PER_RPM
            above = f"the previous speed {rpm:g} rpm is above the maximum {limit:g} rpm of gear {spindle.gear.stage}"
            return spindle.warn(cycle, SPEED_LIMITED, f"{above} (P-AXIS-00212); the spindle stays at rest")
        spindle.rotate(cycle, procedure.resume)
        return None
