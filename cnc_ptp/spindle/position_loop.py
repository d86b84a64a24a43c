"""Position loop of a spindle: closed, opened at the control limit or by velocity control, or open for good.

TF5200 spindle 2.2.4 (open position loop), 2.4.2 (control limit), P-AXIS-00265 and 00266 (velocity control). In the open
loop the speed setpoint goes to the drive. Above the control limit the actual values are simulated: the following error
is speed / Kv. Units: °, °/s.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from math import inf

from cnc_ptp.control.drives import Drive
from cnc_ptp.control.feedforward import CouplingLimits, Feedforward, State
from cnc_ptp.parameters import GearParameters, SpindleParameters
from cnc_ptp.spindle.speed_table import Motion

HISTORY = 16
"""Setpoints that feedforward may look back at."""
Cycles = tuple[list[float], list[float], list[float], list[int]]
"""Actual positions, actual speeds, following errors, drive outputs."""


class PositionLoop:
    """Command to the drive and actual values, cycle by cycle."""

    def __init__(self, parameters: SpindleParameters, gear: GearParameters, drive: Drive, *, cycle_time: float) -> None:
        """`cycle_time` in s."""
        self._parameters = parameters
        self._cycle_time = cycle_time
        self._increments = parameters.scaling.per_deg_s(cycle_time)
        self.drive = drive
        self.offset = 0.0
        """Between the counting of the encoder and the coordinates of the spindle."""
        self.beyond_limit = False
        self.velocity_control = False
        self.drive_output = 0
        self._last_position: float | None = None
        self._feedforward_on, self._weight_percent = False, 100.0
        self._history: deque[State] = deque(maxlen=HISTORY)
        self.use_gear(gear)

    def use_gear(self, gear: GearParameters) -> None:
        """The parameters of a gear count from now on."""
        self._gear = gear
        self._sign = -1.0 if gear.reversed else 1.0
        self._kv = gear.kv
        self._zero = gear.zero_speed
        self.feedforward = self._make_feedforward(gear)

    def _make_feedforward(self, gear: GearParameters) -> Feedforward:
        """That of a gear, with what was selected; there is no delay line, so no lead either (P-AXIS-00165)."""
        parameters = gear.control.feedforward
        feedforward = Feedforward(
            parameters,
            cycle_time=self._cycle_time,
            kv=gear.kv,
            torque_per_acceleration=gear.control.scaling.torque_per_acceleration,
            limits=CouplingLimits(gear.max_speed, gear.max_acceleration, inf),
            delay_cycles=parameters.lead_cycles,
        )
        feedforward.select(self._feedforward_on, self._weight_percent)
        return feedforward

    def select_feedforward(self, on: bool, weight_percent: float) -> None:
        """G135 or G137 with the weight of G136; it holds in all gears."""
        self._feedforward_on, self._weight_percent = on, weight_percent
        self.feedforward.select(on, weight_percent)

    def count_from(self, position: float) -> None:
        """The encoder stands at `position`, whatever it shows."""
        self.offset = position - self._sign * self.drive.position
        self._last_position = None

    def shift(self, distance: float) -> None:
        """All coordinates grow by `distance`."""
        self.offset += distance
        self._last_position = None if self._last_position is None else self._last_position + distance

    @property
    def encoder(self) -> float:
        """Position as the encoder counts it."""
        return self._sign * self.drive.position

    @property
    def position(self) -> float:
        """Actual position as the encoder shows it."""
        return self._sign * self.drive.position + self.offset

    @property
    def closed(self) -> bool:
        return not (self._parameters.open_loop or self.beyond_limit or self.velocity_control)

    @property
    def measures_position(self) -> bool:
        """The actual position is a measured one."""
        return self._parameters.has_position and not self.beyond_limit

    @property
    def measures_speed(self) -> bool:
        """False: the speed is acknowledged by the setpoint."""
        return self._parameters.feedback != "NONE" and not self.beyond_limit

    def lag(self, speed: float) -> float:
        """Following error of a closed loop at a constant speed."""
        return speed / self._kv

    def passes_limit(self, set_speed: float) -> bool:
        """True in the cycle in which the speed goes above the control limit; the reference is lost with it."""
        if self.beyond_limit or self._parameters.open_loop or abs(set_speed) <= self._gear.control_limit:
            return False
        self.beyond_limit = True
        return True

    def comes_back(self, set_speed: float) -> bool:
        """True when the speed has come below the control limit: the measuring system counts again."""
        if not self.beyond_limit or abs(set_speed) > self._gear.control_limit:
            return False
        self.beyond_limit = False
        self._last_position = None
        return True

    def waits_to_close(self, set_speed: float, wanted_speed: float) -> bool:
        """Under velocity control that is needed no more; only the drive must slow down yet."""
        return (
            self.velocity_control
            and abs(wanted_speed) <= self._parameters.velocity_control_on
            and abs(set_speed) <= self._parameters.velocity_control_off
        )

    def leaves_velocity_control(self, set_speed: float, wanted_speed: float) -> bool:
        """True when no speed above P-AXIS-00265 is wanted and the spindle is down to P-AXIS-00266."""
        if not self.waits_to_close(set_speed, wanted_speed):
            return False
        limit = self._parameters.velocity_control_off
        if abs(self.drive.velocity) > limit + max(self._zero, self._parameters.speed_reached_band * limit):
            return False
        self.velocity_control = False
        return True

    def actual_position(self, set_position: float, set_speed: float) -> float:
        """Measured, or simulated where there is no measurement."""
        if self.measures_position:
            return self._sign * self.drive.position + self.offset
        return set_position - set_speed / self._kv if self.beyond_limit else set_position

    def actual_speed(self, set_speed: float) -> float:
        """By what the drive sends; asked once a cycle, because an open loop takes it from two positions."""
        if not self.measures_speed:
            return set_speed
        if self._parameters.open_loop and self._parameters.has_position:
            last, self._last_position = self._last_position, self.position
            return 0.0 if last is None else (self._last_position - last) / self._cycle_time
        return self._sign * self.drive.velocity

    def undisturbed(self, first_speed: float, last_speed: float) -> bool:
        """True when nothing opens or closes the loop while the speed goes steadily from one value to the other."""
        if self.velocity_control or self.beyond_limit:
            return False
        limit = self._gear.control_limit
        return self._parameters.open_loop or (abs(first_speed) <= limit and abs(last_speed) <= limit)

    def closed_cycles(self, positions: Sequence[float], limit: float) -> Cycles:
        """Cycles of the closed loop for the set `positions`, up to a following error above `limit`.

        The same as actual_position, actual_speed and command, cycle by cycle.
        """
        drive, sign, offset, kv, gain = self.drive, self._sign, self.offset, self._kv, self._gear.output_gain
        step = drive.step
        cycles: Cycles = [], [], [], []
        actuals, speeds, errors, outputs = cycles
        for position in positions:
            actual = sign * drive.position + offset
            error = position - actual
            if not -limit <= error <= limit:
                break
            actuals.append(actual)
            speeds.append(sign * drive.velocity)
            errors.append(error)
            command = kv * error
            outputs.append(round(command * gain * sign))
            step(sign * command)
        if outputs:
            self.drive_output = outputs[-1]
        return cycles

    def cycles(self, motions: Sequence[Motion], limit: float, *, on: bool) -> Cycles:
        """The same with feedforward, where the loop is open, or without power."""
        cycles: Cycles = [], [], [], []
        actuals, actual_speeds, errors, outputs = cycles
        for position, speed, acceleration in motions:
            actual = self.actual_position(position, speed)
            error = position - actual
            if not -limit <= error <= limit:
                break
            actuals.append(actual)
            actual_speeds.append(self.actual_speed(speed))
            errors.append(error)
            self.command(error, speed, acceleration, on=on)
            outputs.append(self.drive_output)
        return cycles

    def command(self, following_error: float, set_speed: float, acceleration: float, *, on: bool) -> float:
        """Moves the drive for one cycle; returns the commanded speed. `on` is False without power."""
        feedforward = self.feedforward
        if not on:
            command = 0.0
        elif self.closed:
            command = self._kv * following_error
            if feedforward.active:
                self._feed_forward(command, set_speed, acceleration)
                command += feedforward.velocity
        else:
            command = set_speed
        if not (on and self.closed):
            self._history.clear()
            feedforward.forget()
        if self._parameters.open_loop and self._increments:
            self.drive_output = round(command * self._increments * self._sign)
            self.drive.step(self.drive_output / self._increments)
        else:
            self.drive_output = round(command * self._gear.output_gain * self._sign)
            self._step(command)
        return command

    def _step(self, command: float) -> None:
        sign, feedforward = self._sign, self.feedforward
        self.drive.step(sign * command, sign * feedforward.additive_velocity, sign * feedforward.additive_torque)

    def _feed_forward(self, feedback: float, speed: float, acceleration: float) -> None:
        setpoint = (0.0, speed, acceleration, 0.0)
        if self._history:
            self._history.appendleft(setpoint)
        else:
            self._history.extend([setpoint] * HISTORY)
        self.feedforward.update(self._history, feedback)
