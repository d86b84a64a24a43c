"""The spindle that is an axis of the path for a while (TF5200 spindle 2.3.3, 2.8.6).

`ready` asks for it and is true when the spindle has reported that it follows: from that block on the channel gives it
setpoints, in every cycle, until `release`.
"""

from __future__ import annotations

from math import inf

from cnc_ptp.channel.commanded_spindle import CommandedSpindle
from cnc_ptp.channel.spindle_functions import SpindleFunctions
from cnc_ptp.errors import CncError
from cnc_ptp.path.geometry import AxisLimits
from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.blocks import Command
from cnc_ptp.protocol.spindle_states import SpindleBit
from cnc_ptp.spindle.acceleration_curves import AccelerationCurve
from cnc_ptp.spindle.tool_limits import SpindleLimits

SPINDLE_TURNS = 22060
SPINDLE_LEFT_PATH = 22061


class PathSpindle:
    """Takes a spindle over and gives it back.

    node      the spindle that follows the path; "" for none
    override  factor of its override on the path
    """

    def __init__(self, channel: str, spindles: SpindleFunctions) -> None:
        """`channel`: its name; `spindles` of it."""
        self._channel, self._spindles = channel, spindles
        self._spindle: CommandedSpindle | None = None
        self._asked_in: int | None = None
        """First cycle of the block with the command; None before it has gone out."""
        self.node = ""
        self.override = self._known_override = 1.0
        self._commands: list[Command] = []

    @property
    def active(self) -> bool:
        """A spindle follows, or was asked to."""
        return self._spindle is not None

    def take_commands(self, first_cycle: int) -> list[Command]:
        """Those that go out with the block."""
        if self._commands and self.active and self._asked_in is None:
            self._asked_in = first_cycle
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

    def ready(self, name: str) -> bool:
        """The spindle follows; it is asked to when it stands. Raises CncError 22060 for one that turns on its own."""
        spindle = self._spindles[name]
        if self._spindle is None and not spindle.pending and stands(spindle):
            self._spindle, self._asked_in = spindle, None
            self._send("follow_path")
        return self.node == spindle.node

    def read(self, first_cycle: int) -> bool:
        """The report of the spindle for the block before `first_cycle`; whether `override` has changed.

        Raises CncError 22061.
        """
        spindle, before = self._spindle, self._known_override
        block = None if spindle is None else spindle.block
        if spindle is not None and block is not None and self._asked_in is not None and first_cycle > self._asked_in:
            if block.status_bits[-1] & SpindleBit.ON_PATH:
                self.node = spindle.node
                suppressed = block.status_bits[-1] & SpindleBit.OVERRIDE_SUPPRESSED
                self.override = 1.0 if suppressed else block.override_percent[-1] / 100.0
            elif self.node:
                self._forget()
                raise CncError(SPINDLE_LEFT_PATH, f"spindle {spindle.node} no longer follows the path")
        self._known_override = self.override
        return self.override != before

    def release(self) -> None:
        """The spindle continues on its own, with the next block."""
        if self.active:
            self._send("leave_path")
            self._forget()

    def _forget(self) -> None:
        """No spindle follows."""
        self._spindle, self._asked_in = None, None
        self.node, self.override = "", 1.0

    def _send(self, command: str) -> None:
        assert self._spindle is not None
        self._commands.append(Command(self._spindle.node, command, {"source": self._channel}))


def limits_in_gear(spindle: CommandedSpindle) -> tuple[SpindleLimits, int]:
    """Limits of a spindle in the gear that it reports, with its tool, and the stage of the gear."""
    unit, block = spindle.unit, spindle.block
    assert unit is not None
    stage = block.gear[-1] if block is not None else unit.path_gear or unit.gear
    gear = unit.gears.get(stage) or unit.gears[unit.gear]
    return SpindleLimits(gear, spindle.tool, control_limit=inf if unit.open_loop else gear.control_limit), stage


def stands(spindle: CommandedSpindle) -> bool:
    """It may be taken over: it stands, or turns as a slave at its speed; False while it comes to that.

    Raises CncError 22060 for one that turns on its own.
    """
    block = spindle.block
    if block is None:
        return False
    state = block.state[-1]
    if state != S.CONTINUOUS_MOTION:
        return state == S.STANDSTILL and block.speed_zero[-1]
    if block.master:
        return block.speed_reached[-1]
    rpm = block.set_speed_rpm[-1]
    reason = f"spindle {spindle.node} turns at {rpm:g} rpm; it must be at a standstill (M05 or M19 before)"
    raise CncError(SPINDLE_TURNS, reason, speed=rpm)
