"""Commands of homing: `home`, and the override of the channel whose G74 homes the axis."""

from __future__ import annotations

from cnc_ptp.axis import transitions as T
from cnc_ptp.axis.axis import Axis
from cnc_ptp.axis.faults import COMPENSATION_RUNS, HOMING_DISABLED, MASTER_HOMES, NOT_READY, ON_CAM
from cnc_ptp.axis.homing import Homing
from cnc_ptp.axis.motions import refuse_other_source
from cnc_ptp.parameters.view.homing_view import DISABLED
from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.axis_states import state_name

HOME = "home"


class HomingCommands:
    """`home`, `set_homing_override`."""

    def __init__(self, axis: Axis, homing: Homing) -> None:
        self._axis, self._homing = axis, homing

    def do_home(self, cycle: int) -> None:
        """Homes the axis (G74). Refusals: 60313, 23005, 23015, 23027, 23040, 23071, 23072."""
        axis = self._axis
        self._check()
        axis.absorb(cycle)
        axis.take(T.HOME)
        axis.has_been_stopped = False
        axis.target_window.watch()
        self._homing.begin(cycle)

    def _check(self) -> None:
        axis, parameters = self._axis, self._axis.parameters.homing
        if parameters.kind == DISABLED:
            axis.refuse(HOME, HOMING_DISABLED, "the axis cannot be homed (P-AXIS-00299 = DISABLED)")
        refuse_other_source(axis, HOME)
        if axis.state != S.STANDSTILL:
            state = state_name(axis.state)
            axis.refuse(HOME, NOT_READY, f"the axis is in {state}, it must be in Standstill", state=state)
        if axis.slaves:
            slaves = ", ".join(sorted(axis.slaves))
            axis.refuse(HOME, MASTER_HOMES, f"the axis is the master of {slaves}; decouple first", slaves=slaves)
        if axis.compensation.active:
            axis.refuse(HOME, COMPENSATION_RUNS, "a position compensation is active")
        if parameters.without_reversing and not parameters.without_cam and self._homing.on_cam:
            reason = "the axis is on its reference cam and may not reverse (P-AXIS-00157 = 1); move it off the cam"
            axis.refuse(HOME, ON_CAM, reason)

    def do_set_homing_override(self, cycle: int, *, percent: float) -> None:
        """Override of the channel that homes the axis, in addition to its own; counts until the homing ends."""
        if self._axis.state == S.HOMING:
            self._axis.set_homing_override(cycle, percent)
