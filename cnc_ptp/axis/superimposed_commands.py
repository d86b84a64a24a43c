"""A motion in addition to the basic one (PLCopen MC_MoveSuperimposed, MC_HaltSuperimposed)."""

from __future__ import annotations

from math import isinf

from cnc_ptp.axis import transitions as T
from cnc_ptp.axis.axis import Axis
from cnc_ptp.axis.faults import (
    BELOW_INCREMENT,
    COMPENSATION_RUNS,
    FEED_WITHHELD,
    NOT_READY,
    START_BESIDE_EXTERNAL,
    VELOCITY_TOO_HIGH,
)
from cnc_ptp.axis.motion_queue import MotionQueue
from cnc_ptp.axis.motions import refuse_beside_trajectory
from cnc_ptp.errors import warning_text
from cnc_ptp.motion import Limits
from cnc_ptp.motion.limits import SMALLEST_LIMIT
from cnc_ptp.motion.to_position import leads_past
from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.axis_states import state_name

MOVE = "move_superimposed"
PERMITTED = (S.STANDSTILL, S.DISCRETE_MOTION, S.CONTINUOUS_MOTION, S.SYNCHRONIZED_MOTION)


class SuperimposedCommands:
    """`move_superimposed` and `halt_superimposed`: jobs beside that of the basic motion."""

    def __init__(self, axis: Axis, queue: MotionQueue) -> None:
        self._axis = axis
        self._queue = queue

    def do_move_superimposed(
        self, cycle: int, *, distance: float, velocity_difference: float | None = None, **dynamics: float
    ) -> str | None:
        """Adds `distance` (mm, deg) to the basic motion, with a velocity and dynamics in addition to those it has.

        Without `velocity_difference` it is what P-AXIS-00212 leaves. The target of a positioning moves by `distance`.
        A superimposed motion that is active ends where it is: `distance` counts from there.
        Refusals: 23003 – 23005, 23011, 23013, 23015, 23027, 23058, 120002, 120003.
        """
        axis = self._axis
        self._check_state()
        base = self._basic_velocity(cycle)
        velocity = self._velocity(base, velocity_difference)
        limits, warning = axis.checks.rescaled_jerk(MOVE, axis.checks.dynamics(MOVE, {"velocity": velocity} | dynamics))
        self._check_sum(base, velocity)
        self._check_release(cycle, distance, limits)
        small = abs(distance) < axis.parameters.encoder_increment or distance == 0.0
        if small and not axis.added.moving(cycle):
            if distance == 0.0:
                text = f"axis {axis.name}: {MOVE} over 0 {axis.unit}: there is no distance to add; nothing is added"
                return warning_text(BELOW_INCREMENT, text)
            size, limit = abs(distance), axis.parameters.encoder_increment
            increment = f"one encoder increment ({limit} {axis.unit})"
            text = f"axis {axis.name}: {MOVE} over {size:g} {axis.unit} is below {increment}; nothing is added"
            return warning_text(BELOW_INCREMENT, text, distance=size, limit=limit)
        growth = axis.added.growth(cycle, distance)
        self._queue.check_addition(cycle, growth)
        self._make_room(cycle, growth)
        self._start(cycle, distance, limits)
        return warning

    def _check_state(self) -> None:
        axis = self._axis
        if axis.state not in PERMITTED:
            axis.refuse(MOVE, NOT_READY, f"the axis is in {state_name(axis.state)}", state=state_name(axis.state))
        refuse_beside_trajectory(axis, MOVE)
        if axis.external.mode is not None:
            axis.refuse(MOVE, START_BESIDE_EXTERNAL, "external setpoints are enabled")
        if axis.compensation.active:
            axis.refuse(MOVE, COMPENSATION_RUNS, "a position compensation is active")

    def _check_release(self, cycle: int, distance: float, limits: Limits) -> None:
        """Neither what it does now nor where it is to go may be withheld."""
        axis = self._axis
        for direction in (axis.added.state(cycle)[1], axis.added.ahead(cycle, distance, limits)):
            if axis.ptp.withholds(direction):
                where = "forward" if direction > 0.0 else "backward"
                axis.refuse(MOVE, FEED_WITHHELD, f"it leads {where}, which is not released (set_feed_release)")

    def _basic_velocity(self, cycle: int) -> float:
        """The largest speed of the basic motion that is known, beside a superimposed motion that is active."""
        axis = self._axis
        if axis.coupled:
            return axis.target_velocity()
        return min(axis.ptp.highest_velocity(cycle), axis.ptp.ceiling)

    def _velocity(self, base: float, given: float | None) -> float:
        """The velocity difference; if it is left out, what the basic motion leaves."""
        own = self._axis.own_limits.velocity
        if given is not None:
            return given
        left = self._axis.parameters.max_velocity - base
        return min(own, left) if left >= SMALLEST_LIMIT else own

    def _check_sum(self, base: float, velocity: float) -> None:
        axis, highest = self._axis, self._axis.parameters.max_velocity
        if base + velocity > highest:
            unit = f"{axis.unit}/s"
            reason = (
                f"the axis would get up to {base + velocity:g} {unit}, above the maximum {highest} {unit} "
                "(P-AXIS-00212)"
            )
            axis.refuse(MOVE, VELOCITY_TOO_HIGH, reason, velocity=base + velocity, limit=highest)

    def _make_room(self, cycle: int, distance: float) -> None:
        """Raises 120002 and 120003 where the sum ends beyond a soft limit; motion at a velocity ends earlier there.

        It does not end later for a distance that leads away from its soft limit: it may come there before that has been
        covered, or the superimposed motion may be stopped.
        """
        axis, ptp, job = self._axis, self._axis.ptp, self._axis.ptp.job
        if axis.state == S.SYNCHRONIZED_MOTION or isinf(ptp.rest):
            return
        now, nearer = ptp.state(cycle)[:3], ptp.rest - distance
        leads_there = distance * (ptp.rest - now[0]) > 0.0
        if job is None or not axis.jogs_to_limit or not leads_there or leads_past(*now, nearer, job.limits):
            axis.checks.soft_limits(MOVE, ptp.rest + axis.shift(cycle) + distance)
        else:
            ptp.continue_to(cycle, nearer, job.limits, jog=job.jog)

    def _start(self, cycle: int, distance: float, limits: Limits) -> None:
        axis = self._axis
        if axis.state == S.STANDSTILL:
            axis.absorb(cycle)
            axis.has_been_stopped = False
            axis.target_window.watch()
            axis.take(T.SUPERIMPOSE)
        axis.added.start(cycle, distance, limits)
        axis.superposed = True
        if axis.state != S.SYNCHRONIZED_MOTION:
            axis.ptp.ceiling = axis.parameters.max_velocity - axis.added.peak
            self._queue.adapt(cycle)

    def do_halt_superimposed(self, cycle: int) -> str | None:
        """Ends the superimposed motion on its ramp; the basic motion continues."""
        axis = self._axis
        if not axis.added.moving(cycle):
            return f"axis {axis.name}: halt_superimposed without effect: no superimposed motion is active"
        axis.halt_added(cycle)
        return None
