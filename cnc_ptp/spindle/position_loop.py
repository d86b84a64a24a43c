"""Position loop of a spindle: closed, opened at the control limit or by velocity control, or always open.

TF5200 spindle 2.2.4 (open position loop), 2.4.2 (control limit), P-AXIS-00265 and 00266 (velocity control). In the open
loop the speed setpoint goes to the drive. The loop of a controlled spindle whose drive sends its position is open in
rotation and closed while it is positioned, homed or held; it closes and opens without a step of the command. Above the
control limit the actual values are simulated: position controller and feedforward continue with an ideal drive, so that
the limit has no effect on the real drive; at constant speed the following error is speed / Kv without
feedforward. Units: °, °/s.
"""

from __future__ import annotations

from math import inf

from cnc_ptp.control.control_loop import ControlColumns, ControlLoop
from cnc_ptp.control.drive_format import shown_velocity
from cnc_ptp.control.drives import Drive
from cnc_ptp.control.feedforward import CouplingLimits, Feedforward
from cnc_ptp.motion.setpoints import MotionState, Setpoints
from cnc_ptp.parameters import GearParameters, SpindleParameters

ROUNDING = 1e-12
"""Part of the control limit by which a speed limited to it may exceed it by rounding."""
Cycles = tuple[list[float], list[float], list[float], list[int], list[float]]
"""Actual positions, actual speeds, following errors, drive outputs."""


class SimulatedActuals:
    """Simulated actual values above the control limit: of an ideal drive under the same position controller."""

    def __init__(self, position: float, speed: float, *, kv: float, feedforward: float) -> None:
        """Starts with the last measured values; `feedforward` is the part of the set speed output besides Kv."""
        self.position, self.speed = position, speed
        self._kv, self._feedforward = kv, feedforward

    def step(self, setpoint: MotionState, cycle_time: float) -> float:
        """The command of this cycle, which the ideal drive follows until the next one."""
        self.speed = self._kv * (setpoint[0] - self.position) + self._feedforward * setpoint[1]
        self.position += self.speed * cycle_time
        return self.speed


class PositionLoop:
    """The control loop of the active gear, closed or open, and the actual values, cycle by cycle."""

    def __init__(self, parameters: SpindleParameters, gear: GearParameters, drive: Drive, *, cycle_time: float) -> None:
        """`cycle_time` in s."""
        self._parameters = parameters
        self._cycle_time = cycle_time
        self._simulated: SimulatedActuals | None = None
        self._feedforward = 0.0
        """Part of the set speed that was output besides the position controller."""
        self._positions = False
        """A controlled spindle is positioned, homed or held."""
        self._commanded_speed = 0.0
        self.velocity_control = False
        self.drive_output = 0
        self.feedforward_percent = 0.0
        """Weight with which feedforward acts, 0 = off."""
        self._last_position: float | None = None
        self._feedforward_on, self._weight_percent = False, 100.0
        self.use_gear(gear, drive)

    def use_gear(self, gear: GearParameters, drive: Drive) -> None:
        """The parameters of a gear count from now on; `drive` has its measuring system."""
        self._gear = gear
        self._control_limit = gear.control_limit * (1.0 + ROUNDING)
        self.control = ControlLoop(
            gear.control,
            cycle_time=self._cycle_time,
            limits=CouplingLimits(gear.max_speed, gear.max_acceleration, inf),
            drive=drive,
        )
        self.control.select_feedforward(self._feedforward_on, self._weight_percent)
        self._output = shown_velocity(gear.control.scaling, gear.control.drive)

    @property
    def feedforward(self) -> Feedforward:
        return self.control.feedforward

    def select_feedforward(self, on: bool, weight_percent: float) -> None:
        """G135 or G137 with the weight of G136; it holds in all gears."""
        self._feedforward_on, self._weight_percent = on, weight_percent
        self.control.select_feedforward(on, weight_percent)

    def count_from(self, position: float) -> None:
        """The spindle is at `position`, whatever the encoder shows."""
        self.control.count_from(position)
        self._last_position = None

    def shift(self, distance: float) -> None:
        """All coordinates grow by `distance`."""
        self.control.shift(distance)
        if self._simulated is not None:
            self._simulated.position += distance
        self._last_position = None if self._last_position is None else self._last_position + distance

    @property
    def encoder(self) -> float:
        """Position as the encoder counts it."""
        return self.control.encoder

    @property
    def position(self) -> float:
        """Actual position as the encoder shows it."""
        return self.control.position

    @property
    def beyond_limit(self) -> bool:
        """Above the control limit; actual values are simulated."""
        return self._simulated is not None

    @property
    def closed(self) -> bool:
        closes = self._positions or not self._parameters.open_loop
        return closes and not (self.beyond_limit or self.velocity_control)

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
        return speed * (1.0 - self.feedforward.velocity_part) / self.control.kv

    def close(self, speed: float) -> float:
        """A controlled spindle at `speed` is positioned from now on; the set position at which its command stays."""
        self._positions = True
        return self.position + self.lag(speed)

    def open(self) -> float | None:
        """A controlled spindle is no longer positioned: the speed it was commanded to; None if the loop was open."""
        closed, self._positions = self._positions, False
        return self._commanded_speed if closed else None

    def passes_limit(self, set_speed: float) -> bool:
        """True in the cycle in which the speed goes above the control limit; the reference is lost with it."""
        if self.beyond_limit or self._parameters.open_loop or abs(set_speed) <= self._control_limit:
            return False
        control = self.control
        self._simulated = SimulatedActuals(
            control.position, control.drive.velocity, kv=control.kv, feedforward=self._feedforward
        )
        return True

    def comes_back(self, set_speed: float) -> bool:
        """True when the speed has come below the control limit: the measuring system is used again, from the
        simulated position on.
        """
        if self._simulated is None or abs(set_speed) > self._control_limit:
            return False
        simulated, self._simulated = self._simulated, None
        self.count_from(simulated.position)
        return True

    def waits_to_close(self, set_speed: float, wanted_speed: float) -> bool:
        """Under velocity control that is no longer needed; only the drive must still slow down."""
        return (
            self.velocity_control
            and abs(wanted_speed) <= self._parameters.velocity_control_on
            and abs(set_speed) <= self._parameters.velocity_control_off
        )

    def leaves_velocity_control(self, set_speed: float, wanted_speed: float) -> bool:
        """True when no speed above P-AXIS-00265 is commanded and the spindle is down to P-AXIS-00266."""
        if not self.waits_to_close(set_speed, wanted_speed):
            return False
        limit = self._parameters.velocity_control_off
        if abs(self.control.drive.velocity) > limit + max(
            self._gear.zero_speed, self._parameters.speed_reached_band * limit
        ):
            return False
        self.velocity_control = False
        return True

    def actual_position(self, set_position: float, set_speed: float) -> float:
        """Measured, or simulated where there is no measurement."""
        if self._simulated is not None:
            return self._simulated.position
        measured = self._parameters.has_position and not self.control.virtual
        return self.control.position if measured else set_position

    def actual_speed(self, set_speed: float) -> float:
        """From the actual values of the drive; once per cycle, because an open loop computes it from two positions."""
        if self._simulated is not None:
            return self._simulated.speed
        if not self.measures_speed or self.control.virtual:
            return set_speed
        if self._parameters.open_loop and self._parameters.has_position:
            last, self._last_position = self._last_position, self.position
            return 0.0 if last is None else (self._last_position - last) / self._cycle_time
        return self.control.drive.velocity

    @property
    def undisturbed_speed(self) -> float:
        """Largest magnitude of speed at which nothing opens or closes the loop; none while it is open temporarily."""
        if self.velocity_control or self.beyond_limit:
            return -inf
        return inf if self._parameters.open_loop else self._control_limit

    def watches(self, *, on: bool) -> bool:
        """True while the following error is monitored; `on` is False without power."""
        return self.control.monitor.on and on and self.closed

    def cycles(self, setpoints: Setpoints, *, on: bool, watched: bool) -> Cycles:
        """Many cycles in which the loop neither opens nor closes; if `watched`, up to an excessive following error.

        The same as actual_position, actual_speed and command, cycle by cycle.
        """
        if on and self.closed and not self._parameters.open_loop:
            return self._closed_cycles(setpoints, watched)
        cycles: Cycles = [], [], [], [], []
        actuals, actual_speeds, errors, outputs, percents = cycles
        for index in range(len(setpoints)):
            setpoint = setpoints.at(index)
            if watched and self.control.too_far(setpoint):
                break
            actual = self.actual_position(setpoint[0], setpoint[1])
            actuals.append(actual)
            actual_speeds.append(self.actual_speed(setpoint[1]))
            errors.append(setpoint[0] - actual)
            self.command(setpoint, on=on)
            outputs.append(self.drive_output)
            percents.append(self.feedforward_percent)
        return cycles

    def _closed_cycles(self, setpoints: Setpoints, watched: bool) -> Cycles:
        control = ControlColumns()
        self.control.follow(setpoints, True, control, watched=watched)
        outputs = self._output.encode_all(control.command_velocity)
        if outputs:
            self.drive_output = outputs[-1]
            self.feedforward_percent = control.feedforward_percent[-1]
            added = control.feedforward_velocity[-1] + control.additive_velocity[-1]
            self._note_feedforward(added, setpoints.velocities[len(outputs) - 1])
        return (
            control.actual_position,
            control.actual_velocity,
            control.following_error,
            outputs,
            control.feedforward_percent,
        )

    def _note_feedforward(self, feedforward_speed: float, set_speed: float) -> None:
        self._feedforward = feedforward_speed / set_speed if set_speed else 0.0

    def command(self, setpoint: MotionState, *, on: bool) -> None:
        """Moves the drive for one cycle. `on` is False without power.

        In the open loop a controlled spindle turns as fast as the output digits say (spindle 2.2.4).
        """
        speed = setpoint[1] if on else 0.0
        if self._parameters.open_loop:
            speed = self._output.decode(self._output.encode(speed))
        if self._simulated is not None and on:
            speed = self._simulated.step(setpoint, self._cycle_time)
        cycle = self.control.step(setpoint, on and self.closed, speed)
        self._note_feedforward(cycle.feedforward_velocity + cycle.additive_velocity, setpoint[1])
        self.feedforward_percent = cycle.feedforward_percent
        self._commanded_speed = cycle.command_velocity + cycle.additive_velocity
        self.drive_output = self._output.encode(cycle.command_velocity)
