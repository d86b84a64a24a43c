"""PTP functions of an axis: start, new target, new velocity. Source: TX1250 2.1, 2.3, 2.4; PLCopen buffer modes."""

from __future__ import annotations

from cnc_ptp.axis import transitions as T
from cnc_ptp.axis.axis import Axis
from cnc_ptp.axis.faults import COMPENSATION_RUNS, NO_MODULO_AXIS, NO_POSITIONING, NOT_READY
from cnc_ptp.axis.motion_queue import MotionQueue
from cnc_ptp.axis.motions import AtRest, AtVelocity, ByDistance, ToModulo, ToTarget
from cnc_ptp.axis.two_stage import Request
from cnc_ptp.motion import Limits
from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.axis_states import state_name

REDIRECTABLE = (S.DISCRETE_MOTION, S.CONTINUOUS_MOTION, S.STOPPING)


class PtpCommands:
    """Commands that start and change a motion; each is refused as a whole or carried out."""

    def __init__(self, axis: Axis, queue: MotionQueue) -> None:
        self._axis = axis
        self._queue = queue

    # start (2.1); `buffer_mode` says what becomes of an active motion (MotionQueue)

    def do_move_absolute(self, cycle: int, *, target: float, buffer_mode: str = "", **dynamics: float) -> str | None:
        """Starts to `target` (mm, deg). Refusals: 23003–23005, 23011, 23013, 23015, 23027, 23063, 120002, 120003."""
        command = "move_absolute"
        motion = ToTarget(command, *self._limits(command, dynamics), float(target))
        return self._queue.start(cycle, motion, buffer_mode)

    def do_move_relative(self, cycle: int, *, distance: float, buffer_mode: str = "", **dynamics: float) -> str | None:
        """Starts by `distance` (mm, deg) from the set position, or from the end of the motion before."""
        command = "move_relative"
        motion = ByDistance(command, *self._limits(command, dynamics), float(distance))
        return self._queue.start(cycle, motion, buffer_mode)

    def do_move_additive(self, cycle: int, *, distance: float, buffer_mode: str = "", **dynamics: float) -> str | None:
        """Starts by `distance` (mm, deg) from the target of the last positioning, without one from the set position."""
        command = "move_additive"
        motion = ByDistance(command, *self._limits(command, dynamics), float(distance), additive=True)
        return self._queue.start(cycle, motion, buffer_mode)

    def do_move_modulo(self, cycle: int, *, position: float, buffer_mode: str = "", **dynamics: float) -> str | None:
        """Starts to the modulo position |`position`| (deg), with whole turns; its sign is the direction.

        Also refused with 23024 on an axis that does not count modulo.
        """
        command = "move_modulo"
        if not self._axis.parameters.modulo:
            self._axis.refuse(command, NO_MODULO_AXIS, "the axis does not count modulo (P-AXIS-00015)")
        motion = ToModulo(command, *self._limits(command, dynamics), float(position))
        return self._queue.start(cycle, motion, buffer_mode)

    def do_move_velocity(self, cycle: int, *, velocity: float, buffer_mode: str = "", **dynamics: float) -> str | None:
        """Moves at `velocity` (mm/s, deg/s; its sign is the direction) until another motion comes.

        On a linear axis it ends at the soft limit. At 0 it comes to rest and waits there. Refusals as move_absolute.
        """
        command = "move_velocity"
        if velocity == 0.0:
            return self._queue.start(cycle, AtRest(command, *self._limits(command, dynamics)), buffer_mode)
        limits = self._limits(command, {"velocity": abs(velocity), **dynamics})
        return self._queue.start(cycle, AtVelocity(command, *limits, velocity), buffer_mode)

    def _limits(self, command: str, dynamics: dict[str, float]) -> tuple[Limits, str | None]:
        checks = self._axis.checks
        return checks.rescaled_jerk(command, checks.dynamics(command, dynamics))

    # new target (2.3), new velocity and new target (2.4)

    def do_new_target(self, cycle: int, *, target: float) -> str | None:
        """Leads the active positioning to `target` (mm, deg). Refusals: 23005, 23014, 23015, 120002, 120003."""
        self._check_redirection("new_target", target)
        return self._redirect("new_target", cycle, Request(self._in_basic_motion(cycle, target)))

    def do_new_velocity_and_target(
        self, cycle: int, *, velocity: float, target: float, activation_position: float
    ) -> str | None:
        """New target immediately, new velocity (mm/s) from `activation_position` on.

        Also refused with 23003, 23004 and 23011 for the velocity.
        """
        command = "new_velocity_and_target"
        self._check_redirection(command, target)
        self._axis.checks.positive(command, {"velocity": velocity})
        self._axis.checks.velocity(command, velocity)
        positions = self._in_basic_motion(cycle, target), self._in_basic_motion(cycle, activation_position)
        return self._redirect(command, cycle, Request(positions[0], float(velocity), positions[1]))

    def _in_basic_motion(self, cycle: int, position: float) -> float:
        return position - self._axis.shift(cycle)

    def _check_redirection(self, command: str, target: float) -> None:
        axis = self._axis
        if axis.state not in REDIRECTABLE or not axis.ptp.can_redirect:
            state = state_name(axis.state)
            reason = f"no positioning is active (the axis is in {state}); start one"
            axis.refuse(command, NO_POSITIONING, reason, state=state)
        if not axis.powered:
            axis.refuse(command, NOT_READY, "the enable was removed")
        if axis.compensation.active:
            axis.refuse(command, COMPENSATION_RUNS, "a position compensation is active")
        axis.checks.soft_limits(command, target)

    def _redirect(self, command: str, cycle: int, request: Request) -> str | None:
        axis = self._axis
        axis.drop_waiting(cycle)
        axis.ptp.redirect(cycle, request)
        axis.last_target = request.target + axis.shift(cycle)
        if axis.ptp.job is None:
            axis.waiting_job = axis.jobs.newest + 1
            return f"axis {axis.name}: {command} waits for the end of the stop"
        axis.take(T.NEW_TARGET)
        axis.has_been_stopped = False
        axis.target_window.watch()
        return None
