"""Tolerances of a trajectory: how far the axis may be away from it, and from its goal at the end."""

from __future__ import annotations

from cnc_ptp.axis.axis import Axis, Report
from cnc_ptp.axis.faults import GOAL_MISSED, PATH_DEVIATION
from cnc_ptp.motion.setpoints import MotionState
from cnc_ptp.protocol.jobs import JobStatus


class TrajectoryWatch:
    """Compares set and actual position of the axis in each cycle of a trajectory."""

    def __init__(self, axis: Axis, *, cycle_time: float, report_warning: Report) -> None:
        """`cycle_time` in s."""
        self._axis = axis
        self._cycle_time = cycle_time
        self._report_warning = report_warning
        self._begin = 0
        self._delay = 0.0
        self._path_tolerance = self._goal_tolerance = self._goal_time = 0.0
        self._end: int | None = None
        """The first cycle at its end."""

    def begin(self, cycle: int, delay: float, path_tolerance: float, goal_tolerance: float, goal_time: float) -> None:
        """A trajectory begins `delay` (s) after `cycle`; tolerances in mm (deg) and s, 0: none."""
        self._begin, self._delay, self._end = cycle, delay, None
        self._path_tolerance, self._goal_tolerance, self._goal_time = path_tolerance, goal_tolerance, goal_time
        self._axis.seeks_goal = goal_tolerance > 0.0

    def watch(self, cycle: int, setpoint: MotionState, actual_position: float) -> None:
        """A fault when the axis deviates too far; its job has failed when it is not at its goal in time."""
        axis = self._axis
        if not axis.ptp.follows or axis.error_id:
            return
        deviation = abs(setpoint[0] - actual_position)
        if not axis.ptp.finished(cycle):
            self._watch_path(cycle, setpoint[0], actual_position, deviation)
        elif axis.seeks_goal:
            self._watch_goal(cycle, setpoint[0], actual_position, deviation)

    def _watch_path(self, cycle: int, position: float, actual_position: float, deviation: float) -> None:
        if 0.0 < self._path_tolerance < deviation:
            axis, unit = self._axis, self._axis.unit
            time = (cycle - self._begin) * self._cycle_time - self._delay
            reason = (
                f"{deviation:g} {unit} away from the trajectory {time:.4g} s after its start (set position "
                f"{position:g} {unit}, actual position {actual_position:g} {unit}), more than the path tolerance "
                f"{self._path_tolerance:g} {unit}"
            )
            values = {"deviation": deviation, "limit": self._path_tolerance, "expected": position}
            values |= {"actual_position": actual_position, "time": time}
            axis.fault(cycle, PATH_DEVIATION, reason, values=values)

    def _watch_goal(self, cycle: int, position: float, actual_position: float, deviation: float) -> None:
        axis, unit = self._axis, self._axis.unit
        if self._end is None:
            self._end = cycle
        if deviation <= self._goal_tolerance:
            axis.seeks_goal = False
        elif (cycle - self._end) * self._cycle_time >= self._goal_time:
            axis.seeks_goal = False
            axis.jobs.end(cycle, JobStatus.FAILED, GOAL_MISSED)
            text = (
                f"axis {axis.name}: {deviation:g} {unit} away from its goal {position:g} {unit} (actual "
                f"position {actual_position:g} {unit}) {self._goal_time:g} s after its end, more than the goal "
                f"tolerance {self._goal_tolerance:g} {unit}; the axis is at a standstill"
            )
            values = {"deviation": deviation, "limit": self._goal_tolerance, "goal": position}
            values |= {"actual_position": actual_position, "time": self._goal_time}
            self._report_warning(cycle, GOAL_MISSED, text, values)
