"""The drive of an axis that moves the axis on its own (S-0-0148), as the axis sees it."""

from __future__ import annotations

from cnc_ptp.control.drives.sercos.service_channel import ServiceChannel


class DriveLead:
    """Whether the axis follows its drive, how to end that, and the drive's service channel."""

    def __init__(self, service: ServiceChannel | None = None) -> None:
        """Without `service` the drive always follows its cyclic commands."""
        self.service = service
        self.active = False
        """The setpoints follow the drive: it moves or holds the axis, or has ended that after the last cycle."""

    def cancel(self) -> None:
        """Takes the procedure command away; the drive stops on its ramp, and the axis follows it to standstill."""
        if self.service is not None:
            self.service.homing.cancel()
