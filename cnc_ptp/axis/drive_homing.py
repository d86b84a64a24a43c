"""Homing by the drive (TX1250 4.2): the axis starts S-0-0148, follows the drive and takes its reference over.

    S-0-0044 is read, S-0-0041 and S-0-0052 are written, S-0-0148 = 3 ─▶ the drive moves, the setpoints follow it
    S-0-0148 is acknowledged, S-0-0403 is set ─▶ coordinates of the drive, soft limits; S-0-0148 = 0, Standstill

A PLC that writes S-0-0148 itself does the same step by step: the axis only follows, and takes over what S-0-0403 says.
"""

from __future__ import annotations

from collections.abc import Callable

from cnc_ptp.axis import transitions as T
from cnc_ptp.axis.axis import Axis
from cnc_ptp.axis.faults import DRIVE_ABORTED, DRIVE_SILENT, NO_REFERENCE_FLAG
from cnc_ptp.control.control_loop import ControlLoop
from cnc_ptp.control.drives.sercos import idns
from cnc_ptp.control.drives.sercos.homing_procedure import ERROR, EXECUTED, HomingProcedure, Phase
from cnc_ptp.control.drives.sercos.service_channel import ServiceChannel
from cnc_ptp.motion.setpoints import MotionState
from cnc_ptp.protocol.axis_states import AxisStateCode as S

PLC_ABORTED, PLC_NO_REFERENCE = "16#FFFFFFFE", "16#FFFFFFFD"
"""Error codes of the manual's PLC program."""


class DriveHoming:
    """The axis' side of S-0-0148, cycle by cycle."""

    def __init__(
        self, axis: Axis, loop: ControlLoop, *, cycle_time: float, report: Callable[[int, int, str], None]
    ) -> None:
        """`cycle_time` in s; `report` takes the phases of the drive as events."""
        self._axis, self._loop = axis, loop
        self._report = report
        self._longest = round(axis.parameters.homing.timeout / cycle_time)
        self._waited = 0
        self._phase = Phase.IDLE
        self._referenced = False
        self.by_command = False
        """`home` has started it, and ends it; otherwise the PLC does."""

    @property
    def service(self) -> ServiceChannel | None:
        """The service channel of the drive, None for a drive without one."""
        return self._axis.lead.service

    def begin(self, service: ServiceChannel, *, by_command: bool) -> None:
        """Sets and enables S-0-0148; what was known of the reference point is lost."""
        self._axis.checks.referenced = self._referenced = False
        self._phase, self._waited, self.by_command = Phase.IDLE, 0, by_command
        self._set_override(service.homing)
        service.write(idns.HOMING, idns.SET_AND_ENABLE)
        self._axis.lead.active = True

    def end(self, cycle: int, homing: HomingProcedure) -> None:
        """The PLC has taken S-0-0148 away: a drive at a standstill follows the axis again, another one stops."""
        axis = self._axis
        if axis.state != S.HOMING:
            return
        if homing.leads:
            axis.take(T.STOP)
            axis.has_been_stopped = True
            return
        self._watch_reference(cycle, homing)
        self._hand_back(cycle)
        axis.take(T.FINISH)

    @property
    def waits_for_plc(self) -> bool:
        """The drive has ended what the PLC has started, and holds the axis until the PLC takes S-0-0148 away."""
        service = self.service
        if service is None or self.by_command or self._axis.state != S.HOMING:
            return False
        return service.homing.acknowledgement in (EXECUTED, ERROR)

    # one cycle

    def watch(self, cycle: int) -> MotionState:
        """One cycle in which the axis follows its drive: actual values are the setpoint.

        Where the drive has ended that, the axis is at a standstill with the setpoint at its actual position.
        """
        axis, loop, service = self._axis, self._loop, self.service
        assert service is not None
        homing = service.homing
        self._set_override(homing)
        self._note_phase(cycle, homing)
        self._watch_reference(cycle, homing)
        if axis.state == S.HOMING and self.by_command:
            self._judge(cycle, homing)
        if not homing.leads:
            self._hand_back(cycle)
            return loop.position, 0.0, 0.0, 0.0
        position, velocity = loop.position, loop.drive.velocity
        axis.ptp.take_over(cycle, position, velocity, 0.0)
        return position, velocity, 0.0, 0.0

    def _hand_back(self, cycle: int) -> None:
        """The drive follows its cyclic commands again, from where it is."""
        self._axis.lead.active = False
        self._axis.ptp.take_over(cycle, self._loop.position, 0.0, 0.0)

    def _set_override(self, homing: HomingProcedure) -> None:
        """S-0-0108. The axis does not know where its drive will go: 0 until both directions are released."""
        ptp = self._axis.ptp
        homing.set_override(0.0 if ptp.restricted else ptp.override)

    def _note_phase(self, cycle: int, homing: HomingProcedure) -> None:
        if homing.phase is not self._phase:
            self._phase = homing.phase
            self._report(cycle, 0, f"axis {self._axis.name}: drive: {homing.diagnosis}")

    def _watch_reference(self, cycle: int, homing: HomingProcedure) -> None:
        """When the drive has its reference, the axis counts as the drive does from now on, and has soft limits."""
        axis = self._axis
        if self._referenced or not homing.referenced:
            return
        self._loop.take_offset(homing.origin)
        axis.checks.referenced = self._referenced = True
        self._report(
            cycle, 0, f"axis {axis.name}: the reference of the drive is taken over ({idns.FEEDBACK_STATUS} is set)"
        )

    def _judge(self, cycle: int, homing: HomingProcedure) -> None:
        """Ends the homing that `home` has started."""
        axis, answer = self._axis, homing.acknowledgement
        self._waited += 1 if homing.override > 0.0 else 0
        if answer == EXECUTED and homing.referenced:
            axis.lead.cancel()
            axis.take(T.FINISH)
        elif answer == EXECUTED:
            flag = f"the drive has not set its reference flag {idns.FEEDBACK_STATUS}"
            axis.fault(cycle, NO_REFERENCE_FLAG, f"homing: {idns.HOMING} is completed, {flag} ({PLC_NO_REFERENCE})")
        elif answer == ERROR:
            reason = f"homing: the drive has aborted {idns.HOMING} with an error: {homing.diagnosis} ({PLC_ABORTED})"
            axis.fault(cycle, DRIVE_ABORTED, reason)
        elif self._waited > self._longest:
            patience = axis.parameters.homing.timeout
            reason = f"homing: the drive has not acknowledged {idns.HOMING} within {patience:g} s (P-MACH-00062)"
            axis.fault(cycle, DRIVE_SILENT, reason, values={"patience": patience})
