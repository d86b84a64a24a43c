"""The motion of a channel's axes: the active path element or dwell, its override and its stop ramp."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Final, NamedTuple

from cnc_ptp.kinematics.kinematics import Kinematics
from cnc_ptp.motion import Limits
from cnc_ptp.motion.limits import check_limits
from cnc_ptp.nc.canonical import STEP, Dwell, FeedPerTurn, LinearMove
from cnc_ptp.parameters import AxisParameters, ChannelParameters
from cnc_ptp.path.geometry import NEGLIGIBLE_MM, Arc, AxisLimits, Line
from cnc_ptp.path.interpolator import LARGEST_OVERRIDE, PathInterpolator
from cnc_ptp.path.linked_path import LinkedPath, MotionSource, Path, is_rapid, taps
from cnc_ptp.path.lookahead.look_ahead import LookAhead
from cnc_ptp.path.lookahead.path_builder import LinkedMotion, PathBuilder
from cnc_ptp.path.lookahead.spans import whole
from cnc_ptp.path.planner import PLANNERS, Planner
from cnc_ptp.path.shape import AxisState, without_jerk
from cnc_ptp.path.thread.retract import Retract
from cnc_ptp.path.thread.thread_check import ThreadSettings, angle_of
from cnc_ptp.path.thread.thread_path import ThreadPath
from cnc_ptp.path.transformed_span import require_possible
from cnc_ptp.protocol.blocks import CycleBlock

CARTESIAN = ("X", "Y", "Z")
AxisStates = tuple[AxisState, ...]
Evaluation = Callable[[float, float, float, float], AxisStates]
"""States of the axes from path length, velocity, acceleration and jerk."""
SpindleLimits = Callable[[str], AxisLimits]
"""Limits of a spindle as an axis of the path, by its name in programs; deg, s."""
SpindleTurns = Callable[[str], float]
"""Turns per second of a spindle, by its name in programs."""
AT_REST: AxisState = (0.0, 0.0, 0.0, 0.0)
NO_LIMITS: Final = AxisLimits(1.0, 1.0, 1.0, 1.0)
"""Of the C axis while the spindle is none: it does not move."""
PathPoint = tuple[AxisStates, float, float]
"""One cycle on the path: the state of each axis, path velocity (mm/s), distance to the end of the element (mm)."""


class Plan(NamedTuple):
    """How a motion is run: its element, dynamics of the path, feed (mm/s), profile of the acceleration."""

    element: Line | Arc
    limits: Limits
    feed: float
    slope: str

    @property
    def steps(self) -> bool:
        """The acceleration of the path may step."""
        return self.slope == STEP

    @property
    def planner(self) -> Planner:
        return PLANNERS[self.slope]

    @property
    def velocity(self) -> float:
        """At override 100 %, mm/s."""
        return min(self.feed, self.limits.velocity)

    @property
    def duration_at_feed(self) -> float:
        """Seconds at that velocity."""
        return self.element.length / self.velocity if self.element.length > 0.0 else 0.0

    @property
    def duration(self) -> float:
        """Seconds from rest to rest with override 100 %."""
        if self.element.length == 0.0:
            return 0.0
        return self.planner.from_rest(0.0, self.element.length, self.limits._replace(velocity=self.velocity)).duration


class PathMotion:
    """Runs the motions of canonical blocks; between them the axes are at rest.

    states           (position, velocity, acceleration, jerk) of each axis in the last cycle that was given out; the C
                     axis is the last one
    velocity         path velocity, mm/s
    distance_to_go   mm to the end of the element
    feed             programmed feed, mm/s; in rapid traverse the velocity that the axes allow
    spindle_states   of the spindle that is an axis of the path (deg since the path took it over), in the cycles that
                     `follow` has given out last; empty if the motion has none
    spindle_state    the last of them; at rest between motions
    """

    def __init__(
        self,
        channel: ChannelParameters,
        axes: Sequence[AxisParameters],
        cycle_time: float,
        spindle_limits: SpindleLimits | None = None,
        spindle_turns: SpindleTurns | None = None,
    ) -> None:
        """`axes` in the order of the channel, standing at their start positions; `cycle_time` in s.

        `spindle_limits`: those of a spindle, by its name in programs, as an axis of the path; `spindle_turns`: how fast
        one really turns, for feeds per turn.
        """
        self._cycle_time = cycle_time
        self._feed_limits = feed_limits(axes)
        self._rapid_limits = [AxisLimits(a.rapid_velocity, a.acceleration, a.deceleration, a.jerk) for a in axes]
        if channel.c_axis:
            self._feed_limits.append(NO_LIMITS)
            self._rapid_limits.append(NO_LIMITS)
        self._path_axes = path_axes(channel)
        self._spindle_limits = spindle_limits
        self.spindle_states: list[AxisState] = []
        self.spindle_state = AT_REST
        self._spindle_turns = spindle_turns
        self._per_turn: FeedPerTurn | None = None
        """Of the active motion."""
        self._nominal_turns = 1.0
        """Turns per second at which the path has the planned feed …"""
        self._turning_factor = 1.0
        """… and the real ones in relation to them."""
        self._spindle_zero: float | None = None
        """Position of the C axis where the path has taken the spindle over; None while it is none."""
        self._taps = False
        """The spindle is the last coordinate of the active element."""
        self._threads = thread_settings(channel, axes, cycle_time)
        self._spindle_nodes = {spindle.name: spindle.node for spindle in channel.spindles}
        self._max_override = channel.max_override_percent / 100.0
        self._interpolator = PathInterpolator()
        self._default_slope = channel.slope
        self._override = 1.0
        self._held = False
        self._full_override = False
        """The active motion is one of G166."""
        self._dwell = 0.0
        """Seconds of the last dwell."""
        self._element: Line | Arc | None = None
        self._evaluate: Evaluation | None = None
        """States of the axes on the active element."""
        self._linked: LinkedPath | None = None
        """The path of several blocks that is active, in place of an element."""
        self.thread: ThreadPath | None = None
        """The thread that is active, in place of an element."""
        self._cycle = 0
        """The last one that was given out."""
        self.states = standing([a.start_position for a in axes] + ([0.0] if channel.c_axis else []))
        self.velocity = 0.0
        self.distance_to_go = 0.0
        self.feed = 0.0

    @property
    def position(self) -> tuple[float, ...]:
        """Position of each axis, mm or deg."""
        return tuple(state[0] for state in self.states)

    @property
    def on_path(self) -> bool:
        """An element is active (a dwell is none)."""
        return self._element is not None or self._linked is not None or self.thread is not None

    @property
    def override(self) -> float:
        """Override of motions without G166, 1 is 100 %, 0 is feed hold."""
        return self._override

    @property
    def time_to_go(self) -> float:
        """Seconds to the end of the active motion or dwell; 0.0 without one, -1.0 while it is held.

        Of a block that the path runs through: at its present velocity.
        """
        if self.thread is not None:
            return self.thread.time_to_go
        if self._linked is not None:
            return self.distance_to_go / self.velocity if self.velocity > 0.0 else -1.0
        return self._interpolator.time_to_go

    @property
    def part_to_go(self) -> float:
        """Part of the active element's length, or of the dwell's time, that is still to come; 0.0 without one."""
        if self.thread is not None:
            return self.thread.part_to_go
        if self._linked is not None:
            return self._linked.part_to_go(self.distance_to_go)
        if self._element is not None:
            return self.distance_to_go / self._element.length if self._element.length > 0.0 else 0.0
        return max(0.0, self._interpolator.time_to_go) / self._dwell if self._dwell > 0.0 else 0.0

    @property
    def held(self) -> bool:
        """Feed hold or override 0 act; the path is at a standstill, or is on its ramp to standstill."""
        if self.thread is not None:
            return self.thread.waits and not self.thread.released
        return self.on_path and self._interpolator.override == 0.0

    @property
    def runs_out(self) -> float:
        """Length of the path, mm, that is known while it brakes because no more is; -1.0 while it does not."""
        ahead = None if self._linked is None else self._linked.look_ahead
        return ahead.known if ahead is not None and ahead.runs_out else -1.0

    @property
    def path_ahead(self) -> float:
        """Length of the path, mm, that the look-ahead knows."""
        if self.thread is not None:
            return self.thread.length_known
        return self.distance_to_go if self._linked is None else self._linked.look_ahead.known

    @property
    def can_be_held(self) -> bool:
        """An element is active that a feed hold would stop before its end."""
        if self.thread is not None:
            return self.thread.waits
        if self._linked is not None:
            return not self._linked.look_ahead.brakes_for_end
        return self._element is not None and not self._interpolator.ends_by_itself

    @property
    def stopped(self) -> bool:
        """True when `stop` was called and the path is at a standstill."""
        if self.thread is not None:
            return self.thread.stopped
        return self._linked.look_ahead.stopped if self._linked is not None else self._interpolator.stopped

    @property
    def runs_through(self) -> bool:
        """The path goes through several blocks."""
        return self._linked is not None

    @property
    def passes(self) -> bool:
        """The active block is finished; the path continues in the next one without a stop."""
        if self.thread is not None:
            return self.thread.passes
        return self._linked is not None and self._linked.passes

    def pass_block(self) -> None:
        """The next block of the path is the active one."""
        if self.thread is not None:
            self.thread.pass_block()
            self.feed = self.thread.feed
            return
        assert self._linked is not None
        self._linked.pass_block()
        self.feed = self._linked.feed

    @property
    def halted(self) -> bool:
        """The path rests at the end of a block that it would have passed, until `resume`."""
        return self._linked is not None and self._linked.halted

    def halt(self) -> None:
        """The path stops at the end of the active block, or of the first one at which the axes permit it."""
        if self._linked is not None:
            self._linked.halt()

    def resume(self) -> None:
        """Continues behind the block at whose end the path has halted."""
        if self._linked is not None:
            self._linked.look_ahead.resume()

    @property
    def point(self) -> PathPoint:
        """The last cycle that was given out."""
        return self.states, self.velocity, self.distance_to_go

    @property
    def rest(self) -> tuple[float, ...]:
        """Where the axes come to rest on the active element, as it is planned now."""
        if self._evaluate is None or self._element is None:
            return self.position
        return tuple([state[0] for state in self._evaluate(self._interpolator.end, 0.0, 0.0, 0.0)])

    def braking(self, motion: Path) -> tuple[float, ...]:
        """Distance of each axis while the path brakes from the feed of a straight motion that starts here; mm, deg."""
        plan = self.plan(motion, self.position)
        planner, length = plan.planner, plan.element.length
        way = planner.stopping_distance(min(plan.feed, plan.limits.velocity), 0.0, plan.limits)
        ends = zip(self.position, motion.target, strict=True)
        return tuple([abs(end - begin) / length * way if length > 0.0 else 0.0 for begin, end in ends])

    def place(self, index: int, position: float) -> None:
        """An axis is at `position`, to which something else has moved it."""
        if position != self.states[index][0]:
            self.states = (*self.states[:index], (position, 0.0, 0.0, 0.0), *self.states[index + 1 :])

    def start(self, motion: Path | Dwell, source: MotionSource | None = None) -> None:
        """Starts a motion, directly after another one at its exact end inside a cycle.

        With a `source` the path continues with the motions that follow, as far as nothing needs a stop between them.
        Raises CncError (22101–22112, 23001) for impossible motions; then nothing is started.
        """
        if isinstance(motion, Dwell):
            self._interpolator.dwell(motion.seconds)
            self._dwell = motion.seconds
            return
        if isinstance(motion, LinearMove) and motion.thread is not None:
            self._start_thread(motion, motion.thread.spindle, source)
            return
        kinematics = motion.kinematics
        start = self.position if kinematics is None else kinematics.forward(self.position)
        plan = self.plan(motion, start)
        if kinematics is not None:
            require_possible(whole(plan.element, 0), kinematics, self.position)
        element, feed = plan.element, plan.feed
        self._set_per_turn(motion)
        self._set_full_override(motion.full_override)
        if (source is not None or kinematics is not None) and self._link(plan, motion, source):
            return
        self._taps = taps(motion)
        self._interpolator.start(element, plan.limits, feed, planner=plan.planner)
        self._element, self.feed, self.distance_to_go = element, feed, element.length
        self._evaluate = evaluation(element, steps=plan.steps)

    def _start_thread(self, motion: LinearMove, spindle: str, source: MotionSource | None) -> None:
        """The thread waits for its spindle from the last cycle on that was given out."""
        thread = ThreadPath(self._threads, self._spindle_nodes[spindle], motion, self.position, source)
        thread.released = self._override > 0.0
        thread.begin(self._cycle)
        self.thread, self.feed = thread, motion.feed

    def read_spindles(self, first_cycle: int, feedback: Mapping[str, CycleBlock]) -> None:
        """Before each block of cycles: what the spindles have reported of the one before.

        Raises CncError 51109 and 22082, which break a thread off.
        """
        self._cycle = first_cycle
        if self.thread is not None:
            self.thread.read(first_cycle, feedback)

    @property
    def cuts_thread(self) -> bool:
        """The axes are in a thread, and not on the ramp at its end."""
        return self.thread is not None and self.thread.cuts

    @property
    def stop_text(self) -> str:
        """How a thread is broken off now, for events; empty without one."""
        return "" if self.thread is None else self.thread.stop_text

    def axis_failed(self, axis: int) -> None:
        """It cannot retract."""
        thread = self.thread
        if thread is not None and not thread.retracts and thread.retract is not None and thread.retract.axis == axis:
            thread.retract = None

    def take_notes(self) -> list[tuple[int, int, str]]:
        """Severity, number and text of what there is to be told of the active thread."""
        if self.thread is None or not self.thread.notes:
            return []
        notes, self.thread.notes = self.thread.notes, []
        return notes

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

    def plan(self, motion: Path, start: tuple[float, ...]) -> Plan:
        """How a motion from `start` is run on its own. Raises as `start`."""
        element, rapid, slope = self._make_element(start, motion), is_rapid(motion), motion.slope or self._default_slope
        axis_limits = self._rapid_limits if rapid else self._feed_limits
        if motion.kinematics is not None:
            axis_limits = programmed_limits(axis_limits, motion.kinematics)
        if isinstance(motion, LinearMove) and motion.tap is not None and self._spindle_limits is not None:
            axis_limits = [*axis_limits, self._spindle_limits(motion.tap.spindle)]
        if slope == STEP:
            axis_limits = [axis._replace(jerk=math.inf) for axis in axis_limits]
        free = rapid or motion.per_turn is not None
        limits = element.limits(math.inf if free else motion.feed, axis_limits, 1.0 if free else self._max_override)
        check_limits(limits)
        return Plan(element, limits, limits.velocity if rapid else motion.feed, slope)

    def _make_element(self, start: tuple[float, ...], motion: Path) -> Line | Arc:
        if isinstance(motion, LinearMove):
            line = Line(start, motion.target, self._feed_axes(motion))
            if motion.tap is None:
                return line
            angle = self.spindle_state[0]
            travel = motion.tap.degrees_per_mm * line.length
            return Line((*start, angle), (*motion.target, angle + travel), self._path_axes)
        turn = (motion.center, motion.plane, motion.radius, motion.sweep)
        return Arc(start, motion.target, *turn, self._feed_axes(motion), motion.directions)

    def _feed_axes(self, motion: Path) -> frozenset[int]:
        """Those whose path the feed is for."""
        return self._path_axes if motion.kinematics is None else self._path_axes.union(motion.kinematics.plane)

    def _link(self, plan: Plan, motion: Path, source: MotionSource | None) -> bool:
        """Starts a path of several blocks if the next motion can be linked to this one, and any with kinematics."""
        ahead = LookAhead(self._interpolator.override, self._interpolator.next_offset)
        path = self._linked_path(plan, motion, source, ahead, self._nominal_turns)
        if path is None:
            return False
        self._linked, self.feed = path, path.feed
        return True

    def _linked_path(
        self, plan: Plan, motion: Path, source: MotionSource | None, ahead: LookAhead, turns: float
    ) -> LinkedPath | None:
        """`turns`: turns per second for which feeds per turn are planned; 0.0: those of each motion."""
        following = None if motion.transition.stops or source is None else source.peek()
        if following is None and motion.kinematics is None:
            return None
        begin = plan.element.start if motion.kinematics is None else self.position
        builder = PathBuilder(sorted(self._feed_axes(motion)), self._cycle_time, begin)
        make = partial(self._make_linked, turns)
        path = LinkedPath(ahead, builder, source or NOTHING_FOLLOWS, make, steps=plan.steps)
        return path if path.begin(self._linked_motion(plan, motion, 0, turns), motion, following, begin) else None

    def _make_linked(self, turns: float, start: tuple[float, ...], motion: Path, block: int) -> LinkedMotion:
        plan = self.plan(motion, start)
        return self._linked_motion(plan, motion, block, turns)

    def _linked_motion(self, plan: Plan, motion: Path, block: int, turns: float) -> LinkedMotion:
        rapid = is_rapid(motion)
        limits = self._rapid_limits if rapid else self._feed_limits
        if plan.steps:
            limits = [stepping(axis, self._cycle_time) for axis in limits]
        feed = math.inf if rapid else motion.feed
        if motion.per_turn is not None and turns:
            feed = motion.per_turn.feed * turns
        return LinkedMotion(plan.element, limits, feed, block, motion.transition, plan.feed, motion.kinematics)

    def take_spindle(self) -> None:
        """A spindle becomes an axis of the path: its travel counts from here."""
        self.spindle_state, self._spindle_zero = AT_REST, None

    def take_c_axis(self, angle: float, limits: AxisLimits) -> None:
        """The spindle becomes the C axis where it stands (deg), with these limits (deg, s)."""
        self._spindle_zero = angle
        self._feed_limits[-1] = self._rapid_limits[-1] = limits
        self.place(len(self.states) - 1, angle)

    def spindle_travel(self, axes: AxisStates) -> AxisState:
        """Of the spindle since the path has taken it over, in a cycle in which no tapping moves it."""
        if self._spindle_zero is None:
            return self.spindle_state
        position, velocity, acceleration, jerk = axes[-1]
        return position - self._spindle_zero, velocity, acceleration, jerk

    def follow(self, count: int) -> list[PathPoint]:
        """The next `count` cycles of the active motion; fewer when it ends before.

        Raises CncError 22080 … 22084 for a thread that cannot be begun.
        """
        points = self._points(count)
        self._cycle += len(points)
        self.spindle_states = []
        if self._taps:
            self.spindle_states = [states[-1] for states, _, _ in points]
            points = [(states[:-1], velocity, distance) for states, velocity, distance in points]
            self.spindle_state = self.spindle_states[-1] if points else self.spindle_state
        if points:
            self.states, self.velocity, self.distance_to_go = points[-1]
        return points

    def _points(self, count: int) -> list[PathPoint]:
        if self.thread is not None:
            return self.thread.follow(count)
        if self._linked is not None:
            return self._linked.follow(count, self._cycle_time)
        rows = self._interpolator.step(count, self._cycle_time)
        element, evaluate = self._element, self._evaluate
        if element is None or evaluate is None:
            return [(self.states, 0.0, 0.0)] * len(rows)
        return [(evaluate(*row[:4]), row[1], element.length - row[0]) for row in rows]

    def stand(self) -> None:
        """A cycle passes in which no motion is active."""
        self._cycle += 1
        self._interpolator.step(1, self._cycle_time)

    def set_override(self, override: float, *, held: bool) -> None:
        """Override of the path, 1 is 100 %; acts from the last cycle given out.

        `held` (feed hold, feed release) comes with 0 and stops a motion of G166, too.
        """
        self._held = held
        self._override = override
        self._apply_override()
        if self.thread is not None:
            self.thread.release(override, held=held)

    def _apply_override(self) -> None:
        acting = 1.0 if self._full_override and not self._held else self._override
        acting = min(acting * self._turning_factor, LARGEST_OVERRIDE)
        self._interpolator.set_override(acting)
        if self._linked is not None:
            self._linked.look_ahead.set_override(acting)

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

    @property
    def awaited_spindle(self) -> str:
        """The spindle (name in programs) that stands, for which the path waits; empty for none."""
        return self._per_turn.spindle if self._per_turn is not None and self._turning_factor == 0.0 else ""

    def _set_full_override(self, full: bool) -> None:
        if full != self._full_override:
            self._full_override = full
            self.set_override(self._override, held=self._held)

    def stop(self) -> None:
        """Ramps down on the path; `follow` continues until `stopped` or the end of the element."""
        if self.thread is not None:
            self.thread.stop()
        elif self._linked is not None:
            self._linked.look_ahead.stop()
        else:
            self._interpolator.stop()

    def finish(self) -> None:
        """The motion has finished: the axes are exactly at its target, or at the end of its stop ramp."""
        linked, element, thread = self._linked, self._element, self.thread
        if thread is not None:
            self.states = standing(thread.target if thread.done and not thread.retracts else self.position)
            self._interpolator.go_on(thread.remaining_time - self._cycle_time if thread.done else 0.0)
            self.thread = None
        elif linked is not None:
            self.states = standing(linked.target if linked.done else self.position)
            self._interpolator.go_on(linked.look_ahead.remaining_time - self._cycle_time if linked.done else 0.0)
            self._linked = None
        else:
            done = element is not None and self._interpolator.done
            target = element.target if element is not None and done else self.position
            if self._taps:
                angle = target[-1] if done else self.spindle_state[0]
                self.spindle_state = (angle, 0.0, 0.0, 0.0)
                target = target[: len(self.states)]
            self.states = standing(target)
        self._element, self._taps, self._per_turn = None, False, None
        self.follow_spindle()
        self._set_full_override(False)
        self.velocity = self.distance_to_go = 0.0

    def abandon(self) -> None:
        """Forgets the motion of an aborted program, once the axes are at a standstill."""
        self.finish()
        override = self._interpolator.override
        self._interpolator = PathInterpolator()
        self._interpolator.set_override(override)


def programmed_limits(axes: Sequence[AxisLimits], kinematics: Kinematics) -> list[AxisLimits]:
    """What the programmed axes can do, roughly: for estimates, and for the feed that is shown in rapid traverse."""
    limits = list(axes)
    like, length = kinematics.likeness
    limits[kinematics.plane[1]] = AxisLimits(*[value * length for value in axes[like]])
    return limits


class NoMotions:
    """A MotionSource without any."""

    busy = False

    def peek(self) -> Path | None:
        return None

    def accept(self) -> None:
        raise AssertionError("there is none")


NOTHING_FOLLOWS: Final = NoMotions()


def evaluation(element: Line | Arc, *, steps: bool) -> Evaluation:
    """States of the axes on an element; without a limit of the jerk none is fed forward (P-AXIS-00337).

    On a line the axes then have none anyway.
    """
    if not steps or isinstance(element, Line):
        return element.evaluate

    def stepping_states(s: float, v: float, a: float, j: float) -> AxisStates:
        return without_jerk(element.evaluate(s, v, a, j))

    return stepping_states


STEP_PART = 0.1
"""Part of a cycle in which the acceleration of a linked path with slope STEP reaches its limit."""


def stepping(axis: AxisLimits, cycle_time: float) -> AxisLimits:
    """Limits without one of the jerk: with one that lets the acceleration step within a part of a cycle."""
    return axis._replace(jerk=max(axis.acceleration, axis.deceleration) / (STEP_PART * cycle_time))


def path_axes(channel: ChannelParameters) -> frozenset[int]:
    """Indices of the axes whose path the feed is for: X, Y and Z in any order, or all if there are none."""
    cartesian = frozenset(n for n, axis in enumerate(channel.axes) if axis.name in CARTESIAN)
    return cartesian or frozenset(range(len(channel.axes)))


def feed_limits(axes: Sequence[AxisParameters]) -> list[AxisLimits]:
    """Of axes on a path with a feed."""
    return [AxisLimits(a.max_velocity, a.acceleration, a.deceleration, a.jerk) for a in axes]


def thread_settings(channel: ChannelParameters, axes: Sequence[AxisParameters], cycle_time: float) -> ThreadSettings:
    """Of the threads of a channel. All axes of a path act equally late."""
    names, limits = list(channel.path_axes), feed_limits(axes)
    if channel.c_axis:
        limits.append(NO_LIMITS)
    retract = None
    if channel.thread_retract_axis in names and channel.thread_retract:
        axis = names.index(channel.thread_retract_axis)
        retract = Retract(axis, channel.thread_retract_axis, channel.thread_retract)
    delay = max((axis.control.delay_cycles for axis in axes), default=0)
    places = sorted(path_axes(channel))
    return ThreadSettings(names, limits, places, cycle_time, delay, channel.thread_run_up, retract)


def begins_element(before: float, now: float) -> bool:
    """From the distances to go (mm) of two cycles: within an element they only decrease, but for rounding."""
    return now > before + NEGLIGIBLE_MM


def standing(position: Sequence[float]) -> AxisStates:
    """States of axes at a standstill at `position` (mm)."""
    return tuple([(value, 0.0, 0.0, 0.0) for value in position])
