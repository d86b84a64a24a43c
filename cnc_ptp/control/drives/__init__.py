"""Drives and mechanics behind one small interface; all that are here are simulated."""

from cnc_ptp.control.drives.drive import Drive
from cnc_ptp.control.drives.first_order import FirstOrderDrive

__all__ = ["Drive", "FirstOrderDrive"]
