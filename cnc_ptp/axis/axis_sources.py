"""Sources of basic motion besides an axis' own generator: the path of a channel, a master axis."""

from __future__ import annotations

from collections.abc import Mapping
from math import copysign

from cnc_ptp.axis import transitions as T
from cnc_ptp.axis.axis import Axis
from cnc_ptp.axis.coupling import Coupling
from cnc_ptp.axis.external import NEGLIGIBLE_VELOCITY
from cnc_ptp.axis.faults import PATH_NOT_ACCEPTED
from cnc_ptp.axis.flying_saw import FlyingSaw
from cnc_ptp.axis.gantry import GantryPair
from cnc_ptp.errors import CncError
from cnc_ptp.motion.limits import LARGEST_STATE, OUT_OF_RANGE
from cnc_ptp.motion.setpoints import Setpoints
from cnc_ptp.parameters import AxisParameters, SpindleParameters
from cnc_ptp.path.geometry import begins_element
from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.axis_states import StatusBit, state_name
from cnc_ptp.protocol.blocks import AxisBlock, ChannelBlock, CycleBlock
from cnc_ptp.protocol.unit import UPSTREAM_LOST
from cnc_ptp.spindle.path_stop import PathStop, path_stop

PATH_TOLERANCE = 1e-9
"""Largest distance (mm, deg) of an axis from the start of the path that takes it over."""


def in_range(setpoints: Setpoints) -> bool:
    """False with an infinity or a NaN, for which no table can be made; multiplied factors of a cascade lead there."""
    for column in (setpoints.positions, setpoints.velocities, setpoints.accelerations):
        for value in column:
            if not -LARGEST_STATE <= value <= LARGEST_STATE:
                return False
    return True


class PathSource:
    """The channel that has the axis on its path."""

    def __init__(
        self, axis: Axis, *, axes: Mapping[str, AxisParameters], spindles: Mapping[str, SpindleParameters]
    ) -> None:
        """`axes` and `spindles` of the machine by name."""
        self._axis, self._axes, self._spindles = axis, axes, spindles
        self._block: ChannelBlock | None = None
        """The last one of the channel that moves the axis."""
        self._first_cycle = 0
        self._to_go = [0.0]
        """Distance to the end of the element: at the end of the last block, then in each cycle of this one."""
        self._lost = ""
        """Who is lost, so that the axis is to stop with its path; empty if it is not."""

    def setpoints(self, first_cycle: int, inputs: Mapping[str, CycleBlock]) -> Setpoints | None:
        """The setpoints of the channel that moves the axis, none if no channel does; switches the setpoint source."""
        channel = self._block = self._owning_channel(inputs)
        if channel is None:
            self._leave(first_cycle)
            return None
        if self._lost and self._axis.on_path and not channel.error_id[0]:
            self._stop_alone(first_cycle, self._lost)
            return None
        count = channel.count
        start = channel.axes.index(self._axis.name) * count
        end = start + count
        setpoints = Setpoints(
            channel.set_position[start:end],
            channel.set_velocity[start:end],
            channel.set_acceleration[start:end],
            channel.set_jerk[start:end],
        )
        self._first_cycle, self._to_go = first_cycle, [self._to_go[-1], *channel.distance_to_go]
        self._enter(first_cycle, setpoints.positions[0])
        if self._axis.state != S.SYNCHRONIZED_MOTION:
            return None
        position, velocity, acceleration, _ = setpoints.at(count - 1)
        self._axis.ptp.take_over(first_cycle + count - 1, position, velocity, acceleration)
        return setpoints

    def stop(self, cycle: int) -> PathStop | None:
        """The ramp in step with the spindle on the path, when no further block comes; none if it is not on one."""
        axis, block = self._axis, self._block
        alone = axis.superposed or axis.coupled or axis.carried is not None
        if block is None or alone or not axis.on_path or block.first_cycle + block.count != cycle:
            return None
        return path_stop(block, self._axes, self._spindles)

    def stop_with_path(self, lost: str) -> bool:
        """Without `lost`, as its channel notices, too: the axis stays on the path until that stands; False off a path.

        When a block of the channel comes that is not one of its error reaction, the axis stops on its own ramp.
        """
        axis = self._axis
        if not axis.on_path or axis.superposed or axis.coupled or axis.carried is not None:
            return False
        self._lost = lost
        return True

    def _stop_alone(self, cycle: int, source: str) -> None:
        self._axis.fault(cycle, UPSTREAM_LOST, f"no block of '{source}' came within the watchdog time")

    def watch(self, cycle: int, velocity: float) -> None:
        """A path no longer waits in a direction when it reverses, or when another element starts."""
        axis, n = self._axis, cycle - self._first_cycle
        if not axis.path_direction:
            return
        turns = axis.path_direction * velocity < -NEGLIGIBLE_VELOCITY
        if turns or (n + 1 < len(self._to_go) and begins_element(*self._to_go[n : n + 2])):
            axis.path_direction = 0.0

    def put_down(self, first_cycle: int, inputs: Mapping[str, CycleBlock]) -> None:
        """When the path of the channel has ended under a flying saw, the axis is an ordinary slave from now on."""
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

    def _enter(self, cycle: int, start: float) -> None:
        """The channel moves the axis from now on; a fault if it is not at `start`, the path's first setpoint."""
        axis = self._axis
        if axis.state == S.ERROR_STOP or axis.on_path:
            return
        position = axis.setpoint(cycle)[0]
        if axis.state != S.STANDSTILL:
            reason = f"the channel moves the path while the axis is in {state_name(axis.state)}"
            axis.fault(cycle, PATH_NOT_ACCEPTED, reason)
        elif axis.stop_held:
            axis.fault(cycle, PATH_NOT_ACCEPTED, "the channel moves the path while MC_Stop holds the axis (hold_stop)")
        elif abs(start - position) > PATH_TOLERANCE:
            reason = f"the path of the channel starts at {start} {axis.unit}, the axis is at {position} {axis.unit}"
            axis.fault(cycle, PATH_NOT_ACCEPTED, reason, values={"start": start, "actual_position": position})
        else:
            axis.absorb(cycle)
            axis.path_direction = 0.0
            axis.take(T.ENTER_PATH)

    def _leave(self, cycle: int) -> None:
        """The path has ended; external setpoints superimposed on it continue alone, or come to rest."""
        axis = self._axis
        lost, self._lost = self._lost, ""
        if not axis.on_path:
            return
        axis.take(T.LEAVE_PATH)
        if lost:
            self._stop_alone(cycle, lost)
        elif axis.ptp.state(cycle)[1] != 0.0:
            axis.fault(cycle, PATH_NOT_ACCEPTED, "the channel released the axis while it moved")
        else:
            axis.advance_state(cycle)


class MasterSource:
    """The master of a coupled axis: its set values, or its actual values if those are to be followed."""

    def __init__(self, axis: Axis, *, axes: Mapping[str, AxisParameters], cycle_time: float) -> None:
        """`axes` of the machine by name, `cycle_time` in s."""
        self._axis = axis
        self._axes = axes
        self._cycle_time = cycle_time
        self._coupling: Coupling | None = None
        self._actual = False
        self._velocity = 0.0
        self._rest: float | None = None
        """Position of the master at the end of its last block, None if it moved."""
        self.gantry = GantryPair(axis)

    def setpoints(self, first_cycle: int, inputs: Mapping[str, CycleBlock]) -> Setpoints | None:
        """The setpoints of the coupling; none when the axis is not coupled or cannot follow."""
        axis = self._axis
        coupling = axis.coupling
        self.gantry.rest()
        if coupling is None or axis.state != S.SYNCHRONIZED_MOTION:
            return None
        block = inputs.get(coupling.master)
        if not isinstance(block, AxisBlock):
            axis.fault(first_cycle, UPSTREAM_LOST, f"there is no block of its master '{coupling.master}'")
            return None
        if coupling is not self._coupling:
            self._coupling, self._actual = coupling, block.couples_actual
            self.gantry.begin()
        else:
            self._allow_placing(coupling, block)
        self._rest = block.set_position[-1] if block.set_velocity[-1] == block.set_acceleration[-1] == 0.0 else None
        axis.follow_master(block.target_velocity, bool(block.status_bits[-1] & StatusBit.HAS_JOB))
        master = self._master_setpoints(coupling, block)
        try:
            carried = axis.carried
            position = axis.ptp.state(first_cycle)[0] if carried is None else carried.state(first_cycle)[0]
            setpoints = coupling.follow(position, master)
        except CncError as error:
            axis.abort_coupling(first_cycle, error.number, error.message)
            return None
        if not in_range(setpoints):
            axis.fault(first_cycle, OUT_OF_RANGE, f"its setpoints as a slave of {coupling.master} are out of range")
            return None
        if axis.error_id and self.gantry.ends(first_cycle, setpoints.positions[0], block):
            return None
        if axis.carried is not None:
            axis.carried.take(first_cycle, setpoints)
            return None
        self.gantry.take(coupling, first_cycle, block)
        position, velocity, acceleration, jerk = setpoints.at(block.count - 1)
        axis.ptp.take_over(first_cycle + block.count - 1, position, velocity, acceleration, jerk)
        return setpoints

    def _allow_placing(self, coupling: Coupling, block: AxisBlock) -> None:
        """A master at a standstill whose position changed without enable does not take its slave along."""
        before, now = self._rest, block.set_position[0]
        if self._actual or block.couples_actual or before is None or before == now:
            return
        if block.set_velocity[0] == 0.0:
            coupling.change_source(before, now)

    def _master_setpoints(self, coupling: Coupling, block: AxisBlock) -> Setpoints:
        if block.couples_actual != self._actual:
            sources = block.set_position[0], block.actual_position[0]
            before, now = sources if block.couples_actual else sources[::-1]
            coupling.change_source(before, now)
            self._actual, self._velocity = block.couples_actual, block.actual_velocity[0]
        if not self._actual:
            return Setpoints(block.set_position, block.set_velocity, block.set_acceleration, block.set_jerk)
        velocities = [self._filtered(coupling.master, velocity) for velocity in block.actual_velocity]
        none = [0.0] * block.count
        return Setpoints(block.actual_position, velocities, none, none)

    def _filtered(self, master: str, velocity: float) -> float:
        """Actual velocity of the master: 0 within its velocity window, through a first-order filter.

        The filter alone would never come to rest: within the window the velocity at which it was entered is kept.
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
