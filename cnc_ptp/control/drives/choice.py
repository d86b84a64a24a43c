"""The drive of an axis, made from its parameters."""

from __future__ import annotations

from cnc_ptp.control.drives.cascaded import CascadedDrive, TorqueCommandedDrive
from cnc_ptp.control.drives.drive import Drive
from cnc_ptp.control.drives.first_order import FirstOrderDrive
from cnc_ptp.control.drives.interfaces import DelayedDrive, LagCommandedDrive, PositionCommandedDrive
from cnc_ptp.control.drives.sercos.sercos_drive import SercosDrive
from cnc_ptp.control.drives.telegram import TelegramDrive
from cnc_ptp.control.drives.virtual import VirtualDrive
from cnc_ptp.parameters.view.control_view import ControlParameters, PlantParameters


def make_drive(control: ControlParameters, cycle_time: float) -> Drive:
    """The drive of the parameters; `cycle_time` in s.

    Plant (P-SIM-00006), on a SERCOS axis with the drive's own motions, then the form of its commands (telegram,
    P-AXIS-00320), then the bus (P-SIM-00018), then its formats, except for the simulated drive (P-AXIS-00020 = 4),
    which takes kernel units. Type 16 has no drive at all.
    """
    interface, plant = control.drive.interface, control.plant
    if interface == "none":
        return VirtualDrive(start_position=plant.start_position)
    drive = commanded_drive(control, interface, cycle_time)
    if plant.bus_delay_cycles:
        rest = drive.position if interface == "position" else 0.0
        drive = DelayedDrive(drive, cycles=plant.bus_delay_cycles, rest=rest)
    return drive if control.drive.ideal else TelegramDrive(control, drive, cycle_time=cycle_time)


def commanded_drive(control: ControlParameters, interface: str, cycle_time: float) -> Drive:
    """The plant behind a velocity, position, lag or torque command.

    A torque command acts on the mechanics alone, even if P-SIM-00006 asks for a first-order lag: that is the lag of a
    velocity controller, and there is none.
    """
    plant, takes_torque = control.plant, interface == "torque"
    drive: Drive = (
        TorqueCommandedDrive(plant, cycle_time=cycle_time) if takes_torque else velocity_drive(plant, cycle_time)
    )
    if control.sercos is not None:
        drive = SercosDrive(control.sercos, plant, drive, cycle_time=cycle_time, own_motion=not takes_torque)
    if interface == "position":
        return PositionCommandedDrive(drive, kv=plant.kv)
    if interface == "lag":
        return LagCommandedDrive(drive, kv=plant.kv)
    return drive


def velocity_drive(plant: PlantParameters, cycle_time: float) -> Drive:
    """The plant that takes velocities (P-SIM-00006)."""
    if plant.cascaded:
        return CascadedDrive(plant, cycle_time=cycle_time)
    return FirstOrderDrive(
        cycle_time=cycle_time,
        time_constant=plant.time_constant,
        encoder_increment=plant.encoder_increment,
        start_position=plant.start_position,
        torque_per_acceleration=plant.torque_per_acceleration,
    )
