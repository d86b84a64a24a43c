"""Parameters of an axis that change while it runs (`write_parameter`, PLCopen MC_WriteParameter, #MACHINE DATA)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from cnc_ptp.axis.axis import Axis
from cnc_ptp.axis.faults import AXIS_MOVES, BEYOND_LIMIT, CHANNEL_HAS_IT, DRIVE_HAS_IT
from cnc_ptp.control.control_loop import ControlLoop
from cnc_ptp.control.feedforward import CouplingLimits
from cnc_ptp.errors import CncError, warning_text
from cnc_ptp.parameters import AxisParameters
from cnc_ptp.parameters.check.runtime_change import Change, changed, corrections
from cnc_ptp.parameters.declare import ids
from cnc_ptp.parameters.view.axis_view import axis_view
from cnc_ptp.parameters.view.control_view import ControlParameters
from cnc_ptp.parameters.view.fields import with_changes
from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.axis_states import state_name

WRITE = "write_parameter"
OF_THE_PATH = (
    ids.SLOPE_PROFIL_A_BESCHL,
    ids.SLOPE_PROFIL_A_BREMS,
    ids.SLOPE_PROFIL_TR_BESCHL_ZU,
    ids.DYNAMIK_A_MAX,
    ids.DYNAMIK_A_EMERGENCY,
    ids.DYNAMIK_VB_MAX,
    ids.KENNGR_SWE_NEG,
    ids.KENNGR_SWE_POS,
    ids.GETRIEBE_POS_REFPKT,
)
"""What a channel has taken over, too, to plan its path and to check its programs."""
AT_REST = (S.STANDSTILL, S.DISABLED, S.ERROR_STOP)


class ParameterCommands:
    """`write_parameter`: the axis becomes the one whose machine file has had the value from the start."""

    def __init__(self, axis: Axis, loop: ControlLoop, *, cycle_time: float, reselect: Callable[[], None]) -> None:
        """`cycle_time` in s; `reselect` selects the feedforward again that programs and PLC have asked for."""
        self._axis, self._loop = axis, loop
        self._cycle_time = cycle_time
        self._reselect = reselect

    def do_write_parameter(self, cycle: int, *, parameter: str, value: float, by_path: bool = False) -> str | None:
        """A new value in the unit of the list, until the end of the run.

        `by_path`: the channel that has the axis gives it, while its path stands. Refusals: 23095 – 23100, 110641.
        """
        axis = self._axis
        if axis.parameters.raw is None:
            raise TypeError(f"axis {axis.name} was made without a list of parameters")
        try:
            change = changed(axis.parameters.raw, parameter, value)
        except CncError as error:
            axis.refuse(WRITE, error.number, error.reason, parameter=parameter, value=value)
        self._require_rest(cycle, change, by_path)
        before, after = (axis_view(own, self._cycle_time) for own in (axis.parameters.raw, change.own))
        view = with_changes(axis.parameters, before, after)
        self._check(cycle, change, view)
        self._take(change, view)
        return self._warning(change)

    def _require_rest(self, cycle: int, change: Change, by_path: bool) -> None:
        axis = self._axis
        if change.at_once or (not axis.moving(cycle) and axis.state in AT_REST):
            return
        _, velocity, acceleration, _ = axis.setpoint(cycle)
        if by_path and axis.on_path and velocity == acceleration == 0.0:
            return
        what = f"{change.declaration.id} ({change.declaration.name}) is written at a standstill only"
        state = f"the axis is in {state_name(axis.state)}"
        axis.refuse(WRITE, AXIS_MOVES, f"{what}, {state}", parameter=change.declaration.id)

    def _check(self, cycle: int, change: Change, view: AxisParameters) -> None:
        """Raises for what drive or channel have taken over at their start, and for soft limits beside the axis."""
        axis, number = self._axis, change.declaration.id
        what = f"{number} ({change.declaration.name}) cannot be written at run time"
        if number in OF_THE_PATH and axis.parameters.channel:
            why = f"channel {axis.parameters.channel}, which has the axis, has taken it over at start-up"
            axis.refuse(WRITE, CHANNEL_HAS_IT, f"{what}, {why}", parameter=number)
        if drive_part(view.control) != drive_part(axis.parameters.control):
            axis.refuse(WRITE, DRIVE_HAS_IT, f"{what}, the drive has taken it over at start-up", parameter=number)
        position = axis.setpoint(cycle)[0] - axis.checks.coordinate_shift
        low, high = view.soft_limit_negative, view.soft_limit_positive
        if axis.checks.referenced and not low <= position <= high:
            where = f"the axis stands at {position:g} {axis.unit}, outside {low:g} to {high:g} {axis.unit}"
            reason = f"{number} ({change.declaration.name}): {where}"
            axis.refuse(WRITE, BEYOND_LIMIT, reason, parameter=number, position=position, low=low, high=high)

    def _take(self, change: Change, view: AxisParameters) -> None:
        axis, loop = self._axis, self._loop
        axis.take_parameters(view, cycle_time=self._cycle_time)
        if change.at_once:
            loop.monitor.take(view.control.monitoring, kv=view.control.kv)
        else:
            loop.take(view.control, CouplingLimits(view.max_velocity, view.max_acceleration, view.jerk))
            self._reselect()

    def _warning(self, change: Change) -> str | None:
        """What is used instead of the value that was written."""
        for notice in corrections(change, self._cycle_time):
            return warning_text(notice.error_id, f"axis {self._axis.name}: {WRITE}: {notice.parameter}: {notice.text}")
        return None


def drive_part(control: ControlParameters) -> tuple[object, ...]:
    """What drive and formats are made of at start-up.

    Not compared: the window of a SERCOS drive, and Kv where the position loop is not in the drive.
    """
    sercos = None if control.sercos is None else replace(control.sercos, position_window=0.0)
    plant = control.plant if control.drive.interface in ("position", "lag") else replace(control.plant, kv=0.0)
    return control.drive, control.scaling, plant, control.modulo_error, sercos, control.delay_cycles
