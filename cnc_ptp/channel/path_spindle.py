"""The spindle that is an axis of the path for a while (TF5200 spindle 2.3.3, 2.8.6, 2.8.8).

`ready` (G63, #CAX) asks for it and is true when the spindle has reported that it follows: from that block on the
channel gives it setpoints, in every cycle, until `release`.
"""

from __future__ import annotations

from collections.abc import Mapping
from math import inf
from typing import Final

from cnc_ptp.channel.commanded_spindle import CommandedSpindle
from cnc_ptp.channel.spindle_functions import SpindleFunctions
from cnc_ptp.errors import CncError
from cnc_ptp.nc.canonical import (
    CanonicalBlock,
    CircularMove,
    HomeAxes,
    LinearMove,
    SpindleAxis,
    SpindleCommand,
    SpindleFunction,
    SpindleLink,
)
from cnc_ptp.path.geometry import AxisLimits
from cnc_ptp.path.path_motion import PathMotion
from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.blocks import Command
from cnc_ptp.protocol.spindle_states import SpindleBit
from cnc_ptp.spindle.acceleration_curves import AccelerationCurve
from cnc_ptp.spindle.tool_limits import SpindleLimits

SPINDLE_TURNS = 22060
SPINDLE_LEFT_PATH = 22061
SPINDLE_ELSEWHERE = 22062
SPINDLE_NOT_REFERENCED = 22120
NOTHING: Final[Mapping[str, float]] = {}
MOVE_SPINDLES = (SpindleFunction, SpindleCommand, SpindleLink, SpindleAxis)


class PathSpindle:
    """Takes a spindle over and gives it back.

    node      the spindle that follows the path; "" for none
    override  factor of its override on the path
    angle     where the path has taken it over, deg, 0 … 360
    is_axis   it is the C axis (#CAX), not the spindle of a tap
    """

    def __init__(self, channel: str, spindles: SpindleFunctions, ramp_time: float = 0.02) -> None:
        """`channel`: its name; `spindles` of it; `ramp_time`: s in which the C axis builds up its acceleration."""
        self._channel, self._spindles, self._ramp_time = channel, spindles, ramp_time
        self._spindle: CommandedSpindle | None = None
        self._asked_in: int | None = None
        """First cycle of the block with the command; None before it has gone out."""
        self._left_in = 0.0
        """The same of that which has given the last one back."""
        self.node = ""
        self.override = self._known_override = 1.0
        self.angle = 0.0
        self.is_axis = False
        self._commands: list[Command] = []

    @property
    def active(self) -> bool:
        """A spindle follows, or was asked to."""
        return self._spindle is not None

    def take_commands(self, first_cycle: int) -> list[Command]:
        """Those that go out with the block."""
        if self._commands and self.active and self._asked_in is None:
            self._asked_in = first_cycle
        if self._commands and self._left_in == inf:
            self._left_in = float(first_cycle)
        commands, self._commands = self._commands, []
        return commands

    def limits(self, name: str) -> AxisLimits:
        """Of a spindle as an axis of the path, in the gear that it reports; deg, s. It has no limit of the jerk."""
        limits, _ = limits_in_gear(self._spindles[name])
        speed = limits.max_positioning_speed
        up, down = limits.acceleration, limits.deceleration
        if isinstance(limits.ramp, AccelerationCurve):
            up = down = min(limits.ramp.acceleration(0.0), limits.ramp.acceleration(speed))
        return AxisLimits(speed, up, down, inf)

    def axis_limits(self, name: str) -> AxisLimits:
        """Of the C axis, which has a limit of the jerk, too (P-CHAN-90045)."""
        limits = self.limits(name)
        return limits._replace(jerk=max(limits.acceleration, limits.deceleration) / self._ramp_time)

    def taken_for(self, block: CanonicalBlock, path: PathMotion) -> bool:
        """The path has the spindle that the block moves or makes its C axis, or needs none; it is asked for it.

        Raises CncError 22060 for one that turns on its own, 22062 for one that another path moves, 22120 for a C axis
        that does not home automatically.
        """
        motion = block.motion
        if isinstance(motion, LinearMove) and motion.tap is not None:
            return self.ready(motion.tap.spindle)
        for function in block.functions:
            if isinstance(function, SpindleAxis) and function.on:
                if not self.ready(function.spindle, as_axis=True):
                    return False
                path.take_c_axis(self.angle, self.axis_limits(function.spindle))
        return True

    def ready(self, name: str, *, as_axis: bool = False) -> bool:
        """The spindle follows; it is asked to when it stands. The C axis homes before if it has no reference point.

        Raises as `taken_for`.
        """
        spindle = self._spindles[name]
        if self._spindle is None:
            self._require_free(spindle)
        if self._spindle is None and not spindle.pending and stands(spindle, alone=as_axis):
            if as_axis and not self._referenced(spindle):
                return False
            self._spindle, self._asked_in, self.is_axis = spindle, None, as_axis
            self._send("follow_path")
        return self.node == spindle.node

    def leave_before(self, block: CanonicalBlock, path: PathMotion) -> None:
        """The spindle is released before a block that has another motion, or commands for spindles.

        The C axis is released by #CAX OFF alone.
        """
        if self.is_axis:
            leaves = any(isinstance(function, SpindleAxis) and not function.on for function in block.functions)
        elif isinstance(block.motion, (LinearMove, CircularMove, HomeAxes)):
            leaves = not (isinstance(block.motion, LinearMove) and block.motion.tap is not None)
        else:
            leaves = any(isinstance(function, MOVE_SPINDLES) for function in block.functions)
        if leaves:
            self.release(path)

    def _require_free(self, spindle: CommandedSpindle) -> None:
        """Raises CncError 22062 for a spindle that the path of another channel moves; its own has given it back."""
        block = spindle.block
        if block is not None and block.first_cycle >= self._left_in and block.status_bits[-1] & SpindleBit.ON_PATH:
            reason = f"the path of another channel moves spindle {spindle.node} (#CAX or tapping)"
            raise CncError(SPINDLE_ELSEWHERE, reason)

    def _referenced(self, spindle: CommandedSpindle) -> bool:
        """It has a reference point; else it homes (P-AXIS-00015). Raises CncError 22120."""
        assert spindle.block is not None and spindle.unit is not None
        if spindle.block.referenced[-1]:
            return True
        if not spindle.unit.automatic_homing:
            how = "does not home automatically (P-AXIS-00015 0x100)"
            then = f"home it before #CAX (G74 {spindle.name}1)"
            reason = f"spindle {spindle.node} has no reference point and {how}; {then}"
            raise CncError(SPINDLE_NOT_REFERENCED, reason)
        self._commands += self._spindles.plain(SpindleCommand(spindle.name, "home"))
        return False

    def read(self, first_cycle: int) -> bool:
        """The report of the spindle for the block before `first_cycle`; whether `override` has changed.

        Raises CncError 22061.
        """
        spindle, before = self._spindle, self._known_override
        block = None if spindle is None else spindle.block
        if spindle is not None and block is not None and self._asked_in is not None and first_cycle > self._asked_in:
            if block.status_bits[-1] & SpindleBit.ON_PATH:
                if not self.node:
                    self.node, self.angle = spindle.node, block.set_position_deg[-1] % 360.0
                bits = block.status_bits[-1]
                percent = 100.0 if bits & SpindleBit.OVERRIDE_SUPPRESSED else block.override_percent[-1]
                self.override = 0.0 if bits & SpindleBit.FEED_HOLD else percent / 100.0
            elif self.node:
                self._forget()
                raise CncError(SPINDLE_LEFT_PATH, f"spindle {spindle.node} no longer follows the path")
        self._known_override = self.override
        return self.override != before

    def release(self, path: PathMotion) -> None:
        """The spindle continues on its own, with the next block, from where the path rests.

        That may be a bit behind its last setpoint, if the path has come to rest within the last cycle.
        """
        if self.active:
            travel, speed, _, _ = path.spindle_travel(path.states)
            self._send("leave_path", {"travel": travel} if self.node and not speed else {})
            self._left_in = inf
            self._forget()

    def _forget(self) -> None:
        """No spindle follows."""
        self._spindle, self._asked_in, self.is_axis = None, None, False
        self.node, self.override = "", 1.0

    def _send(self, command: str, arguments: Mapping[str, float] = NOTHING) -> None:
        assert self._spindle is not None
        self._commands.append(Command(self._spindle.node, command, {"source": self._channel, **arguments}))


def limits_in_gear(spindle: CommandedSpindle) -> tuple[SpindleLimits, int]:
    """Limits of a spindle in the gear that it reports, with its tool, and the stage of the gear."""
    unit, block = spindle.unit, spindle.block
    assert unit is not None
    stage = block.gear[-1] if block is not None else unit.path_gear or unit.gear
    gear = unit.gears.get(stage) or unit.gears[unit.gear]
    return SpindleLimits(gear, spindle.tool, control_limit=inf if unit.open_loop else gear.control_limit), stage


def stands(spindle: CommandedSpindle, *, alone: bool = False) -> bool:
    """It may be taken over: it stands, or (not `alone`) turns as a slave at its speed; False while it comes to that.

    One without power is asked, too: it refuses and says why. Raises CncError 22060 for one that turns on its own.
    """
    block = spindle.block
    if block is None:
        return False
    state = block.state[-1]
    if state == S.DISABLED:
        return True
    if state != S.CONTINUOUS_MOTION:
        return state == S.STANDSTILL and block.speed_zero[-1]
    if block.master and not alone:
        return block.speed_reached[-1]
    rpm = block.set_speed_rpm[-1]
    reason = f"spindle {spindle.node} turns at {rpm:g} rpm; it must be at a standstill (M05 or M19 before)"
    raise CncError(SPINDLE_TURNS, reason, speed=rpm)
