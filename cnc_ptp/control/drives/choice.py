"""Which drive an axis gets from its parameters."""

from __future__ import annotations

from cnc_ptp.control.drives.cascaded import CascadedDrive
from cnc_ptp.control.drives.drive import Drive
from cnc_ptp.control.drives.first_order import FirstOrderDrive
from cnc_ptp.control.drives.virtual import VirtualDrive
from cnc_ptp.parameters.control_view import ControlParameters


def make_drive(control: ControlParameters, cycle_time: float) -> Drive:
    """The simulated drive of the parameters; `cycle_time` in s."""
    plant = control.plant
    if control.drive.interface == "none":
        return VirtualDrive(start_position=plant.start_position)
    if plant.cascaded:
        return CascadedDrive(plant, cycle_time=cycle_time)
    return FirstOrderDrive(
        cycle_time=cycle_time,
        time_constant=plant.time_constant,
        encoder_increment=plant.encoder_increment,
        start_position=plant.start_position,
        torque_per_acceleration=plant.torque_per_acceleration,
    )
