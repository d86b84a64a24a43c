"""The motion of a channel's axes: which motion is active, its override and its stop ramp."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Final

from cnc_ptp.nc.canonical import Dwell, FeedPerTurn, LinearMove
from cnc_ptp.parameters import AxisParameters, ChannelParameters
from cnc_ptp.path.active_motion import ActiveMotion, Note, PathPoint
from cnc_ptp.path.element_motion import DwellMotion, ElementMotion, TappingMotion
from cnc_ptp.path.geometry import AxisLimits
from cnc_ptp.path.interpolator import LARGEST_OVERRIDE, PathInterpolator
from cnc_ptp.path.linked_path import LinkedPath, MotionSource, Path
from cnc_ptp.path.lookahead.look_ahead import LookAhead
from cnc_ptp.path.lookahead.path_builder import LinkedMotion, PathBuilder
from cnc_ptp.path.lookahead.spans import whole
from cnc_ptp.path.motion_plan import LimitsOfSpindle, MotionPlanner, Plan
from cnc_ptp.path.shape import AT_REST, AxisState, AxisStates, standing
from cnc_ptp.path.thread.thread_check import angle_of, thread_settings, with_retract
from cnc_ptp.path.thread.thread_path import ThreadPath
from cnc_ptp.path.thread_place import ThreadPlace
from cnc_ptp.path.transformed_span import require_possible
from cnc_ptp.protocol.blocks import CycleBlock

SpindleTurns = Callable[[str], float]
"""Turns per second of a spindle, by its name in programs."""


class PathMotion:
    """Runs the motions of canonical blocks; between them the axes are at rest.

    states           (position, velocity, acceleration, jerk) of each axis in the last cycle that was given out; the C
                     axis is the last one
    velocity         path velocity, mm/s
    distance_to_go   mm to the end of the block
    feed             programmed feed, mm/s; in rapid traverse the velocity that the axes allow
    spindle_state    of the spindle that is an axis of the path (deg since the path took it over), in the last cycle; at
                     rest between motions
    """

    def __init__(
        self,
        channel: ChannelParameters,
        axes: Sequence[AxisParameters],
        cycle_time: float,
        spindle_limits: LimitsOfSpindle | None = None,
        spindle_turns: SpindleTurns | None = None,
    ) -> None:
        """`axes` in the order of the channel, standing at their start positions; `cycle_time` in s.

        `spindle_limits`: those of a spindle, by its name in programs, as an axis of the path; `spindle_turns`: how fast
        one really turns, for feeds per turn.
        """
        self._cycle_time = cycle_time
        self._planner = MotionPlanner(channel, axes, cycle_time, spindle_limits)
        self._threads = thread_settings(channel, axes, cycle_time)
        self._spindle_nodes = {spindle.name: spindle.node for spindle in channel.spindles}
        self._interpolator = PathInterpolator()
        self._active: ActiveMotion | None = None
        self._override = 1.0
        self._held = False
        self._full_override = False
        """The active motion is one of G166."""
        self._spindle_turns = spindle_turns
        self._per_turn: FeedPerTurn | None = None
        """Of the active motion."""
        self._nominal_turns = 1.0
        """Turns per second at which the path has the planned feed …"""
        self._turning_factor = 1.0
        """… and the real ones in relation to them."""
        self._spindle_zero: float | None = None
        """Position of the C axis where the path has taken the spindle over; None while it is none."""
        self._cycle = 0
        """The last one that was given out."""
        self.spindle_state = AT_REST
        self.states = standing([a.start_position for a in axes] + ([0.0] if channel.c_axis else []))
        self.velocity = 0.0
        self.distance_to_go = 0.0
        self.feed = 0.0

    # state

    @property
    def delay(self) -> int:
        """Cycles by which the axes act later than their setpoints come."""
        return self._threads.delay

    @property
    def position(self) -> tuple[float, ...]:
        """Position of each axis, mm or deg."""
        return tuple(state[0] for state in self.states)

    @property
    def point(self) -> PathPoint:
        """The last cycle that was given out."""
        return self.states, self.velocity, self.distance_to_go

    @property
    def on_path(self) -> bool:
        """A motion is active (a dwell is none)."""
        return self._active is not None and self._active.on_path

    @property
    def override(self) -> float:
        """Override of motions without G166, 1 is 100 %, 0 is feed hold."""
        return self._override

    @property
    def time_to_go(self) -> float:
        """Seconds to the end of the active block; 0.0 without one, -1.0 while it is held."""
        return 0.0 if self._active is None else self._active.time_to_go(self.velocity, self.distance_to_go)

    @property
    def part_to_go(self) -> float:
        """Part of the active block's length, or of the dwell's time, that is still to come; 0.0 without one."""
        return 0.0 if self._active is None else self._active.part_to_go(self.distance_to_go)

    @property
    def held(self) -> bool:
        """Feed hold or override 0 act; the path is at a standstill, or is on its ramp to standstill."""
        return self._active is not None and self._active.held_by(self._interpolator.override)

    @property
    def runs_out(self) -> float:
        """Length of the path, mm, that is known while it brakes because no more is; -1.0 while it does not."""
        return -1.0 if self._active is None else self._active.runs_out

    @property
    def path_ahead(self) -> float:
        """Length of the path, mm, that the look-ahead knows."""
        return self.distance_to_go if self._active is None else self._active.length_known(self.distance_to_go)

    @property
    def can_be_held(self) -> bool:
        """A motion is active that a feed hold would stop before its end."""
        return self._active is not None and self._active.can_be_held

    @property
    def stopped(self) -> bool:
        """True when `stop` was called and the path is at a standstill."""
        return self._active is not None and self._active.stopped

    @property
    def runs_through(self) -> bool:
        """The path goes through several blocks."""
        return self._active is not None and self._active.runs_through

    @property
    def passes(self) -> bool:
        """The active block is finished; the path continues in the next one without a stop."""
        return self._active is not None and self._active.passes

    @property
    def halted(self) -> bool:
        """The path rests at the end of a block that it would have passed, until `resume`."""
        return self._active is not None and self._active.halted

    @property
    def rest(self) -> tuple[float, ...]:
        """Where the axes come to rest in the active block, as it is planned now."""
        return self.position if self._active is None else self._active.rest(self.position)

    @property
    def cuts_thread(self) -> bool:
        """The axes are in a thread, and not on the ramp at its end."""
        return self._active is not None and self._active.cuts_thread

    @property
    def stop_text(self) -> str:
        """How a thread is broken off now, for events; empty without one."""
        return "" if self._active is None else self._active.stop_text

    @property
    def waits_for(self) -> str:
        """What the active motion waits for and does not come with time alone."""
        return "" if self._active is None else self._active.waits_for

    @property
    def awaited_spindle(self) -> str:
        """The spindle (name in programs) that stands, for which the path waits; empty for none."""
        return self._per_turn.spindle if self._per_turn is not None and self._turning_factor == 0.0 else ""

    @property
    def spindle_states(self) -> list[AxisState]:
        """As `spindle_state`, in the cycles that `follow` has given out last; empty if the motion has none."""
        return [] if self._active is None else self._active.spindle_states

    @property
    def thread_places(self) -> list[ThreadPlace | None]:
        """Of the cycles that `follow` has given out last; empty outside of threads and tapping."""
        return [] if self._active is None else self._active.places

    def take_notes(self) -> list[Note]:
        """What there is to be told of the active motion."""
        if self._active is None or not self._active.notes:
            return []
        notes, self._active.notes = self._active.notes, []
        return notes

    # start

    def start(self, motion: Path | Dwell, source: MotionSource | None = None) -> None:
        """Starts a motion, directly after another one at its exact end inside a cycle.

        With a `source` the path continues with the motions that follow, as far as nothing needs a stop between them.
        Raises CncError (22101–22112, 23001) for impossible motions; then nothing is started.
        """
        if isinstance(motion, Dwell):
            self._active = DwellMotion(self._interpolator, self._cycle_time, motion.seconds, self.states)
            return
        if isinstance(motion, LinearMove) and motion.thread is not None:
            self._start_thread(motion, motion.thread.spindle, source)
            return
        kinematics = motion.kinematics
        start = self.position if kinematics is None else kinematics.forward(self.position)
        plan = self.plan(motion, start)
        if kinematics is not None:
            require_possible(whole(plan.element, 0), kinematics, self.position)
        self._set_per_turn(motion)
        self._set_full_override(motion.full_override)
        active: ActiveMotion | None = self._linked(plan, motion, source)
        if active is None:
            active = self._single(plan, motion)
            self.distance_to_go = plan.element.length
        self._active, self.feed = active, active.feed

    def _single(self, plan: Plan, motion: Path) -> ElementMotion:
        """A motion with an exact stop at its end."""
        if isinstance(motion, LinearMove) and motion.tap is not None:
            node = self._spindle_nodes[motion.tap.spindle]
            return TappingMotion(self._interpolator, self._cycle_time, plan, node)
        return ElementMotion(self._interpolator, self._cycle_time, plan)

    def _linked(self, plan: Plan, motion: Path, source: MotionSource | None) -> LinkedPath | None:
        """A path of several blocks if the next motion can be linked to this one, and any with kinematics."""
        ahead = LookAhead(self._interpolator.override, self._interpolator.next_offset)
        return self._linked_path(plan, motion, source, ahead, self._nominal_turns)

    def _linked_path(
        self, plan: Plan, motion: Path, source: MotionSource | None, ahead: LookAhead, turns: float
    ) -> LinkedPath | None:
        """`turns`: turns per second for which feeds per turn are planned; 0.0: those of each motion."""
        following = None if motion.transition.stops or source is None else source.peek()
        if following is None and motion.kinematics is None:
            return None
        begin = plan.element.start if motion.kinematics is None else self.position
        builder = PathBuilder(sorted(self._planner.axes_with_feed(motion)), self._cycle_time, begin)
        make = partial(self._make_linked, turns)
        path = LinkedPath(ahead, builder, source or NOTHING_FOLLOWS, make, self._cycle_time, steps=plan.steps)
        first = self._planner.linked(plan, motion, 0, turns)
        return path if path.begin(first, motion, following, begin) else None

    def _make_linked(self, turns: float, start: tuple[float, ...], motion: Path, block: int) -> LinkedMotion:
        return self._planner.linked(self.plan(motion, start), motion, block, turns)

    def _start_thread(self, motion: LinearMove, spindle: str, source: MotionSource | None) -> None:
        """The thread waits for its spindle from the last cycle on that was given out."""
        settings = with_retract(self._threads, motion)
        thread = ThreadPath(settings, self._spindle_nodes[spindle], motion, self.position, source)
        thread.released = self._override > 0.0
        thread.begin(self._cycle)
        self._active, self.feed = thread, thread.feed

    # cycles

    def read_spindles(self, first_cycle: int, feedback: Mapping[str, CycleBlock]) -> None:
        """Before each block of cycles: what the spindles have reported of the one before.

        Raises CncError 51109 and 22082, which break a thread off.
        """
        self._cycle = first_cycle
        if self._active is not None:
            self._active.read(first_cycle, feedback)

    def follow(self, count: int) -> list[PathPoint]:
        """The next `count` cycles of the active block; fewer when it ends before.

        Raises CncError 22080 … 22084 for a thread that cannot be begun.
        """
        active = self._active
        if active is None:
            return []
        points = active.follow(count)
        self._cycle += len(points)
        if points:
            self.states, self.velocity, self.distance_to_go = points[-1]
        if active.spindle_states:
            self.spindle_state = active.spindle_states[-1]
        return points

    def stand(self) -> None:
        """A cycle passes in which no motion is active."""
        self._cycle += 1
        self._interpolator.step(1, self._cycle_time)

    def pass_block(self) -> None:
        """The next block of the path is the active one."""
        assert self._active is not None
        self._active.pass_block()
        self.feed = self._active.feed

    def place(self, index: int, position: float) -> None:
        """An axis is at `position`, to which something else has moved it."""
        if position != self.states[index][0]:
            self.states = (*self.states[:index], (position, 0.0, 0.0, 0.0), *self.states[index + 1 :])

    # halt, stop, end

    def halt(self) -> None:
        """The path stops at the end of the active block, or of the first one at which the axes permit it."""
        if self._active is not None:
            self._active.halt()

    def resume(self) -> None:
        """Continues behind the block at whose end the path has halted."""
        if self._active is not None:
            self._active.resume()

    def stop(self) -> None:
        """Ramps down on the path; `follow` continues until `stopped` or the end of the motion."""
        if self._active is not None:
            self._active.stop()

    def axis_failed(self, axis: int) -> None:
        """It can do nothing more than stop with the path."""
        if self._active is not None:
            self._active.axis_failed(axis)

    def finish(self) -> None:
        """The motion has finished: the axes are exactly at its target, or at the end of its stop ramp."""
        active, self._active = self._active, None
        if active is not None:
            self.states = standing(active.end(self.position))
            active.hand_over(self._interpolator)
            if active.spindle_states:
                self.spindle_state = (active.spindle_states[-1][0], 0.0, 0.0, 0.0)
        self._per_turn = None
        self.follow_spindle()
        self._set_full_override(False)
        self.velocity = self.distance_to_go = 0.0

    def abandon(self) -> None:
        """Forgets the motion of an aborted program, once the axes are at a standstill."""
        self.finish()
        override = self._interpolator.override
        self._interpolator = PathInterpolator()
        self._interpolator.set_override(override)

    # override

    def set_override(self, override: float, *, held: bool) -> None:
        """Override of the path, 1 is 100 %; acts from the last cycle given out.

        `held` (feed hold, feed release) comes with 0 and stops a motion of G166, too.
        """
        self._held = held
        self._override = override
        self._apply_override()
        if self._active is not None:
            self._active.release(override, held=held)

    def _apply_override(self) -> None:
        acting = 1.0 if self._full_override and not self._held else self._override
        acting = min(acting * self._turning_factor, LARGEST_OVERRIDE)
        self._interpolator.set_override(acting)
        if self._active is not None:
            self._active.set_override(acting)

    def _set_full_override(self, full: bool) -> None:
        if full != self._full_override:
            self._full_override = full
            self.set_override(self._override, held=self._held)

    def _set_per_turn(self, motion: Path) -> None:
        """The feed of the motion is that of a spindle, which the path follows from here on."""
        per_turn = motion.per_turn
        self._per_turn = per_turn
        if per_turn is not None:
            self._nominal_turns = motion.feed / per_turn.feed
        self.follow_spindle()

    def follow_spindle(self) -> None:
        """Feed per turn: the velocity of the path changes with the speed of the spindle."""
        factor = 1.0
        if self._per_turn is not None and self._spindle_turns is not None:
            factor = self._spindle_turns(self._per_turn.spindle) / self._nominal_turns
        if factor != self._turning_factor:
            self._turning_factor = factor
            self._apply_override()

    # the spindle as an axis

    def take_spindle(self) -> None:
        """A spindle becomes an axis of the path: its travel counts from here."""
        self.spindle_state, self._spindle_zero = AT_REST, None

    def take_c_axis(self, angle: float, limits: AxisLimits) -> None:
        """The spindle becomes the C axis where it stands (deg), with these limits (deg, s)."""
        self._spindle_zero = angle
        self._planner.set_c_axis(limits)
        self.place(len(self.states) - 1, angle)

    def spindle_travel(self, axes: AxisStates) -> AxisState:
        """Of the spindle since the path has taken it over, in a cycle in which no tapping moves it."""
        if self._spindle_zero is None:
            return self.spindle_state
        position, velocity, acceleration, jerk = axes[-1]
        return position - self._spindle_zero, velocity, acceleration, jerk

    # without running it

    def plan(self, motion: Path, start: tuple[float, ...]) -> Plan:
        """How a motion from `start` is run on its own. Raises as `start`."""
        return self._planner.plan(motion, start, self.spindle_state[0])

    def braking(self, motion: Path) -> tuple[float, ...]:
        """Distance of each axis while the path brakes from the feed of a straight motion that starts here; mm, deg."""
        plan = self.plan(motion, self.position)
        planner, length = plan.planner, plan.element.length
        distance = planner.stopping_distance(min(plan.feed, plan.limits.velocity), 0.0, plan.limits)
        ends = zip(self.position, motion.target, strict=True)
        return tuple([abs(end - begin) / length * distance if length > 0.0 else 0.0 for begin, end in ends])

    def durations(self, motion: Path, start: tuple[float, ...], source: MotionSource, cell_time: float) -> list[float]:
        """Seconds of a motion from `start`, at rest, and of those that are linked to it, with override 100 %.

        They are planned in cells of at most `cell_time` s. Raises as `start`.
        """
        if isinstance(motion, LinearMove) and motion.thread is not None:
            return [angle_of(motion) / abs(motion.thread.speed) if motion.thread.speed else 0.0]
        plan = self.plan(motion, start)
        if motion.kinematics is not None:
            return [plan.duration]
        path = self._linked_path(plan, motion, source, LookAhead(1.0, 0.0, cell_time), 0.0)
        return [plan.duration] if path is None else path.durations()


class NoMotions:
    """A MotionSource without any."""

    busy = False

    def peek(self) -> Path | None:
        return None

    def accept(self) -> None:
        raise AssertionError("there is none")


NOTHING_FOLLOWS: Final = NoMotions()
