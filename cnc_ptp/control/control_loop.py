"""One axis below its setpoint: position controller, feedforward, friction compensation and drive, cycle by cycle.

    setpoint ─▶ delay line ─▶ position controller ─▶ + ─▶ drive ─▶ actual position
        └────▶ feedforward, friction compensation ──┴──────▲ additive velocity and torque

The delay line is there only where something must be known before the setpoint counts (P-AXIS-00165 on PROFIdrive,
P-COMP-00044). Sources: TF5200 feedforward figures 1 and 2, friction figures 4 and 6.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from cnc_ptp.control.drives import Drive, VirtualDrive
from cnc_ptp.control.feedforward import CouplingLimits, Feedforward
from cnc_ptp.control.following_error_monitor import FollowingErrorMonitor
from cnc_ptp.control.friction_compensation import FrictionCompensation
from cnc_ptp.control.history import SetpointHistory
from cnc_ptp.control.modulo_compensation import ModuloCompensation
from cnc_ptp.control.velocity_controller import VelocityController
from cnc_ptp.errors import Value
from cnc_ptp.motion.setpoints import MotionState, Setpoints
from cnc_ptp.parameters.view.control_view import ControlParameters


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


class ControlColumns:
    """The values of ControlCycle over many cycles, each a list."""

    __slots__ = (
        "actual_position",
        "actual_torque",
        "actual_velocity",
        "additive_torque",
        "additive_velocity",
        "command_velocity",
        "feedforward_percent",
        "feedforward_velocity",
        "following_error",
        "friction_current",
    )

    def __init__(self) -> None:
        self.actual_position: list[float] = []
        self.actual_velocity: list[float] = []
        self.following_error: list[float] = []
        self.command_velocity: list[float] = []
        self.feedforward_velocity: list[float] = []
        self.additive_velocity: list[float] = []
        self.additive_torque: list[float] = []
        self.friction_current: list[float] = []
        self.actual_torque: list[float] = []
        self.feedforward_percent: list[float] = []

    def last(self) -> ControlCycle:
        """The newest cycle."""
        return ControlCycle(
            self.actual_position[-1],
            self.actual_velocity[-1],
            self.following_error[-1],
            self.command_velocity[-1],
            self.feedforward_velocity[-1],
            self.additive_velocity[-1],
            self.additive_torque[-1],
            self.friction_current[-1],
            self.actual_torque[-1],
            self.feedforward_percent[-1],
        )

    def nothing_added(self, count: int) -> None:
        """Neither feedforward nor friction compensation has acted in `count` cycles."""
        none = [0.0] * count
        self.feedforward_velocity += none
        self.additive_velocity += none
        self.additive_torque += none
        self.friction_current += none
        self.feedforward_percent += none


class ControlLoop:
    """Position control of one axis or spindle in one gear."""

    def __init__(
        self, parameters: ControlParameters, *, cycle_time: float, limits: CouplingLimits, drive: Drive
    ) -> None:
        """`cycle_time` in s; `limits` of the axis, within which feedforward is coupled in and out."""
        self.drive = drive
        self._virtual = drive if isinstance(drive, VirtualDrive) else None
        self._cycle_time = cycle_time
        self.kv = parameters.kv
        self.monitor = FollowingErrorMonitor(parameters.monitoring, kv=parameters.kv, cycle_time=cycle_time)
        self.delay_cycles = parameters.delay_cycles
        scaling = parameters.scaling
        self.feedforward = self._feedforward_of(parameters, limits)
        self.friction = self._friction_of(parameters)
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
        self._history = SetpointHistory()
        self.offset = 0.0
        """Offset between the position of the encoder and the coordinates of the axis."""
        self.is_open = True
        """Whether the loop was open in the last cycle; True before the first one."""
        self._plain = self._interface == "velocity" and self.delay_cycles == 0
        self._plain = self._plain and not (self._virtual or self._modulo.on or parameters.friction.permitted)

    def _feedforward_of(self, parameters: ControlParameters, limits: CouplingLimits) -> Feedforward:
        scaling = parameters.scaling
        return Feedforward(
            parameters.feedforward,
            cycle_time=self._cycle_time,
            kv=parameters.kv,
            torque_per_acceleration=scaling.torque_per_acceleration if scaling.torque else 0.0,  # 110465
            limits=limits,
            delay_cycles=self.delay_cycles,
            samples_velocity=parameters.drive.interface == "torque",
        )

    def _friction_of(self, parameters: ControlParameters) -> FrictionCompensation:
        return FrictionCompensation(parameters.friction, delay_cycles=self.delay_cycles, cycle_time=self._cycle_time)

    def take(self, parameters: ControlParameters, limits: CouplingLimits) -> None:
        """Other gains, feedforward and friction compensation, at a standstill; the feedforward is to be selected again.

        Drive, formats and delays are those of the start.
        """
        self.kv = parameters.kv
        self.monitor.take(parameters.monitoring, kv=parameters.kv)
        self.feedforward = self._feedforward_of(parameters, limits)
        friction, self.friction = self.friction, self._friction_of(parameters)
        self.friction.follow(friction)

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
        self._history.shift(distance)

    def take_offset(self, offset: float) -> None:
        """From now on the axis is at `offset` where the encoder is at 0."""
        distance, self.offset = offset - self.offset, offset
        self._history.shift(distance)

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
        if behind and history.filled:
            return history.position(behind - 1) - self.position, history.velocity(behind - 1)
        return setpoint[0] - self.position, setpoint[1]

    def too_far(self, setpoint: MotionState) -> bool:
        """True when the following error of this cycle is above what P-AXIS-00172 permits; changes nothing."""
        if self._virtual is not None:
            return False
        following_error, velocity = self.monitored(setpoint)
        return self.monitor.exceeded(following_error, velocity)

    def why_too_far(self, setpoint: MotionState, unit: str) -> str:
        """Following error, limit and its parameter, for messages."""
        following_error, velocity = self.monitored(setpoint)
        limit = f"{round(self.monitor.limit(velocity), 4)} {unit} ({self.monitor.source(velocity)})"
        return f"following error {following_error:.4f} {unit} exceeds {limit}"

    def lag_values(self, setpoint: MotionState) -> dict[str, Value]:
        """The numbers of `why_too_far`, mm or deg."""
        following_error, velocity = self.monitored(setpoint)
        return {"following_error": following_error, "limit": self.monitor.limit(velocity)}

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
        columns = ControlColumns()
        self.cycle(setpoint, closed, columns, open_velocity)
        return columns.last()

    def follow(self, setpoints: Setpoints, closed: bool, columns: ControlColumns, *, watched: bool) -> int:
        """`cycle` for many setpoints; if `watched`, up to the first excessive following error. Returns their number."""
        self.is_open = not closed
        if closed and self._plain and not self.feedforward.active:
            return self._plain_cycles(setpoints, columns, watched)
        count = len(setpoints)
        for index in range(count):
            setpoint = setpoints.at(index)
            if watched and self.too_far(setpoint):
                return index
            self.cycle(setpoint, closed, columns)
        return count

    def _plain_cycles(self, setpoints: Setpoints, columns: ControlColumns, watched: bool) -> int:
        """Position control alone: v = Kv · following error."""
        drive, monitor, offset, kv = self.drive, self.monitor, self.offset, self.kv
        monitored = monitor.on
        set_positions, set_velocities = setpoints.positions, setpoints.velocities
        positions, velocities, errors = columns.actual_position, columns.actual_velocity, columns.following_error
        commands, torques = columns.command_velocity, columns.actual_torque
        count = len(set_positions)
        n = 0
        while n < count:
            position = drive.position + offset
            following_error = set_positions[n] - position
            if monitored:
                if watched and monitor.exceeded(following_error, set_velocities[n]):
                    break
                monitor.advance(following_error, set_velocities[n])
            command = kv * following_error
            positions.append(position)
            velocities.append(drive.velocity)
            errors.append(following_error)
            commands.append(command)
            torques.append(drive.torque)
            drive.step(command)
            n += 1
        if self.feedforward.mode:
            for index in range(n):
                self._history.take(
                    set_positions[index],
                    set_velocities[index],
                    setpoints.accelerations[index],
                    setpoints.jerks[index],
                )
        columns.nothing_added(n)
        return n

    def cycle(self, setpoint: MotionState, closed: bool, columns: ControlColumns, open_velocity: float = 0.0) -> None:
        """`step`, with the values of the cycle added to `columns`."""
        drive = self.drive
        self.is_open = not closed
        if self._virtual is not None:
            self._virtual.follow(setpoint[0] - self.offset, setpoint[1])
            columns.actual_position.append(setpoint[0])
            columns.actual_velocity.append(setpoint[1])
            columns.following_error.append(0.0)
            columns.command_velocity.append(0.0)
            columns.actual_torque.append(0.0)
            columns.nothing_added(1)
            return
        position = self.position
        columns.actual_position.append(position)
        columns.actual_velocity.append(drive.velocity)
        columns.following_error.append(setpoint[0] - position)
        columns.actual_torque.append(drive.torque)
        if closed:
            self._close(setpoint, position, columns)
        else:
            self._open(open_velocity)
            columns.command_velocity.append(open_velocity)
            columns.nothing_added(1)

    def _close(self, setpoint: MotionState, position: float, columns: ControlColumns) -> None:
        """Position control with all that is added to it."""
        history, feedforward, friction = self._history, self.feedforward, self.friction
        history.take(setpoint[0], setpoint[1], setpoint[2], setpoint[3])
        behind = self.delay_cycles
        set_position, set_velocity = history.position(behind), history.velocity(behind)
        lag = set_position - position
        self.monitor.advance(lag, set_velocity)
        command = self.kv * lag
        if feedforward.active:
            feedforward.update(history, command)
            command += feedforward.velocity
        friction.update(history)
        additive_torque = feedforward.additive_torque + friction.current * self._torque_per_digit
        velocity = self.drive.velocity
        self._command(command, set_position, lag, velocity, feedforward.additive_velocity, additive_torque)
        columns.command_velocity.append(command)
        columns.feedforward_velocity.append(feedforward.velocity)
        columns.additive_velocity.append(feedforward.additive_velocity)
        columns.additive_torque.append(additive_torque)
        columns.friction_current.append(friction.current)
        columns.feedforward_percent.append(feedforward.percent)

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
