"""The core of a spindle: its state, its setpoints, its limits, refusals and faults."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import copysign, inf
from typing import NoReturn

from cnc_ptp.control.drives import Drive
from cnc_ptp.errors import NO_VALUES, CncError, Value, warning_text
from cnc_ptp.motion.setpoints import Setpoints
from cnc_ptp.parameters import GearParameters, SpindleParameters
from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.spindle_states import SpindleMode
from cnc_ptp.protocol.transitions import Transition, require_source
from cnc_ptp.spindle import transitions as T
from cnc_ptp.spindle.exact_stop import ExactStop
from cnc_ptp.spindle.faults import NOT_READY
from cnc_ptp.spindle.path_travel import PathTravel
from cnc_ptp.spindle.position_loop import PositionLoop
from cnc_ptp.spindle.procedure import Work
from cnc_ptp.spindle.speed_ramp import plan_speed
from cnc_ptp.spindle.speed_table import Motion, SpeedTable
from cnc_ptp.spindle.tool_limits import SpindleLimits, ToolLimits

Report = Callable[[int, int, str, Mapping[str, Value]], None]
"""Takes an event: cycle, number, text, and the numbers of the text by name."""


class Spindle:
    """The setpoint side of a spindle. Commands (one class per group) change it, the unit around it computes cycles.

    Speeds are in °/s, + = M03. Every fault ends in ErrorStop on the ramp of endless rotation.
    """

    def __init__(
        self,
        parameters: SpindleParameters,
        *,
        drive: Drive,
        make_drive: Callable[[GearParameters, float], Drive],
        cycle_time: float,
        report_error: Report,
        report_warning: Report,
    ) -> None:
        """`make_drive(gear, position)`: the drive with the measuring system of a gear; `cycle_time` in s."""
        self.parameters = parameters
        self.name = parameters.name
        self.cycle_time = cycle_time
        self.gear = parameters.gears[parameters.gear]
        self.tool = ToolLimits()
        self.has_tool_limits = False
        self.next_tool: ToolLimits | None = None
        """Counts when the spindle next leaves standstill."""
        self.limits = self._limits()
        self.loop = PositionLoop(parameters, self.gear, drive, cycle_time=cycle_time)
        self._make_drive = make_drive
        self._table = plan_speed(parameters.start_position, 0.0, 0.0, self.limits.ramp)
        self._origin = 0
        self._shift = 0.0
        self.travel: PathTravel | None = None
        """What the path of a channel adds to its own motion."""
        self.powered = parameters.powered_at_start
        self.state = S.STANDSTILL if self.powered else S.DISABLED
        self.mode = SpindleMode.STOP
        self.error_id = 0
        self.job_error = False
        self.referenced = parameters.referenced_at_start
        self.reference_lost = False
        """The control limit was exceeded since the last homing: M05 homes before it stops."""
        self.override_percent = min(100.0, parameters.max_override_percent)
        self.override_suppressed = False
        self.feed_held = False
        self.programmed_speed = 0.0
        """As commanded, °/s: with sign in endless rotation, without in positioning."""
        self.wanted_speed = 0.0
        """Speed with which the actual speed is compared: the programmed one under override and limits."""
        self.target: float | None = None
        """Target of the positioning, also after its end."""
        self.exact_stop = ExactStop(time=parameters.settling_time, cycle_time=cycle_time)
        self.speed_was_reached = True
        self.speed_lost_at = -inf
        """First cycle in which a speed that was reached was lost again."""
        self.unsettled = True
        """In the next cycles more may happen than following the setpoint."""
        self.work = Work()
        self.when_faulted: Callable[[], None] = lambda: None
        """Called immediately at every fault."""
        self.report_error = report_error
        self.report_warning = report_warning

    def warn(self, cycle: int, number: int, reason: str, /, **values: Value) -> str:
        """Reports a warning as an event; returns it as the record of a command shows it."""
        text = f"spindle {self.name}: {reason}"
        self.report_warning(cycle, number, text, values)
        return warning_text(number, text, **values)

    # setpoints

    def motion(self, cycle: int) -> Motion:
        """Set position, speed and acceleration at `cycle`, before a command that acts there."""
        position, speed, acceleration = self._own_motion(cycle)
        if self.travel is None:
            return position, speed, acceleration
        travel = self.travel.at(cycle)
        return position + travel[0], speed + travel[1], acceleration + travel[2]

    def _own_motion(self, cycle: int) -> Motion:
        """Without what a path adds."""
        position, speed, acceleration = self._table.state_at((cycle - self._origin) * self.cycle_time)
        return position + self._shift, speed, acceleration

    def jerk(self, cycle: int) -> float:
        """Of the path; the spindle's own motion has none that is fed forward."""
        return 0.0 if self.travel is None else self.travel.at(cycle)[3]

    def motions(self, first_cycle: int, count: int) -> Setpoints:
        """`motion` of many cycles, as setpoints of the control loop; on no path."""
        cycle_time, shift, first = self.cycle_time, self._shift, first_cycle - self._origin
        times = [cycle * cycle_time for cycle in range(first, first + count)]
        if not self.finished(first_cycle):
            motions = self._table.states_at(times)
            return Setpoints(
                [p + shift for p, _, _ in motions],
                [v for _, v, _ in motions],
                [a for _, _, a in motions],
                [0.0] * count,
            )
        end = self._table.segments[-1]
        start, (position, speed) = end.start, end.position
        positions = [position + (t - start) * speed + shift for t in times]
        return Setpoints(positions, [speed] * count, [0.0] * count, [0.0] * count)

    def finished(self, cycle: int) -> bool:
        """True when the table has reached its end speed."""
        return (cycle - self._origin) * self.cycle_time >= self._table.duration

    def cycles_since_end(self, cycle: int) -> float:
        """Cycles since the table has reached its end speed."""
        return cycle - self._origin - self._table.duration / self.cycle_time

    def cycles_without_speed(self, cycle: int) -> float:
        """Cycles for which the actual speed has been missing, from the end of the table on."""
        return min(self.cycles_since_end(cycle), cycle - self.speed_lost_at)

    def note_speed(self, cycle: int, reached: bool) -> None:
        """Notes whether the actual speed is reached; a rotation can lose it again."""
        if reached:
            self.speed_was_reached = True
        elif self.speed_was_reached and self.state == S.CONTINUOUS_MOTION:
            self.speed_was_reached, self.speed_lost_at = False, float(cycle)
            self.unsettled = True

    def follow(self, cycle: int, table: SpeedTable) -> None:
        """The setpoints come from `table` from `cycle` on."""
        self._table, self._origin, self._shift = table, cycle, 0.0
        self.unsettled = True

    def ramp_to(self, cycle: int, speed: float) -> None:
        """A speed ramp from the state of its own motion at `cycle`."""
        position, before, _ = self._own_motion(cycle)
        self.follow(cycle, plan_speed(position, before, speed, self.limits.ramp))

    def shift_coordinates(self, distance: float) -> None:
        """Shifts the coordinates of set and actual position; nothing moves."""
        self._shift += distance
        self.loop.shift(distance)
        if self.target is not None:
            self.target += distance

    def place(self, cycle: int, position: float) -> None:
        """The set position at `cycle` is `position`; the speed stays."""
        self._shift += position - self.motion(cycle)[0]

    def place_after_open_loop(self, cycle: int) -> None:
        """The set position begins at the actual one, unless a position loop has held it so far."""
        if self.loop.measures_position and self.loop.control.is_open:
            self.place(cycle, self.loop.position)

    @property
    def override(self) -> float:
        if self.feed_held:
            return 0.0
        return 1.0 if self.override_suppressed else self.override_percent / 100.0

    def take(self, transition: Transition) -> None:
        """Changes the state; nothing else does. Every test checks that only transitions of the table are taken."""
        require_source(self.name, self.state, transition)
        self.state = transition.target

    # endless rotation

    def rotate(self, cycle: int, speed: float) -> None:
        """Endless rotation at a signed speed, under override and limits."""
        self.take_tool(cycle)
        self.end_procedure()
        self.mode = SpindleMode.CW if copysign(1.0, speed) > 0.0 else SpindleMode.CCW
        self.take(T.ROTATE)
        self.programmed_speed = speed
        self._open_loop(cycle)
        self.apply_speed(cycle)

    def apply_speed(self, cycle: int) -> None:
        """The ramp of endless rotation to the programmed speed under the present override."""
        self.wanted_speed = self.limits.endless(self.programmed_speed * self.override)
        if abs(self.wanted_speed) > self.parameters.velocity_control_on and not self.parameters.open_loop:
            self.loop.velocity_control = True
        self._await_speed()
        self.ramp_to(cycle, self.wanted_speed)

    def _await_speed(self) -> None:
        self.speed_was_reached, self.speed_lost_at = False, -inf

    def stop(self, cycle: int) -> None:
        """Down to speed 0 immediately; an active job is aborted."""
        self._brake(cycle)
        self.take(T.STOP)

    def _brake(self, cycle: int) -> None:
        self.end_procedure()
        self.mode = SpindleMode.STOP
        self.programmed_speed = self.wanted_speed = 0.0
        self._await_speed()
        self._open_loop(cycle)
        self.ramp_to(cycle, 0.0)

    def end_procedure(self) -> None:
        self.work.cancel()
        self.exact_stop.forget()
        self.target = None
        self.job_error = False

    def take_tool(self, cycle: int) -> None:
        """New limits of a tool count from standstill on."""
        if self.next_tool is not None and self.state == S.STANDSTILL and self.motion(cycle)[1] == 0.0:
            self.tool, self.next_tool = self.next_tool, None
            self.has_tool_limits = self.tool != ToolLimits()
            self.limits = self._limits()

    def use_gear(self, cycle: int, stage: int) -> None:
        """Parameters of another gear; the position of the spindle is that of the encoder."""
        actual = self.loop.position
        self.gear = self.parameters.gears[stage]
        self.loop.use_gear(self.gear, self._make_drive(self.gear, self.loop.control.drive.position))
        self.loop.count_from(actual)
        self.limits = self._limits()
        if self.parameters.has_position:
            self.place(cycle, actual)

    def _limits(self) -> SpindleLimits:
        """An open loop has no control limit."""
        control_limit = inf if self.parameters.open_loop else self.gear.control_limit
        return SpindleLimits(self.gear, self.tool, control_limit=control_limit)

    # position

    @property
    def holds_position(self) -> bool:
        """A positioning has finished, and nothing else was commanded since."""
        return self.work.done and self.target is not None and self.state == S.STANDSTILL

    def note_position(self, cycle: int, away: float, speed: float) -> bool:
        """Exact stop while the setpoint is at a standstill; `away` is the distance from it in °."""
        gear = self.gear
        return self.exact_stop.note(
            cycle, in_position=abs(away) <= gear.position_window, at_rest=abs(speed) <= gear.zero_speed
        )

    # path of a channel

    def leave_path(self, cycle: int, travel: float | None = None) -> None:
        """Its own motion is left; what speed it had of the path ends on its ramp, or at `travel` (deg) of the path."""
        assert self.travel is not None
        position, speed, _ = self.motion(cycle)
        own = self._own_motion(cycle)[1]
        if travel is not None:
            position, speed = self._own_motion(cycle)[0] + travel, own
        self.travel = None
        self.follow(cycle, plan_speed(position, speed, own if self.finished(cycle) else 0.0, self.limits.ramp))
        if self.state == S.SYNCHRONIZED_MOTION:
            self.mode = SpindleMode.STOP
            self.take(T.LEAVE_PATH)

    # position loop

    def _open_loop(self, cycle: int) -> None:
        """The speed of a controlled spindle continues from the command of the position controller."""
        if self.travel is not None:
            return
        speed = self.loop.open()
        if speed is not None:
            self.follow(cycle, plan_speed(self.loop.position, speed, speed, self.limits.ramp))

    def watch_loop(self, cycle: int, speed: float) -> None:
        """Opens and closes the position loop when the speed requires it; the closed loop continues without a jump."""
        if self.loop.passes_limit(speed):
            self.referenced = False
            self.reference_lost = True
        else:
            self.loop.comes_back(speed)
        if self.loop.leaves_velocity_control(speed, self.wanted_speed):
            self.place(cycle, self.loop.position + self.loop.lag(speed))

    # refusals and faults

    def refuse(self, command: str, number: int, reason: str, /, **values: Value) -> NoReturn:
        raise self._refusal(command, number, reason, "nothing was changed", **values)

    def _refusal(self, command: str, number: int, reason: str, effect: str, /, **values: Value) -> CncError:
        return CncError(number, reason, effect, where=f"spindle {self.name}: {command} refused", **values)

    def require_ready(self, command: str) -> None:
        """Raises 24003 in ErrorStop and without power."""
        if self.state == S.ERROR_STOP:
            reason = f"the spindle is in ErrorStop (P-ERR-{self.error_id}); reset it first"
            self.refuse(command, NOT_READY, reason, state="ErrorStop", error=self.error_id)
        if self.state == S.DISABLED:
            self.refuse(command, NOT_READY, "the spindle is in Disabled; power it on", state="Disabled")

    def fault(self, cycle: int, error_id: int, reason: str, values: Mapping[str, Value] = NO_VALUES) -> None:
        """Error reaction: down to speed 0 on the spindle's ramp, state ErrorStop; `values`: numbers of the reason."""
        had_job = self.work.procedure is not None or not self.speed_was_reached
        if self.state == S.DISABLED:
            self.place_after_open_loop(cycle)
        self._brake(cycle)
        self.error_id = error_id
        self.job_error = had_job
        self.take(T.FAULT)
        self.when_faulted()
        how = "on its ramp" if self.travel is None else "with the path"
        if self.travel is not None and self.travel.stop is not None:
            how = "in step with the axes of the path"
        text = f"spindle {self.name}: {reason}; the spindle stops {how} (ErrorStop)"
        self.report_error(cycle, error_id, text, values)

    def fail(self, command: str, cycle: int, number: int, reason: str, /, **values: Value) -> NoReturn:
        """A command that is refused and puts the spindle into ErrorStop."""
        self.fault(cycle, number, reason, values)
        self.job_error = True
        raise self._refusal(command, number, reason, "the spindle is in ErrorStop", **values)
