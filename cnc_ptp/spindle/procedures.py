"""Jobs of a spindle that take several steps: positioning, homing, stop with homing, gear change.

The steps of a job are fixed when it starts, by the state at that time (open loop, reference); each
cycle checks whether the active step is finished. TF5200 spindle 2.3 (state graphs), 2.7, 2.8.2.
"""

from __future__ import annotations

from math import copysign

from cnc_ptp.control.faults import TARGET_MISSED
from cnc_ptp.errors import Value
from cnc_ptp.parameters.list_units import DEG_S_PER_RPM
from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.spindle_states import SpindleMode
from cnc_ptp.spindle import transitions as T
from cnc_ptp.spindle.faults import GEAR_NOT_ACKNOWLEDGED, NO_ZERO_PULSE
from cnc_ptp.spindle.homing import PATIENCE, ZeroPulse, nearest_shift
from cnc_ptp.spindle.positioning import next_target, plan_positioning, shortest_direction, stopping_distance
from cnc_ptp.spindle.procedure import DIRECTIONS, Procedure, Step
from cnc_ptp.spindle.spindle import Spindle


class Procedures:
    """Carries out the job of one spindle, step by step."""

    def __init__(self, spindle: Spindle) -> None:
        self._spindle = spindle
        self._zero_pulse = ZeroPulse(spindle.parameters.zero_pulse)
        self._search_from: float | None = None
        self._since = 0
        self._turns = 1.0
        """Direction in which the target is reached."""

    # start

    def start(self, cycle: int, procedure: Procedure) -> None:
        """Starts a job, with the steps that it needs before its first own one."""
        spindle = self._spindle
        spindle.take_tool(cycle)
        spindle.end_procedure()
        needs_reference = procedure.steps[0] is Step.POSITION and not spindle.referenced
        if needs_reference:
            procedure.steps.appendleft(Step.SEARCH)
        if self._loop_stays_open:
            procedure.steps.appendleft(Step.APPROACH)
        spindle.work.procedure = procedure
        spindle.programmed_speed = procedure.speed
        spindle.wanted_speed = 0.0
        spindle.unsettled = True
        self._begin_step(cycle)

    @property
    def _loop_stays_open(self) -> bool:
        """The loop is open for another reason than the control limit, which ends automatically on the ramp down."""
        parameters, loop = self._spindle.parameters, self._spindle.loop
        return loop.velocity_control or (parameters.open_loop and parameters.has_position and not loop.closed)

    def _begin_step(self, cycle: int) -> None:
        self._since = cycle
        self._spindle.exact_stop.forget()
        {
            Step.APPROACH: self._approach,
            Step.SEARCH: self._search,
            Step.POSITION: self._position,
            Step.HALT: self._halt,
            Step.SHIFT: self._shift,
        }[self._current().steps[0]](cycle)

    def _current(self) -> Procedure:
        procedure = self._spindle.work.procedure
        assert procedure is not None
        return procedure

    def _approach(self, cycle: int) -> None:
        spindle = self._spindle
        self._begin(homes=self._current().homes)
        speed = spindle.motion(cycle)[1]
        limit = self._procedure_speed if spindle.parameters.open_loop else spindle.parameters.velocity_control_off
        spindle.ramp_to(cycle, copysign(min(abs(speed), limit), speed))

    @property
    def _procedure_speed(self) -> float:
        """Limits of the motion after the approach, without override."""
        procedure = self._current()
        return self._homing_speed if procedure.homes else self._spindle.limits.positioning(procedure.speed).speed

    def _begin(self, *, homes: bool) -> None:
        self._spindle.take(T.HOME if homes else T.POSITION)
        self._spindle.mode = SpindleMode.HOMING if homes else SpindleMode.POSITION

    def _search(self, cycle: int) -> None:
        spindle = self._spindle
        self._begin(homes=True)
        self._search_from = None
        speed = spindle.motion(cycle)[1]
        direction = copysign(1.0, speed) if speed else float(spindle.parameters.preferred_direction or 1)
        spindle.ramp_to(cycle, direction * self._homing_speed)

    @property
    def _homing_speed(self) -> float:
        return min(self._spindle.gear.homing_speed, self._spindle.limits.max_speed)

    def _position(self, cycle: int) -> None:
        spindle, procedure = self._spindle, self._current()
        self._begin(homes=False)
        position, speed, _ = spindle.motion(cycle)
        limits = spindle.limits.positioning(procedure.speed * spindle.override)
        turn = spindle.gear.modulo_high - spindle.gear.modulo_low
        self._turns = self._direction(position, speed, procedure, turn)
        spindle.target = next_target(position, speed, procedure.goal, turn, self._turns, limits)
        table = plan_positioning(position, speed, spindle.target, self._turns, limits)
        assert table is not None, "the target was chosen so that the spindle can stop there"
        spindle.follow(cycle, table)

    def _direction(self, position: float, speed: float, procedure: Procedure, turn: float) -> float:
        """The given direction, else the only one permitted, else that of the rotation, or the shortest from rest."""
        if procedure.direction in DIRECTIONS:
            return DIRECTIONS[procedure.direction]
        if self._spindle.parameters.preferred_direction:
            return float(self._spindle.parameters.preferred_direction)
        if speed and procedure.direction != "shortest":
            return copysign(1.0, speed)
        limits = self._spindle.limits.positioning(0.0)
        return shortest_direction(
            position + copysign(stopping_distance(abs(speed), limits), speed), procedure.goal, turn
        )

    def _halt(self, cycle: int) -> None:
        spindle = self._spindle
        if spindle.state != S.HOMING:
            spindle.take(T.STOP)
        spindle.mode = SpindleMode.HOMING if spindle.state == S.HOMING else SpindleMode.STOP
        spindle.ramp_to(cycle, 0.0)

    def _shift(self, cycle: int) -> None:
        self._spindle.take(T.CHANGE_GEAR)

    # cycle by cycle

    def replan(self, cycle: int) -> bool:
        """Another override in a positioning; False if the spindle already brakes for its target."""
        spindle, procedure = self._spindle, self._current()
        if procedure.steps[0] is not Step.POSITION or spindle.target is None:
            return True
        position, speed, _ = spindle.motion(cycle)
        limits = spindle.limits.positioning(procedure.speed * spindle.override)
        table = plan_positioning(position, speed, spindle.target, self._turns, limits)
        if table is None:
            return False
        spindle.follow(cycle, table)
        return True

    def advance(self, cycle: int, actual_speed: float) -> None:
        """When the active step has finished, the next one starts in this cycle, or the job ends."""
        procedure = self._current()
        step = procedure.steps[0]
        if step is Step.APPROACH:
            done = self._approached(cycle)
        elif step is Step.SEARCH:
            done = self._found(cycle)
        elif step is Step.SHIFT:
            done = self._shifted(cycle)
        else:
            done = self._stands(cycle, actual_speed)
        if not done or self._spindle.work.procedure is not procedure:
            return
        procedure.steps.popleft()
        if procedure.steps:
            self._begin_step(cycle)
        else:
            self._finish()

    def _approached(self, cycle: int) -> bool:
        spindle = self._spindle
        if not spindle.parameters.open_loop:
            return not spindle.loop.velocity_control
        if not spindle.finished(cycle):
            return False
        spindle.place(cycle, spindle.loop.close(spindle.motion(cycle)[1]))
        return True

    def _found(self, cycle: int) -> bool:
        spindle = self._spindle
        position = spindle.motion(cycle)[0]
        if self._search_from is None:
            if spindle.finished(cycle) and spindle.loop.measures_position:
                self._search_from = position
                self._zero_pulse.arm()
                self._zero_pulse.passed(spindle.loop.encoder)
            return False
        mark = self._zero_pulse.passed(spindle.loop.encoder)
        if mark is not None:
            reference = spindle.gear.reference_position
            spindle.shift_coordinates(nearest_shift(mark + spindle.loop.control.offset, reference))
            spindle.referenced, spindle.reference_lost = True, False
            return True
        if abs(position - self._search_from) > PATIENCE:
            velocity = self._homing_speed
            reason = f"no zero pulse came in {PATIENCE:g} deg at homing speed {velocity:g} deg/s (P-AXIS-00218)"
            spindle.fault(cycle, NO_ZERO_PULSE, reason, {"range": PATIENCE, "velocity": velocity})
        return False

    def _stands(self, cycle: int, actual_speed: float) -> bool:
        """Exact stop at the end of the setpoint; an error when that takes too long."""
        spindle, step = self._spindle, self._current().steps[0]
        position, speed, _ = spindle.motion(cycle)
        if speed != 0.0 or not spindle.finished(cycle):
            return False
        if step is Step.POSITION and position != spindle.target:
            return False  # held by override 0
        loop = spindle.loop
        measured = loop.measures_position and not (step is Step.HALT and not loop.closed)
        away = position - loop.position if measured else 0.0
        if spindle.note_position(cycle, away, actual_speed):
            return True
        if self._too_long(spindle.cycles_since_end(cycle)):
            time = spindle.parameters.target_time
            reason = f"{time:g} s after its end the positioning {self._missed(away, actual_speed)}"
            spindle.fault(cycle, TARGET_MISSED, reason, {**self._missed_by(away, actual_speed), "time": time})
        return False

    def hold(self, cycle: int, actual: float, actual_speed: float) -> None:
        """After a positioning: the spindle stays at its target; an error when it leaves it and does not come back."""
        spindle = self._spindle
        if not spindle.holds_position or spindle.target is None:
            return
        away = spindle.target - actual
        spindle.note_position(cycle, away, actual_speed)
        if self._too_long(cycle - spindle.exact_stop.left_at):
            time = spindle.parameters.target_time
            since = f"the position was left and has not come back for {time:g} s: the spindle"
            reason = f"{since} {self._missed(away, actual_speed)}"
            spindle.fault(cycle, TARGET_MISSED, reason, {**self._missed_by(away, actual_speed), "time": time})

    def _too_long(self, cycles: float) -> bool:
        """True if the position has been missing for too many `cycles` and is not about to be reached."""
        spindle = self._spindle
        patience = spindle.parameters.target_time / spindle.cycle_time
        return patience > 0.0 and cycles >= patience and not spindle.exact_stop.settles

    def _missed(self, away: float, actual_speed: float) -> str:
        gear = self._spindle.gear
        if abs(away) > gear.position_window:
            window = f"position window {gear.position_window:g} deg (P-AXIS-00236)"
            return f"is {abs(away):g} deg away from its target, more than the {window}"
        limit = f"zero speed {gear.zero_speed / DEG_S_PER_RPM:g} rpm (P-AXIS-00216)"
        return f"still turns at {abs(actual_speed) / DEG_S_PER_RPM:g} rpm, more than the {limit}"

    def _missed_by(self, away: float, actual_speed: float) -> dict[str, Value]:
        """The numbers of `_missed`."""
        gear = self._spindle.gear
        if abs(away) > gear.position_window:
            return {"distance": abs(away), "limit": gear.position_window}
        return {"actual_speed": abs(actual_speed) / DEG_S_PER_RPM, "limit": gear.zero_speed / DEG_S_PER_RPM}

    def _shifted(self, cycle: int) -> bool:
        """Only the PLC ends this step; an error if it does not in time."""
        spindle = self._spindle
        patience = spindle.parameters.gear_change_time
        if patience and (cycle - self._since) * spindle.cycle_time >= patience:
            stage = self._current().stage
            reason = f"the PLC has not acknowledged the change to gear {stage} within {patience:g} s (P-MACH-00051)"
            spindle.fault(cycle, GEAR_NOT_ACKNOWLEDGED, reason, {"patience": patience})
        return False

    def _finish(self) -> None:
        spindle, procedure = self._spindle, self._current()
        spindle.work.finish()
        spindle.programmed_speed = 0.0
        spindle.take(T.FINISH if spindle.powered else T.FINISH_WITHOUT_POWER)
        if procedure.name in ("home", "stop"):
            spindle.mode = SpindleMode.STOP

    def gear_changed(self, cycle: int) -> Procedure:
        """The PLC has acknowledged: the parameters of the new gear count; returns the finished job."""
        procedure = self._current()
        self._spindle.use_gear(cycle, procedure.stage)
        self._spindle.target = None
        self._spindle.mode = SpindleMode.STOP
        self._finish()
        return procedure
