"""Commands of homing: `home`, and the override of the channel whose G74 homes the axis."""

from __future__ import annotations

from cnc_ptp.axis.axis import Axis
from cnc_ptp.axis.drive_homing import DriveHoming
from cnc_ptp.axis.faults import (
    BAD_REFERENCE,
    COMPENSATION_RUNS,
    HOMING_DISABLED,
    MASTER_HOMES,
    NOT_READY,
    ON_CAM,
    PARAMETER_SCALED,
    SERVICE_CHANNEL,
)
from cnc_ptp.axis.homing import Homing
from cnc_ptp.axis.motions import refuse_other_source
from cnc_ptp.control.drives.sercos import idns
from cnc_ptp.control.drives.sercos.service_channel import ServiceChannel, ServiceError
from cnc_ptp.parameters.view.homing_view import DISABLED, DRIVE_CONTROLLED
from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.axis_states import state_name

HOME = "home"
PLC_SCALING = "16#FFFFFFFF"
"""Error code of the manual's PLC program."""


class HomingCommands:
    """`home`, `set_homing_override`."""

    def __init__(self, axis: Axis, homing: Homing, drive_homing: DriveHoming) -> None:
        self._axis, self._homing, self._drive_homing = axis, homing, drive_homing

    def do_home(self, cycle: int, *, position: float | None = None) -> None:
        """Homes the axis (G74, MC_Home); the reference point gets `position`, without it P-AXIS-00152.

        Refusals: 60313, 23005, 23015, 23027, 23040, 23071, 23072, 23126; of a drive 23121, 23122.
        """
        axis, parameters = self._axis, self._axis.parameters.homing
        if parameters.kind == DISABLED:
            axis.refuse(HOME, HOMING_DISABLED, "the axis cannot be homed (P-AXIS-00299 = DISABLED)")
        refuse_to_home(axis, HOME)
        reference = parameters.reference_position if position is None else self._checked(position)
        service = axis.lead.service
        if parameters.kind == DRIVE_CONTROLLED and service is not None:
            settings = self._of_drive(service, reference)
            axis.begin_homing(cycle)
            for idn, value in settings.items():
                service.write(idn, value)
            self._drive_homing.begin(service, by_command=True)
            return
        if parameters.without_reversing and not parameters.without_cam and self._homing.on_cam:
            reason = "the axis is on its reference cam and may not reverse (P-AXIS-00157 = 1); move it off the cam"
            axis.refuse(HOME, ON_CAM, reason)
        axis.begin_homing(cycle)
        self._homing.begin(cycle, reference)

    def _checked(self, position: float) -> float:
        """As P-AXIS-00152, the reference point is within the soft limits."""
        axis, parameters = self._axis, self._axis.parameters
        low, high = parameters.soft_limit_negative, parameters.soft_limit_positive
        if not low <= position <= high:
            limits = f"{low:g} ... {high:g} {axis.unit} (P-AXIS-00177, P-AXIS-00178)"
            reason = f"position {position} {axis.unit} is not within the soft limits {limits}"
            axis.refuse(HOME, BAD_REFERENCE, reason, position=position, low=low, high=high)
        return position

    def _of_drive(self, service: ServiceChannel, reference: float) -> dict[str, int]:
        """What the drive gets before it starts: velocity and reference, in digits of preferred scaling."""
        axis, digits = self._axis, service.scaling
        kind = service.read(idns.VELOCITY_SCALING)
        if isinstance(kind, int) and kind & idns.PARAMETER_SCALING:
            reason = (
                f"the drive scales velocities by parameters ({idns.VELOCITY_SCALING} = 0x{kind:02x}), supported is "
                f"preferred scaling ({PLC_SCALING})"
            )
            axis.refuse(HOME, PARAMETER_SCALED, reason, scaling=kind)
        settings = {
            idns.HOMING_VELOCITY: round(axis.parameters.homing.fast * digits.velocity.scale),
            idns.REFERENCE_DISTANCE: round(reference * digits.position.scale),
        }
        try:
            for idn, value in (settings | {idns.HOMING: idns.SET_AND_ENABLE}).items():
                service.check(idn, value)
        except ServiceError as error:
            axis.refuse(HOME, SERVICE_CHANNEL, f"{error.reason} (SERCOS error 0x{error.code:04x})", code=error.code)
        return settings

    def do_set_homing_override(self, cycle: int, *, percent: float) -> None:
        """Override of the channel that homes the axis, in addition to its own; counts until the homing ends."""
        if self._axis.state == S.HOMING:
            self._axis.set_homing_override(cycle, percent)


def refuse_to_home(axis: Axis, command: str) -> None:
    """Raises the refusal of an axis that is not in a state from which it could be homed."""
    refuse_other_source(axis, command)
    if axis.state != S.STANDSTILL:
        state = state_name(axis.state)
        axis.refuse(command, NOT_READY, f"the axis is in {state}, it must be in Standstill", state=state)
    if axis.slaves:
        slaves = ", ".join(sorted(axis.slaves))
        axis.refuse(command, MASTER_HOMES, f"the axis is the master of {slaves}; decouple first", slaves=slaves)
    if axis.compensation.active:
        axis.refuse(command, COMPENSATION_RUNS, "a position compensation is active")
