"""Gear change of a spindle with the PLC: M40 … M45. Source: TF5200 spindle 2.8.2."""

from __future__ import annotations

from collections import deque

from cnc_ptp.parameters.list_units import DEG_S_PER_RPM
from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.spindle.faults import NO_GEAR_CHANGE, NO_SUCH_GEAR, SPEED_LIMITED
from cnc_ptp.spindle.position_commands import require_reference, slower_positioning
from cnc_ptp.spindle.procedure import Procedure, Step
from cnc_ptp.spindle.procedures import Procedures
from cnc_ptp.spindle.spindle import Spindle


class GearCommands:
    """`select_gear` and `gear_changed`."""

    def __init__(self, spindle: Spindle, procedures: Procedures) -> None:
        self._spindle = spindle
        self._procedures = procedures

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
            require_reference(spindle, "select_gear", cycle)
            procedure.steps[0] = Step.POSITION
            procedure.goal, procedure.speed = spindle.gear.change_position, spindle.gear.positioning_speed
        self._procedures.start(cycle, procedure)
        return slower_positioning(spindle, cycle, procedure.speed)

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
            reason = f"{above} (P-AXIS-00212); the spindle stays at rest"
            return spindle.warn(cycle, SPEED_LIMITED, reason, speed=rpm, limit=limit)
        spindle.rotate(cycle, procedure.resume)
        return None
