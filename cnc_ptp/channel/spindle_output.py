"""Functions of spindles -> commands to their units, what the PLC is told, what there is to wait for.

Three kinds of spindles: NC spindles carry out commands and report; axis-specific PLC spindles (P-AXIS-00015 0x40000) do
so too, but their PLC alone acknowledges; channel-specific ones (P-CHAN-00069) have no unit, all goes to the PLC.
Source: TF5200 spindle 2.2, 2.4.1, 2.5, 2.8.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from cnc_ptp.channel.spindle_concern import SpindleConcern
from cnc_ptp.channel.spindle_reports import Condition
from cnc_ptp.channel.waits import StoredSpeed, Wait
from cnc_ptp.nc.canonical import GearChange, SpindleCommand, SpindleFunction, SpindleLink
from cnc_ptp.parameters import ChannelParameters, ChannelSpindle, SpindleParameters, Synchronisation
from cnc_ptp.protocol.blocks import Block, Command, SpindleBlock
from cnc_ptp.protocol.commands import COMMANDS

DIRECTIONS = {3: "cw", 4: "ccw"}
CONDITIONS = {
    3: Condition.SPEED,
    4: Condition.SPEED,
    None: Condition.SPEED,
    5: Condition.STANDSTILL,
    19: Condition.POSITION,
}


class SpindleOutput:
    """The spindles of one channel: what it has set turning, coupled, or freed of the override."""

    def __init__(self, channel: ChannelParameters, units: Mapping[str, SpindleParameters]) -> None:
        """`units`: the spindles of the machine by node name."""
        self._channel = channel
        self._spindles = {spindle.name: spindle for spindle in channel.spindles}
        self._units = units
        self.concern = SpindleConcern(channel.name)
        """What is to be stopped with the program."""
        self._directions: dict[str, str] = {}
        """As the program knows it: what turns, and how."""
        self._standing_after_gear: set[str] = set()
        """A gear change has ended their rotation: the next speed starts them again."""
        self._full_override: set[str] = set()
        self._masters: dict[str, str] = {}
        """Slave -> master, both by name."""
        self._linked: set[str] = set()
        """Slaves to which their coupling has gone out."""
        self.slaves: set[str] = set()
        """Those that have reported their master."""

    # what the spindles report

    def send(self, first_cycle: int) -> None:
        """What is queued goes out with the block that begins at `first_cycle`."""
        self.concern.send(first_cycle)
        self._linked = set(self._masters)

    def read(self, cycle: int, feedback: Mapping[str, Block]) -> list[str]:
        """Blocks for the cycles before `cycle`; a text for each coupling of the channel that others have ended."""
        for name in self.concern:
            block = feedback.get(self[name].node)
            if isinstance(block, SpindleBlock):
                self.concern.read(cycle, name, block)
        texts = [self._read_slave(name, feedback.get(self[name].node)) for name in sorted(self._linked)]
        return [text for text in texts if text]

    def _read_slave(self, name: str, block: Block | None) -> str:
        if not isinstance(block, SpindleBlock):
            return ""
        master = self[self._masters[name]].node
        if block.master == master:
            self.slaves.add(name)
        elif name in self.slaves:
            self._release(name)
            return f"spindle {self[name].node} does not follow {master} any more"
        return ""

    def _release(self, slave: str) -> None:
        """What a slave goes on with after its coupling is the concern of who has coupled it."""
        if slave in self.slaves:
            self.concern.keep(slave)
        del self._masters[slave]
        self.slaves.discard(slave)
        self._linked.discard(slave)

    # functions

    def __getitem__(self, name: str) -> ChannelSpindle:
        return self._spindles[name]

    def told_to_plc(self, name: str) -> bool:
        """The PLC gets every function of the spindle, whatever its synchronisation type says."""
        return self[name].plc_control or self._units[self[name].node].plc_controlled

    def follows(self, name: str) -> bool:
        """A slave: the PLC hears of its master only (2.8.3)."""
        return name in self._masters

    def wait(self, function: SpindleFunction) -> Wait:
        """What the spindle reports when it has carried out the function; for PLC spindles the PLC says so."""
        node = self[function.spindle].node
        if self.told_to_plc(function.spindle):
            return Wait(spindle=node)
        condition = CONDITIONS[function.m]
        if condition is Condition.SPEED:
            sign = 1.0 if self._directions[function.spindle] == "cw" else -1.0
            return Wait(node, condition, sign * (function.speed_rpm or 0.0))
        if condition is Condition.POSITION:
            gear = self._units[node].gears[self._units[node].gear]
            return Wait(node, condition, function.position_deg or 0.0, turn=gear.modulo_high - gear.modulo_low)
        return Wait(node, condition)

    def synchronisation(self, function: SpindleFunction) -> Synchronisation:
        """M19, M3, M4, M5 go before S."""
        spindle = self[function.spindle]
        return {3: spindle.m3, 4: spindle.m4, 5: spindle.m5, 19: spindle.m19, None: spindle.s}[function.m]

    def acts(self, function: SpindleFunction) -> bool:
        """False for an S word while the spindle stands: the speed counts for the next M3 or M4. Notes the rotation."""
        name = function.spindle
        if function.m is None:
            return name in self._directions and function.speed_rpm is not None
        if function.m in DIRECTIONS:
            self._directions[name] = DIRECTIONS[function.m]
        else:
            self._directions.pop(name, None)
        if function.m == 5 and self[name].plc_control:
            self.concern.end(name)
        else:
            self.concern.add(name)
        return True

    def stored(self, function: SpindleFunction) -> list[StoredSpeed]:
        """The speed of a function that does not act; of a slave only where its master turns."""
        master = self._masters.get(function.spindle, "")
        all_stand = master and master not in self._directions
        if function.speed_rpm is None or all_stand or self[function.spindle].plc_control:
            return []
        return [StoredSpeed(self[function.spindle].node, function.speed_rpm, self[master].node if master else "")]

    def commands(self, function: SpindleFunction) -> list[Command]:
        """For the unit of the spindle; a slave gets none, it does what its master is told (2.8.3)."""
        spindle = self[function.spindle]
        if spindle.plc_control:
            return []
        commands = self._override(spindle, function)
        if function.spindle not in self._masters:
            commands += self._motion(spindle, function)
        return commands

    def _override(self, spindle: ChannelSpindle, function: SpindleFunction) -> list[Command]:
        """G167 holds for what its block commands."""
        was_off = spindle.name in self._full_override
        if function.full_override == was_off:
            return []
        (self._full_override.add if function.full_override else self._full_override.discard)(spindle.name)
        return [self._command(spindle.node, "suppress_override", enabled=function.full_override)]

    def _motion(self, spindle: ChannelSpindle, function: SpindleFunction) -> list[Command]:
        if function.m == 5:
            return [self._command(spindle.node, "stop")]
        if function.m == 19:
            return [self._orientation(spindle, function)]
        direction = self._directions.get(spindle.name)
        if direction is None or function.speed_rpm is None:
            return []
        resumes = spindle.name in self._standing_after_gear
        self._standing_after_gear.discard(spindle.name)
        if function.m is None and not resumes:
            return [self._command(spindle.node, "set_speed", speed_rpm=function.speed_rpm)]
        return [self._command(spindle.node, "start", direction=direction, speed_rpm=function.speed_rpm)]

    def _orientation(self, spindle: ChannelSpindle, function: SpindleFunction) -> Command:
        words: dict[str, Any] = {"position_deg": function.position_deg}
        if function.speed_rpm is not None:
            words["speed_rpm"] = function.speed_rpm
        if function.direction:
            words["direction"] = function.direction
        return self._command(spindle.node, "orient", **words)

    def _command(self, node: str, command: str, **arguments: Any) -> Command:
        """Says where motion commands come from, so that a spindle can refuse a second commander."""
        if "source" in COMMANDS["spindle"][command]:
            arguments["source"] = self._channel.name
        return Command(node, command, arguments)

    # without speed and position

    def plain(self, function: SpindleCommand) -> list[Command]:
        """G74, DEFAULT_DYNAMIC_DATA: nobody waits for them."""
        if function.command == "home":
            self._directions.pop(function.spindle, None)
            self.concern.add(function.spindle)
        if function.spindle in self._masters:
            return []
        return [self._command(self[function.spindle].node, function.command)]

    def tool_limits(self, tool: int) -> list[Command]:
        """What a tool permits goes to the spindle that carries it; D0 leaves the last limits in force (2.8.5)."""
        limits = self._channel.tools.get(tool) if tool else None
        if limits is None:
            return []
        named = zip(("min_speed_rpm", "max_speed_rpm", "max_acceleration"), limits[1:], strict=True)
        return [self._command(limits.node, "set_limits", **{name: value for name, value in named if value is not None})]

    # gears

    def gear_change(self, change: GearChange, feedback: Mapping[str, Block]) -> tuple[Command, Wait] | None:
        """The command for another gear and the wait for it; None where the spindle is in that gear.

        What was turning stays at rest then: the words of the block say what comes after.
        """
        node = self[change.spindle].node
        block = feedback.get(node)
        if isinstance(block, SpindleBlock):
            in_gear = block.gear[-1] == change.stage and not block.gear_change_active[-1]
        else:
            in_gear = change.stage == self._units[node].gear
        if in_gear:
            return None
        if change.spindle in self._directions:
            self._standing_after_gear.add(change.spindle)
        self.concern.add(change.spindle)
        wait = Wait(node, Condition.GEAR, change.stage)
        return self._command(node, "select_gear", stage=change.stage, resume=False), wait

    # synchronous operation

    def link(self, link: SpindleLink) -> tuple[list[Command], Wait]:
        """Begin and end of a coupling: the path goes on when the slave reports it. What others have ended is over."""
        slave, master = self[link.slave].node, self[link.master].node
        if link.on:
            self._masters[link.slave] = link.master
            arguments: dict[str, Any] = {"master": master, "owner": self._channel.name}
            if link.num != link.den:
                arguments |= {"factor_num": link.num, "factor_den": link.den}
            return [Command(slave, "couple", arguments)], Wait(slave, Condition.MASTER, master=master)
        return self._decouple(link.slave), Wait(slave)

    def _decouple(self, slave: str) -> list[Command]:
        if slave not in self._masters:
            return []
        self._release(slave)
        return [Command(self[slave].node, "decouple", {"owner": self._channel.name})]

    # ends

    def decouple_all(self) -> list[Command]:
        """Ends all couplings of the channel at once: its program was aborted."""
        return [command for slave in list(self._masters) for command in self._decouple(slave)]

    def forget(self, name: str) -> None:
        """The spindle is none of the channel's concern any more, and does not turn as far as the next block knows."""
        self.concern.drop(name)
        self._directions.pop(name, None)
        self._standing_after_gear.discard(name)

    def stop(self, name: str, *, homes: bool) -> list[Command]:
        """M05, unless somebody else has commanded the spindle since; none where there is no unit."""
        self.forget(name)
        spindle = self[name]
        return [] if spindle.plc_control else [self._command(spindle.node, "stop", own=True, homes=homes)]

    def __iter__(self) -> Iterator[str]:
        """Names of the channel's spindles."""
        return iter(self._spindles)

    @property
    def turning(self) -> list[str]:
        """Names of the spindles that turn, as the program knows it."""
        return list(self._directions)
