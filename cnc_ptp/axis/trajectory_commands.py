"""A trajectory that an axis follows: points at given times, with tolerances while it runs and at its end."""

from __future__ import annotations

from collections.abc import Sequence

from cnc_ptp.axis import transitions as T
from cnc_ptp.axis.axis import Axis
from cnc_ptp.axis.faults import FEED_WITHHELD, NOT_READY
from cnc_ptp.axis.motions import refuse_other_source
from cnc_ptp.axis.trajectory_checks import BEGIN, TrajectoryChecks
from cnc_ptp.axis.trajectory_watch import TrajectoryWatch
from cnc_ptp.motion.trajectory import Trajectory
from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.axis_states import state_name


class TrajectoryCommands:
    """`begin_trajectory`, which the PLC gives for all axes of a trajectory in one block."""

    def __init__(self, axis: Axis, watch: TrajectoryWatch, *, cycle_time: float) -> None:
        """`cycle_time` in s."""
        self._axis = axis
        self._watch = watch
        self._checks = TrajectoryChecks(axis, cycle_time=cycle_time)

    def do_begin_trajectory(
        self,
        cycle: int,
        *,
        points: Sequence[object],
        path_tolerance: float = 0.0,
        goal_tolerance: float = 0.0,
        goal_time: float = 0.0,
        delay: float = 0.0,
    ) -> None:
        """Follows rows of time, position and, if given, velocity and acceleration; it begins after `delay` (s).

        Tolerances (mm, deg) of the actual position: while it runs, and at its end within `goal_time` (s); 0: none.
        Refusals: 23004, 23005, 23011, 23013, 23027, 23040, 23058, 23064, 120002, 120003.
        """
        axis = self._axis
        self._check_state()
        for name, value in (
            ("path_tolerance", path_tolerance),
            ("goal_tolerance", goal_tolerance),
            ("goal_time", goal_time),
            ("delay", delay),
        ):
            self._checks.tolerance(name, value)
        now = axis.setpoint(cycle)[0]
        trajectory = Trajectory(self._checks.points(points, now), delay=delay)
        self._checks.limits(trajectory, now)
        axis.absorb(cycle)
        axis.ptp.follow(cycle, trajectory)
        axis.target_window.watch()
        axis.has_been_stopped = False
        axis.take(T.START)
        axis.last_target = trajectory.end[0]
        self._watch.begin(cycle, delay, path_tolerance, goal_tolerance, goal_time)

    def _check_state(self) -> None:
        axis = self._axis
        refuse_other_source(axis, BEGIN, "external setpoints are enabled; disable them")
        if axis.state != S.STANDSTILL:
            state = state_name(axis.state)
            axis.refuse(BEGIN, NOT_READY, f"the axis is in {state}, it must be in Standstill", state=state)
        if axis.ptp.restricted:
            axis.refuse(BEGIN, FEED_WITHHELD, "both directions must be released (set_feed_release)")
