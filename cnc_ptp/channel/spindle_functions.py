"""Spindle functions of a channel: commands to the spindle units, and the reports expected of them.

Three kinds of spindles: NC spindles carry out commands and report; axis-specific PLC spindles (P-AXIS-00015 0x40000) do
so too, but their PLC alone acknowledges; channel-specific ones (P-CHAN-00069) have no unit, all goes to the PLC.
Source: TF5200 spindle 2.2, 2.4.1, 2.5, 2.8.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import count
from math import inf
from typing import Any

from cnc_ptp.channel.commanded_spindle import CommandedSpindle
from cnc_ptp.channel.spindle_reports import Condition, Expectation, turns
from cnc_ptp.nc.canonical import GearChange, SpindleCommand, SpindleFunction, SpindleLink
from cnc_ptp.nc.spindles import DIRECTIONS
from cnc_ptp.parameters import ChannelParameters, SpindleParameters, Synchronisation
from cnc_ptp.parameters.list_units import DEG_S_PER_RPM
from cnc_ptp.parameters.view.channel_view import ToolLimits as ChannelToolLimits
from cnc_ptp.protocol.blocks import Command, CycleBlock
from cnc_ptp.protocol.commands import COMMANDS
from cnc_ptp.spindle.tool_limits import ToolLimits


class SpindleFunctions:
    """The spindles of one channel by the name that programs have for them, in the order of the machine file."""

    def __init__(self, channel: ChannelParameters, units: Mapping[str, SpindleParameters]) -> None:
        """`units`: the spindles of the machine by node name."""
        self._channel = channel
        ranks = count()
        self._spindles = {
            spindle.name: CommandedSpindle(spindle, units.get(spindle.node), channel=channel.name, ranks=ranks)
            for spindle in channel.spindles
        }

    def __getitem__(self, name: str) -> CommandedSpindle:
        return self._spindles[name]

    def __iter__(self) -> Iterator[CommandedSpindle]:
        return iter(self._spindles.values())

    @property
    def turning(self) -> list[CommandedSpindle]:
        """Those that turn for the program, the first to start first."""
        return sorted((spindle for spindle in self if spindle.turns), key=lambda spindle: spindle.turning_rank)

    # from block to block

    def send(self, first_cycle: int) -> None:
        """The commands go out with the block that starts at `first_cycle`."""
        for spindle in self:
            spindle.send(first_cycle)

    def read(self, cycle: int, feedback: Mapping[str, CycleBlock]) -> list[str]:
        """Reads the blocks before `cycle`; a text for each coupling of the channel that others have ended."""
        texts = {spindle.name: spindle.read(cycle, feedback.get(spindle.node)) for spindle in self}
        return [texts[name] for name in sorted(texts) if texts[name]]

    # functions

    def synchronisation(self, function: SpindleFunction) -> Synchronisation:
        """The type of M19, M3, M4, M5 goes before that of S."""
        spindle = self[function.spindle].parameters
        return {3: spindle.m3, 4: spindle.m4, 5: spindle.m5, 19: spindle.m19, None: spindle.s}[function.m]

    def command(self, function: SpindleFunction) -> tuple[list[Command], Expectation | None]:
        """Commands for the spindle, and what it is to report; None for a speed that only counts for the next M03, M04.

        A slave gets no command except for its override: it follows its master (2.8.3).
        """
        spindle = self[function.spindle]
        acts = spindle.acts(function)
        if function.m in DIRECTIONS:
            spindle.turn(DIRECTIONS[function.m])
        elif function.m == 5 and spindle.unit is None:
            spindle.hand_over()
        elif function.m is not None:
            spindle.hold()
        commands = (
            [] if spindle.unit is None else [*self._override(spindle, function), *self._motion(spindle, function)]
        )
        if not acts:
            return commands, None
        expectation = expected(spindle, function)
        spindle.expect(expectation)
        return commands, expectation

    def _override(self, spindle: CommandedSpindle, function: SpindleFunction) -> Iterator[Command]:
        if spindle.switch_override(full=function.full_override):
            yield self._command(spindle, "suppress_override", enabled=function.full_override)

    def _motion(self, spindle: CommandedSpindle, function: SpindleFunction) -> Iterator[Command]:
        if spindle.follows:
            return
        if function.m == 5:
            yield self._command(spindle, "stop")
        elif function.m == 19:
            yield self._orientation(spindle, function)
        elif spindle.turns and function.speed_rpm is not None:
            speed = {"speed_rpm": function.speed_rpm}
            if spindle.start() or function.m is not None:
                yield self._command(spindle, "start", direction=spindle.direction, **speed)
            else:
                yield self._command(spindle, "set_speed", **speed)

    def _orientation(self, spindle: CommandedSpindle, function: SpindleFunction) -> Command:
        words: dict[str, Any] = {"position_deg": function.position_deg}
        if function.speed_rpm is not None:
            words["speed_rpm"] = function.speed_rpm
        if function.direction:
            words["direction"] = function.direction
        return self._command(spindle, "orient", **words)

    def _command(self, spindle: CommandedSpindle, command: str, **arguments: Any) -> Command:
        """Adds the source to motion commands, so that a spindle can refuse a second one."""
        if "source" in COMMANDS["spindle"][command]:
            arguments["source"] = self._channel.name
        return Command(spindle.node, command, arguments)

    def without_effect(self, function: SpindleFunction) -> str:
        """Warning of a speed that commands nothing now; empty if M03 or M04 is simply still to come."""
        spindle = self[function.spindle]
        master, speed = spindle.master, function.speed_rpm
        if speed is None or spindle.unit is None or (master is not None and not master.turns):
            return ""
        words = f"S{speed:g} is without effect on spindle {spindle.node}"
        if master is not None:
            return f"{words}, which is at a standstill; M03 or M04 of its master {master.node} starts it"
        if spindle.block is not None and turns(spindle.block):
            return f"{words}, which this channel has not started; it counts for its next M03 or M04"
        return ""

    # without speed and position

    def plain(self, function: SpindleCommand) -> list[Command]:
        """G74, DEFAULT_DYNAMIC_DATA: nobody waits for them."""
        spindle = self[function.spindle]
        if function.command == "home":
            spindle.hold()
            spindle.expect(Expectation(spindle.node))
        return [] if spindle.follows else [self._command(spindle, function.command)]

    def tool_limits(self, tool: int) -> list[Command]:
        """What a tool permits goes to the spindle that carries it; D0 leaves the last limits in force (2.8.5)."""
        limits = self._channel.tools.get(tool) if tool else None
        if limits is None:
            return []
        for spindle in self:
            if spindle.node == limits.node:
                spindle.tool = in_kernel_units(limits)
        named = zip(("min_speed_rpm", "max_speed_rpm", "max_acceleration"), limits[1:], strict=True)
        return [Command(limits.node, "set_limits", {name: value for name, value in named if value is not None})]

    # gears

    def change_gear(self, change: GearChange) -> tuple[Command, Expectation] | None:
        """The command for another gear and the expected report; None if the spindle is in that gear."""
        spindle = self[change.spindle]
        if spindle.in_gear(change.stage):
            return None
        spindle.change_gear()
        expectation = Expectation(spindle.node, Condition.GEAR, change.stage)
        spindle.expect(expectation)
        return self._command(spindle, "select_gear", stage=change.stage, resume=False), expectation

    # synchronous operation

    def link(self, link: SpindleLink) -> tuple[list[Command], Expectation]:
        """Start and end of a coupling: the path waits for the slave's report. A coupling ended by others is gone."""
        slave, master = self[link.slave], self[link.master]
        if not link.on:
            return self._decouple(slave), Expectation(slave.node)
        slave.couple(master)
        arguments: dict[str, Any] = {"master": master.node, "owner": self._channel.name}
        if link.num != link.den:
            arguments |= {"factor_num": link.num, "factor_den": link.den}
        expectation = Expectation(slave.node, Condition.MASTER, master=master.node)
        return [Command(slave.node, "couple", arguments)], expectation

    def _decouple(self, slave: CommandedSpindle) -> list[Command]:
        if not slave.follows:
            return []
        slave.release()
        return [Command(slave.node, "decouple", {"owner": self._channel.name})]

    # ends

    def decouple_all(self) -> list[Command]:
        """Ends all couplings of the channel immediately: its program was aborted."""
        slaves = sorted((spindle for spindle in self if spindle.follows), key=lambda spindle: spindle.coupling_rank)
        return [command for slave in slaves for command in self._decouple(slave)]

    def stop(self, spindle: CommandedSpindle, *, homes: bool) -> list[Command]:
        """M05, unless somebody else has commanded the spindle since; none if there is no unit."""
        spindle.forget()
        spindle.expect(Expectation(spindle.node))
        return [] if spindle.unit is None else [self._command(spindle, "stop", own=True, homes=homes)]


def in_kernel_units(limits: ChannelToolLimits) -> ToolLimits:
    """Limits of a tool in deg/s and deg/s²."""
    _, low, high, acceleration = limits
    return ToolLimits(
        inf if high is None else high * DEG_S_PER_RPM,
        0.0 if low is None else low * DEG_S_PER_RPM,
        inf if acceleration is None else acceleration,
    )


def expected(spindle: CommandedSpindle, function: SpindleFunction) -> Expectation:
    """The report when the spindle has carried out the function; of PLC spindles the PLC reports it."""
    if spindle.reported_to_plc or spindle.unit is None:
        return Expectation(spindle.node)
    if function.m == 5:
        return Expectation(spindle.node, Condition.STANDSTILL)
    if function.m == 19:
        gear = spindle.unit.gears[spindle.unit.gear]
        turn = gear.modulo_high - gear.modulo_low
        return Expectation(spindle.node, Condition.POSITION, function.position_deg or 0.0, turn)
    sign = 1.0 if spindle.direction == "cw" else -1.0
    return Expectation(spindle.node, Condition.SPEED, sign * (function.speed_rpm or 0.0))
