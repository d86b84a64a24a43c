"""What all functions of an axis share: its state, its setpoint generator, refusals and faults."""

from __future__ import annotations

from collections.abc import Callable
from typing import NoReturn

from cnc_ptp.axis.checks import MotionChecks
from cnc_ptp.axis.ptp import PtpGenerator, State
from cnc_ptp.axis.states import AxisStateCode as S
from cnc_ptp.parameters import AxisParameters

Report = Callable[[int, int, str], None]
"""Takes an error event: cycle, number, text."""


class Axis:
    """The setpoint side of an axis. Commands (one class a group) change it, the unit around it computes cycles.

    Every fault ends in ErrorStop on the axis' own ramp (P-AXIS-00002 and the ramp time P-AXIS-00196), or on that of the
    motion in work where this is stronger.
    """

    def __init__(self, parameters: AxisParameters, *, cycle_time: float, report_error: Report) -> None:
        """`cycle_time` in s; `report_error` takes each fault as an event."""
        self.parameters = parameters
        self.name = parameters.name
        self.unit = "deg" if parameters.rotary else "mm"
        self.checks = MotionChecks(parameters, cycle_time=cycle_time)
        self.own_limits = self.checks.own_limits()
        self.ptp = PtpGenerator(
            position=parameters.start_position, cycle_time=cycle_time, override_type=parameters.override_type
        )
        self.powered = parameters.powered_at_start
        self.state = S.STANDSTILL if self.powered else S.DISABLED
        self.error_id = 0
        self.has_been_stopped = False
        self.override_percent = 100.0
        self._report_error = report_error

    def setpoint(self, cycle: int) -> State:
        """Position, velocity, acceleration and jerk at `cycle`, as they stand before a command that acts there."""
        return self.ptp.state(cycle)

    def at_rest_state(self) -> S:
        """Where an axis without error comes to rest."""
        return S.STANDSTILL if self.powered else S.DISABLED

    def advance_state(self, cycle: int) -> None:
        """Ends a motion that is through at `cycle`."""
        if self.state == S.DISCRETE_MOTION and self.ptp.arrived(cycle):
            self.ptp.finish()
            self.state = S.STANDSTILL
        elif self.state == S.STOPPING and self.ptp.finished(cycle):
            self.ptp.finish()
            self.state = self.at_rest_state()

    def refuse(self, command: str, error_id: int, reason: str) -> NoReturn:
        raise self.checks.refusal(command, error_id, reason)

    def fault(self, cycle: int, error_id: int, reason: str) -> None:
        """Error reaction: own ramp from the setpoint of `cycle`, state ErrorStop."""
        self.error_id = error_id
        self.ptp.stop(cycle, self.own_limits, at_least=True)
        self.state = S.ERROR_STOP
        self._report_error(cycle, error_id, f"axis {self.name}: {reason}; the axis stops on its own ramp (ErrorStop)")
