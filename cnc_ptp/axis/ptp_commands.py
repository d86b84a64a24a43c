"""PTP functions of an axis: start, override, stop. Source: TX1250 2.1 and 2.2."""

from __future__ import annotations

from cnc_ptp.axis.axis import Axis
from cnc_ptp.axis.faults import BAD_OVERRIDE, BELOW_INCREMENT, NOT_READY
from cnc_ptp.axis.states import AxisStateCode as S
from cnc_ptp.axis.states import state_name


class PtpCommands:
    """Commands that start, change and end a positioning; each is refused as a whole or carried out."""

    def __init__(self, axis: Axis) -> None:
        self._axis = axis

    def do_move_absolute(self, cycle: int, *, target: float, **dynamics: float) -> str | None:
        """Starts to `target` (mm, deg). Source: TX1250 2.1. Refusals: 23003–23005, 23011, 23013, 120002, 120003."""
        return self._start("move_absolute", cycle, float(target), dynamics)

    def do_move_relative(self, cycle: int, *, distance: float, **dynamics: float) -> str | None:
        """Starts by `distance` (mm, deg) from the set position."""
        return self._start("move_relative", cycle, self._axis.setpoint(cycle)[0] + distance, dynamics)

    def do_stop(self, cycle: int) -> str | None:
        """Stops PTP motion on the ramp of its start. Source: TX1250 2.2."""
        axis = self._axis
        if axis.state == S.SYNCHRONIZED_MOTION:
            axis.refuse("stop", NOT_READY, "the channel path moves the axis; use feed_hold or reset of the channel")
        if axis.state != S.DISCRETE_MOTION:
            return f"axis {axis.name}: stop without effect in {state_name(axis.state)}"
        axis.ptp.stop(cycle, axis.own_limits)
        axis.state = S.STOPPING
        axis.has_been_stopped = True
        return None

    def do_set_override(self, cycle: int, *, percent: float) -> str | None:
        """Override of PTP motion, 0 … 100 % in steps of 0.0001 % (less is 0). Source: TX1250 2.2."""
        axis = self._axis
        highest = min(100.0, axis.parameters.max_override_percent)
        if not 0.0 <= percent <= highest:
            reason = f"percent = {percent} is not within 0 ... {highest:g} (P-AXIS-00109, at most 100)"
            axis.refuse("set_override", BAD_OVERRIDE, reason)
        acts = axis.ptp.set_override(cycle, percent / 100.0)
        axis.override_percent = float(percent) if axis.ptp.override else 0.0
        if acts or axis.state != S.DISCRETE_MOTION:
            return None
        reason = "brake phase or level out of reach"
        return f"axis {axis.name}: override {percent} % does not change the motion in work ({reason})"

    def _start(self, command: str, cycle: int, target: float, dynamics: dict[str, float]) -> str | None:
        axis = self._axis
        if axis.state != S.STANDSTILL:
            axis.refuse(command, NOT_READY, f"the axis is in {state_name(axis.state)}, it must be in Standstill")
        limits = axis.checks.dynamics(command, dynamics)
        limits, warning = axis.checks.rescaled_jerk(command, limits)
        axis.checks.soft_limits(command, target)
        distance = abs(target - axis.setpoint(cycle)[0])
        increment = axis.parameters.encoder_increment
        if distance < increment or distance == 0.0:
            axis.has_been_stopped = False
            return (
                f"P-WARN-{BELOW_INCREMENT} axis {axis.name}: {command} over {distance:g} {axis.unit} is below one "
                f"encoder increment ({increment} {axis.unit}); the axis does not move"
            )
        axis.ptp.start(cycle, target, limits)
        axis.has_been_stopped = False
        axis.state = S.DISCRETE_MOTION
        return warning
