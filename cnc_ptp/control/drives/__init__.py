"""Drives and mechanics behind one small interface; all of them are simulated."""

from cnc_ptp.control.drives.cascaded import CascadedDrive, TorqueCommandedDrive
from cnc_ptp.control.drives.choice import make_drive
from cnc_ptp.control.drives.drive import Drive
from cnc_ptp.control.drives.first_order import FirstOrderDrive
from cnc_ptp.control.drives.interfaces import DelayedDrive, LagCommandedDrive, PositionCommandedDrive
from cnc_ptp.control.drives.telegram import TelegramDrive
from cnc_ptp.control.drives.virtual import VirtualDrive

__all__ = [
    "CascadedDrive",
    "DelayedDrive",
    "Drive",
    "FirstOrderDrive",
    "LagCommandedDrive",
    "PositionCommandedDrive",
    "TelegramDrive",
    "TorqueCommandedDrive",
    "VirtualDrive",
    "make_drive",
]
