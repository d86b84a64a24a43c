"""One object of the HLI: who holds it, what that PLC commands, what has become of it.

Messages come at any rate, commands go out once a block: of levels the newest value, of edges each. A PLC that serves
anything, or has begun a motion that has not ended, holds the object until it gives everything back and the motion has
ended, or its messages stop. A motion that it has begun does not outlive it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from math import inf, isfinite
from typing import Any, NamedTuple

from cnc_ptp.plc.hli.external_commands import external_command
from cnc_ptp.plc.hli.external_jobs import ExternalJobs
from cnc_ptp.plc.hli.messages import ControlMessage, stops_of
from cnc_ptp.plc.sequence import is_newer
from cnc_ptp.protocol.blocks import AxisBlock, ChannelBlock, Command, CommandAnswer, ControlUnitState, SpindleBlock
from cnc_ptp.protocol.control_units import CONTROL_UNITS, PERCENT, ControlUnit

SECOND_PLC = 26162
OUT_OF_SEQUENCE = 26163
BAD_VALUE = 26164
PLC_SILENT = 26165
NOT_HIS = 26166
NOT_TAKEN = 26167
MOST_SOURCES = 16
"""PLCs whose sequence numbers are remembered, and texts that are not told again."""

Tell = Callable[[int, str], None]
"""Takes a warning: number, text."""


class Served(NamedTuple):
    """What a PLC commands of a control unit."""

    value: float
    source: str
    silent: bool = False
    """The PLC has fallen silent: the value holds until others ask for another one."""


class Answered:
    """What has become of an edge or of the external command: how often, and the last answer."""

    __slots__ = ("command", "count", "error_id", "job")

    def __init__(self) -> None:
        self.command: Command | None = None
        """Given, not answered yet."""
        self.count = 0
        self.error_id = 0
        self.job = 0

    def give(self, command: Command) -> Command:
        self.command = command
        self.count += 1
        return command

    def read(self, answers: Iterable[CommandAnswer]) -> bool:
        """Takes the answer; True if it has come."""
        for answer in answers:
            if self.command is not None and answer.id == self.command.id:
                self.command, self.error_id, self.job = None, answer.error_id, answer.job
                return True
        return False


class ObjectControl:
    """What PLCs command of one axis, spindle or channel."""

    def __init__(
        self,
        name: str,
        kind: str,
        *,
        largest_override: float,
        timeout: float,
        tell: Tell,
        masters: Mapping[int, str] | None = None,
    ) -> None:
        """`largest_override` in percent; `timeout` in s: without a message for so long the object is free; 0: never.

        `masters`: the units of this kind by their logical numbers.
        """
        self._masters = masters or {}
        self.name = name
        self.kind = kind
        self.holder: str | None = None
        """The PLC that commands the object."""
        self.states: dict[str, ControlUnitState] = {}
        """As the object has reported its control units."""
        self.edges = {unit.name: Answered() for unit in CONTROL_UNITS[kind] if unit.edge}
        self.external = Answered()
        self._largest_override = largest_override
        self._timeout = timeout or inf
        self._tell = tell
        self._heard = 0.0
        self._last_source = ""
        self._sequences: dict[str, int] = {}
        self._wanted: dict[str, Served] = {}
        """By control unit; those that no PLC serves are missing."""
        self._sent: dict[str, Served] = {}
        self._high: set[str] = set()
        """Edges and the semaphore that are on in the last message, acknowledgements that are in it."""
        self._rising: dict[str, str] = {}
        """Edges for the next block, with the PLC."""
        self._external_waits: Command | None = None
        self._jobs = ExternalJobs(name, kind)
        self._stopping: set[tuple[str, str]] = set()
        """PLCs that do not hold the object, and the stops of their last message."""
        self._acknowledged: list[int] = []
        self.serves_functions = False
        """The PLC acknowledges the functions of a channel, or the gear changes of a spindle."""
        self._told: set[tuple[int, str]] = set()
        self._commanding = False
        """The last message of the holder serves anything, or has an external command."""
        self._feed_held = False
        """The feed hold is on because the life sign is lost."""
        self._changed = False
        """What it has commanded last no longer holds, so that the same message counts again."""
        self._news = False
        """A message has come since the last block."""

    # messages

    def take(self, message: ControlMessage, now: float) -> bool:
        """A message, at `now` in s. True when it counts and its PLC holds the object."""
        source = message.source
        if not self._in_sequence(message):
            return False
        self._news = True
        if not message.valid:
            self._leave(source)
            return False
        if self.holder not in (None, source):
            self._take_from_another(message)
            return False
        if message.commands or source == self._last_source:
            self._heard = now
            self._hold(source)
            self._take_units(message)
            self._take_external(message)
            self._take_acknowledgements(message)
            self._commanding = message.commands
            self.holder = source if message.commands or self._moves else None
        return self.holder is not None

    @property
    def _moves(self) -> bool:
        """A motion that the PLC has commanded has not ended, or is still to begin."""
        return self.command_semaphore or self._jobs.active

    def _take_from_another(self, message: ControlMessage) -> None:
        """Of a PLC that does not hold the object only a stop counts: whoever sees a reason to stop may do so."""
        source, stops = message.source, stops_of(self.kind, message)
        for command, arguments in stops.items():
            if (source, command) not in self._stopping:
                self._jobs.stop(command, arguments)
        self._forget_stops(source)
        if len(self._stopping) >= MOST_SOURCES:
            self._stopping.clear()
        self._stopping |= {(source, command) for command in stops}
        if stops:
            text = (
                f"'{source}' stops it while '{self.holder}' holds it; the stop is carried out, nothing else was changed"
            )
            self._tell_once(SECOND_PLC, f"stop of {source}", text)
        elif message.commands:
            text = f"'{source}' commands it too and is refused while '{self.holder}' holds it; nothing was changed"
            self._tell_once(SECOND_PLC, source, text)

    def _forget_stops(self, source: str) -> None:
        self._stopping = {(other, command) for other, command in self._stopping if other != source}

    def heard(self, source: str, sequence: int, now: float) -> bool:
        """The PLC that holds the object has sent the same again: nothing else changes. False if it must be read."""
        if source != self.holder or self._changed or not is_newer(sequence, self._sequences.get(source, 0)):
            return False
        self._sequences[source] = sequence
        self._heard = now
        return True

    def _hold(self, source: str) -> None:
        """What another PLC had switched on last is no edge of this one."""
        if source != self._last_source:
            self._high.clear()
            self._forget_stops(source)
            self._told = {(number, what) for number, what in self._told if number != SECOND_PLC}
        self._last_source, self._changed = source, False

    def _in_sequence(self, message: ControlMessage) -> bool:
        source, last = message.source, self._sequences.get(message.source, 0)
        if not is_newer(message.sequence, last):
            text = f"message {message.sequence} of '{source}' comes after {last}; it is ignored"
            self._tell_once(OUT_OF_SEQUENCE, source, text)
            return False
        if len(self._sequences) >= MOST_SOURCES:
            self._sequences.clear()
        self._sequences[source] = message.sequence
        self._told.discard((OUT_OF_SEQUENCE, source))
        return True

    def _leave(self, source: str) -> None:
        """The PLC that holds the object, or held it last, gives everything back; of others nothing counts."""
        if source == (self._last_source if self.holder is None else self.holder):
            self._wanted.clear()
            self._high.clear()
            self._rising.clear()
            self._abandon()
            self.serves_functions, self.holder = False, None

    def _abandon(self) -> bool:
        """Motions that the PLC has begun are halted, one still to begin does not begin; False if there are none."""
        moves, self._external_waits = self._moves, None
        self._jobs.abandon(unanswered=self.external.command is not None)
        return moves

    def _take_units(self, message: ControlMessage) -> None:
        for unit in CONTROL_UNITS[self.kind]:
            enabled, command = message.units[unit.name]
            if unit.edge:
                self._take_edge(unit, message.source, enabled, bool(command))
            elif not enabled:
                self._wanted.pop(unit.name, None)
            elif self._is_good(unit, command):
                self._wanted[unit.name] = Served(command, message.source)
        self.serves_functions = message.serves_functions or self._serves("gear_changed")

    def _serves(self, name: str) -> bool:
        return name in self._wanted

    def _is_good(self, unit: ControlUnit, value: float) -> bool:
        """Says so of a value that is none, or beyond its limits: the one before holds."""
        largest = self._largest_override if unit.value == PERCENT else unit.largest
        whole = unit.value == PERCENT or value == value // 1.0
        if isfinite(value) and 0.0 <= value <= largest and whole:
            self._told.discard((BAD_VALUE, unit.name))
            return True
        before = self._wanted.get(unit.name)
        now = f"{before[0]:g} holds" if before is not None else "nobody serves it"
        number = "" if unit.value == PERCENT else "a whole number "
        text = f"{unit.name}: command {value:g} is not {number}within 0 ... {largest:g}; {now}"
        self._tell_once(BAD_VALUE, unit.name, text)
        return False

    def _take_edge(self, unit: ControlUnit, source: str, enabled: bool, command: bool) -> None:
        if not enabled:
            self._wanted.pop(unit.name, None)
        else:
            self._wanted[unit.name] = Served(0.0, source)
        if not (enabled and command):
            self._high.discard(unit.name)
        elif unit.name not in self._high:
            self._high.add(unit.name)
            if unit.name in self._rising:
                self._tell_once(NOT_TAKEN, unit.name, f"{unit.name} comes twice within a block; it is carried out once")
            self._rising[unit.name] = source

    def _take_external(self, message: ControlMessage) -> None:
        if not message.semaphore:
            self._high.discard("external")
            self._told.discard((NOT_TAKEN, "external"))
            return
        if "external" in self._high:
            return
        self._high.add("external")
        if self.command_semaphore:
            text = "an external command comes before the one before was taken; nothing was changed"
            self._tell_once(NOT_TAKEN, "external", text)
            return
        command = external_command(self.kind, self.name, message.external, self._masters)
        if isinstance(command, str):
            self._tell(BAD_VALUE, self._text(f"external command: {command}; nothing was changed"))
            self.external.count += 1
            self.external.error_id, self.external.job = BAD_VALUE, 0
        else:
            self._external_waits = command

    @property
    def command_semaphore(self) -> bool:
        """An external command is still to be taken."""
        return self._external_waits is not None or self.external.command is not None

    def _take_acknowledgements(self, message: ControlMessage) -> None:
        """Each number counts when it appears."""
        names = {f"acknowledge {number}" for number in message.acknowledged}
        for number in message.acknowledged:
            if f"acknowledge {number}" not in self._high:
                self._acknowledged.append(number)
        self._high = {name for name in self._high if not name.startswith("acknowledge ")} | names

    def watch(self, now: float) -> None:
        """The object is free when its PLC has fallen silent: values hold, motions that it has begun are halted."""
        if self.holder is not None and now - self._heard > self._timeout:
            moved = f"; its motion is {'stopped' if self.kind == 'spindle' else 'halted'}" if self._abandon() else ""
            text = f"no message of '{self.holder}' for {self._timeout * 1000.0:.0f} ms"
            text += f"{moved}; its values hold until others command them, and another PLC may take it"
            self._tell(PLC_SILENT, self._text(text))
            self._free()

    def _free(self) -> None:
        """Edges that the PLC served are everybody's again; values hold until others ask for another one."""
        self.holder = None
        self._rising.clear()
        levels = {name: served for name, served in self._wanted.items() if name not in self.edges}
        self._wanted = {name: served._replace(silent=True) for name, served in levels.items()}
        self._changed = self._news = True

    def hold_feed(self) -> None:
        """The life sign of the PLC is lost, and others set the feed hold: one that it serves is no longer its own.

        Its next message that serves the feed hold ends the one that was set.
        """
        self._feed_held = True
        if self._wanted.pop("feed_hold", None) is not None:
            self._changed = self._news = True

    # blocks

    def commands(self) -> Iterator[Command]:
        """The commands for the next block."""
        yield from self._jobs.commands()
        if not self._news:
            return
        self._news = False
        for unit in CONTROL_UNITS[self.kind]:
            wanted, sent = self._wanted.get(unit.name), self._sent.get(unit.name)
            if unit.name in self._rising:
                source = self._rising[unit.name]
                yield self.edges[unit.name].give(self._overlay(unit.name, Served(1.0, source)))
                sent = Served(0.0, source)
            if wanted != sent:
                yield self._overlay(unit.name, wanted)
        self._rising.clear()
        self._sent = dict(self._wanted)
        if self._feed_held and self._serves("feed_hold"):
            self._feed_held = False
            yield Command(self.name, "feed_hold", {"enabled": False})
        if self._external_waits is not None:
            yield self.external.give(self._external_waits)
            self._external_waits = None

    def _overlay(self, name: str, wanted: Served | None) -> Command:
        if wanted is None:
            return Command(self.name, "overlay", {"control_unit": name, "enabled": False})
        value, holder, silent = wanted
        arguments: dict[str, Any] = {"control_unit": name, "enabled": True, "value": value, "holder": holder}
        if silent:
            arguments["silent"] = True
        return Command(self.name, "overlay", arguments)

    def take_acknowledgements(self) -> list[int]:
        """Numbers of requests that the PLC has acknowledged since the last call."""
        numbers, self._acknowledged = self._acknowledged, []
        return numbers

    def read(self, block: AxisBlock | SpindleBlock | ChannelBlock) -> None:
        """What the object has reported."""
        for state in block.control_units:
            self.states[state.name] = state
        if block.answers:
            for edge in self.edges.values():
                edge.read(block.answers)
            command = self.external.command
            if self.external.read(block.answers) and command is not None:
                self._jobs.begin(self.external.job, command.command)
        self._jobs.read(block)
        if not (self.holder is None or self._moves or self._commanding):
            self.holder = None

    # texts

    def tell(self, number: int, text: str) -> None:
        self._tell(number, self._text(text))

    def _text(self, text: str) -> str:
        return f"plc: HLI of {self.name}: {text}"

    def _tell_once(self, number: int, what: str, text: str) -> None:
        """Once while it lasts: messages may come at 1 kHz."""
        if (number, what) not in self._told:
            if len(self._told) >= MOST_SOURCES:
                self._told.clear()
            self._told.add((number, what))
            self._tell(number, self._text(text))
