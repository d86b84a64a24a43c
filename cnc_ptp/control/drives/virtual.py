"""The virtual axis: no drive at all, actual values are the set values (P-AXIS-00020 = 16)."""

from __future__ import annotations

from mypy_extensions import mypyc_attr

from cnc_ptp.control.drives.drive import Drive


@mypyc_attr(allow_interpreted_subclasses=True)
class VirtualDrive(Drive):
    """Shows the set values; `step` moves nothing."""

    __slots__ = ()

    def __init__(self, *, start_position: float) -> None:
        """`start_position` in mm or deg."""
        super().__init__(position=start_position)

    def follow(self, position: float, velocity: float) -> None:
        """Takes over the setpoint of a cycle, mm and mm/s (deg, deg/s)."""
        self.position, self.velocity = position, velocity

    def step(self, command: float, additive_velocity: float = 0.0, additive_torque: float = 0.0) -> None:
        """No effect: there is nothing to be commanded."""
