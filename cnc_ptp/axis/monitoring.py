"""Monitoring of an axis in motion: feed releases, soft limits, superimposed motions, target window."""

from __future__ import annotations

from collections.abc import Mapping
from math import copysign

from cnc_ptp.axis.axis import ROUNDING, Axis, Report
from cnc_ptp.axis.faults import FEED_WITHHELD, SETPOINT_TOO_FAR, SETPOINTS_STOPPED, SUM_TOO_FAST
from cnc_ptp.control.faults import TARGET_MISSED
from cnc_ptp.errors import NO_VALUES, Value
from cnc_ptp.motion.setpoints import MotionState, Setpoints
from cnc_ptp.protocol.axis_states import AxisStateCode as S

MOVING_ALONE = (S.DISCRETE_MOTION, S.STOPPING, S.CONTINUOUS_MOTION)
"""States that can end without a command."""


class Monitoring:
    """Checks the setpoints of an axis cycle by cycle, and where it comes to rest; a fault changes the setpoint."""

    def __init__(self, axis: Axis, *, cycle_time: float, report_warning: Report) -> None:
        """`cycle_time` in s."""
        self._axis = axis
        self._report_warning = report_warning
        self._longest_silence = round(axis.parameters.external_timeout / cycle_time)
        self._before: tuple[int, MotionState] | None = None
        """The last cycle with superimposed motion, and its setpoint."""

    def forget(self) -> None:
        """The coordinates of the axis have changed."""
        self._before = None

    def undisturbed(self, first_cycle: int, setpoints: Setpoints) -> bool:
        """True when in these cycles of basic motion nothing can happen to state, soft limits and target window.

        The state of the first cycle has been advanced already.
        """
        axis = self._axis
        if axis.superposed or axis.error_id or (axis.ptp.restricted and axis.state == S.SYNCHRONIZED_MOTION):
            return False
        if axis.state == S.HOMING or axis.lead.active or axis.ptp.follows:
            return False
        last_cycle = first_cycle + len(setpoints) - 1
        if axis.state in MOVING_ALONE and axis.ptp.arrived(last_cycle):
            return False
        if axis.coupling is not None or axis.state == S.CONTINUOUS_MOTION:
            low, high = axis.checks.soft_limit(-1.0).position, axis.checks.soft_limit(1.0).position
            for position in setpoints.positions:
                if not low <= position <= high:
                    return False
        if axis.ptp.job is not None or 0.0 not in setpoints.velocities:
            axis.target_window.moves()
            return True
        return not axis.target_window.watching

    def watch(self, cycle: int, setpoint: MotionState) -> MotionState:
        """Checks that cannot be made beforehand: feed releases, soft limits, external setpoints that jump or stay away.

        Returns the setpoint to be used, which is another one if a fault prevents it.
        """
        axis = self._axis
        if axis.error_id:
            return setpoint
        if axis.ptp.withholds(setpoint[1]) and not self._stops_in_time(cycle, setpoint[1]):
            where = "forward" if setpoint[1] > 0.0 else "backward"
            reason = f"it is moved {where}, which is not released (set_feed_release)"
            return self._fault_before(cycle, FEED_WITHHELD, reason, setpoint)
        if axis.superposed:
            return self._watch_superposition(cycle, setpoint)
        if axis.coupling is not None or (axis.state == S.CONTINUOUS_MOTION and not axis.jogs_to_limit):
            self._watch_soft_limits(cycle, setpoint)
        return setpoint

    def _stops_in_time(self, cycle: int, velocity: float) -> bool:
        """True for a motion in a withheld direction that its own generator or its channel brakes or will brake."""
        axis = self._axis
        if axis.on_path:
            return self._path_stops_in_time(cycle, velocity)
        if axis.coupled:
            return False
        if not axis.superposed or axis.state == S.STOPPING:
            return True
        if axis.added.halting and axis.added.moving(cycle):
            return True
        driven = axis.external.mode is not None and axis.ptp.withholds(axis.external.contribution(cycle)[1])
        return not driven and axis.ptp.withholds(axis.ptp.state(cycle)[1])

    def _path_stops_in_time(self, cycle: int, velocity: float) -> bool:
        """The channel brakes its path; motions added to it must not move the axis in a withheld direction."""
        axis = self._axis
        added = axis.superimposed(cycle, (0.0, 0.0, 0.0, 0.0))[1]
        if axis.ptp.withholds(velocity - added):
            axis.path_direction = copysign(1.0, velocity - added)
        driven = axis.carried is not None or axis.external.mode is not None
        return not (driven and axis.ptp.withholds(added))

    def _fault_before(
        self, cycle: int, error_id: int, reason: str, setpoint: MotionState, values: Mapping[str, Value] = NO_VALUES
    ) -> MotionState:
        """A fault that excludes `setpoint`: the ramp starts in the cycle before. Returns the setpoint to be used.

        If nothing was superimposed there, it starts at `setpoint`. The slave of a gantry pair continues with its
        master.
        """
        axis = self._axis
        if axis.pair_in(error_id) is not None:
            axis.fault(cycle, error_id, reason, values=values)
            return setpoint
        before = self._before if self._before is not None and self._before[0] == cycle - 1 else (cycle, setpoint)
        axis.brake(*before)
        axis.fault(cycle, error_id, reason, values=values)
        return axis.ptp.state(cycle)

    def _watch_superposition(self, cycle: int, setpoint: MotionState) -> MotionState:
        axis, unit, most = self._axis, self._axis.unit, self._axis.parameters.max_velocity
        if axis.coupled and not axis.has_job and setpoint[1] == 0.0:
            axis.compensation.end()
        if axis.external.rejected is not None:
            packet, distance = axis.external.rejected
            reason = (
                f"external setpoint {packet.position} {unit} is {abs(distance):g} {unit} away, more than the axis can "
                f"move in a cycle at {most} {unit}/s (P-AXIS-00212)"
            )
            values = {"position": packet.position, "distance": abs(distance), "velocity_limit": most}
            axis.fault(cycle, SETPOINT_TOO_FAR, reason, setpoint, values=values)
        elif axis.external.silence(cycle) > self._longest_silence:
            timeout = axis.parameters.external_timeout * 1000.0
            reason = f"no external setpoint for {timeout:g} ms while the axis moves"
            axis.fault(cycle, SETPOINTS_STOPPED, reason, setpoint, values={"timeout": timeout})
        elif abs(setpoint[1]) > most * (1.0 + ROUNDING):
            velocity = abs(setpoint[1])
            total = f"the superimposed motions would add up to {velocity:g} {unit}/s"
            reason = f"{total}, above the maximum {most} {unit}/s (P-AXIS-00212)"
            return self._fault_before(cycle, SUM_TOO_FAST, reason, setpoint, {"velocity": velocity, "limit": most})
        else:
            self._watch_soft_limits(cycle, setpoint)
        self._before = cycle, setpoint
        return setpoint

    def _watch_soft_limits(self, cycle: int, setpoint: MotionState) -> None:
        axis, (position, velocity, _, _) = self._axis, setpoint
        limit = axis.checks.soft_limit(velocity)
        outside = position > limit.position if velocity > 0.0 else position < limit.position
        if outside and velocity != 0.0:
            reason = f"set position {position} {axis.unit} is beyond the {limit.text}"
            axis.fault(cycle, limit.number, reason, setpoint, values={"position": position, "limit": limit.position})

    def watch_target(self, cycle: int, setpoint: MotionState, actual_position: float) -> None:
        """Warns once of an axis that has not come into its target window in time."""
        axis, window = self._axis, self._axis.target_window
        leads = axis.ptp.job is not None or axis.ptp.follows or axis.lead.active
        if setpoint[1] != 0.0 or leads:
            window.moves()
            return
        if not window.overdue(cycle, setpoint[0], actual_position):
            return
        distance = abs(window.error(setpoint[0], actual_position))
        time, limit = axis.parameters.target_time, axis.parameters.position_window
        text = (
            f"axis {axis.name}: {time:g} s after its end the motion is {distance:g} {axis.unit} away from its target, "
            f"more than the position window {limit:g} {axis.unit} (P-AXIS-00236)"
        )
        self._report_warning(cycle, TARGET_MISSED, text, {"distance": distance, "limit": limit, "time": time})
