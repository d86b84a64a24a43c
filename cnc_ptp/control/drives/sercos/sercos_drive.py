"""A SERCOS drive: follows its cyclic commands, or moves its axis on its own while a procedure command is active."""

from __future__ import annotations

from mypy_extensions import mypyc_attr

from cnc_ptp.control.drives.drive import Drive
from cnc_ptp.control.drives.sercos.homing_procedure import HomingProcedure
from cnc_ptp.control.drives.sercos.service_channel import ServiceChannel
from cnc_ptp.parameters.view.control_view import PlantParameters
from cnc_ptp.parameters.view.sercos_view import SercosParameters

SLOWEST = 0.001
"""mm/s (deg/s); the standstill window S-0-0124 is at least that, or what an increment of the encoder makes of Kv."""


@mypyc_attr(allow_interpreted_subclasses=True)
class SercosDrive(Drive):
    """The plant behind the drive's service channel.

    The encoder counts on when the drive finds its reference; `service.homing.origin` makes drive positions of it. The
    axis takes that over when the drive has set S-0-0403, as a control would with the positions of the telegram.
    """

    __slots__ = ("_drive", "_homing")

    def __init__(
        self, sercos: SercosParameters, plant: PlantParameters, drive: Drive, *, cycle_time: float, own_motion: bool
    ) -> None:
        """`drive`: the plant, which takes velocities, or torques if the drive has no motion of its own."""
        homing = HomingProcedure(
            sercos,
            cycle_time=cycle_time,
            kv=plant.kv,
            place=drive.position,
            standstill_window=max(SLOWEST, plant.kv * plant.encoder_increment),
        )
        super().__init__(has_torque=drive.has_torque, service=ServiceChannel(sercos, homing, own_motion=own_motion))
        self._drive, self._homing = drive, homing
        self._take_over()

    def step(self, command: float, additive_velocity: float = 0.0, additive_torque: float = 0.0) -> None:
        """As the plant; while the drive homes its axis, the commands have no effect."""
        homing, drive = self._homing, self._drive
        if homing.leads:
            drive.step(homing.next_velocity())
        else:
            drive.step(command, additive_velocity, additive_torque)
        homing.watch(drive.position, drive.velocity)
        self._take_over()

    def _take_over(self) -> None:
        drive = self._drive
        self.position, self.velocity, self.torque = drive.position, drive.velocity, drive.torque
