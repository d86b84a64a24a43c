"""The file of a recording that pages look at: its machine, its events and programs, and its blocks by seconds."""

from __future__ import annotations

import asyncio
from collections import OrderedDict
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import fields
from pathlib import Path
from typing import Any, BinaryIO, NamedTuple

import numpy as np
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory

from cnc_ptp.client.record_arguments import record_arguments
from cnc_ptp.errors import CncError
from cnc_ptp.machine.wiring import unit_kinds
from cnc_ptp.nodes.topics import BLOCK_CLASSES
from cnc_ptp.parameters import load_machine
from cnc_ptp.protocol.blocks import ChannelOffsets, CommandRecord, CycleBlock, Event, EventValue, Severity
from cnc_ptp.recording.command_words import is_load
from cnc_ptp.recording.mcap_chunks import CORRUPT
from cnc_ptp.recording.mcap_index import NOT_CLOSED
from cnc_ptp.recording.opened import OpenRecording
from cnc_ptp.recording.parts import files_of
from cnc_ptp.web.faces.description import describe_units
from cnc_ptp.web.faces.program_watch import load_of
from cnc_ptp.web.faces.scope import HEAD, Samples, Signal
from cnc_ptp.wire.block_codec import codec_of_file

WINDOW = 1.0
"""Seconds of blocks that are read together …"""
WINDOWS_KEPT = 8
"""… and how many of them are kept for pages that come there next."""
MOST_SAMPLES = 4_000_000
"""Of all signals in one answer."""
NS = 1e-9
DIAGNOSTICS, DIAGNOSTICS_TYPE = "/diagnostics", "diagnostic_msgs/msg/DiagnosticArray"


class NodeReport(NamedTuple):
    """What a node has told of itself."""

    time: float
    """Seconds."""
    fields: dict[str, Any]
    """As pages show it."""


class Window(NamedTuple):
    """A piece of a recording."""

    blocks: Mapping[str, list[CycleBlock]]
    """Of each unit."""
    reports: list[NodeReport]


class RecordedFile:
    """Read by all pages that look at it, one window after the other."""

    def __init__(self, path: str) -> None:
        """Raises CncError 26001 to 26003, 26005, 26011."""
        self._recording = OpenRecording(path)
        self._files: list[BinaryIO] = []
        try:
            self._read(path)
        except BaseException:
            self.close()
            raise

    def _read(self, path: str) -> None:
        if not self._recording.is_closed:
            raise CncError(
                CORRUPT,
                f"recording {path}: {NOT_CLOSED}",
                "nothing is shown, 'cnc_ptp recover' makes a file that can be shown",
            )
        self.parameters = load_machine(self._recording.attached("machine.yaml"), path)
        self.kinds = unit_kinds(self.parameters)
        self.sets = {unit: self.parameters.sets[unit] for unit, kind in self.kinds.items() if kind != "plc"}
        self.cycle_time = self.parameters.cycle_time_us * 1e-6
        self._files = [Path(file).open("rb") for file in files_of(Path(path))]  # noqa: SIM115  # until close
        self.units = describe_units(self.kinds, self.sets, self.cycle_time)
        self.end = self._end()
        self.events = self._read_events()
        self.offsets = self._read_offsets()
        self.programs = [
            (record.cycle, record.target, load_of(record_arguments(record)))
            for record in self._read_records()
            if record.command == "load" and is_load(record_arguments(record))
        ]
        """Cycle, channel, and each program that was loaded."""
        self._reading = asyncio.Lock()
        self._decoders = [DecoderFactory() for _ in self._files]
        self._windows: OrderedDict[int, Window] = OrderedDict()
        self.first = self._read_window(0)
        """The window of its begin."""

    async def window(self, number: int) -> Window:
        """What there is from `number` seconds on, for a second."""
        async with self._reading:
            if number not in self._windows:
                self._windows[number] = await asyncio.to_thread(self._read_window, number)
            self._windows.move_to_end(number)
            while len(self._windows) > WINDOWS_KEPT:
                self._windows.popitem(last=False)
            return self._windows[number]

    def samples(self, signals: Sequence[Signal], begin: float, end: float, points: int, *, bits: int) -> bytes:
        """A frame as of the scope, with the cycles between two samples in place of its stream; from and to in s.

        Every cycle as long as these are no more than `points` of a signal. A cycle that was not recorded is NaN.
        """
        columns, first = self._by_cycle(signals, begin, end)
        count = len(columns[0])
        step = max(1, -(-count // min(points, MOST_SAMPLES // len(columns))))
        picked = [column[::step].astype("<f8" if bits == 64 else "<f4") for column in columns]
        head = HEAD.pack(step, first & 0xFFFFFFFF, first >> 32, len(picked), len(picked[0]))
        return head + np.concatenate(picked).tobytes()

    def _by_cycle(self, signals: Sequence[Signal], begin: float, end: float) -> tuple[list[Samples], int]:
        """A value of each signal for every cycle from the first one on, and that cycle."""
        wanted: dict[str, list[str]] = {}
        for signal in signals:
            wanted.setdefault(signal.unit, []).append(signal.field)
        read = {
            unit: self._recording.columns(f"/{unit}/state", "cycle", *names, start=begin, end=end)
            for unit, names in wanted.items()
        }
        cycles = {unit: found["cycle"].astype(np.int64) for unit, found in read.items()}
        recorded = np.concatenate([*cycles.values()])
        first = int(recorded.min()) if len(recorded) else 0
        count = int(recorded.max()) - first + 1 if len(recorded) else 0
        columns = [np.full(count, np.nan) for _ in signals]
        for (unit, field), column in zip(signals, columns, strict=True):
            column[cycles[unit] - first] = read[unit][field]
        return columns, first

    def _end(self) -> float:
        summaries = [make_reader(file).get_summary() for file in self._files]
        last = max(summary.statistics.message_end_time for summary in summaries if summary and summary.statistics)
        return float(last - self._recording.start_ns) * NS

    def _read_window(self, number: int) -> Window:
        begin = self._recording.start_ns + round(number * WINDOW / NS)
        end = begin + round(WINDOW / NS)
        topics = {f"/{unit}/block": unit for unit in self.kinds}
        window = Window({unit: [] for unit in self.kinds}, [])
        for file, decoders in zip(self._files, self._decoders, strict=True):
            file.seek(0)
            read = make_reader(file).iter_messages([*topics, DIAGNOSTICS], starting_at=begin, ending_before=end)
            for schema, channel, message in read:
                if schema is not None and (unit := topics.get(channel.topic)):
                    with suppress(CncError):  # what no unit sends
                        codec = codec_of_file(BLOCK_CLASSES[self.kinds[unit]], schema.data)
                        window.blocks[unit].append(codec.decode(message.data))
                elif schema is not None and schema.name == DIAGNOSTICS_TYPE:
                    decode: Any = decoders.decoder_for("cdr", schema)
                    time = (message.log_time - self._recording.start_ns) * NS
                    window.reports.extend(NodeReport(time, node_fields(each)) for each in decode(message.data).status)
        return window

    def _read_events(self) -> list[Event]:
        if "/events" not in self._recording.topics:
            return []
        known = self._recording.topics["/events"].fields
        names = [each.name for each in fields(Event) if each.name in known]  # older recordings have no values
        columns = self._recording.columns("/events", *names)
        rows = zip(*(columns[name].tolist() for name in names), strict=True)
        events = (recorded_event(dict(zip(names, row, strict=True))) for row in rows)
        return sorted((each for each in events if each.severity <= max(Severity)), key=lambda event: event.cycle)

    def _read_offsets(self) -> list[tuple[str, ChannelOffsets]]:
        """Channel, and what lies between its programmed and machine positions from a cycle on."""
        found: list[tuple[str, ChannelOffsets]] = []
        for channel in (unit for unit, kind in self.kinds.items() if kind == "channel"):
            topic = self._recording.topics.get(f"/{channel}/offsets")
            if topic is None:
                continue
            names = [each.name for each in fields(ChannelOffsets) if each.name in topic.fields]
            columns = self._recording.columns(topic.name, *names)
            rows = zip(*(columns[name].tolist() for name in names), strict=True)
            found += [(channel, ChannelOffsets(**dict(zip(names, map(as_list, row), strict=True)))) for row in rows]
        return sorted(found, key=lambda offsets: offsets[1].cycle)

    def _read_records(self) -> list[CommandRecord]:
        """Of commands to channels that were carried out."""
        if "/commands" not in self._recording.topics:
            return []
        names = ("cycle", "target", "command", "arguments_json", "accepted")
        columns = self._recording.columns("/commands", *names)
        rows = zip(*(columns[name].tolist() for name in names), strict=True)
        records = [
            CommandRecord(cycle, unit, command, given, ok, 0, "")
            for cycle, unit, command, given, ok in rows
            if ok and self.kinds.get(unit) == "channel"
        ]
        return sorted(records, key=lambda record: record.cycle)

    def close(self) -> None:
        self._recording.close()
        for file in self._files:
            file.close()


def as_list(value: Any) -> Any:
    """A sequence of numbers as a channel has it; another value as it is."""
    return value.tolist() if isinstance(value, np.ndarray) else value


def recorded_event(fields: dict[str, Any]) -> Event:
    """The roles of its values are left out."""
    values = fields.pop("values", [])
    return Event(**fields, values=[EventValue(value["name"], value["value"], value["unit"]) for value in values])


def node_fields(status: Any) -> dict[str, Any]:
    """Of a DiagnosticStatus, as `diagnostics` has them."""
    values = {value.key: value.value for value in status.values}
    return {"name": status.name, "level": status.level, "text": status.message, "values": values}
