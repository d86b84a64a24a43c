"""Enable and reset of a spindle."""

from __future__ import annotations

from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.unit import EMERGENCY_STOP
from cnc_ptp.spindle import transitions as T
from cnc_ptp.spindle.faults import ENABLE_REMOVED, STILL_TURNING
from cnc_ptp.spindle.spindle import Spindle


class PowerCommands:
    """`power` and `reset`."""

    def __init__(self, spindle: Spindle) -> None:
        self._spindle = spindle

    def do_power(self, cycle: int, *, enabled: bool) -> str | None:
        """Enables or disables the spindle; one that moves stops on its ramp with an error first (24011).

        While the PLC changes the gear an enable counts after that; no rotation resumes then. The enable itself moves
        nothing.
        """
        spindle = self._spindle
        if enabled == spindle.powered:
            return f"spindle {spindle.name}: power is {'on' if enabled else 'off'} already"
        spindle.powered = enabled
        spindle.unsettled = True
        if spindle.work.gear_request:
            spindle.take(T.POWER_OFF)
            spindle.work.forget_rotation()
            return f"spindle {spindle.name}: power on counts when the PLC has changed the gear" if enabled else None
        if enabled:
            self._switch_on(cycle)
        elif spindle.state == S.STANDSTILL:
            spindle.take(T.POWER_OFF)
        elif spindle.state != S.ERROR_STOP:
            spindle.fault(cycle, ENABLE_REMOVED, "the enable was removed in motion")
        return None

    def _switch_on(self, cycle: int) -> None:
        spindle = self._spindle
        if spindle.state == S.DISABLED:
            spindle.take(T.POWER_ON)
            spindle.exact_stop.forget()
            spindle.place_after_open_loop(cycle)

    def do_set_emergency_stop(self, cycle: int, *, enabled: bool) -> None:
        """The emergency stop of the machine or of the HLI: down to speed 0, ErrorStop.

        When it is released nothing turns: the spindle wants a reset.
        """
        if enabled and self._spindle.state != S.ERROR_STOP:
            self._spindle.fault(cycle, EMERGENCY_STOP, "emergency stop")

    def do_reset(self, cycle: int) -> None:
        """Leaves ErrorStop at standstill (24004 while turning); otherwise stops the spindle in any state."""
        spindle = self._spindle
        if spindle.state == S.DISABLED:
            spindle.end_procedure()
            return
        if spindle.state != S.ERROR_STOP:
            spindle.stop(cycle)
            return
        if spindle.motion(cycle)[1] != 0.0:
            reason = "the spindle still turns on its error ramp; wait for standstill"
            spindle.refuse("reset", STILL_TURNING, reason)
        spindle.error_id = 0
        spindle.job_error = False
        spindle.take(T.RESET if spindle.powered else T.RESET_WITHOUT_POWER)
        spindle.unsettled = True
