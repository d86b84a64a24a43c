"""Drives and mechanics behind one small interface; all that are here are simulated."""

from cnc_ptp.control.drives.choice import make_drive
from cnc_ptp.control.drives.drive import Drive
from cnc_ptp.control.drives.first_order import FirstOrderDrive
from cnc_ptp.control.drives.virtual import VirtualDrive

__all__ = ["Drive", "FirstOrderDrive", "VirtualDrive", "make_drive"]
