"""How each motion of a channel is run on its own: its element, the dynamics of the path and the feed."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Final, NamedTuple

from cnc_ptp.kinematics.kinematics import Kinematics
from cnc_ptp.motion import Limits
from cnc_ptp.motion.limits import check_limits
from cnc_ptp.nc.canonical import STEP, LinearMove
from cnc_ptp.parameters import AxisParameters, ChannelParameters
from cnc_ptp.path.geometry import Arc, AxisLimits, Line
from cnc_ptp.path.linked_path import Path, is_rapid
from cnc_ptp.path.lookahead.path_builder import LinkedMotion
from cnc_ptp.path.planner import PLANNERS, Planner

CARTESIAN = ("X", "Y", "Z")
LimitsOfSpindle = Callable[[str], AxisLimits]
"""Limits of a spindle as an axis of the path, by its name in programs; deg, s."""
NO_LIMITS: Final = AxisLimits(1.0, 1.0, 1.0, 1.0)
"""Of the C axis while the spindle is none: it does not move."""
STEP_PART = 0.1
"""Part of a cycle in which the acceleration of a linked path with slope STEP reaches its limit."""


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


class MotionPlanner:
    """Plans the motions of a channel."""

    def __init__(
        self,
        channel: ChannelParameters,
        axes: Sequence[AxisParameters],
        cycle_time: float,
        spindle_limits: LimitsOfSpindle | None,
    ) -> None:
        """`axes` in the order of the channel; `cycle_time` in s; `spindle_limits` for tapping."""
        self._cycle_time = cycle_time
        self._feed_limits = feed_limits(axes)
        self._rapid_limits = [AxisLimits(a.rapid_velocity, a.acceleration, a.deceleration, a.jerk) for a in axes]
        if channel.c_axis:
            self._feed_limits.append(NO_LIMITS)
            self._rapid_limits.append(NO_LIMITS)
        self._path_axes = path_axes(channel)
        self._spindle_limits = spindle_limits
        self._max_override = channel.max_override_percent / 100.0
        self._default_slope = channel.slope

    def set_c_axis(self, limits: AxisLimits) -> None:
        """Limits of the spindle that is the C axis now; deg, s."""
        self._feed_limits[-1] = self._rapid_limits[-1] = limits

    def plan(self, motion: Path, start: tuple[float, ...], spindle_angle: float) -> Plan:
        """How a motion from `start` is run; `spindle_angle` of a spindle on the path, deg.

        Raises CncError 22101–22109 and 23001 for impossible motions.
        """
        element, slope = self._make_element(motion, start, spindle_angle), motion.slope or self._default_slope
        rapid = is_rapid(motion)
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

    def linked(self, plan: Plan, motion: Path, block: int, turns: float) -> LinkedMotion:
        """A planned motion as block number `block` of a linked path.

        `turns`: turns per second for which feeds per turn are planned; 0.0: those of each motion.
        """
        rapid = is_rapid(motion)
        limits = self._rapid_limits if rapid else self._feed_limits
        if plan.steps:
            limits = [stepping(axis, self._cycle_time) for axis in limits]
        feed = math.inf if rapid else motion.feed
        if motion.per_turn is not None and turns:
            feed = motion.per_turn.feed * turns
        return LinkedMotion(plan.element, limits, feed, block, motion.transition, plan.feed, motion.kinematics)

    def axes_with_feed(self, motion: Path) -> frozenset[int]:
        """Those whose path the feed is for."""
        return self._path_axes if motion.kinematics is None else self._path_axes.union(motion.kinematics.plane)

    def _make_element(self, motion: Path, start: tuple[float, ...], spindle_angle: float) -> Line | Arc:
        if isinstance(motion, LinearMove):
            line = Line(start, motion.target, self.axes_with_feed(motion))
            if motion.tap is None:
                return line
            travel = motion.tap.degrees_per_mm * line.length
            return Line((*start, spindle_angle), (*motion.target, spindle_angle + travel), self._path_axes)
        turn = (motion.center, motion.plane, motion.radius, motion.sweep)
        return Arc(start, motion.target, *turn, self.axes_with_feed(motion), motion.directions)


def programmed_limits(axes: Sequence[AxisLimits], kinematics: Kinematics) -> list[AxisLimits]:
    """What the programmed axes can do, roughly: for estimates, and for the feed that is shown in rapid traverse."""
    limits = list(axes)
    like, length = kinematics.likeness
    limits[kinematics.plane[1]] = AxisLimits(*[value * length for value in axes[like]])
    return limits


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
