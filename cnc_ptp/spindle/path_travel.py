"""What the path of a channel adds to the motion of a spindle (G63; TF5200 spindle 2.3.3, 2.8.6)."""

from __future__ import annotations

from cnc_ptp.motion.setpoints import MotionState, Setpoints
from cnc_ptp.protocol.blocks import ChannelBlock
from cnc_ptp.spindle.path_stop import PathStop

AT_REST: MotionState = (0.0, 0.0, 0.0, 0.0)


class PathTravel:
    """Travel of a spindle on the path since it was taken over: deg, deg/s, deg/s², deg/s³, cycle by cycle.

    channel   whose path it is
    """

    def __init__(self, channel: str, cycle_time: float) -> None:
        """`cycle_time` in s."""
        self.channel = channel
        self._cycle_time = cycle_time
        self._first_cycle = 0
        self._setpoints = Setpoints([], [], [], [])
        self._last = AT_REST
        self.block: ChannelBlock | None = None
        """The last one of the channel."""
        self.stop: PathStop | None = None
        """The ramp to a standstill, without the channel."""

    @property
    def begun(self) -> bool:
        """Setpoints have come: those of the first block come behind the report that the spindle follows."""
        return len(self._setpoints) > 0

    def take(self, spindle: str, block: ChannelBlock) -> bool:
        """The setpoints of a block; False if the path no longer has any for the spindle."""
        if spindle not in block.path_spindles:
            return False
        begin = block.path_spindles.index(spindle) * block.count
        end = begin + block.count
        self._first_cycle = block.first_cycle
        self._setpoints = Setpoints(
            block.spindle_travel[begin:end],
            block.spindle_speed[begin:end],
            block.spindle_acceleration[begin:end],
            block.spindle_jerk[begin:end],
        )
        self._last = self._setpoints.at(block.count - 1)
        self.block = block
        return True

    def at_rest(self, cycle: int) -> bool:
        """The ramp has ended."""
        stop = self.stop
        return stop is not None and (cycle - stop.origin) * self._cycle_time >= stop.profile.duration

    def at(self, cycle: int) -> MotionState:
        """In a cycle of the last block, and behind it with the speed of its last cycle, or on the ramp."""
        if self.stop is not None:
            return self.stop.profile.state_at((cycle - self.stop.origin) * self._cycle_time)
        index = cycle - self._first_cycle
        count = len(self._setpoints)
        if index < count:
            return self._setpoints.at(index)
        travel, speed, _, _ = self._last
        return travel + (index - count + 1) * self._cycle_time * speed if count else 0.0, speed, 0.0, 0.0
