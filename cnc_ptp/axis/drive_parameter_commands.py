"""Commands that read and write the parameters of a SERCOS drive through its service channel."""

from __future__ import annotations

from cnc_ptp.axis.axis import Axis
from cnc_ptp.axis.drive_homing import DriveHoming
from cnc_ptp.axis.faults import NO_SERVICE_CHANNEL, SERVICE_CHANNEL
from cnc_ptp.axis.homing_commands import refuse_to_home
from cnc_ptp.control.drives.sercos import idns
from cnc_ptp.control.drives.sercos.service_channel import ALREADY_ACTIVE, ServiceChannel, ServiceError
from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.unit import Answer

READ, WRITE = "read_drive_parameter", "write_drive_parameter"


class DriveParameterCommands:
    """`read_drive_parameter`, `write_drive_parameter`."""

    def __init__(self, axis: Axis, homing: DriveHoming) -> None:
        self._axis, self._homing = axis, homing

    def do_read_drive_parameter(self, cycle: int, *, idn: str) -> Answer:
        """The answer is text and value: "S-0-0403 = 3". Refusals: 23120, 23121."""
        service = self._service(READ)
        try:
            value = service.read(idn)
        except ServiceError as error:
            self._refuse(READ, error)
        return Answer(f"{idn} = {value}", {idn: value})

    def do_write_drive_parameter(self, cycle: int, *, idn: str, value: int) -> None:
        """Writes in the digits of the drive. S-0-0148 = 3 lets the drive home the axis, 0 ends that.

        Refusals: 23120, 23121; for S-0-0148 = 3 those of `home` that concern the state of the axis, too.
        """
        service = self._service(WRITE)
        try:
            service.check(idn, value)
            if idn == idns.HOMING:
                self._command_homing(cycle, service, value)
            else:
                service.write(idn, value)
        except ServiceError as error:
            self._refuse(WRITE, error)

    def _command_homing(self, cycle: int, service: ServiceChannel, value: int) -> None:
        axis, homing = self._axis, self._homing
        if axis.state == S.HOMING and homing.by_command:
            raise ServiceError(ALREADY_ACTIVE, f"{idns.HOMING} is active for home; stop ends it")
        if value == idns.SET_AND_ENABLE and not axis.lead.active:
            refuse_to_home(axis, WRITE)
            axis.begin_homing(cycle)
            homing.begin(service, by_command=False)
            return
        service.write(idns.HOMING, value)
        if not value:
            homing.end(cycle, service.homing)

    def _service(self, command: str) -> ServiceChannel:
        service = self._homing.service
        if service is None:
            reason = "the axis has no SERCOS drive (P-AXIS-00020), which has such parameters"
            self._axis.refuse(command, NO_SERVICE_CHANNEL, reason)
        return service

    def _refuse(self, command: str, error: ServiceError) -> None:
        self._axis.refuse(
            command, SERVICE_CHANNEL, f"{error.reason} (SERCOS error 0x{error.code:04x})", code=error.code
        )
