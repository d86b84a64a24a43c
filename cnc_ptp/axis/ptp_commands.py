"""PTP functions of an axis: start, new target, new velocity. Source: TX1250 2.1, 2.3, 2.4."""

from __future__ import annotations

from cnc_ptp.axis import transitions as T
from cnc_ptp.axis.axis import Axis
from cnc_ptp.axis.faults import (
    BELOW_INCREMENT,
    COMPENSATION_RUNS,
    NO_MODULO_AXIS,
    NO_POSITIONING,
    NOT_READY,
    SLAVE_LOCKED,
    START_BESIDE_EXTERNAL,
)
from cnc_ptp.axis.modulo import modulo_target
from cnc_ptp.axis.two_stage import Request
from cnc_ptp.errors import warning_text
from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.axis_states import state_name

REDIRECTABLE = (S.DISCRETE_MOTION, S.CONTINUOUS_MOTION, S.STOPPING)


def refuse_other_source(axis: Axis, command: str) -> None:
    """Raises 23027 and 23040 if external setpoints or a master move the axis."""
    if axis.external.mode is not None:
        reason = "external setpoints are enabled; a PTP start is not permitted at the same time"
        axis.refuse(command, START_BESIDE_EXTERNAL, reason)
    if axis.coupled and axis.coupling is not None:
        reason = f"the axis is a slave of {axis.coupling.master}; decouple it"
        axis.refuse(command, SLAVE_LOCKED, reason, master=axis.coupling.master)


class PtpCommands:
    """Commands that start and change a positioning; each is refused as a whole or carried out."""

    def __init__(self, axis: Axis) -> None:
        self._axis = axis

    # start (2.1)

    def do_move_absolute(self, cycle: int, *, target: float, **dynamics: float) -> str | None:
        """Starts to `target` (mm, deg). Refusals: 23003–23005, 23011, 23013, 23027, 120002, 120003."""
        return self._start("move_absolute", cycle, float(target), dynamics)

    def do_move_relative(self, cycle: int, *, distance: float, **dynamics: float) -> str | None:
        """Starts by `distance` (mm, deg) from the set position."""
        return self._start("move_relative", cycle, self._axis.setpoint(cycle)[0] + distance, dynamics)

    def do_move_modulo(self, cycle: int, *, position: float, **dynamics: float) -> str | None:
        """Starts to the modulo position |`position`| (deg), with whole turns; its sign is the direction.

        Also refused with 23024 on an axis that does not count modulo.
        """
        parameters = self._axis.parameters
        if not parameters.modulo:
            reason = "the axis does not count modulo (P-AXIS-00015)"
            self._axis.refuse("move_modulo", NO_MODULO_AXIS, reason)
        turn = parameters.modulo_high - parameters.modulo_low
        target = modulo_target(self._axis.setpoint(cycle)[0], float(position), turn)
        return self._start("move_modulo", cycle, target, dynamics)

    def _start(self, command: str, cycle: int, target: float, dynamics: dict[str, float]) -> str | None:
        axis = self._axis
        refuse_other_source(axis, command)
        if axis.state != S.STANDSTILL:
            state = state_name(axis.state)
            axis.refuse(command, NOT_READY, f"the axis is in {state}, it must be in Standstill", state=state)
        limits = axis.checks.dynamics(command, dynamics)
        limits, warning = axis.checks.rescaled_jerk(command, limits)
        axis.checks.soft_limits(command, target)
        distance = abs(target - axis.setpoint(cycle)[0])
        increment = axis.parameters.encoder_increment
        if distance < increment or distance == 0.0:
            axis.has_been_stopped = False
            reason = f"{distance:g} {axis.unit} is below one encoder increment ({increment} {axis.unit})"
            return warning_text(BELOW_INCREMENT, f"axis {axis.name}: {command} over {reason}; the axis does not move")
        axis.absorb(cycle)
        axis.ptp.start(cycle, target, limits)
        axis.target_window.watch()
        axis.has_been_stopped = False
        axis.take(T.START)
        return warning

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
        axis.ptp.redirect(cycle, request)
        if axis.ptp.job is None:
            return f"axis {axis.name}: {command} waits for the end of the stop"
        axis.take(T.NEW_TARGET)
        axis.has_been_stopped = False
        axis.target_window.watch()
        return None
