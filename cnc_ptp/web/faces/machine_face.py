"""A machine under the hands of a client as pages see it; and one without a graph, which runs in real time."""

from __future__ import annotations

import asyncio
from abc import abstractmethod
from collections.abc import Callable, Collection, Mapping
from math import inf
from types import SimpleNamespace
from typing import Any

from cnc_ptp.channel.channel_unit import ChannelUnit
from cnc_ptp.client import Machine
from cnc_ptp.client.faults import error_of, unknown_unit
from cnc_ptp.client.link import Link, Reply
from cnc_ptp.client.offline_link import OfflineLink
from cnc_ptp.client.record_arguments import written_parameter
from cnc_ptp.errors import CncError
from cnc_ptp.nodes.bridge.jog_topics import JogTopics
from cnc_ptp.parameters import ParameterSet
from cnc_ptp.parameters.check.runtime_change import changed
from cnc_ptp.parameters.view.authority import OF_PAGES, OF_SERVICES, OF_TOPICS, closed_units
from cnc_ptp.protocol.authority import closed_to, require_axes_open
from cnc_ptp.protocol.blocks import ChannelBlock, Command, CommandRecord, Event, Severity
from cnc_ptp.protocol.unit import PLC
from cnc_ptp.web.access.rights import is_stop
from cnc_ptp.web.faces.description import describe_commands, describe_units
from cnc_ptp.web.faces.face import Face, News, State, nothing
from cnc_ptp.web.faces.scope import signals_of
from cnc_ptp.web.faces.unit_fields import unit_states
from cnc_ptp.web.numbers import NO_COMMAND_RIGHT, SESSION_ENDED, STOPPED

NOT_SENT = frozenset({NO_COMMAND_RIGHT, SESSION_ENDED, STOPPED})
"""Why a command that waited for its turn was dropped."""

JOG_SOURCES = (OF_PAGES, OF_SERVICES, OF_TOPICS)
"""A jog of a page leaves on a topic; it is a command of pages, which are clients, all the same."""


class MachineFace(Face):
    """What the graph and an offline machine have in common: their link."""

    def __init__(self, machine: Machine) -> None:
        self._machine = machine
        self._link: Link = machine._session.link
        self.kinds = self._link.kinds
        self.cycle_time = self._link.cycle_time
        seen = self._link.seen
        self._events = seen.events()
        self._records = seen.records()
        self._blocks = {unit: seen.blocks_of(unit) for unit in self.kinds}
        self._earlier = [
            (unit, offsets)
            for unit, block in seen.blocks.items()
            if isinstance(block, ChannelBlock)
            for offsets in block.offsets
        ]
        self._stops = dict.fromkeys(self.kinds, 0)
        """How often a unit was stopped."""
        self._turns = {unit: asyncio.Lock() for unit in self.kinds}
        self.sets: dict[str, ParameterSet] = {
            unit: self._link.parameters_of(unit) for unit, kind in self.kinds.items() if kind != "plc"
        }
        self.machine_set = self._link.parameters_of(PLC)
        self._closed = closed_units(self.machine_set, self.kinds)
        self._units = describe_units(self.kinds, self.sets, self.cycle_time)

    def machine(self) -> dict[str, Any]:
        block = next(iter(self._link.seen.blocks.values()))
        return {
            "units": self._units,
            "commands": describe_commands(),
            "signals": signals_of(self.kinds, {unit["name"]: unit.get("unit", "mm") for unit in self._units}),
            "cycle_time": self.cycle_time,
            "block_cycles": block.count,
        }

    @property
    def time(self) -> float:
        return self._machine.time

    def state(self) -> State:
        states = unit_states(self._link.seen.blocks)
        for channel, fields in self.programs().items():
            states[channel].update(fields)
        return states

    def programs(self) -> Mapping[str, Mapping[str, Any]]:
        """Channel -> program, file and text of the active line."""
        return {}

    def news(self) -> News:
        requests = [*self._link.seen.known_requests()] if "plc" in self._link.seen.blocks else []
        blocks = [(unit, block) for unit, mailbox in self._blocks.items() for block in taken(mailbox.items)]
        records = taken(self._records.items)
        for record in records:
            self._take_parameter(record)
        earlier, self._earlier = self._earlier, []
        return News(taken(self._events.items), requests, blocks, records, offsets=earlier)

    def _take_parameter(self, record: CommandRecord) -> None:
        """A parameter of an axis that was written, by whomever."""
        unit, parameter = record.target, written_parameter(record)
        if parameter is None or unit not in self.sets:
            return
        try:
            self.sets[unit] = changed(self.sets[unit], *parameter).own
        except CncError:  # no unit has said so
            return
        self._units = describe_units(self.kinds, self.sets, self.cycle_time)

    async def ask(
        self, unit: str, command: str, arguments: Mapping[str, Any], *, user: str, require: Callable[[], None] = nothing
    ) -> Reply:
        if unit not in self.kinds:
            raise unknown_unit(unit, self.kinds)
        given = self._machine[unit]._prepared(command, dict(arguments))
        try:
            self.require_open(unit, command, given)
        except CncError as error:
            self.note(round(self.time / self.cycle_time), who_text(user, self.kinds[unit], unit, command, error.number))
            raise
        try:
            reply = await self._in_turn(unit, command, given, user, require)
        except CncError as error:
            end = f"{'not sent' if error.number in NOT_SENT else 'no answer'}, P-ERR-{error.number}"
            self.note(round(self.time / self.cycle_time), f"{user}: {self.kinds[unit]} {unit}: {command}, {end}")
            raise
        self.note(reply.cycle, who_text(user, self.kinds[unit], unit, command, reply.error_id))
        if reply.error_id:
            raise error_of(reply.error_id, reply.message, reply.values)
        return reply

    def jog(self, axis: str, velocity: float, *, user: str) -> None:
        self.require_open(axis, "jog", {"velocity": velocity}, JOG_SOURCES)
        self._send_jog(axis, velocity, user)

    @abstractmethod
    def _send_jog(self, axis: str, velocity: float, user: str) -> None:
        """One message of a jog that is open to pages."""

    def require_open(
        self, unit: str, command: str, arguments: Mapping[str, Any], sources: Collection[str] = (OF_PAGES,)
    ) -> None:
        """Raises CncError 26218 where the machine file closes the unit to one of the sources.

        Also where it closes an axis of a trajectory to pages.
        """
        closed = self._closed.get(unit, ())
        for source in sources:
            error = closed_to(self.kinds[unit], unit, command, arguments, source=source, closed=closed)
            if error is not None:
                raise error
        require_axes_open(Command(unit, command, dict(arguments)), self._closed, OF_PAGES)

    async def _in_turn(
        self, unit: str, command: str, arguments: Mapping[str, Any], user: str, require: Callable[[], None]
    ) -> Reply:
        """Commands of a unit one after the other. A stop waits for none; those that wait then are not sent.

        Nor are those of a page that may command no longer when it is their turn.
        """
        kind = self.kinds[unit]
        if is_stop(kind, command, arguments):
            for stopped in stopped_by(kind, unit, command, self.kinds):
                self._stops[stopped] += 1
            return await self._answer_to(unit, command, arguments, user)
        stops = self._stops[unit]
        async with self._turns[unit]:
            if self._stops[unit] != stops:
                raise CncError(STOPPED, f"{kind} {unit}: {command}: a stop came before it", "it was not sent")
            require()
            return await self._answer_to(unit, command, arguments, user)

    def publish(self, event: Event) -> None:
        self._link.seen.take_event(event)

    async def _answer_to(self, unit: str, command: str, arguments: Mapping[str, Any], user: str) -> Reply:
        ticket = self._link.give(unit, command, arguments)
        while (reply := self._link.answer(ticket)) is None:
            await self._link.turn_async(inf)
        return reply

    def close(self) -> None:
        self._machine.close()


def stopped_by(kind: str, unit: str, command: str, kinds: Mapping[str, str]) -> list[str]:
    """The units whose waiting commands a stop drops: its own, all of an emergency stop, none of a feed hold."""
    if kind == "plc":
        return [*kinds]
    return [] if command == "feed_hold" else [unit]


def who_text(user: str, kind: str, unit: str, command: str, error_id: int) -> str:
    """Who has given the command of the record with the same cycle, unit and name."""
    end = f"refused with P-ERR-{error_id}" if error_id else "carried out"
    return f"{user}: {kind} {unit}: {command}, {end}"


def taken(items: Any) -> list[Any]:
    """What is in a mailbox; it is empty then."""
    found = []
    while items:
        found.append(items.popleft())
    return found


class OfflineFace(MachineFace):
    """A machine without a graph: its time passes as `run` or a test lets it."""

    def __init__(self, machine: Machine, *, stands: bool = False) -> None:
        """`stands`: its time passes in `step` alone."""
        super().__init__(machine)
        link = self._link
        assert isinstance(link, OfflineLink)
        self._offline = link
        self._stands = stands
        self._jogs = JogTopics(self._warn)
        self._sequence = 0
        self.users: list[tuple[str, str, str]] = []
        """User, unit and command, of all that were given."""

    def programs(self) -> Mapping[str, Mapping[str, Any]]:
        shown = {}
        for name, unit in self._offline._units.items():
            if isinstance(unit, ChannelUnit):
                view = unit.program_view
                shown[name] = {"program": view.program, "manual": view.manual, "file": view.file, "text": view.text}
        return shown

    async def _answer_to(self, unit: str, command: str, arguments: Mapping[str, Any], user: str) -> Reply:
        self.users.append((user, unit, command))
        ticket = self._offline.give(unit, command, arguments)
        while (reply := self._offline.answer(ticket)) is None:
            self.step()
        return reply

    def _send_jog(self, axis: str, velocity: float, user: str) -> None:
        self._sequence += 1
        message: Any = SimpleNamespace(
            header=SimpleNamespace(frame_id=user), sequence=self._sequence, valid=True, velocity=velocity
        )
        changed = self._jogs.heard(axis, message, self._offline.now, paced=True)
        if changed is not None:
            self._give_jog(axis, changed)

    def _give_jog(self, axis: str, velocity: float) -> None:
        reply = self._offline.answer(self._offline.give(axis, "jog", {"velocity": velocity}))
        assert reply is not None

    def _warn(self, number: int, text: str) -> None:
        cycle = round(self._offline.now / self.cycle_time)
        self._offline.seen.take_event(Event(cycle, "plc", Severity.WARNING, number, text))

    def step(self) -> None:
        """One block. Raises CncError 26171 when the run has ended."""
        for axis in self._jogs.fallen_silent(self._offline.now):
            self._give_jog(axis, 0.0)
        self._offline.turn(0.0)

    async def run(self) -> None:
        loop = asyncio.get_running_loop()
        begin, passed = loop.time(), self._offline.now
        while True:
            while not self._stands and self._offline.now - passed < loop.time() - begin:
                self.step()
                await asyncio.sleep(0)
            await asyncio.sleep(0.005)


def offline_face(machine: str, *, stands: bool = False) -> OfflineFace:
    """A machine of a machine file. Raises ParameterError, CncError 26110."""
    return OfflineFace(Machine.offline(machine), stands=stands)
