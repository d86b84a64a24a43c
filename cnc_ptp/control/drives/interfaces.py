"""Interfaces between the command of the NC and a drive that takes velocities: its own position loop, and the bus."""

from __future__ import annotations

from collections import deque

from mypy_extensions import mypyc_attr

from cnc_ptp.control.drives.drive import Drive


@mypyc_attr(allow_interpreted_subclasses=True)
class PositionCommandedDrive(Drive):
    """The drive closes the position loop: v = Kv (x_set - x) once per cycle, x as its encoder shows it."""

    __slots__ = (
        "_drive",
        "_kv",
    )

    def __init__(self, drive: Drive, *, kv: float) -> None:
        """`kv` in 1/s (S-0-0104, P-SIM-00019); `drive` takes velocities."""
        super().__init__(has_torque=drive.has_torque, service=drive.service)
        self._drive, self._kv = drive, kv
        self._take_over()

    def step(self, command: float, additive_velocity: float = 0.0, additive_torque: float = 0.0) -> None:
        """`command` is the set position, mm (deg)."""
        self._drive.step(self._kv * (command - self._drive.position), additive_velocity, additive_torque)
        self._take_over()

    def _take_over(self) -> None:
        drive = self._drive
        self.position, self.velocity, self.torque = drive.position, drive.velocity, drive.torque


@mypyc_attr(allow_interpreted_subclasses=True)
class LagCommandedDrive(Drive):
    """Dynamic servo control: the NC sends its following error, the drive multiplies it: v = Kv · lag."""

    __slots__ = (
        "_drive",
        "_kv",
    )

    def __init__(self, drive: Drive, *, kv: float) -> None:
        """`kv` in 1/s; `drive` takes velocities."""
        super().__init__(has_torque=drive.has_torque, service=drive.service)
        self._drive, self._kv = drive, kv
        self._take_over()

    def step(self, command: float, additive_velocity: float = 0.0, additive_torque: float = 0.0) -> None:
        """`command` is the following error (XERR), mm (deg); NSOLL_B is the additive velocity."""
        self._drive.step(self._kv * command, additive_velocity, additive_torque)
        self._take_over()

    def _take_over(self) -> None:
        drive = self._drive
        self.position, self.velocity, self.torque = drive.position, drive.velocity, drive.torque


@mypyc_attr(allow_interpreted_subclasses=True)
class DelayedDrive(Drive):
    """Delays commands by some cycles on the bus to the drive."""

    __slots__ = (
        "_commands",
        "_drive",
    )

    def __init__(self, drive: Drive, *, cycles: int, rest: float) -> None:
        """`cycles` >= 1; `rest` is the command of the drive until the first one has arrived."""
        super().__init__(has_torque=drive.has_torque, service=drive.service)
        self._drive = drive
        self._commands = deque([(rest, 0.0, 0.0)] * cycles)
        self._take_over()

    def step(self, command: float, additive_velocity: float = 0.0, additive_torque: float = 0.0) -> None:
        """Carries out the command of some cycles ago."""
        self._commands.append((command, additive_velocity, additive_torque))
        self._drive.step(*self._commands.popleft())
        self._take_over()

    def _take_over(self) -> None:
        drive = self._drive
        self.position, self.velocity, self.torque = drive.position, drive.velocity, drive.torque
