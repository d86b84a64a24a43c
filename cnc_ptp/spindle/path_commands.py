"""A spindle on the path of a channel: `follow_path`, `leave_path` (TF5200 spindle 2.3.3, 2.8.6).

The spindle keeps a motion of its own: it stands, or turns as the slave of another spindle (tapping in a rotating
workpiece). The path adds its travel to it, which is 0 when it begins: nothing can jump.
"""

from __future__ import annotations

from collections.abc import Mapping

from cnc_ptp.parameters import AxisParameters
from cnc_ptp.parameters.list_units import DEG_S_PER_RPM
from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.axis_states import state_name
from cnc_ptp.protocol.blocks import ChannelBlock
from cnc_ptp.protocol.spindle_states import SpindleMode
from cnc_ptp.protocol.unit import CLOCK
from cnc_ptp.spindle import transitions as T
from cnc_ptp.spindle.faults import NOT_AT_STANDSTILL, ON_PATH, PATH_ENDED, SENSORLESS
from cnc_ptp.spindle.path_stop import path_stop
from cnc_ptp.spindle.path_travel import PathTravel
from cnc_ptp.spindle.spindle import Spindle


class PathCommands:
    """Commands of the channel whose path moves the spindle."""

    def __init__(self, spindle: Spindle, axes: Mapping[str, AxisParameters]) -> None:
        """`axes` of the machine."""
        self._spindle, self._axes = spindle, axes

    def check(self, command: str) -> None:
        """Raises 24031 for a command to move the spindle while the path does."""
        travel = self._spindle.travel
        if travel is not None:
            reason = f"the path of channel '{travel.channel}' moves the spindle; reset the channel to stop it"
            self._spindle.refuse(command, ON_PATH, reason, channel=travel.channel)

    def do_follow_path(self, cycle: int, *, source: str) -> None:
        """The path of channel `source` moves the spindle from the next block on.

        Refused with 24003, 24031 (another path), 24032 (in motion) and 70252 (no position loop).
        """
        spindle = self._spindle
        spindle.require_ready("follow_path")
        self.check("follow_path")
        if not spindle.parameters.has_position:
            reason = "the spindle has no actual position (P-AXIS-00320, P-SIM-00050) and cannot follow a path"
            spindle.refuse("follow_path", SENSORLESS, reason)
        speed = spindle.motion(cycle)[1]
        turns = spindle.state == S.CONTINUOUS_MOTION and spindle.finished(cycle)
        if spindle.state != S.STANDSTILL and not turns:
            state, rpm = state_name(spindle.state), speed / DEG_S_PER_RPM
            reason = f"the spindle is in {state} at {rpm:g} rpm; it must be at a standstill"
            spindle.refuse("follow_path", NOT_AT_STANDSTILL, reason, state=state, speed=rpm)
        spindle.take_tool(cycle)
        if spindle.parameters.open_loop:
            spindle.place(cycle, spindle.loop.close(speed))
        if not turns:
            spindle.end_procedure()
            spindle.mode = SpindleMode.SUPERIMPOSED
            spindle.take(T.FOLLOW_PATH)
        spindle.travel = PathTravel(source, spindle.cycle_time)
        spindle.unsettled = True

    def do_leave_path(self, cycle: int, *, source: str, travel: float | None = None) -> str | None:
        """The path no longer moves the spindle, which stands where it has brought it, or turns as before.

        `travel`: deg since it was taken over, where the path has come to rest.
        """
        spindle = self._spindle
        if spindle.travel is None or spindle.travel.channel != source or spindle.travel.stop is not None:
            return f"spindle {spindle.name}: leave_path without effect, no path of '{source}' moves it"
        spindle.leave_path(cycle, travel)
        return None

    def lose(self, cycle: int, source: str) -> None:
        """Nothing more comes from `source`: channel, PLC or clock.

        The spindle continues in step with the axes of the path, each of which comes to the same ramp. Where there is no
        such ramp (#CAX), and the channel is silent, it leaves the path.
        """
        spindle, travel = self._spindle, self._spindle.travel
        if travel is None or travel.stop is not None:
            return
        block = travel.block
        if block is not None and block.first_cycle + block.count == cycle:
            travel.stop = path_stop(block, self._axes, {spindle.name: spindle.parameters})
        if travel.stop is None and source in (travel.channel, CLOCK):
            spindle.leave_path(cycle)

    def take_setpoints(self, cycle: int, block: object) -> None:
        """The travel of this block; without any the spindle stops on its own ramp (24033)."""
        spindle, travel = self._spindle, self._spindle.travel
        if travel is None:
            return
        if travel.stop is not None:
            if travel.at_rest(cycle):
                spindle.leave_path(cycle, travel.at(cycle)[0])
            return
        if isinstance(block, ChannelBlock) and (travel.take(spindle.name, block) or not travel.begun):
            return
        moved = travel.at(cycle)[1] != 0.0
        spindle.leave_path(cycle)
        if moved and not spindle.error_id:
            spindle.fault(cycle, PATH_ENDED, f"the path of channel '{travel.channel}' no longer gives setpoints")
