"""External setpoints of an axis: enable, disable, setpoints. Source: TX1250 2.6."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from math import isfinite

from cnc_ptp.axis.axis import Axis
from cnc_ptp.axis.external import ABSOLUTE, Setpoint
from cnc_ptp.axis.faults import (
    BAD_SETPOINT,
    EXTERNAL_BESIDE_MOTION,
    EXTERNAL_COUPLED,
    EXTERNAL_IGNORED,
    EXTERNAL_IN_ERROR,
    EXTERNAL_MODE,
    EXTERNAL_NOT_ENABLED,
    NOT_READY,
)
from cnc_ptp.axis.states import AxisStateCode as S
from cnc_ptp.axis.states import state_name

ENABLE = "external_enable"
SETPOINTS = "external_setpoints"


class ExternalCommands:
    """`external_enable`, `external_disable` and `external_setpoints`."""

    def __init__(self, axis: Axis) -> None:
        self._axis = axis

    def do_external_enable(self, cycle: int, *, mode: str, target: float | None = None) -> str | None:
        """Lets external setpoints move the axis: `absolute`, or `relative` to where it is, also on top of PTP motion.

        `target` (mm, deg; absolute, or relative like the setpoints) switches the target window monitoring to it. Called
        again in the same mode it takes over a new target. Refusals: 23005, 23025, 23026, 23028 – 23030, 120002, 120003.
        """
        axis = self._axis
        self._check_state(mode)
        position = axis.setpoint(cycle)[0]
        goal = target if target is None or mode == ABSOLUTE else position + target
        if goal is not None:
            axis.checks.soft_limits(ENABLE, goal)
        if axis.state == S.STANDSTILL:
            axis.absorb(cycle)
            axis.state = S.CONTINUOUS_MOTION
            axis.has_been_stopped = False
        axis.external.enable(cycle, mode, position)
        axis.superposed = True
        axis.target_window.watch(goal)
        return None

    def _check_state(self, mode: str) -> None:
        axis = self._axis
        if axis.error_id:
            axis.refuse(ENABLE, EXTERNAL_IN_ERROR, f"the axis has error {axis.error_id}; reset it")
        if not axis.powered:
            axis.refuse(ENABLE, EXTERNAL_NOT_ENABLED, "the axis is not enabled; power it on")
        if axis.state == S.SYNCHRONIZED_MOTION:
            axis.refuse(ENABLE, EXTERNAL_COUPLED, "the channel path moves the axis")
        if axis.state == S.STOPPING:
            axis.refuse(ENABLE, NOT_READY, f"the axis is in {state_name(axis.state)}")
        if axis.external.mode not in (None, mode):
            reason = f"external setpoints are enabled as {axis.external.mode}; {mode} does not match"
            axis.refuse(ENABLE, EXTERNAL_MODE, reason)
        if mode == ABSOLUTE and axis.state == S.DISCRETE_MOTION:
            reason = "absolute setpoints beside a PTP motion are not permitted; use relative"
            axis.refuse(ENABLE, EXTERNAL_BESIDE_MOTION, reason)

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
        if axis.external.mode is None:
            return (
                f"P-WARN-{EXTERNAL_IGNORED} axis {axis.name}: {SETPOINTS} ignored: external setpoints are not enabled"
            )
        packets = [self._checked(row) for row in setpoints]
        for before, packet in pairwise(packets):
            if packet.cycle <= before.cycle:
                self._refuse(packet.cycle, f"comes after cycle {before.cycle}; cycles must ascend")
        axis.external.feed(packets)
        return None

    def _checked(self, row: Sequence[float]) -> Setpoint:
        if len(row) != len(Setpoint._fields):
            names = ", ".join(Setpoint._fields)
            self._axis.refuse(SETPOINTS, BAD_SETPOINT, f"a setpoint needs {names}; {list(row)} has {len(row)} values")
        for name, value in zip(Setpoint._fields, row, strict=True):
            if isinstance(value, bool) or not isinstance(value, (int, float)) or not isfinite(value):
                self._axis.refuse(SETPOINTS, BAD_SETPOINT, f"{name} = {value!r} is not a finite number")
        packet = Setpoint(int(row[0]), float(row[1]), float(row[2]), float(row[3]), int(row[4]))
        parameters, unit = self._axis.parameters, self._axis.unit
        if packet.direction not in (-1, 0, 1):
            self._refuse(packet.cycle, f"direction = {packet.direction} is none of -1, 0, 1")
        if abs(packet.velocity) > parameters.max_velocity:
            limit = f"{parameters.max_velocity} {unit}/s (P-AXIS-00212)"
            self._refuse(packet.cycle, f"velocity {packet.velocity} {unit}/s is above the maximum {limit}")
        return packet

    def _refuse(self, cycle: int, reason: str) -> None:
        self._axis.refuse(SETPOINTS, BAD_SETPOINT, f"setpoint of cycle {cycle}: {reason}")
