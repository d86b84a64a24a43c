"""Other coordinates for an axis without moving it (PLCopen MC_SetPosition)."""

from __future__ import annotations

from cnc_ptp.axis.axis import Axis
from cnc_ptp.axis.faults import MASTER_HOMES, NOT_READY
from cnc_ptp.axis.monitoring import Monitoring
from cnc_ptp.axis.motion_queue import MotionQueue
from cnc_ptp.axis.motions import refuse_beside_trajectory, refuse_other_source
from cnc_ptp.control.control_loop import ControlLoop
from cnc_ptp.motion.limits import LARGEST_STATE, OUT_OF_RANGE
from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.axis_states import state_name

SET = "set_position"


class CoordinateCommands:
    """`set_position`. Set and actual position change together; all that is commanded already keeps its place."""

    def __init__(self, axis: Axis, loop: ControlLoop, queue: MotionQueue, monitoring: Monitoring) -> None:
        self._axis, self._loop = axis, loop
        self._queue, self._monitoring = queue, monitoring

    def do_set_position(self, cycle: int, *, position: float, relative: bool = False) -> None:
        """The actual position is `position` (mm, deg) from now on, or more by that if `relative`.

        The following error stays, soft limits stay where they are on the machine. Refusals: 23002, 23005, 23027, 23040,
        23071.
        """
        axis, loop = self._axis, self._loop
        self._check_state()
        distance = position if relative else position - loop.position
        now = loop.position + distance
        if not abs(now) <= LARGEST_STATE:
            reason = f"position {now} {axis.unit} is not within ±{LARGEST_STATE:g} {axis.unit}"
            axis.refuse(SET, OUT_OF_RANGE, reason, position=now, limit=LARGEST_STATE)
        loop.shift(distance)
        axis.shift_coordinates(distance)
        self._queue.shift(distance)
        self._monitoring.forget()

    def _check_state(self) -> None:
        axis = self._axis
        refuse_other_source(axis, SET, "external setpoints are enabled; disable them")
        refuse_beside_trajectory(axis, SET)
        if axis.state in (S.HOMING, S.SYNCHRONIZED_MOTION):
            state = state_name(axis.state)
            axis.refuse(SET, NOT_READY, f"the axis is in {state}", state=state)
        if axis.slaves:
            slaves = ", ".join(sorted(axis.slaves))
            axis.refuse(SET, MASTER_HOMES, f"the axis is the master of {slaves}; decouple first", slaves=slaves)
