"""Enable and reset of an axis."""

from __future__ import annotations

from cnc_ptp.axis import transitions as T
from cnc_ptp.axis.axis import Axis
from cnc_ptp.axis.faults import ENABLE_REMOVED, STILL_MOVING
from cnc_ptp.axis.transitions import STOPPABLE
from cnc_ptp.control.control_loop import ControlLoop
from cnc_ptp.protocol.axis_states import AxisStateCode as S


class PowerCommands:
    """`power` and `reset`."""

    def __init__(self, axis: Axis, loop: ControlLoop) -> None:
        self._axis = axis
        self._loop = loop

    def do_power(self, cycle: int, *, enabled: bool) -> str | None:
        """Enables or disables the axis; a moving axis is stopped on its ramp first.

        If the position loop was open, it is closed at the actual position, so that the enable moves nothing.
        """
        axis = self._axis
        if enabled == axis.powered:
            return f"axis {axis.name}: power is {'on' if enabled else 'off'} already"
        if enabled:
            self._switch_on(cycle)
        else:
            self._switch_off(cycle)
        return None

    def _switch_on(self, cycle: int) -> None:
        axis = self._axis
        if self._loop.is_open and not axis.moving(cycle):
            axis.place(cycle, self._loop.position)
        axis.powered = True
        if axis.state == S.DISABLED:
            axis.take(T.POWER_ON)

    def _switch_off(self, cycle: int) -> None:
        axis = self._axis
        axis.powered = False
        axis.ptp.drop_suspended()
        axis.drop_waiting(cycle)
        if axis.state == S.STANDSTILL:
            axis.take(T.POWER_OFF)
        elif axis.state == S.SYNCHRONIZED_MOTION:
            what = "path motion" if axis.on_path else "synchronous motion"
            axis.fault(cycle, ENABLE_REMOVED, f"the enable was removed during {what}")
        elif axis.state in STOPPABLE:
            axis.abort_motion(cycle)

    def do_reset(self, cycle: int) -> None:
        """Leaves ErrorStop; refused while the axis moves (23008). PTP motion and external setpoints are aborted."""
        axis = self._axis
        if axis.state in STOPPABLE:
            axis.abort_motion(cycle)
        if axis.on_path:
            axis.external.disable(cycle)
            axis.halt_added(cycle)
        if axis.state != S.ERROR_STOP:
            return
        if not axis.rests(cycle):
            axis.refuse("reset", STILL_MOVING, "the axis still moves on its error ramp; wait for standstill")
        axis.error_id = 0
        axis.ptp.finish()
        axis.coupling = None
        axis.take(T.RESET if axis.powered else T.RESET_WITHOUT_POWER)
