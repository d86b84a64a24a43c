"""The core of an axis: its state, its setpoints, refusals and faults."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import copysign, isfinite, sqrt
from typing import NoReturn

from cnc_ptp.axis import transitions as T
from cnc_ptp.axis.added_motion import AddedMotion
from cnc_ptp.axis.carried import CarriedMotion
from cnc_ptp.axis.command_checks import MotionChecks
from cnc_ptp.axis.compensation import Compensation
from cnc_ptp.axis.coupling import Coupling
from cnc_ptp.axis.drive_lead import DriveLead
from cnc_ptp.axis.external import ExternalSetpoints
from cnc_ptp.axis.faults import (
    FEED_WITHHELD,
    GANTRY_DIFFERENCE,
    GROUP_ERROR,
    JOG_AT_LIMIT,
)
from cnc_ptp.axis.override_filter import OverrideFilter
from cnc_ptp.axis.ptp import SMALLEST_OVERRIDE, PtpGenerator
from cnc_ptp.axis.target_window import TargetWindow
from cnc_ptp.errors import NO_VALUES, Value
from cnc_ptp.motion.limits import Limits
from cnc_ptp.motion.setpoints import MotionState, Setpoints
from cnc_ptp.parameters import AxisParameters
from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.axis_states import StatusBit
from cnc_ptp.protocol.jobs import Jobs, JobStatus
from cnc_ptp.protocol.transitions import Transition, require_source
from cnc_ptp.protocol.unit import EMERGENCY_STOP
from cnc_ptp.spindle.path_stop import PathStop

CONSTANT_VELOCITY, IN_TARGET_POSITION = int(StatusBit.CONSTANT_VELOCITY), int(StatusBit.IN_TARGET_POSITION)

PAIR_ERRORS = (FEED_WITHHELD, GANTRY_DIFFERENCE, GROUP_ERROR, EMERGENCY_STOP)
"""Errors in which the slave of a gantry pair stops with its master."""
ROUNDING = 1e-9
"""Part of a velocity limit."""

KEEPING_TARGET = (S.STANDSTILL, S.DISCRETE_MOTION, S.STOPPING)
"""States in which the target of the last positioning still counts for move_additive."""

Report = Callable[[int, int, str, Mapping[str, Value]], None]
"""Takes an event: cycle, number, text, and the numbers of the text by name."""


class Axis:
    """The setpoint side of an axis. Commands (one class per group) change it, the unit around it computes cycles.

    The setpoint is the basic motion (PTP generator, path, master) plus what a compensation, external setpoints, a
    superimposed motion (`added`) and a flying saw on a path add. Every fault ends in ErrorStop on the axis' own ramp
    (P-AXIS-00002 and the ramp time P-AXIS-00196), or on that of the active motion where this is stronger.
    """

    def __init__(
        self, parameters: AxisParameters, *, cycle_time: float, jobs: Jobs, report_error: Report, report_warning: Report
    ) -> None:
        """`cycle_time` in s; `jobs` of its unit; the reports take faults and warnings as events."""
        self.parameters = parameters
        self.name = parameters.name
        self.unit = "deg" if parameters.rotary else "mm"
        self.checks = MotionChecks(parameters, cycle_time=cycle_time)
        self.own_limits = self.checks.own_limits()
        self.ptp = PtpGenerator(
            position=parameters.start_position, cycle_time=cycle_time, override_type=parameters.override_type
        )
        self.compensation = Compensation(cycle_time=cycle_time)
        self.external = ExternalSetpoints(
            cycle_time=cycle_time,
            dead_time=parameters.external_dead_time,
            limits=self.own_limits._replace(velocity=parameters.max_velocity),
        )
        self.added = AddedMotion(cycle_time=cycle_time)
        self.superposed = False
        """Something is added to the basic motion."""
        self.override_filter = OverrideFilter(
            steps=parameters.override_steps, interval_cycles=round(parameters.override_interval / cycle_time)
        )
        self.target_window = TargetWindow(
            window=parameters.position_window, cycles=round(parameters.target_time / cycle_time)
        )
        self.coupling: Coupling | None = None
        """To the master; after an error has put the axis on its own ramp it is kept until a reset."""
        self.carried: CarriedMotion | None = None
        """What the coupling adds to the path of a channel; None where it is the basic motion itself."""
        self.lead = DriveLead()
        """A drive that homes the axis on its own."""
        self.slaves: set[str] = set()
        self.jobs = jobs
        self.waiting_job = 0
        """Number of the job that waits for the end of the active one, or of a stop; 0: none waits."""
        self.seeks_goal = False
        """The trajectory has a goal tolerance and has not come into it."""
        self.last_target: float | None = None
        """Target of the last positioning, whatever has become of it; None when there has been another motion since."""
        self.stop_held = False
        """MC_Stop holds the axis: no path may move it."""
        self.powered = parameters.powered_at_start
        self.state = S.STANDSTILL if self.powered else S.DISABLED
        self.error_id = 0
        self.has_been_stopped = False
        self.path_direction = 0.0
        """-1 or +1: the direction in which the path of a channel waits for the feed release."""
        self.override_percent = 100.0
        self._homing_override = 1.0
        self._master_velocity = 0.0
        self._master_has_job = False
        self._propagation_delay = round(parameters.error_propagation_delay / cycle_time)
        self._propagated_at = 0
        self._report_error = report_error
        self._report_warning = report_warning

    def take_parameters(self, parameters: AxisParameters, *, cycle_time: float) -> None:
        """Other parameters, from now on; what the axis does and where it is stays. `cycle_time` in s."""
        self.parameters = parameters
        self.checks.take(parameters)
        self.own_limits = self.checks.own_limits()
        self.external.limits = self.own_limits._replace(velocity=parameters.max_velocity)
        cycles = round(parameters.target_time / cycle_time)
        self.target_window.set(window=parameters.position_window, cycles=cycles)

    @property
    def emergency_limits(self) -> Limits:
        """Those of the emergency ramp: P-AXIS-00003, never weaker than the axis' own deceleration."""
        strongest = max(self.own_limits.deceleration, self.parameters.emergency_deceleration)
        return self.own_limits._replace(deceleration=strongest)

    @property
    def modulo_range(self) -> tuple[float, float]:
        """Lower end and length of the modulo range, mm (deg); length 0 for an axis without one."""
        low, high = self.parameters.modulo_low, self.parameters.modulo_high
        return (low, high - low) if self.parameters.modulo else (0.0, 0.0)

    # setpoints

    def setpoint(self, cycle: int) -> MotionState:
        """Position, velocity, acceleration and jerk at `cycle`, before a command that acts there."""
        return self.superimposed(cycle, self.ptp.state(cycle))

    def superimposed(self, cycle: int, base: MotionState) -> MotionState:
        """The basic motion at `cycle` with everything that is superimposed."""
        if not self.superposed:
            return base
        state = self.external.at(cycle, self.compensation.at(cycle, base))
        if self.added.active:
            state = plus(state, self.added.state(cycle))
        return state if self.carried is None else plus(state, self.carried.state(cycle))

    def shift(self, cycle: int) -> float:
        """Lasting offset of the axis from its basic motion, mm (deg); targets of the axis have it too."""
        self.setpoint(cycle)
        return self.compensation.offset + self.external.zero(cycle) + self.added.offset

    def moving(self, cycle: int) -> bool:
        return self.superposition_moves(cycle) or not self.rests(cycle)

    def rests(self, cycle: int) -> bool:
        """Neither its own generator nor its drive moves the axis."""
        return self.ptp.finished(cycle) and not self.lead.active

    def superposition_moves(self, cycle: int) -> bool:
        """Something moves the axis in addition to its basic motion."""
        moves = self.compensation.moving or self.external.moving(cycle) or self.added.moving(cycle)
        return self.superposed and moves

    def absorb(self, cycle: int) -> None:
        """The basic motion takes over what is superimposed on it, which ends.

        The acceleration of compensation and external setpoints is not limited in jerk and ends here: on a jerk-limited
        ramp it would raise the velocity further.
        """
        self.leave_trajectory(cycle)
        if self.superposed:
            position, velocity, _, _ = self.setpoint(cycle)
            acceleration = self.ptp.state(cycle)[2]
            if self.added.active:
                acceleration += self.added.state(cycle)[2]
            self.ptp.take_over(cycle, position, velocity, self._bearable(velocity, acceleration))
            self._end_superposition(cycle)

    def _bearable(self, velocity: float, acceleration: float) -> float:
        """The part of an acceleration to be ramped down: a²/2J must not lead above P-AXIS-00212, or through 0.

        Nor may it exceed the limits of the axis, or of the job that caused it.
        """
        limits = self.own_limits if self.ptp.job is None else self.ptp.job.limits
        jerk = min(self.own_limits.jerk, limits.jerk)
        outwards = velocity * acceleration > 0.0
        left = max(0.0, self.parameters.max_velocity - abs(velocity)) if outwards else abs(velocity)
        most = max(self.own_limits[1:3] + limits[1:3])
        bearable = min(most, sqrt(2.0 * jerk * left) * (1.0 + ROUNDING))
        return acceleration if abs(acceleration) <= bearable else copysign(bearable, acceleration)

    def brake(self, cycle: int, setpoint: MotionState) -> None:
        """The axis' own ramp starts at `setpoint`; superimposed motions and their acceleration end immediately."""
        position, velocity, acceleration, _ = setpoint
        if self.superposed:
            own = 0.0 if self.state == S.SYNCHRONIZED_MOTION else self.ptp.state(cycle)[2]
            acceleration = self._bearable(velocity, own)
        self.ptp.take_over(cycle, position, velocity, acceleration)
        self._end_superposition(cycle)
        self.ptp.stop(cycle, self.own_limits, at_least=True)

    def leave_trajectory(self, cycle: int) -> None:
        """The axis' own generator continues from the trajectory, with as much acceleration as it may keep."""
        if self.ptp.follows:
            position, velocity, acceleration, _ = self.ptp.state(cycle)
            self.ptp.take_over(cycle, position, velocity, self._bearable(velocity, acceleration))

    def leave_master(self, cycle: int) -> None:
        """The axis' own generator continues the motion of the coupling, with as much acceleration as it may keep."""
        self.absorb(cycle)
        position, velocity, acceleration, _ = self.ptp.state(cycle)
        bearable = self._bearable(velocity, acceleration)
        if bearable != acceleration:
            self.ptp.take_over(cycle, position, velocity, bearable)

    def place(self, cycle: int, position: float) -> None:
        """An axis at a standstill without position control was moved to `position`."""
        self.ptp.take_over(cycle, position, 0.0, 0.0)
        self._end_superposition(cycle)

    def _end_superposition(self, cycle: int) -> None:
        self.compensation.reset()
        self.external.reset()
        self.jobs.end_superimposed(cycle, JobStatus.ABORTED)
        self.added.reset()
        self.ptp.lift_ceiling(cycle)
        self.carried = None
        self.superposed = False

    def halt_added(self, cycle: int) -> None:
        """The superimposed motion ends on its ramp; its job is aborted."""
        self.jobs.end_superimposed(cycle, JobStatus.ABORTED)
        self.added.halt(cycle)

    def end_added(self, cycle: int) -> None:
        """The superimposed motion has come to rest at `cycle`: the axis' own basic motion takes its offset over."""
        if not self.added.active or self.added.moving(cycle):
            return
        self.jobs.end_superimposed(cycle, JobStatus.DONE)
        self.ptp.lift_ceiling(cycle)
        offset = self.added.offset
        if self.state == S.SYNCHRONIZED_MOTION or offset == 0.0:
            return
        self.ptp.shift(offset)
        self.added.reset()
        if self.last_target is not None:
            self.last_target += offset
        others = self.compensation.active or self.external.mode is not None or self.external.moving(cycle)
        self.superposed = others or self.shift(cycle) != 0.0

    def stop(self, cycle: int, *, locks: bool = True) -> None:
        """Basic motion and what is superimposed on it come to rest, each on its ramp; `locks` as in the PTP.

        A target that the external setpoints were to reach no longer counts. A drive that leads stops on its own ramp.
        """
        if self.lead.active:
            self.lead.cancel()
            return
        self.setpoint(cycle)  # brings compensation and external setpoints up to this cycle
        self.leave_trajectory(cycle)
        self.target_window.target = None
        self.ptp.stop(cycle, self.own_limits, locks=locks)
        self._stop_superposition(cycle)

    def _stop_superposition(self, cycle: int) -> None:
        """What is superimposed comes to rest, each on its ramp."""
        self.compensation.stop()
        self.external.disable(cycle)
        self.halt_added(cycle)

    def set_override(self, cycle: int, percent: float) -> bool:
        """Applies an override; False when it does not change the active motion."""
        acts = self.ptp.set_override(cycle, percent / 100.0 * self._homing_override)
        self.override_percent = float(percent) if percent / 100.0 >= SMALLEST_OVERRIDE else 0.0
        return acts

    def set_homing_override(self, cycle: int, percent: float) -> None:
        """Applies the override of the channel that homes the axis, in addition to its own."""
        self._homing_override = percent / 100.0
        self.set_override(cycle, self.override_percent)

    def _end_homing(self) -> None:
        """The override of the channel no longer counts."""
        self._homing_override = 1.0
        self.ptp.override = self.override_percent / 100.0

    def release_feed(self, cycle: int, *, forward: bool, backward: bool) -> None:
        """Releases each direction of motion, or withholds it."""
        self.ptp.release(cycle, forward=forward, backward=backward)
        if self.ptp.follows and self.ptp.restricted:
            self.abort_motion(cycle)
        if self.ptp.withholds(self.added.state(cycle)[1]):
            self.halt_added(cycle)
        if not self.ptp.withholds(self.path_direction):
            self.path_direction = 0.0

    def _release_bits(self) -> int:
        bits = StatusBit.FEED_WITHHELD if self.feed_withheld else 0
        if self.ptp.withholds(1.0):
            bits |= StatusBit.FORWARD_NOT_RELEASED
        if self.ptp.withholds(-1.0):
            bits |= StatusBit.BACKWARD_NOT_RELEASED
        return bits

    @property
    def feed_withheld(self) -> bool:
        """A motion, or the path of the channel that moves the axis, waits for the feed release of its direction."""
        led = self.lead.active and self.ptp.restricted
        return led or self.ptp.withheld or (self.on_path and self.path_direction != 0.0)

    def begin_homing(self, cycle: int) -> None:
        """From Standstill to Homing, with nothing superimposed."""
        self.absorb(cycle)
        self.take(T.HOME)
        self.has_been_stopped = False
        self.target_window.watch()

    def shift_coordinates(self, distance: float) -> None:
        """All positions of the axis grow by `distance`; it does not move."""
        self.ptp.shift(distance)
        self.checks.shift_coordinates(distance)
        if self.last_target is not None:
            self.last_target += distance
        if self.target_window.target is not None:
            self.target_window.target += distance

    # couplings

    @property
    def on_path(self) -> bool:
        """True while a channel moves the axis."""
        return self.state == S.SYNCHRONIZED_MOTION and (self.coupling is None or self.carried is not None)

    @property
    def coupled(self) -> bool:
        """True while the axis follows a master."""
        return self.state == S.SYNCHRONIZED_MOTION and self.coupling is not None

    @property
    def has_job(self) -> bool:
        if self.jobs.superimposed:
            return True
        if self.coupled:
            return self._master_has_job
        return self.ptp.job is not None or self.ptp.follows or self.state == S.HOMING

    def follow_master(self, target_velocity: float, has_job: bool) -> None:
        """What the master reports about its motion besides its setpoints."""
        self._master_velocity, self._master_has_job = target_velocity, has_job

    def target_velocity(self) -> float:
        """Velocity (mm/s, deg/s) of the active motion at 100 % override; of a slave |ratio| times its master's."""
        if self.coupling is not None:
            return abs(self.coupling.ratio) * self._master_velocity
        return self.ptp.target_velocity

    def abort_coupling(self, cycle: int, error_id: int, reason: str) -> None:
        """A coupling that cannot start; it has not moved the axis yet. A path that needs it must not continue."""
        assert self.coupling is not None
        if self.carried is not None:
            self.fault(cycle, error_id, f"cannot follow {self.coupling.master} in addition to the path: {reason}")
            return
        effect = "the axis is at a standstill and not coupled"
        text = f"axis {self.name}: cannot follow {self.coupling.master}: {reason}; {effect}"
        self.coupling = None
        self.jobs.end(cycle, JobStatus.FAILED, error_id)
        self.take(T.DECOUPLE_AT_REST if self.powered else T.DECOUPLE_WITHOUT_POWER)
        self._report_warning(cycle, error_id, text, NO_VALUES)

    def couples_actual(self) -> bool:
        """Slaves follow the actual values: of a main master without enable, or of an axis with a delayed error."""
        if not self.parameters.couple_to_actual:
            return False
        if self.error_id:
            return self.parameters.error_propagation_delayed
        return self.state == S.DISABLED and self.coupling is None

    # jobs

    def drop_waiting(self, cycle: int) -> None:
        """A motion, or a new target, that waits will not be carried out."""
        if self.waiting_job:
            self.jobs.drop(cycle, self.waiting_job)
            self.waiting_job = 0

    def abort_job(self, cycle: int) -> None:
        """Something that is no job stops the axis."""
        self.drop_waiting(cycle)
        self.jobs.end(cycle, JobStatus.ABORTED)

    def abort_motion(self, cycle: int) -> None:
        """Something that is no job stops the axis on its ramp (state Stopping)."""
        self.abort_job(cycle)
        self.stop(cycle)
        self.take(T.STOP)
        self.has_been_stopped = True

    def next_job(self, cycle: int) -> None:
        """The active job has ended in full; the one that has waited is the active one."""
        self.jobs.end(cycle, JobStatus.DONE)
        if self.waiting_job:
            self.jobs.activate(cycle, self.waiting_job)
            self.waiting_job = 0

    # states

    def advance(self, cycle: int) -> None:
        """Carries out what is due at `cycle`: an override that waits in the filter, changes of the basic motion."""
        if self.state != S.SYNCHRONIZED_MOTION:
            self.end_added(cycle)
        percent = self.override_filter.due(cycle)
        if percent is not None:
            self.set_override(cycle, percent)
        self.ptp.advance(cycle)

    def basic_motion(self, cycle: int, count: int) -> Setpoints:
        """The basic motion of `count` cycles, fewer (but one at least) when something comes due among them.

        One cycle at a time while a homing looks for its signals, or the drive leads.
        """
        if self.state == S.HOMING or self.lead.active:
            return self.ptp.setpoints(cycle, 1)
        due = self.override_filter.due_cycle
        if due is not None:
            count = max(1, min(count, due - cycle))
        if self.superposed and self.added.moving(cycle):
            count = min(count, self.added.end_cycle - cycle)
        return self.ptp.setpoints(cycle, count)

    def take(self, transition: Transition) -> None:
        """Changes the state; nothing else does. Every test checks that only transitions of the table are taken."""
        require_source(self.name, self.state, transition)
        if self.state == S.HOMING:
            self._end_homing()
        self.state = transition.target
        if self.state not in KEEPING_TARGET:
            self.last_target = None

    def advance_state(self, cycle: int) -> None:
        """Ends a motion that has finished at `cycle`; a request that waited for the end of a stop has started."""
        if self.lead.active:
            return
        if self.ptp.job is not None and self.state == S.STOPPING:
            self.take(T.NEW_TARGET)
            self.has_been_stopped = False
            self.next_job(cycle)
        if not self.ptp.arrived(cycle) or (self.ptp.follows and self.seeks_goal):
            return
        self.compensation.end()
        if self.compensation.moving:
            return
        if self.jogs_to_limit:
            self._report_limit(cycle)
        if self.superposed and self.added.moving(cycle):
            self._continue_added(cycle)
        elif self.superposed and self.external.mode is not None:
            self.jobs.end(cycle, JobStatus.DONE)
            self._finish(T.CONTINUE_EXTERNALLY)
        elif self.superposed and self.external.moving(cycle):
            self._finish(T.STOP_EXTERNALLY)
        else:
            self._finish(T.FINISH if self.powered else T.FINISH_WITHOUT_POWER)

    def _continue_added(self, cycle: int) -> None:
        """Only the superimposed motion moves the axis; a stop ends with it, any other motion has ended."""
        if self.ptp.job is not None or not self.added.halting:
            self.jobs.end(cycle, JobStatus.DONE)
            self._finish(T.CONTINUE_SUPERIMPOSED)

    @property
    def jogs_to_limit(self) -> bool:
        """Only motion at a velocity has a job with an end in ContinuousMotion: to stop at the soft limit."""
        return self.state == S.CONTINUOUS_MOTION and self.ptp.job is not None and isfinite(self.ptp.job.target)

    def _report_limit(self, cycle: int) -> None:
        """Motion at a velocity has come to rest where it did not want to: its job is aborted."""
        self.jobs.end(cycle, JobStatus.ABORTED)
        position, rest = self.ptp.state(cycle)[0], self.setpoint(cycle)[0]
        limit = min(map(self.checks.soft_limit, (1.0, -1.0)), key=lambda each: abs(each.position - position))
        now = "the axis is at a standstill" + (f" at {rest:g} {self.unit}" if rest != position else "")
        if self.added.moving(cycle):
            now = "a superimposed motion moves the axis now"
        elif self.external.mode is not None or self.superposition_moves(cycle):
            now = "external setpoints move the axis now"
        what = "jog" if self.ptp.job is None or self.ptp.job.jog else "motion at a velocity"
        text = f"axis {self.name}: the {what} has reached the {limit.text}; {now}"
        self._report_warning(cycle, JOG_AT_LIMIT, text, {"soft_limit": limit.position})

    def _finish(self, transition: Transition) -> None:
        """A stop that has finished, while external setpoints come to rest, may still be given a new target."""
        if transition.target != self.state or self.ptp.job is not None:
            self.ptp.finish()
        self.take(transition)

    def status_bits(self, cycle: int, setpoint: MotionState, actual_position: float) -> int:
        return self.common_bits(cycle) | self.motion_bits(setpoint, actual_position)

    def common_bits(self, cycle: int) -> int:
        """The bits that do not depend on the setpoint of the cycle."""
        bits = StatusBit.HAS_JOB if self.has_job else 0
        if self.coupling is not None:
            bits |= StatusBit.PROTECTED
        if self.has_been_stopped:
            bits |= StatusBit.HAS_BEEN_STOPPED
        if self.ptp.restricted:
            bits |= self._release_bits()
        if not self.checks.referenced:
            bits |= StatusBit.NOT_REFERENCED
        if self.checks.coordinate_shift:
            bits |= StatusBit.COORDINATES_SHIFTED
        if self.superposed:
            bits |= StatusBit.COMPENSATING if self.compensation.active or self.added.moving(cycle) else 0
            bits |= StatusBit.EXT_SETPOINT if self.external.mode is not None else 0
        if self.error_id:
            bits |= StatusBit.ERROR
            bits |= StatusBit.ERROR_DELAYED if cycle < self._propagated_at else 0
        return int(bits)

    def motion_bits(self, setpoint: MotionState, actual_position: float) -> int:
        position, velocity, acceleration, _ = setpoint
        if self.lead.active:
            return 0
        if velocity != 0.0:
            return CONSTANT_VELOCITY if acceleration == 0.0 else 0
        leads = self.ptp.job is not None or self.ptp.follows
        if not leads and self.target_window.reached(position, actual_position):
            return IN_TARGET_POSITION
        return 0

    # refusals and faults

    def refuse(self, command: str, number: int, reason: str, /, **values: Value) -> NoReturn:
        raise self.checks.refusal(command, number, reason, **values)

    def fault(
        self,
        cycle: int,
        error_id: int,
        reason: str,
        setpoint: MotionState | None = None,
        path_stop: PathStop | None = None,
        values: Mapping[str, Value] = NO_VALUES,
    ) -> None:
        """Error reaction: own ramp from the setpoint of `cycle`, state ErrorStop; nothing waits then.

        The slave of a gantry pair whose group has an error follows its master to standstill (`end_with_master`); what
        is superimposed on it ends on its ramp. `setpoint` within a block, if it comes from another source than the
        axis' own generator. `path_stop` is the ramp in step with a spindle, instead of its own. `values`: the numbers
        of the reason by name.
        """
        self.error_id = error_id
        self.drop_waiting(cycle)
        pair = self.pair_in(error_id)
        if pair is not None:
            self.jobs.end_superimposed(cycle, JobStatus.FAILED, error_id)
            self._stop_superposition(cycle)
            self._note_propagation(cycle, error_id)
            text = f"axis {self.name}: {reason}; the axis stops with its master {pair.master} (ErrorStop)"
            self._report_error(cycle, error_id, text, values)
            return
        if setpoint is not None and self.state == S.SYNCHRONIZED_MOTION:
            position, velocity, acceleration, _ = setpoint
            self.ptp.take_over(cycle, position, velocity, 0.0 if self.superposed else acceleration)
            self._end_superposition(cycle)
        if self.coupled:
            self.leave_master(cycle)
        self.jobs.end_superimposed(cycle, JobStatus.FAILED, error_id)
        self.absorb(cycle)
        self._note_propagation(cycle, error_id)
        effect = self._stop_for(cycle, error_id) if path_stop is None else self._stop_in_step(cycle, path_stop)
        self.target_window.forget()
        self.take(T.FAULT)
        self._report_error(cycle, error_id, f"axis {self.name}: {reason}; {effect} (ErrorStop)", values)

    def _stop_for(self, cycle: int, error_id: int) -> str:
        """The ramp of a fault: the drive's where it leads the axis, that of an emergency stop, or the axis' own."""
        if self.lead.active:
            self.lead.cancel()
            return "the drive stops on its ramp"
        emergency = error_id == EMERGENCY_STOP
        self.ptp.stop(cycle, self.emergency_limits if emergency else self.own_limits, at_least=True)
        return f"the axis stops on its {'emergency' if emergency else 'own'} ramp"

    def _stop_in_step(self, cycle: int, stop: PathStop) -> str:
        """The ramp of the path, which its spindle goes along, too."""
        position = self.ptp.state(stop.origin)[0]
        self.ptp.run_out(stop.origin, stop.of_axis(self.name, position))
        return f"the axis stops in step with spindle {stop.spindle}"

    def stop_in_emergency(self, cycle: int) -> None:
        """Down to standstill on the emergency ramp, state ErrorStop; a ramp that an error has started gets stronger."""
        if self.error_id:
            if self.state == S.ERROR_STOP and not self.ptp.finished(cycle):
                self.ptp.stop(cycle, self.emergency_limits, at_least=True)
            return
        self.fault(cycle, EMERGENCY_STOP, "emergency stop")

    def pair_in(self, error_id: int) -> Coupling | None:
        """The coupling on which the slave of a gantry pair stays in this error."""
        keeps = self.coupled and self.coupling is not None and self.coupling.keeps_pair
        return self.coupling if keeps and error_id in PAIR_ERRORS else None

    def _note_propagation(self, cycle: int, error_id: int) -> None:
        if self.parameters.error_propagation_delayed and error_id != GROUP_ERROR and (self.coupling or self.slaves):
            self._propagated_at = cycle + self._propagation_delay

    def end_alone(self, cycle: int) -> None:
        """A slave in error whose master does not stop: its own ramp."""
        self.leave_master(cycle)
        self.ptp.stop(cycle, self.own_limits, at_least=True)
        self.target_window.forget()
        self.take(T.FAULT)

    def end_with_master(self, cycle: int, position: float) -> None:
        """A slave in error that has come to rest with its master, its basic motion at `position`.

        What is superimposed on it may still move: that ends on the axis' own ramp.
        """
        self.ptp.take_over(cycle, position, 0.0, 0.0)
        self.absorb(cycle)
        self.ptp.stop(cycle, self.own_limits, at_least=True)
        self.target_window.forget()
        self.take(T.FAULT)


def plus(base: MotionState, added: MotionState) -> MotionState:
    """The sum of two motions."""
    return base[0] + added[0], base[1] + added[1], base[2] + added[2], base[3] + added[3]
