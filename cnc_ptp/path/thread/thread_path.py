"""A thread (G33) as the path of a channel: the angle φ by which the spindle has turned takes the place of time.

| phase | φ | next |
|---|---|---|
| WAITS | 0; the axes stand until the spindle is where the run-up has to begin | RUNS_UP |
| RUNS_UP | a ramp with limited jerk to the speed ω of the spindle | FOLLOWS |
| FOLLOWS | the angle that is expected of the spindle, after each of its blocks anew | RUNS_OUT |
| RUNS_OUT | a ramp that ends exactly at the end of the last block | finished |
| STOPS | a ramp to a standstill after `stop` | stopped |

The thread begins (φ = 0) where the angle of the spindle is k · 360 deg + OFFSET, counted in the direction in which it
turns. A run-up of the duration T goes as far as D = ∫φ'dt < ω·T, so it begins while the spindle still lacks ω·T - D. At
its end φ is exactly the angle of the spindle, at every speed: passes from the same start lie in the same groove.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from enum import Enum, auto
from math import ceil, hypot
from typing import Final

from cnc_ptp.motion import Limits, Profile, plan_to_position, plan_to_velocity, stopping_distance
from cnc_ptp.motion.setpoints import MotionState
from cnc_ptp.nc.canonical import LinearMove
from cnc_ptp.parameters.list_units import DEG_S_PER_RPM
from cnc_ptp.path.active_motion import ActiveMotion, PathPoint
from cnc_ptp.path.interpolator import PathInterpolator
from cnc_ptp.path.linked_path import MotionSource
from cnc_ptp.path.shape import AxisState, standing
from cnc_ptp.path.thread.following import Following
from cnc_ptp.path.thread.leading_spindle import STANDS, LeadingSpindle
from cnc_ptp.path.thread.retract import Retract, RetractMotion
from cnc_ptp.path.thread.thread_check import (
    ROUNDING,
    TURN,
    Ramps,
    ThreadSettings,
    angle_of,
    checked_geometry,
    joined,
    last_pitch_of,
    limits_of,
    pitch_of,
    require_velocity,
    words_of,
)
from cnc_ptp.path.thread.thread_geometry import ThreadGeometry
from cnc_ptp.path.thread_place import ThreadPlace
from cnc_ptp.protocol.blocks import CycleBlock, Severity

THREAD_BEGINS = 22085
NO_OVERRIDE = 22086

AHEAD: Final = 50
"""Blocks behind the active one that are looked at."""
SHORTEST_HORIZON: Final = 2.0
"""Blocks of cycles within which the path at the soonest is where the spindle is."""


class Phase(Enum):
    """Where a thread is."""

    WAITS = auto()
    RUNS_UP = auto()
    FOLLOWS = auto()
    RUNS_OUT = auto()
    STOPS = auto()


class ThreadPath(ActiveMotion):
    """Runs the blocks of a thread.

    block   number of the active one, from 0
    """

    def __init__(
        self,
        settings: ThreadSettings,
        node: str,
        motion: LinearMove,
        start: tuple[float, ...],
        source: MotionSource | None,
    ) -> None:
        """`node` of the spindle; `source`: the motions behind `motion`."""
        super().__init__()
        self._settings, self._source = settings, source
        self._spindle = LeadingSpindle(node, settings.cycle_time)
        self._words = words_of(motion)
        self._following = Following(settings, self._spindle, self._words.offset)
        self._start = start
        self._motions = [motion]
        self._closed = source is None
        self._geometry: ThreadGeometry | None = None
        """From the moment on at which the speed is known."""
        self._renewed = True
        """The newest report has been used."""
        self._block_cycles = 1
        self._last_cycle = 0
        """Of the block of cycles that is being computed."""
        self._cycle = 0
        """The last one that was given out."""
        self._state: MotionState = (0.0, 0.0, 0.0, 0.0)
        """φ and its derivatives in that cycle."""
        self._pending: MotionState | None = None
        """Of the next cycle, if that belongs to the next block already."""
        self.phase = Phase.WAITS
        self._profile: Profile | None = None
        self._profile_begin = 0.0
        self._speed = abs(self._words.speed)
        self._ramps = Ramps(0.0, 0.0)
        self._retract: RetractMotion | None = None
        self.retract = settings.retract
        """None: the path stops in the thread."""
        self._stops = False
        self.done = False
        self.remaining_time = 0.0
        """s from the end of the thread to the cycle that is still to be filled."""
        self.released = True
        """Override and feed hold permit the start."""
        self.block = 0
        self._told_override = False
        self._extend()

    # what the channel asks

    @property
    def waits(self) -> bool:
        """The axes still stand at the start."""
        return self.phase is Phase.WAITS

    @property
    def feed(self) -> float:
        """What the speed of the spindle amounts to."""
        return self._motions[self.block].feed

    def end(self, position: tuple[float, ...]) -> tuple[float, ...]:
        return self._motions[-1].target if self.done and self._retract is None else position

    def hand_over(self, interpolator: PathInterpolator) -> None:
        interpolator.go_on(self.remaining_time - self._settings.cycle_time if self.done else 0.0)

    def held_by(self, override: float) -> bool:
        """Within the thread nothing holds it."""
        return self.waits and not self.released

    @property
    def can_be_held(self) -> bool:
        return self.waits

    def axis_failed(self, axis: int) -> None:
        """It cannot retract."""
        if self._retract is None and self.retract is not None and self.retract.axis == axis:
            self.retract = None

    @property
    def cuts_thread(self) -> bool:
        return self.phase in (Phase.RUNS_UP, Phase.FOLLOWS)

    @property
    def stopped(self) -> bool:
        if not self._stops or not self._retracted:
            return False
        ramp = self._profile
        ended = ramp is not None and self._time(self._cycle) >= ramp.duration
        return self.done or self.waits or (self.phase in (Phase.STOPS, Phase.RUNS_OUT) and ended)

    @property
    def passes(self) -> bool:
        return self._pending is not None and self._block_of(self._pending[0]) > self.block

    def pass_block(self) -> None:
        self.block += 1

    @property
    def angle_to_go(self) -> float:
        """deg to the end of the active block."""
        begin = 0.0 if self.waits else self._state[0]
        return max(0.0, self._end_of(self.block) - begin)

    def part_to_go(self, distance: float) -> float:
        return min(1.0, self.angle_to_go / angle_of(self._motions[self.block]))

    def time_to_go(self, velocity: float, distance: float) -> float:
        """At the speed of the spindle, without waiting for it."""
        return self.angle_to_go / self._speed if self._speed > 0.0 else -1.0

    def length_known(self, distance: float) -> float:
        if self._geometry is None:
            return 0.0
        return (self._geometry.end - self._state[0]) * pitch_of(self._motions[self.block])

    @property
    def waits_for(self) -> str:
        return self._spindle.waits_for if self.waits else ""

    def release(self, override: float, *, held: bool) -> None:
        """Override of the path and feed hold count before the start; within the thread one warning says so."""
        self.released = override > 0.0
        if self.waits or self._stops or self._told_override or (override == 1.0 and not held):
            return
        self._told_override = True
        percent = override * 100.0
        what = "feed hold" if held else f"path override {percent:g} %"
        text = f"{what} has no effect within a thread, it counts behind it"
        self.notes.append((Severity.WARNING, NO_OVERRIDE, text, {} if held else {"percent": percent}))

    # from block to block

    def begin(self, cycle: int) -> None:
        """The thread begins behind `cycle`."""
        self._cycle = cycle

    def read(self, first_cycle: int, feedback: Mapping[str, CycleBlock]) -> None:
        """The report of the spindle for the block before `first_cycle`.

        Raises CncError 51109 for a spindle that is held or stopped, 22082 for one that has become too fast.
        """
        reported = self._spindle.read(feedback)
        self._extend()
        if not reported:
            return
        self._block_cycles = self._spindle.cycles
        self._last_cycle = first_cycle + self._spindle.cycles
        self._renewed = False
        if self.cuts_thread and not self._stops and self._geometry is not None:
            self._spindle.require_turning()
            number = self._geometry.block_at(self._state[0])
            slopes, motion = self._geometry.slopes_of(number), self._motions[number]
            require_velocity(self._settings, slopes, motion, abs(self._spindle.angle.speed))

    def follow(self, count: int) -> list[PathPoint]:
        """As every motion. Raises CncError 22080 … 22084 for a thread that cannot be begun."""
        points: list[PathPoint] = []
        self.places = []
        self._renew()
        while len(points) < count:
            state = self._pending or self._next(self._cycle + 1)
            if state is None:
                break
            self._pending = state
            if self.passes:
                break
            self._pending = None
            self._cycle += 1
            self._state = state
            points.append(self._point(state))
            self.places.append(self._place(state, points[-1][0]))
        return points

    def _place(self, state: MotionState, axes: Sequence[AxisState]) -> ThreadPlace | None:
        """The angle of the spindle is that of φ, turned back by its direction, the zero passage and OFFSET."""
        if self.phase is not Phase.FOLLOWS or self._retract is not None or state[1] < STANDS:
            return None
        axis = words_of(self._motions[self._block_of(state[0])]).axis
        lead = self._following.sign * TURN * axes[axis][1] / state[1]
        angle = self._following.spindle_angle(state[0])
        return ThreadPlace(self._spindle.node, axis, axes[axis][0], lead, angle)

    def _point(self, state: MotionState) -> PathPoint:
        geometry = self._geometry
        if geometry is None or self.phase is Phase.WAITS:
            still = standing(self._start)
            return still, 0.0, self._distance(still, self._motions[0].target)
        states = geometry.evaluate(*state)
        distance = self._distance(states, geometry.start_of(self.block + 1))
        if self._retract is not None:
            states = self._retract.applied(states, self._cycle)
        velocity = hypot(*[states[axis][1] for axis in self._settings.path_axes])
        return states, velocity, distance

    def _distance(self, states: Sequence[AxisState], end: Sequence[float]) -> float:
        """mm of path to a point."""
        return hypot(*[end[axis] - states[axis][0] for axis in self._settings.path_axes])

    def _end_of(self, block: int) -> float:
        if self._geometry is not None:
            return self._geometry.begin_of(block + 1)
        return angle_of(self._motions[0])

    def _block_of(self, angle: float) -> int:
        return 0 if self._geometry is None else self._geometry.block_at(angle)

    # the motions of the thread

    def _extend(self) -> None:
        """Takes the blocks of G33 that follow, as far as they are known; a joint that does not fit ends the thread."""
        while not self._closed and len(self._motions) - self.block <= AHEAD:
            assert self._source is not None
            motion = self._source.peek()
            if motion is None and self._source.busy:
                return
            if not isinstance(motion, LinearMove) or not self._continues(motion) or not self._joined(motion):
                self._closed = True
                return
            self._source.accept()
            self._motions.append(motion)

    def _continues(self, motion: LinearMove) -> bool:
        thread = motion.thread
        return thread is not None and (thread.spindle, thread.offset) == (self._words.spindle, self._words.offset)

    def _joined(self, motion: LinearMove) -> bool:
        """Appends a motion to a thread that has begun; False if its joint does not fit."""
        if self._geometry is None:
            return True
        if self._stops or not self.cuts_thread:
            return False
        begin = max(self._ramps.run_up, self._state[0] + self._speed * self._horizon)
        run_out = joined(self._settings, self._geometry, motion, self._speed, begin)
        if run_out is None:
            return False
        self._ramps = self._ramps._replace(run_out=run_out)
        return True

    @property
    def _horizon(self) -> float:
        return SHORTEST_HORIZON * self._block_cycles * self._settings.cycle_time

    def _limits(self, geometry: ThreadGeometry, blocks: Sequence[int], velocity: float) -> Limits:
        return limits_of(self._settings, geometry, blocks, velocity)

    # start

    def _renew(self) -> None:
        """After each report of the spindle: the start, or how the path follows, is planned anew."""
        if self._renewed:
            return
        self._renewed = True
        if self.phase is Phase.WAITS:
            self._try_to_begin()
        elif self.phase is Phase.FOLLOWS:
            self._follow_from(self._cycle, self._state)

    def _try_to_begin(self) -> None:
        if self._stops or not self.released or not self._spindle.ready:
            return
        speed = self._spindle.angle.speed
        self._following.sign, self._speed = 1.0 if speed > 0.0 else -1.0, abs(speed)
        geometry, self._ramps = checked_geometry(self._settings, self._start, self._motions, self._speed)
        limits = self._limits(geometry, [0], self._speed)
        ramp = plan_to_velocity(0.0, 0.0, 0.0, self._speed, limits)
        cycle_time = self._settings.cycle_time
        angle, speed, _, _ = self._following.turned(self._cycle + ramp.duration / cycle_time)
        missing = ramp.end[0] - angle
        turns = ceil(-missing / TURN - ROUNDING)
        begin = self._cycle + (missing + turns * TURN) / speed / cycle_time
        if begin >= self._last_cycle:
            return
        self._following.zero = turns * TURN
        self._geometry, self._profile, self._profile_begin = geometry, ramp, begin
        self.phase = Phase.RUNS_UP
        self._note_begin(geometry)

    def _note_begin(self, geometry: ThreadGeometry) -> None:
        first, last = pitch_of(self._motions[0]), last_pitch_of(self._motions[len(geometry) - 1])
        speed, run_up, run_out = self._speed / DEG_S_PER_RPM, self._ramps.run_up * first, self._ramps.run_out * last
        text = f"thread at {speed:.1f} rpm: run-up {run_up:.3f} mm, run-out {run_out:.3f} mm"
        values = {"actual_speed": speed, "run_up": run_up, "run_out": run_out}
        self.notes.append((Severity.INFO, THREAD_BEGINS, text, values))

    # the angle of the path

    def _time(self, cycle: int) -> float:
        """s since the start of the active ramp."""
        return (cycle - self._profile_begin) * self._settings.cycle_time

    def _next(self, cycle: int) -> MotionState | None:
        """φ at the next cycle; None when the thread has ended before it."""
        if self.phase is Phase.WAITS:
            return self._state
        if self.phase is Phase.FOLLOWS:
            return self._follow_spindle(cycle)
        assert self._profile is not None
        t = self._time(cycle)
        state = self._profile.state_at(t)
        if self.phase is Phase.RUNS_UP and t >= self._profile.duration:
            self.phase = Phase.FOLLOWS
            self._follow_from(cycle, state)
        elif self.phase is Phase.RUNS_OUT and t >= self._profile.duration and self._retracted:
            self.done = True
            self.remaining_time = min(t - self._profile.duration, self._settings.cycle_time)
            return None
        return state

    def _follow_from(self, cycle: int, state: MotionState) -> None:
        assert self._geometry is not None
        self._following.renew(self._geometry, cycle, state, self._horizon, stops=self._stops and self._retract is None)

    def _follow_spindle(self, cycle: int) -> MotionState | None:
        """φ at `cycle` from the spindle; its end, a stop and a retract may come first."""
        geometry = self._geometry
        assert geometry is not None
        state = self._following.at(cycle)
        limits = self._limits_at_end(geometry)
        way = stopping_distance(state[1], state[2], limits.deceleration, limits.jerk)
        if state[0] + way > geometry.end:
            self._run_out(geometry)
            return self._next(cycle)
        if self._stops and (self._lands(cycle, state, way) or self._may_stop(state)):
            self._ramp_down()
            return self._next(cycle)
        return state

    def _lands(self, cycle: int, state: MotionState, way: float) -> bool:
        """A spindle that stops comes to rest where the path would, or stands already."""
        rest = self._following.rest() if self._retract is None else None
        return rest is not None and (state[0] + way > rest[0] or cycle + 1 >= rest[1])

    def _limits_at_end(self, geometry: ThreadGeometry) -> Limits:
        return self._limits(geometry, [len(geometry) - 1], max(self._state[1], STANDS))

    def _run_out(self, geometry: ThreadGeometry) -> None:
        angle, speed, gain, _ = self._state
        limits = self._limits_at_end(geometry)
        self._ramp(Phase.RUNS_OUT, plan_to_position(angle, speed, gain, geometry.end, limits))
        self._closed = True

    def _ramp(self, phase: Phase, profile: Profile) -> None:
        self.phase, self._profile, self._profile_begin = phase, profile, float(self._cycle)

    # stop and retract

    def stop(self) -> None:
        """Breaks the thread off: by a retract, in step with a spindle that stops, or on the ramp of the path."""
        if self._stops:
            return
        self._stops = True
        if not self.cuts_thread:
            return
        if self.retract is not None:
            self._begin_retract(self.retract)
        elif self.phase is Phase.RUNS_UP or not self._spindle.stops:
            self._pending = None
            self._ramp_down()

    @property
    def stop_text(self) -> str:
        """Empty also when the thread ends anyway."""
        if self.waits:
            return "the thread is not begun"
        if self._stops or not self.cuts_thread:
            return ""
        retract = self.retract
        if retract is not None:
            way = f"axis {retract.name} retracts by {retract.way:g} mm"
            return f"{way} while the path follows spindle {self._spindle.node}, then the path stops"
        if self.phase is Phase.FOLLOWS and self._spindle.stops:
            return f"the path follows spindle {self._spindle.node} to its standstill in the thread"
        return "the path stops on its ramp in the thread"

    def _may_stop(self, state: MotionState) -> bool:
        if self._retract is not None:
            return self._retracted
        return not self._spindle.stops or state[1] < STANDS

    def _ramp_down(self) -> None:
        """To a standstill as soon as possible; with a spindle that stops where that does, if it is not too late."""
        geometry = self._geometry
        assert geometry is not None
        angle, speed, gain, _ = self._state
        number = self._block_of(angle)
        blocks = [number] if number + 1 >= len(geometry) else [number, number + 1]
        limits = self._limits(geometry, blocks, max(speed, STANDS))
        ramp = plan_to_velocity(angle, speed, gain, 0.0, limits)
        rest = self._following.rest() if self._spindle.stops and self._retract is None else None
        if rest is not None and ramp.end[0] < rest[0] < geometry.end:
            ramp = plan_to_position(angle, speed, gain, rest[0], limits)
        if ramp.end[0] <= geometry.end:
            self._ramp(Phase.STOPS, ramp)
        else:
            self._run_out(geometry)

    def _begin_retract(self, retract: Retract) -> None:
        geometry = self._geometry
        assert geometry is not None
        slope = max(geometry.slopes_of(block)[retract.axis] for block in range(len(geometry)))
        limits, cycle_time = self._settings.limits[retract.axis], self._settings.cycle_time
        self._retract = RetractMotion(retract, limits, slope * self._speed, self._cycle, cycle_time)

    @property
    def _retracted(self) -> bool:
        """No retract is under way."""
        return self._retract is None or self._retract.done(self._cycle)
