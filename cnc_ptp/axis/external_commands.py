"""External setpoints of an axis: enable, disable, setpoints. Source: TX1250 2.6."""

from __future__ import annotations

from collections.abc import Sequence

from cnc_ptp.axis import transitions as T
from cnc_ptp.axis.axis import Axis
from cnc_ptp.axis.external import ABSOLUTE, Setpoint, check_order, read_setpoints
from cnc_ptp.axis.faults import (
    BAD_SETPOINT,
    EXTERNAL_BESIDE_MOTION,
    EXTERNAL_COUPLED,
    EXTERNAL_IGNORED,
    EXTERNAL_IN_ERROR,
    EXTERNAL_MODE,
    EXTERNAL_NOT_ENABLED,
    NOT_READY,
    SUPERIMPOSED_RUNS,
)
from cnc_ptp.axis.motions import refuse_beside_trajectory
from cnc_ptp.errors import warning_text
from cnc_ptp.parameters.declare import ids
from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.axis_states import state_name

ENABLE = "external_enable"
SETPOINTS = "external_setpoints"


class ExternalCommands:
    """`external_enable`, `external_disable` and `external_setpoints`."""

    def __init__(self, axis: Axis) -> None:
        self._axis = axis

    def do_external_enable(self, cycle: int, *, mode: str, target: float | None = None) -> str | None:
        """Lets external setpoints move the axis: `absolute`, or `relative` to where it is, also added to other motion.

        On a PTP motion or the path of a channel they are relative; on a path they have no target.

        `target` (mm, deg; absolute, or relative like the setpoints) switches the target window monitoring to it. Called
        again in the same mode it takes over a new target. Refusals: 23005, 23025, 23026, 23028 – 23030, 120002, 120003.
        """
        axis = self._axis
        self._check_state(mode)
        if axis.added.moving(cycle):
            axis.refuse(ENABLE, SUPERIMPOSED_RUNS, "a superimposed motion is active")
        if axis.on_path:
            self._check_path(mode, target)
        position = axis.setpoint(cycle)[0]
        goal = target if target is None or mode == ABSOLUTE else self._relative_goal(cycle, target)
        if goal is not None:
            axis.checks.soft_limits(ENABLE, goal)
        if axis.state == S.STANDSTILL:
            axis.absorb(cycle)
            if mode == ABSOLUTE:
                axis.ptp.take_over(cycle, 0.0, 0.0, 0.0)
                axis.external.carry(position)
            axis.take(T.ENABLE_EXTERNAL)
            axis.has_been_stopped = False
        axis.external.enable(cycle, mode, position)
        axis.superposed = True
        axis.target_window.watch(goal)
        return None

    def _relative_goal(self, cycle: int, target: float) -> float:
        """Where the axis ends when the relative setpoints end at `target`; they count from where they were enabled."""
        axis = self._axis
        external = axis.external
        begin = external.zero(cycle) if external.mode else external.contribution(cycle)[0]
        end = axis.ptp.state(cycle)[0] if axis.ptp.job is None else axis.ptp.job.target
        return end + axis.compensation.offset + begin + target

    def _check_state(self, mode: str) -> None:
        axis = self._axis
        if axis.error_id:
            reason = f"the axis has error {axis.error_id}; reset it"
            axis.refuse(ENABLE, EXTERNAL_IN_ERROR, reason, error=axis.error_id)
        if not axis.powered:
            axis.refuse(ENABLE, EXTERNAL_NOT_ENABLED, "the axis is not enabled; power it on")
        if axis.ptp.restricted:
            axis.refuse(ENABLE, EXTERNAL_NOT_ENABLED, "both directions must be released (set_feed_release)")
        if axis.coupled and axis.coupling is not None:
            master = axis.coupling.master
            axis.refuse(ENABLE, EXTERNAL_COUPLED, f"{master} is the master of the axis", master=master)
        if axis.state in (S.STOPPING, S.HOMING):
            state = state_name(axis.state)
            axis.refuse(ENABLE, NOT_READY, f"the axis is in {state}", state=state)
        refuse_beside_trajectory(axis, ENABLE)
        enabled = axis.external.mode
        if enabled is not None and enabled != mode:
            reason = f"external setpoints are enabled as {enabled}; {mode} does not match"
            axis.refuse(ENABLE, EXTERNAL_MODE, reason, mode=mode, enabled=enabled)
        if mode == ABSOLUTE and (axis.state == S.DISCRETE_MOTION or axis.ptp.job is not None):
            reason = "absolute setpoints are not permitted during a PTP motion; use relative"
            axis.refuse(ENABLE, EXTERNAL_BESIDE_MOTION, reason)

    def _check_path(self, mode: str, target: float | None) -> None:
        """The axis does not know where the path ends, so there is no target to be watched."""
        if mode == ABSOLUTE:
            reason = "absolute setpoints are not permitted on the path of a channel; use relative"
            self._axis.refuse(ENABLE, EXTERNAL_BESIDE_MOTION, reason)
        if target is not None:
            reason = f"a target ({target:g}) is not permitted on the path of a channel; leave it out"
            self._axis.refuse(ENABLE, EXTERNAL_BESIDE_MOTION, reason, target=target)

    def do_external_disable(self, cycle: int) -> str | None:
        """The setpoint of this cycle counts once more; an axis that still moves then comes to rest on its ramp."""
        axis = self._axis
        if axis.external.mode is None:
            return f"axis {axis.name}: external_disable without effect: external setpoints are not enabled"
        axis.external.disable(cycle)
        return None

    def do_external_setpoints(self, cycle: int, *, setpoints: Sequence[Sequence[float]], file: str = "") -> str | None:
        """Takes rows of cycle, position, velocity, acceleration and direction; ignored while not enabled.

        Refused (23032) as a whole when one is not in order.
        """
        axis = self._axis
        if not axis.external.takes(cycle):
            text = f"axis {axis.name}: {SETPOINTS} ignored: external setpoints are not enabled"
            return warning_text(EXTERNAL_IGNORED, text)
        try:
            packets = read_setpoints(setpoints)
            if packets and packets[0].direction:
                check_order(axis.external.newest_cycle, packets[0])
        except ValueError as error:
            axis.refuse(SETPOINTS, BAD_SETPOINT, str(error))
        for packet in packets:
            self._check_limits(packet)
        axis.external.feed(packets)
        return None

    def _check_limits(self, packet: Setpoint) -> None:
        parameters, unit = self._axis.parameters, self._axis.unit
        for name, value, most, per, source in (
            ("velocity", packet.velocity, parameters.max_velocity, f"{unit}/s", ids.DYNAMIK_VB_MAX),
            ("acceleration", packet.acceleration, parameters.max_acceleration, f"{unit}/s²", ids.DYNAMIK_A_MAX),
        ):
            if abs(value) > most:
                reason = f"{name} {value} {per} is above the maximum {most} {per} ({source})"
                text = f"setpoint of cycle {packet.cycle}: {reason}"
                self._axis.refuse(
                    SETPOINTS, BAD_SETPOINT, text, setpoint=packet.cycle, argument=name, value=value, limit=most
                )
