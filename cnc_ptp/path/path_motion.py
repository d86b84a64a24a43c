"""The motion of a channel's axes: the active path element or dwell, its override and its stop ramp."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

from cnc_ptp.motion import Limits
from cnc_ptp.nc.canonical import STEP, CircularMove, Dwell, LinearMove
from cnc_ptp.parameters import AxisParameters, ChannelParameters
from cnc_ptp.path.geometry import NEGLIGIBLE_MM, Arc, AxisLimits, AxisState, Line
from cnc_ptp.path.interpolator import PathInterpolator
from cnc_ptp.path.planner import JERK_LIMITED, STEPS

CARTESIAN = ("X", "Y", "Z")
AxisStates = tuple[AxisState, ...]
Evaluation = Callable[[float, float, float, float], AxisStates]
"""States of the axes from path length, velocity, acceleration and jerk."""
PathPoint = tuple[AxisStates, float, float]
"""One cycle on the path: the state of each axis, path velocity (mm/s), distance to the end of the element (mm)."""


class Plan(NamedTuple):
    """How a motion is run: its element, dynamics of the path, feed (mm/s), with `steps` of the acceleration."""

    element: Line | Arc
    limits: Limits
    feed: float
    steps: bool


class PathMotion:
    """Runs the motions of canonical blocks; between them the axes are at rest.

    states           (position, velocity, acceleration, jerk) of each axis in the last cycle that was given out
    velocity         path velocity, mm/s
    distance_to_go   mm to the end of the element
    feed             programmed feed, mm/s; in rapid traverse the velocity that the axes allow
    """

    def __init__(self, channel: ChannelParameters, axes: Sequence[AxisParameters], cycle_time: float) -> None:
        """`axes` in the order of the channel, standing at their start positions; `cycle_time` in s."""
        self._cycle_time = cycle_time
        self._feed_limits = [AxisLimits(a.max_velocity, a.acceleration, a.deceleration, a.jerk) for a in axes]
        self._rapid_limits = [AxisLimits(a.rapid_velocity, a.acceleration, a.deceleration, a.jerk) for a in axes]
        self._path_axes = path_axes(channel)
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
        self.states = standing([a.start_position for a in axes])
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
        return self._element is not None

    @property
    def override(self) -> float:
        """Override of motions without G166, 1 is 100 %, 0 is feed hold."""
        return self._override

    @property
    def time_to_go(self) -> float:
        """Seconds to the end of the active motion or dwell; 0.0 without one, -1.0 while it is held."""
        return self._interpolator.time_to_go

    @property
    def part_to_go(self) -> float:
        """Part of the active element's length, or of the dwell's time, that is still to come; 0.0 without one."""
        if self._element is not None:
            return self.distance_to_go / self._element.length if self._element.length > 0.0 else 0.0
        return max(0.0, self._interpolator.time_to_go) / self._dwell if self._dwell > 0.0 else 0.0

    @property
    def held(self) -> bool:
        """Feed hold or override 0 act; the path is at a standstill, or is on its ramp to standstill."""
        return self._element is not None and self._interpolator.override == 0.0

    @property
    def can_be_held(self) -> bool:
        """An element is active that a feed hold would stop before its end."""
        return self._element is not None and not self._interpolator.ends_by_itself

    @property
    def stopped(self) -> bool:
        """True when `stop` was called and the path is at a standstill."""
        return self._interpolator.stopped

    @property
    def point(self) -> PathPoint:
        """The last cycle that was given out."""
        return self.states, self.velocity, self.distance_to_go

    def place(self, index: int, position: float) -> None:
        """An axis is at `position`, to which something else has moved it."""
        if position != self.states[index][0]:
            self.states = (*self.states[:index], (position, 0.0, 0.0, 0.0), *self.states[index + 1 :])

    def start(self, motion: LinearMove | CircularMove | Dwell) -> None:
        """Starts a motion, directly after another one at its exact end inside a cycle.

        Raises CncError (22101–22112, 23001) for impossible motions; then nothing is started.
        """
        if isinstance(motion, Dwell):
            self._interpolator.dwell(motion.seconds)
            self._dwell = motion.seconds
            return
        plan = self._plan(motion, self.position)
        element, feed = plan.element, plan.feed
        self._set_full_override(motion.full_override)
        self._interpolator.start(element, plan.limits, feed, planner=STEPS if plan.steps else JERK_LIMITED)
        self._element, self.feed, self.distance_to_go = element, feed, element.length
        self._evaluate = evaluation(element, steps=plan.steps)

    def duration(self, motion: LinearMove | CircularMove, start: tuple[float, ...]) -> float:
        """Seconds that a motion from `start` takes from rest to rest with override 100 %. Raises as `start`."""
        plan = self._plan(motion, start)
        if plan.element.length == 0.0:
            return 0.0
        limits = plan.limits._replace(velocity=min(plan.feed, plan.limits.velocity))
        planner = STEPS if plan.steps else JERK_LIMITED
        return planner.from_rest(0.0, plan.element.length, limits).duration

    def _plan(self, motion: LinearMove | CircularMove, start: tuple[float, ...]) -> Plan:
        element = self._make_element(motion, start)
        rapid = isinstance(motion, LinearMove) and motion.rapid
        axis_limits = self._rapid_limits if rapid else self._feed_limits
        steps = (motion.slope or self._default_slope) == STEP
        if steps:
            axis_limits = [axis._replace(jerk=math.inf) for axis in axis_limits]
        limits = element.limits(math.inf if rapid else motion.feed, axis_limits, 1.0 if rapid else self._max_override)
        return Plan(element, limits, limits.velocity if rapid else motion.feed, steps)

    def _make_element(self, motion: LinearMove | CircularMove, start: tuple[float, ...]) -> Line | Arc:
        if isinstance(motion, LinearMove):
            return Line(start, motion.target, self._path_axes)
        return Arc(start, motion.target, motion.center, motion.plane, motion.radius, motion.sweep, self._path_axes)

    def follow(self, count: int) -> list[PathPoint]:
        """The next `count` cycles of the active motion; fewer when it ends before."""
        rows = self._interpolator.step(count, self._cycle_time)
        element, evaluate = self._element, self._evaluate
        if element is None or evaluate is None:
            return [(self.states, 0.0, 0.0)] * len(rows)
        points = [(evaluate(*row[:4]), row[1], element.length - row[0]) for row in rows]
        if points:
            self.states, self.velocity, self.distance_to_go = points[-1]
        return points

    def stand(self) -> None:
        """A cycle passes in which no motion is active."""
        self._interpolator.step(1, self._cycle_time)

    def set_override(self, override: float, *, held: bool) -> None:
        """Override of the path, 1 is 100 %; acts from the last cycle given out.

        `held` (feed hold, feed release) comes with 0 and stops a motion of G166, too.
        """
        self._held = held
        self._override = override
        self._interpolator.set_override(1.0 if self._full_override and not held else override)

    def _set_full_override(self, full: bool) -> None:
        if full != self._full_override:
            self._full_override = full
            self.set_override(self._override, held=self._held)

    def stop(self) -> None:
        """Ramps down on the path; `follow` continues until `stopped` or the end of the element."""
        self._interpolator.stop()

    def finish(self) -> None:
        """The motion has finished: the axes are exactly at its target, or at the end of its stop ramp."""
        element = self._element
        self.states = standing(element.target if element and self._interpolator.done else self.position)
        self._element = None
        self._set_full_override(False)
        self.velocity = self.distance_to_go = 0.0

    def abandon(self) -> None:
        """Forgets the motion of an aborted program, once the axes are at a standstill."""
        self.finish()
        override = self._interpolator.override
        self._interpolator = PathInterpolator()
        self._interpolator.set_override(override)


def evaluation(element: Line | Arc, *, steps: bool) -> Evaluation:
    """States of the axes on an element; without a limit of the jerk none is fed forward (P-AXIS-00337).

    On a line the axes then have none anyway.
    """
    if not steps or isinstance(element, Line):
        return element.evaluate

    def without_jerk(s: float, v: float, a: float, j: float) -> AxisStates:
        return tuple([(p, v, a, 0.0) for p, v, a, _ in element.evaluate(s, v, a, j)])

    return without_jerk


def path_axes(channel: ChannelParameters) -> frozenset[int]:
    """Indices of the axes whose path the feed is for: X, Y and Z in any order, or all if there are none."""
    cartesian = frozenset(n for n, axis in enumerate(channel.axes) if axis.name in CARTESIAN)
    return cartesian or frozenset(range(len(channel.axes)))


def begins_element(before: float, now: float) -> bool:
    """From the distances to go (mm) of two cycles: within an element they only decrease, but for rounding."""
    return now > before + NEGLIGIBLE_MM


def standing(position: Sequence[float]) -> AxisStates:
    """States of axes at a standstill at `position` (mm)."""
    return tuple([(value, 0.0, 0.0, 0.0) for value in position])
