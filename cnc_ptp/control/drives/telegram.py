"""Telegram between NC and drive: whole digits of limited length in both directions."""

from __future__ import annotations

from mypy_extensions import mypyc_attr

from cnc_ptp.control.drive_format import CounterReader, drive_format
from cnc_ptp.control.drives.drive import Drive
from cnc_ptp.parameters.view.control_view import ControlParameters


@mypyc_attr(allow_interpreted_subclasses=True)
class TelegramDrive(Drive):
    """Encodes commands as the telegram does and decodes the actual values; the drive gets the values of the words.

    What the telegram does not carry is not transmitted: additive values without an object are 0, a velocity without an
    object is the distance of the last cycle divided by its time, a torque without an object is 0.0 (`has_torque` is
    False).
    """

    __slots__ = (
        "_carries",
        "_cycle_time",
        "_drive",
        "_feedback",
        "_format",
        "_interface",
        "_set_position",
        "_shown",
        "additive_torque_word",
        "additive_velocity_word",
        "command_word",
        "position_word",
        "torque_word",
        "velocity_word",
    )

    def __init__(self, control: ControlParameters, drive: Drive, *, cycle_time: float) -> None:
        """`drive` takes the commands of `control.drive.interface` in kernel units; `cycle_time` in s."""
        super().__init__(service=drive.service)
        self._drive = drive
        self._cycle_time = cycle_time
        self._interface = control.drive.interface
        self._carries = control.drive.commands
        self._feedback = control.drive.feedback
        self._format = form = drive_format(control.scaling, control.drive)
        self.has_torque = "torque" in self._feedback and form.actual_torque.scale != 0.0
        start = form.sign * drive.position
        self._set_position = CounterReader(form.position, position=start)
        self._shown = CounterReader(form.actual_position, position=start)
        self.command_word = form.position.encode(start) if self._interface == "position" else 0
        self.additive_velocity_word = self.additive_torque_word = 0
        self.velocity_word = self.torque_word = 0
        self.position_word = form.actual_position.encode(start)
        self.position = form.sign * self._shown.position

    def step(self, command: float, additive_velocity: float = 0.0, additive_torque: float = 0.0) -> None:
        """Commands in kernel units: velocity, position, lag or torque as the interface asks for."""
        form, carries = self._format, self._carries
        sign = form.sign
        velocity = sign * additive_velocity if "additive_velocity" in carries else 0.0
        torque = sign * additive_torque if "additive_torque" in carries else 0.0
        self.additive_velocity_word = form.additive_velocity.encode(velocity)
        self.additive_torque_word = form.additive_torque.encode(torque)
        self._drive.step(
            sign * self._received(sign * command),
            sign * form.additive_velocity.decode(self.additive_velocity_word),
            sign * form.additive_torque.decode(self.additive_torque_word),
        )
        self._take_over()

    def _received(self, command: float) -> float:
        """The command as the drive decodes the word."""
        form, interface = self._format, self._interface
        if interface == "position":
            self.command_word = form.position.encode(command)
            return self._set_position.read(self.command_word)
        digits = {"velocity": form.velocity, "lag": form.lag, "torque": form.torque}[interface]
        self.command_word = digits.encode(command)
        return digits.decode(self.command_word)

    def _take_over(self) -> None:
        form, drive = self._format, self._drive
        sign, before = form.sign, self.position
        self.position_word = form.actual_position.encode(sign * drive.position)
        self.position = sign * self._shown.read(self.position_word)
        if "velocity" in self._feedback:
            self.velocity_word = form.actual_velocity.encode(sign * drive.velocity)
            self.velocity = sign * form.actual_velocity.decode(self.velocity_word)
        else:
            self.velocity = (self.position - before) / self._cycle_time
        if self.has_torque:
            self.torque_word = form.actual_torque.encode(sign * drive.torque)
            self.torque = sign * form.actual_torque.decode(self.torque_word)
