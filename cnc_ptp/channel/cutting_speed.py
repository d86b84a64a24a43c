"""Constant cutting speed (G96): the speed of a spindle follows the position of the facing axis.

The path of a block is known before the block goes out. So the spindle gets, with the same block, the speed for the
middle of the way that the axis goes in it. Rapid traverse, dwells and waits leave the speed as it is.
Source: programming manual, constant cutting speed.
"""

from __future__ import annotations

from math import inf
from typing import Final

from cnc_ptp.channel.commanded_spindle import CommandedSpindle
from cnc_ptp.channel.path_spindle import limits_in_gear
from cnc_ptp.channel.spindle_functions import SpindleFunctions
from cnc_ptp.channel.spindle_reports import Expectation
from cnc_ptp.nc.canonical import CuttingSpeed, SpindleFunction
from cnc_ptp.nc.turning import rpm_at
from cnc_ptp.parameters.list_units import DEG_S_PER_RPM
from cnc_ptp.protocol.blocks import Command

LEAST_CHANGE: Final = 0.001
"""Part by which a speed has to change before it is commanded."""


class ConstantCuttingSpeed:
    """G96 of a channel.

    function   what is programmed; None with G97
    """

    def __init__(self, spindles: SpindleFunctions) -> None:
        """`spindles` of the channel."""
        self._spindles = spindles
        self.function: CuttingSpeed | None = None
        self._rpm = 0.0
        """Commanded last, 0.0 nothing yet."""

    def take(self, function: CuttingSpeed) -> None:
        """The path has reached G96 with S, or G97."""
        self.function = function if function.speed else None
        self._rpm = 0.0

    def end(self) -> None:
        """The program has ended, or was aborted."""
        self.function = None

    @property
    def spindle(self) -> CommandedSpindle | None:
        """The one whose speed follows now: it turns for the program, and no other function of it is to go out."""
        if self.function is None:
            return None
        spindle = self._spindles[self.function.spindle]
        return spindle if spindle.turns and not spindle.follows and not spindle.unsent else None

    def commands(self, first_cycle: int, radius: float) -> list[Command]:
        """Those of the block that starts at `first_cycle`; `radius` of the facing axis in its middle, mm."""
        spindle, function = self.spindle, self.function
        if spindle is None or function is None:
            return []
        rpm = self._limited(spindle, function, radius)
        if abs(rpm - self._rpm) <= LEAST_CHANGE * self._rpm:
            return []
        self._rpm = rpm
        speed = SpindleFunction(function.spindle, None, rpm, full_override=spindle.full_override)
        commands, _ = self._spindles.command(speed)
        spindle.send(first_cycle)
        for slave in self._slaves(spindle):
            slave.expect(Expectation(slave.node))
            slave.send(first_cycle)
        return commands

    @property
    def nodes(self) -> list[str]:
        """Of the spindle and of its slaves."""
        spindle = self.spindle
        return [] if spindle is None else [spindle.node, *[slave.node for slave in self._slaves(spindle)]]

    def _slaves(self, spindle: CommandedSpindle) -> list[CommandedSpindle]:
        """They follow on their own."""
        return [other for other in self._spindles if other.master is spindle]

    def _limited(self, spindle: CommandedSpindle, function: CuttingSpeed, radius: float) -> float:
        """rpm, in the limits of G196, of the gear that the spindle reports, and of the tool."""
        limits, stage = limits_in_gear(spindle)
        ranges = spindle.parameters.ranges
        low, high = ranges[stage - 1] if stage <= len(ranges) else (0.0, 0.0)
        largest = min(function.max_rpm or inf, high or inf, limits.max_speed / DEG_S_PER_RPM)
        return max(low, min(largest, rpm_at(function.speed, radius)))
