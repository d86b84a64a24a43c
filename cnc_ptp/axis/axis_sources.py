"""Where an axis gets its basic motion from besides its own generator: the path of a channel, a master axis."""

from __future__ import annotations

from collections.abc import Mapping
from math import copysign

from cnc_ptp.axis import transitions as T
from cnc_ptp.axis.axis import Axis
from cnc_ptp.axis.coupling import Coupling, LinearCoupling
from cnc_ptp.axis.external import NEGLIGIBLE_VELOCITY
from cnc_ptp.axis.faults import GANTRY_DIFFERENCE, PATH_NOT_ACCEPTED
from cnc_ptp.axis.flying_saw import FlyingSaw
from cnc_ptp.errors import CncError
from cnc_ptp.motion.limits import LARGEST_STATE, OUT_OF_RANGE
from cnc_ptp.motion.profile import MotionState
from cnc_ptp.parameters import AxisParameters
from cnc_ptp.path.path_motion import begins_element
from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.axis_states import StatusBit, state_name
from cnc_ptp.protocol.blocks import AxisBlock, ChannelBlock, CycleBlock
from cnc_ptp.protocol.unit import UPSTREAM_LOST

PATH_TOLERANCE = 1e-9
"""Largest distance (mm, deg) between an axis and the begin of the path that takes it over."""


def in_range(state: MotionState) -> bool:
    """False for what no table can be made for, an infinity or a NaN: where factors of a cascade multiply."""
    p, v, a, _ = state
    return -LARGEST_STATE <= p <= LARGEST_STATE and abs(v) <= LARGEST_STATE and abs(a) <= LARGEST_STATE


class PathSource:
    """The channel that has the axis on its path."""

    def __init__(self, axis: Axis) -> None:
        self._axis = axis
        self._first_cycle = 0
        self._to_go = [0.0]
        """Distance to the end of the element: at the end of the last block, then in each cycle of this one."""

    def setpoints(self, first_cycle: int, inputs: Mapping[str, CycleBlock]) -> list[MotionState]:
        """The setpoints of the channel that moves the axis, none if no one does; switches the setpoint source."""
        channel = self._owning_channel(inputs)
        if channel is None:
            self._leave(first_cycle)
            return []
        start = channel.axes.index(self._axis.name) * channel.count
        part = slice(start, start + channel.count)
        setpoints = list(
            zip(
                channel.set_position[part],
                channel.set_velocity[part],
                channel.set_acceleration[part],
                channel.set_jerk[part],
                strict=True,
            )
        )
        self._first_cycle, self._to_go = first_cycle, [self._to_go[-1], *channel.distance_to_go]
        self._enter(first_cycle, setpoints[0][0])
        if self._axis.state != S.SYNCHRONIZED_MOTION:
            return []
        self._axis.ptp.take_over(first_cycle + channel.count - 1, *setpoints[-1][:3])
        return setpoints

    def watch(self, cycle: int, velocity: float) -> None:
        """A path that waits in a direction waits no more when it turns round, or another element begins."""
        axis, n = self._axis, cycle - self._first_cycle
        if not axis.path_direction:
            return
        turns = axis.path_direction * velocity < -NEGLIGIBLE_VELOCITY
        if turns or (n + 1 < len(self._to_go) and begins_element(*self._to_go[n : n + 2])):
            axis.path_direction = 0.0

    def put_down(self, first_cycle: int, inputs: Mapping[str, CycleBlock]) -> None:
        """Where the path of the channel has ended below a flying saw, the axis is an ordinary slave from now on."""
        axis = self._axis
        if self._owning_channel(inputs) is not None or not isinstance(axis.coupling, FlyingSaw):
            return
        position, velocity, _, _ = axis.ptp.state(first_cycle)
        if velocity == 0.0:
            axis.coupling.shift(position)
            axis.carried = None

    def forbid(self, first_cycle: int, inputs: Mapping[str, CycleBlock]) -> None:
        """A channel may not move an axis that follows a master."""
        if self._owning_channel(inputs) is not None:
            reason = "the channel moves the path while the axis is a slave"
            self._axis.fault(first_cycle, PATH_NOT_ACCEPTED, reason)

    def _owning_channel(self, inputs: Mapping[str, CycleBlock]) -> ChannelBlock | None:
        for block in inputs.values():
            if isinstance(block, ChannelBlock) and block.path_active and self._axis.name in block.axes:
                return block
        return None

    def _enter(self, cycle: int, begin: float) -> None:
        """The channel moves the axis from now on; a fault unless it stands at `begin`, the path's first setpoint."""
        axis = self._axis
        if axis.state == S.ERROR_STOP or axis.on_path:
            return
        position = axis.setpoint(cycle)[0]
        if axis.state != S.STANDSTILL:
            reason = f"the channel moves the path while the axis is in {state_name(axis.state)}"
            axis.fault(cycle, PATH_NOT_ACCEPTED, reason)
        elif abs(begin - position) > PATH_TOLERANCE:
            reason = f"the path of the channel begins at {begin} {axis.unit}, the axis stands at {position} {axis.unit}"
            axis.fault(cycle, PATH_NOT_ACCEPTED, reason)
        else:
            axis.absorb(cycle)
            axis.path_direction = 0.0
            axis.take(T.ENTER_PATH)

    def _leave(self, cycle: int) -> None:
        """The path is over; external setpoints on top of it go on alone, or come to rest."""
        axis = self._axis
        if not axis.on_path:
            return
        axis.take(T.LEAVE_PATH)
        if axis.ptp.state(cycle)[1] != 0.0:
            axis.fault(cycle, PATH_NOT_ACCEPTED, "the channel let the axis go while it moved")
        else:
            axis.advance_state(cycle)


PAIR_PATIENCE = 4
"""Blocks in which the error of a gantry slave must have reached its master."""


class MasterSource:
    """The master of a coupled axis: its set values, or its actual values where these are the ones to follow."""

    def __init__(self, axis: Axis, *, axes: Mapping[str, AxisParameters], cycle_time: float) -> None:
        """`axes` of the machine by name, `cycle_time` in s."""
        self._axis = axis
        self._axes = axes
        self._cycle_time = cycle_time
        self._coupling: Coupling | None = None
        self._actual = False
        self._velocity = 0.0
        self._rest: float | None = None
        """Where the master stood at the end of its last block, None if it moved."""
        self._first_cycle = 0
        self._gantry: list[float] | None = None
        self._gantry_distance: float | None = None
        self._blocks_in_error = 0

    def setpoints(self, first_cycle: int, inputs: Mapping[str, CycleBlock]) -> list[MotionState]:
        """The setpoints of the coupling; none when the axis is not coupled or cannot follow."""
        axis = self._axis
        coupling = axis.coupling
        self._gantry = None
        if coupling is None or axis.state != S.SYNCHRONIZED_MOTION:
            return []
        block = inputs.get(coupling.master)
        if not isinstance(block, AxisBlock):
            axis.fault(first_cycle, UPSTREAM_LOST, f"there is no block of its master '{coupling.master}'")
            return []
        if coupling is not self._coupling:
            self._coupling, self._actual, self._gantry_distance = coupling, block.couples_actual, None
            self._blocks_in_error = 0
        else:
            self._allow_placing(coupling, block)
        self._rest = block.set_position[-1] if block.set_velocity[-1] == block.set_acceleration[-1] == 0.0 else None
        axis.follow_master(block.target_velocity, bool(block.status_bits[-1] & StatusBit.HAS_JOB))
        states = self._states(coupling, block)
        try:
            setpoints = coupling.follow((axis.carried or axis.ptp).state(first_cycle)[0], states)
        except CncError as error:
            axis.give_up_coupling(first_cycle, error.number, error.message)
            return []
        if not all(in_range(state) for state in setpoints):
            axis.fault(first_cycle, OUT_OF_RANGE, f"its setpoints as a slave of {coupling.master} are out of all range")
            return []
        if axis.error_id and self._pair_ends(first_cycle, setpoints[0][0], block):
            return []
        if axis.carried is not None:
            axis.carried.take(first_cycle, setpoints)
            return []
        self._prepare_gantry(coupling, first_cycle, block)
        axis.ptp.take_over(first_cycle + block.count - 1, *setpoints[-1])
        return setpoints

    def _pair_ends(self, first_cycle: int, position: float, block: AxisBlock) -> bool:
        """The slave of a gantry pair in error: it ends with its master, or alone where the master does not stop."""
        self._blocks_in_error += 1
        if not (block.set_velocity[0] or block.set_acceleration[0]):
            self._axis.end_with_master(first_cycle, position)
            return True
        if block.error_id[0] or self._blocks_in_error <= PAIR_PATIENCE:
            return False
        self._axis.end_alone(first_cycle)
        return True

    def _allow_placing(self, coupling: Coupling, block: AxisBlock) -> None:
        """A standing master that counts from elsewhere (it was moved without enable) does not take its slave along."""
        before, now = self._rest, block.set_position[0]
        if self._actual or block.couples_actual or before is None or before == now:
            return
        if block.set_velocity[0] == 0.0:
            coupling.change_source(before, now)

    def _states(self, coupling: Coupling, block: AxisBlock) -> list[MotionState]:
        if block.couples_actual != self._actual:
            sources = block.set_position[0], block.actual_position[0]
            before, now = sources if block.couples_actual else sources[::-1]
            coupling.change_source(before, now)
            self._actual, self._velocity = block.couples_actual, block.actual_velocity[0]
        if not self._actual:
            return list(
                zip(block.set_position, block.set_velocity, block.set_acceleration, block.set_jerk, strict=True)
            )
        velocities = [self._filtered(coupling.master, velocity) for velocity in block.actual_velocity]
        return [(p, v, 0.0, 0.0) for p, v in zip(block.actual_position, velocities, strict=True)]

    def _filtered(self, master: str, velocity: float) -> float:
        """Actual velocity of the master: 0 within its velocity window, through a first-order filter.

        The filter alone would never come to rest: within the window it goes on as fast as it entered it.
        """
        parameters = self._axes[master]
        window = max(parameters.velocity_window, NEGLIGIBLE_VELOCITY)
        if abs(velocity) < window:
            velocity = 0.0
        share = self._cycle_time / (self._cycle_time + parameters.velocity_filter_time)
        change = (velocity - self._velocity) * share
        if velocity == 0.0 and abs(self._velocity) < window:
            change = -copysign(min(window * share, abs(self._velocity)), self._velocity)
        self._velocity += change
        return self._velocity

    def _prepare_gantry(self, coupling: Coupling, first_cycle: int, block: AxisBlock) -> None:
        if isinstance(coupling, LinearCoupling) and coupling.difference_limit is not None:
            self._first_cycle = first_cycle
            self._gantry = list(block.actual_position)

    @property
    def watches_gantry(self) -> bool:
        return self._gantry is not None and self._axis.coupled

    def watch_gantry(self, cycle: int, setpoint: MotionState, actual_position: float) -> None:
        """A fault when the actual positions of a gantry pair have left their distance by more than its limit."""
        if self._gantry is None or self._axis.error_id or not self._axis.coupled:
            return
        axis, coupling = self._axis, self._axis.coupling
        assert isinstance(coupling, LinearCoupling) and coupling.difference_limit is not None
        distance = actual_position - self._gantry[cycle - self._first_cycle]
        if self._gantry_distance is None:
            self._gantry_distance = distance
        difference = abs(distance - self._gantry_distance)
        if difference > coupling.difference_limit:
            reason = (
                f"the actual positions of {axis.name} and its gantry master {coupling.master} differ by "
                f"{difference:g} {axis.unit}, more than {coupling.difference_limit:g} {axis.unit}"
            )
            axis.fault(cycle, GANTRY_DIFFERENCE, reason, setpoint)
