"""What pages know of a machine: all pages share that of a machine that runs, each has its own of a recording."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any, Protocol

from cnc_ptp.client.record_arguments import written_parameter
from cnc_ptp.protocol.blocks import (
    ChannelBlock,
    ChannelOffsets,
    CommandRecord,
    CycleBlock,
    Event,
    HandshakeRequest,
)
from cnc_ptp.web.faces.alarms import Alarms, event_fields
from cnc_ptp.web.faces.distances import DistancesToGo
from cnc_ptp.web.faces.face import Face, News, Past, State
from cnc_ptp.web.faces.handshakes import Handshakes
from cnc_ptp.web.faces.lag_range import lag_ranges
from cnc_ptp.web.faces.offset_table import OffsetTable
from cnc_ptp.web.faces.program_watch import ProgramWatch
from cnc_ptp.web.faces.switches import Switches
from cnc_ptp.web.faces.targets import Targets
from cnc_ptp.web.protocol import difference

EVENTS_KEPT = 500
"""Events that a page keeps (static/store.js)."""


class Looking(Protocol):
    """A page that gets what comes."""

    def send(self, message: Mapping[str, Any]) -> None: ...

    def send_state(self, time: float, state: State, changes: State) -> None: ...

    def take_blocks(self, blocks: Sequence[tuple[str, CycleBlock]]) -> None: ...


class View:
    """A face of a machine, what has come of it, and the pages that look at it."""

    def __init__(self, face: Face, programs: ProgramWatch) -> None:
        self.face = face
        self.pages: list[Looking] = []
        self.programs = programs
        self.alarms = Alarms()
        channels = [unit for unit, kind in face.kinds.items() if kind == "channel"]
        self.handshakes = Handshakes(channels)
        self.tables = {unit: OffsetTable(face.sets[unit], face.sets) for unit in channels}
        self.targets = Targets([unit for unit, kind in face.kinds.items() if kind == "axis"])
        self._distances = DistancesToGo()
        self.offsets: dict[str, dict[str, Any]] = {}
        """Channel -> what lies between programmed and machine positions."""
        self._switches = Switches()
        self._state: State = {}
        self._blocks: Sequence[tuple[str, CycleBlock]] = ()
        """Those of the last time: the record of a command may be behind the blocks of its axis."""

    def known(self) -> dict[str, Any]:
        """What a page that comes now gets at first."""
        return {
            "alarms": self.alarms.list(),
            "handshakes": [*self.handshakes.waiting.values()],
            "programs": self.programs.all(),
            "offsets": self.offsets,
        }

    def tell(self) -> bool:
        """What has come since the last time, to all pages; whether a channel has another program."""
        units = self.face.state()  # before the news: a program that it names has its command among them
        if (past := self.face.past()) is not None:
            self._tell_past(past, self.face.cycle_time)
        news = self.face.news()
        self._tell_news(news)
        state = self._completed(units, news.blocks)
        changes = difference(state, self._state)
        self._state = state
        has_loaded = self._tell_programs(changes)
        for page in [*self.pages]:
            page.send_state(self.face.time, state, changes)
            page.take_blocks(news.blocks)
        return has_loaded

    def _tell_news(self, news: News) -> None:
        for event in news.events:
            self._tell_event(event, self.face.cycle_time)
        for request in news.requests:
            self._tell_request(request)
        self._tell_offsets(news.offsets)
        for record in news.records:
            self._tell_answered(record, [*self._blocks, *news.blocks])
        for unit, block in news.blocks:
            if isinstance(block, ChannelBlock):
                self._distances.take_block(unit, block)
                self._tell_offsets([(unit, offsets) for offsets in block.offsets])
                self._tell_done(self.handshakes.take_block(unit, block))
        self._blocks = news.blocks
        self._tell_tables()
        if news.diagnostics:
            self.to_all({"type": "diagnostics", "nodes": [*news.diagnostics]})

    def _completed(self, units: State, blocks: Sequence[tuple[str, CycleBlock]]) -> State:
        """The state of units with what no block of them says; `blocks` that are new."""
        distances = self._distances.fields(units, self._state, self.targets.positions)
        lags = lag_ranges(blocks)
        return {
            unit: {
                **fields,
                **self._switches.fields.get(unit, {}),
                **self.targets.fields(unit),
                **distances.get(unit, {}),
                **lags.get(unit, {}),
            }
            for unit, fields in units.items()
        }

    def to_all(self, message: Mapping[str, Any]) -> None:
        for page in self.pages:
            page.send(message)

    def _tell_programs(self, changes: State) -> bool:
        self.programs.take_state(changes, self.face.loads())
        loaded = self.programs.news()
        for program in loaded:
            self.to_all({"type": "program", **program})
        return bool(loaded)

    def _tell_event(self, event: Event, cycle_time: float) -> None:
        fields = event_fields(event, cycle_time)
        alarm = self.alarms.take(fields)
        self.to_all({"type": "event", **(alarm or fields)})
        self._tell_acknowledged(self.alarms.acknowledge(event))

    def acknowledge(self, number: int | None, user: str) -> None:
        """One alarm, or all (None). Raises CncError 26233."""
        event = self.alarms.acknowledgement(number, user, round(self.face.time / self.face.cycle_time))
        if event is not None:
            self.face.publish(event)
            self._tell_acknowledged(self.alarms.acknowledge(event, is_own=True))

    def _tell_acknowledged(self, acknowledged: Mapping[str, Any] | None) -> None:
        if acknowledged is not None and acknowledged["alarms"]:
            self.to_all({"type": "acknowledged", **acknowledged})

    def _tell_request(self, request: HandshakeRequest) -> None:
        """A function of a program; pages get those that wait for an acknowledgement."""
        self._switches.take_request(request)
        if self.handshakes.take_request(request):
            self.to_all({"type": "handshake", **self.handshakes.waiting[request.id]})

    def _tell_answered(self, record: CommandRecord, blocks: Sequence[tuple[str, CycleBlock]]) -> None:
        """A request that was acknowledged, a program that was loaded, by whomever."""
        self._switches.take_record(record)
        self.targets.take_record(record, blocks)
        self.programs.take_record(record)
        if written_parameter(record) is not None:
            self._tell_parameters(record.target)
        self._tell_done(self.handshakes.take_record(record))

    def _tell_parameters(self, unit: str) -> None:
        """A parameter of it was written: pages read them again; limits that follow come with it."""
        described = [each for each in self.face.machine()["units"] if each["name"] == unit]
        for each in described:
            self.to_all({"type": "parameters", "unit": unit, "described": each})

    def _tell_done(self, numbers: Sequence[int]) -> None:
        """Of requests that wait no longer."""
        for number in numbers:
            self.to_all({"type": "handshake_done", "id": number})

    def _tell_past(self, past: Past, cycle_time: float) -> None:
        """In place of all that pages know: theirs is another time of the recording now."""
        self.alarms.begin_again(past.events, cycle_time)
        self.offsets.clear()
        for table in self.tables.values():
            table.begin_again()
        for channel, offsets in past.offsets:
            self._take_offsets(channel, offsets)
        events = [event_fields(event, cycle_time) for event in past.events[-EVENTS_KEPT:]]
        known = {"events": events, "alarms": self.alarms.list(), "offsets": self.offsets}
        self.to_all({"type": "past", **known, "nodes": [*past.diagnostics]})

    def _tell_offsets(self, told: Sequence[tuple[str, ChannelOffsets]]) -> None:
        """Of a block, or of their topic: the newest of each channel, once."""
        for channel in {channel for channel, offsets in told if self._take_offsets(channel, offsets)}:
            self.to_all({"type": "offsets", **self.offsets[channel]})

    def _tell_tables(self) -> None:
        """The zero offsets of channels, as they were changed."""
        for channel, table in self.tables.items():
            if (shown := table.news()) is not None:
                self.to_all({"type": "zero_offsets", "channel": channel, **shown})

    def _take_offsets(self, channel: str, offsets: ChannelOffsets) -> bool:
        """They may come late, and twice; whether they are new."""
        self.tables[channel].take(offsets)
        known, told = self.offsets.get(channel, {}), {"channel": channel, **asdict(offsets)}
        if known == told or known.get("cycle", 0) > offsets.cycle:
            return False
        self.offsets[channel] = told
        return True
