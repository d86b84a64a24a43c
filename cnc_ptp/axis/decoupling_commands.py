"""Decoupling of a slave axis: in motion it becomes a pseudo master. Source: TX1250 3.2.3."""

from __future__ import annotations

from math import copysign, inf
from typing import NoReturn

from cnc_ptp.axis import transitions as T
from cnc_ptp.axis.axis import Axis
from cnc_ptp.axis.carried import CarriedMotion
from cnc_ptp.axis.faults import BAD_COUPLING_VALUE, DECOUPLE_AT_REST, NOT_COUPLED
from cnc_ptp.errors import warning_text
from cnc_ptp.motion.limits import SMALLEST_LIMIT
from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.axis_states import state_name


def refuse_free(axis: Axis, command: str) -> NoReturn:
    """Raises 23047: the command needs a slave."""
    state = state_name(axis.state)
    axis.refuse(command, NOT_COUPLED, f"the axis is not coupled (it is in {state})", state=state)


class DecouplingCommands:
    """`decouple`."""

    def __init__(self, axis: Axis) -> None:
        self._axis = axis

    def do_decouple(self, cycle: int, *, target: float | None = None, velocity: float | None = None) -> str | None:
        """Ends the coupling. A moving slave continues as a master with its velocity, or to `target`, or at `velocity`.

        `target` in mm (deg), in or against the direction of travel; `velocity` > 0 in mm/s (deg/s).
        Refusals: 23003, 23004, 23011, 23047, 23054 (an argument on the path of a channel), 120002, 120003.
        """
        axis, command = self._axis, "decouple"
        coupling = axis.coupling
        if coupling is None or axis.state not in (S.SYNCHRONIZED_MOTION, S.ERROR_STOP):
            refuse_free(axis, command)
        if velocity is not None:
            axis.checks.positive(command, {"velocity": velocity})
            axis.checks.velocity(command, velocity)
        if target is not None:
            axis.checks.soft_limits(command, target)
        if axis.carried is not None:
            self._put_down(cycle, axis.carried, target=target, velocity=velocity)
            return None
        if axis.state == S.ERROR_STOP:
            axis.coupling = None
            return None
        return self._continue(cycle, target, velocity)

    def _put_down(self, cycle: int, carried: CarriedMotion, **arguments: float | None) -> None:
        """What was added to the path comes to rest on the ramp of the axis; the path continues with that offset."""
        axis = self._axis
        for name, value in arguments.items():
            if value is not None:
                reason = f"{name} = {value:g} is not permitted on the path of a channel; leave it out"
                axis.refuse("decouple", BAD_COUPLING_VALUE, reason, argument=name, value=value)
        axis.external.brake(cycle, carried.state(cycle))
        axis.carried = axis.coupling = None

    def _continue(self, cycle: int, target: float | None, velocity: float | None) -> str | None:
        axis = self._axis
        former = axis.target_velocity()
        axis.coupling = None
        axis.leave_master(cycle)
        if axis.error_id:  # the slave of a gantry pair in error leaves its master: it stops alone
            axis.ptp.stop(cycle, axis.own_limits, at_least=True)
            axis.take(T.FAULT)
            return None
        _, speed, acceleration, _ = axis.ptp.state(cycle)
        if speed == 0.0 and acceleration == 0.0:
            axis.take(T.DECOUPLE_AT_REST if axis.powered else T.DECOUPLE_WITHOUT_POWER)
            return None if target is None and velocity is None else self._at_rest(target, velocity)
        highest = axis.parameters.max_velocity
        full = max(SMALLEST_LIMIT, velocity or min(former or abs(speed), highest))
        limits = axis.own_limits._replace(velocity=full)
        if target is not None:
            # what a compensation adds to the velocity is kept for the motion to the target too
            kept = velocity or min(max(full, abs(speed)), highest)
            axis.ptp.continue_to(cycle, float(target), limits._replace(velocity=kept))
            axis.target_window.watch()
            axis.take(T.DECOUPLE_TO_TARGET)
            axis.last_target = float(target)
        elif velocity is not None:
            axis.ptp.continue_to(cycle, copysign(inf, speed), limits)
            axis.take(T.DECOUPLE_IN_MOTION)
        else:
            axis.ptp.continue_at(cycle, full, limits)
            axis.take(T.DECOUPLE_IN_MOTION if axis.ptp.job else T.DECOUPLE_AND_STOP)
        return None

    def _at_rest(self, target: float | None, velocity: float | None) -> str:
        given = {"target": target, "velocity": velocity}
        unused = " and ".join(f"{name} {value:g}" for name, value in given.items() if value is not None)
        text = f"axis {self._axis.name}: decouple: the axis is at a standstill; {unused} is not used, start it"
        return warning_text(DECOUPLE_AT_REST, text)
