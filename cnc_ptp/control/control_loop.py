"""One axis below its setpoint: position controller, feedforward, friction compensation and drive, cycle by cycle.

    setpoint ─▶ delay line ─▶ position controller ─▶ + ─▶ drive ─▶ actual position
        └────▶ feedforward, friction compensation ──┴──────▲ additive velocity and torque

The delay line is there only where something must be known before the setpoint counts (P-AXIS-00165 on PROFIdrive,
P-COMP-00044). Sources: TF5200 feedforward figures 1 and 2, friction figures 4 and 6.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from typing import NamedTuple

from cnc_ptp.control.drives import Drive, VirtualDrive
from cnc_ptp.control.feedforward import CouplingLimits, Feedforward
from cnc_ptp.control.following_error_monitor import FollowingErrorMonitor
from cnc_ptp.control.friction_compensation import FrictionCompensation
from cnc_ptp.control.modulo_compensation import ModuloCompensation
from cnc_ptp.control.velocity_controller import VelocityController
from cnc_ptp.motion.profile import MotionState
from cnc_ptp.parameters.view.control_view import ControlParameters

LoopRow = tuple[float, float, float, float, float, float, float, float, float, float]
"""A ControlCycle as a plain tuple, which is faster."""
Columns = Sequence[list[float]]
"""The values of ControlCycle over many cycles."""
HISTORY = 16
"""Number of setpoints kept: 4 cycles of lead, 6 of delay, and their neighbours."""


class ControlCycle(NamedTuple):
    """Values and commands of a cycle; mm, mm/s (deg, deg/s), Nm (N), friction current in the unit of the drive."""

    actual_position: float
    actual_velocity: float
    following_error: float
    """Set position of this cycle - actual position."""
    command_velocity: float
    """Position controller and conventional feedforward."""
    feedforward_velocity: float
    additive_velocity: float
    additive_torque: float
    friction_current: float
    actual_torque: float
    feedforward_percent: float
    """Weight with which feedforward acts in this cycle, 0 = off."""


class ControlLoop:
    """Position control of one axis or spindle in one gear."""

    def __init__(
        self, parameters: ControlParameters, *, cycle_time: float, limits: CouplingLimits, drive: Drive
    ) -> None:
        """`cycle_time` in s; `limits` of the axis, within which feedforward is coupled in and out."""
        self.drive = drive
        self._virtual = drive if isinstance(drive, VirtualDrive) else None
        self.kv = parameters.kv
        self.monitor = FollowingErrorMonitor(parameters.monitoring, kv=parameters.kv, cycle_time=cycle_time)
        self.delay_cycles = parameters.delay_cycles
        scaling = parameters.scaling
        self.feedforward = Feedforward(
            parameters.feedforward,
            cycle_time=cycle_time,
            kv=parameters.kv,
            torque_per_acceleration=scaling.torque_per_acceleration if scaling.torque else 0.0,  # 110465
            limits=limits,
            delay_cycles=self.delay_cycles,
            samples_velocity=parameters.drive.interface == "torque",
        )
        self.friction = FrictionCompensation(parameters.friction, delay_cycles=self.delay_cycles, cycle_time=cycle_time)
        self.torque_digits = scaling.torque
        """Digits of the drive for 1 Nm (N)."""
        self._torque_per_digit = 1.0 / scaling.torque if scaling.torque else 0.0
        self._modulo = ModuloCompensation(parameters.modulo_error, origin=drive.position)
        self._interface = parameters.drive.interface
        self._velocity_controller = VelocityController(
            gain=parameters.drive.velocity_gain,
            integral_time=parameters.drive.velocity_integral_time,
            torque_per_acceleration=scaling.torque_per_acceleration,
            cycle_time=cycle_time,
        )
        self._history: deque[MotionState] = deque(maxlen=HISTORY)
        self.offset = 0.0
        """Offset between the position of the encoder and the coordinates of the axis."""
        self._plain = self._interface == "velocity" and self.delay_cycles == 0
        self._plain = self._plain and not (self._virtual or self._modulo.on or parameters.friction.permitted)

    @property
    def virtual(self) -> bool:
        """No drive: actual values are the set values of the same cycle."""
        return self._virtual is not None

    @property
    def encoder(self) -> float:
        """Position as the encoder counts it, with modulo compensation, mm (deg)."""
        position = self.drive.position
        return position + self._modulo.correction(position) if self._modulo.on else position

    @property
    def position(self) -> float:
        """Actual position, mm (deg)."""
        return self.encoder + self.offset

    def count_from(self, position: float) -> None:
        """The axis is at `position`, whatever the encoder shows."""
        self.offset = position - self.encoder

    def shift(self, distance: float) -> None:
        """All coordinates grow by `distance`."""
        self.offset += distance
        self._history = deque(((p + distance, v, a, j) for p, v, a, j in self._history), maxlen=HISTORY)

    def select_feedforward(self, on: bool, weight_percent: float) -> None:
        """G135 or G137 with the weight of G136: immediately at a standstill, softly in motion.

        Before the first closed cycle nothing has been output that could step.
        """
        self.feedforward.select(on, weight_percent)
        if self.feedforward.at_rest(self._history):
            self.feedforward.settle()

    def monitored(self, setpoint: MotionState) -> tuple[float, float]:
        """Following error and set velocity that the position controller has at `setpoint`, behind the delay line."""
        behind, history = self.delay_cycles, self._history
        position, velocity, _, _ = history[behind - 1] if behind and history else setpoint
        return position - self.position, velocity

    def too_far(self, setpoint: MotionState) -> bool:
        """True when the following error of this cycle is above what P-AXIS-00172 permits; changes nothing."""
        return self._virtual is None and self.monitor.exceeded(*self.monitored(setpoint))

    def why_too_far(self, setpoint: MotionState, unit: str) -> str:
        """Following error, limit and its parameter, for messages."""
        following_error, velocity = self.monitored(setpoint)
        limit = f"{round(self.monitor.limit(velocity), 4)} {unit} ({self.monitor.source(velocity)})"
        return f"following error {following_error:.4f} {unit} exceeds {limit}"

    def lag_share(
        self, positions: Sequence[float], velocities: Sequence[float], actual_position: float, *, unit: float = 1.0
    ) -> float:
        """Following error after cycles with these set values as a fraction of its limit; 1 and more is too large.

        `velocities` in multiples of `unit`, mm/s or deg/s.
        """
        behind = min(self.delay_cycles, len(positions) - 1)
        lag = abs(positions[-1 - behind] - actual_position)
        limit = self.monitor.limit(velocities[-1 - behind] * unit)
        return lag / limit if limit else float(lag > 0.0)

    def step(self, setpoint: MotionState, closed: bool, open_velocity: float = 0.0) -> ControlCycle:
        """Closes the loop for one cycle; if open, the drive gets `open_velocity` and the history is cleared."""
        return ControlCycle(*self._cycle(setpoint, closed, open_velocity))

    def follow(self, setpoints: Sequence[MotionState], closed: bool, *, watched: bool) -> Columns:
        """`step` for many setpoints, value by value; if `watched`, up to the first excessive following error."""
        if closed and self._plain and not self.feedforward.active:
            return self._plain_cycles(setpoints, watched)
        rows = []
        for setpoint in setpoints:
            if watched and self.too_far(setpoint):
                break
            rows.append(self._cycle(setpoint, closed))
        return [*map(list, zip(*rows, strict=True))] if rows else [[] for _ in ControlCycle._fields]

    def _plain_cycles(self, setpoints: Sequence[MotionState], watched: bool) -> Columns:
        """Position control alone: v = Kv · following error."""
        drive, monitor, offset, kv = self.drive, self.monitor, self.offset, self.kv
        step, monitored = drive.step, monitor.on
        columns: tuple[list[float], ...] = [], [], [], [], []
        positions, velocities, errors, commands, torques = columns
        for setpoint in setpoints:
            position = drive.position + offset
            following_error = setpoint[0] - position
            if monitored:
                if watched and monitor.exceeded(following_error, setpoint[1]):
                    break
                monitor.advance(following_error, setpoint[1])
            command = kv * following_error
            positions.append(position)
            velocities.append(drive.velocity)
            errors.append(following_error)
            commands.append(command)
            torques.append(drive.torque)
            step(command)
        n = len(positions)
        if self.feedforward.mode:
            for setpoint in setpoints[:n][-HISTORY:]:
                self._remember(setpoint)
        none = [0.0] * n
        return positions, velocities, errors, commands, none, none, none, none, torques, none

    def _remember(self, setpoint: MotionState) -> None:
        """Before the first setpoint the axis was at rest there."""
        if self._history:
            self._history.appendleft(setpoint)
        else:
            self._history.extend([setpoint] * HISTORY)

    def _cycle(self, setpoint: MotionState, closed: bool, open_velocity: float = 0.0) -> LoopRow:
        drive = self.drive
        if self._virtual is not None:
            self._virtual.follow(setpoint[0] - self.offset, setpoint[1])
            return setpoint[0], setpoint[1], 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        position, velocity, torque = self.position, drive.velocity, drive.torque
        if closed:
            return self._closed_cycle(setpoint, position, velocity, torque)
        self._open(open_velocity)
        return position, velocity, setpoint[0] - position, open_velocity, 0.0, 0.0, 0.0, 0.0, torque, 0.0

    def _closed_cycle(self, setpoint: MotionState, position: float, velocity: float, torque: float) -> LoopRow:
        self._remember(setpoint)
        history = self._history
        set_position, set_velocity, _, _ = history[self.delay_cycles]
        lag = set_position - position
        self.monitor.advance(lag, set_velocity)
        feedforward, friction = self.feedforward, self.friction
        command = self.kv * lag
        if feedforward.active:
            feedforward.update(history, command)
            command += feedforward.velocity
        friction.update(history)
        additive_torque = feedforward.additive_torque + friction.current * self._torque_per_digit
        self._command(command, set_position, lag, velocity, feedforward.additive_velocity, additive_torque)
        return (
            position,
            velocity,
            setpoint[0] - position,
            command,
            feedforward.velocity,
            feedforward.additive_velocity,
            additive_torque,
            friction.current,
            torque,
            feedforward.percent,
        )

    def _command(
        self,
        command: float,
        set_position: float,
        lag: float,
        velocity: float,
        additive_velocity: float,
        additive_torque: float,
    ) -> None:
        """Passes the command on in the form that the drive takes; a drive's own position loop has the same Kv."""
        if self._interface == "velocity":
            self.drive.step(command, additive_velocity, additive_torque)
        elif self._interface == "torque":
            torque = self._velocity_controller.torque(command + additive_velocity - velocity)
            self.drive.step(torque + additive_torque)
        else:
            shift = self.feedforward.velocity / self.kv
            base = lag if self._interface == "lag" else self._on_the_encoder(set_position, lag)
            self.drive.step(base + shift, additive_velocity, additive_torque)

    def _on_the_encoder(self, set_position: float, lag: float) -> float:
        """The set position for a drive, without offset and modulo compensation."""
        return self.drive.position + lag if self._modulo.on or self.offset else set_position

    def _open(self, velocity: float) -> None:
        """No position control: the drive holds a velocity from where it is."""
        self._history.clear()
        self.monitor.forget()
        self.feedforward.forget()
        self.friction.forget()
        drive, controller = self.drive, self._velocity_controller
        if self._interface == "velocity":
            drive.step(velocity)
        elif self._interface == "torque":
            drive.step(controller.torque(velocity - drive.velocity) if velocity else controller.brake(drive.velocity))
        else:
            drive.step(velocity / self.kv + (drive.position if self._interface == "position" else 0.0))
