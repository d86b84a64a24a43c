"""The file of a recording that pages look at: its machine, its events and programs, and its blocks by seconds."""

from __future__ import annotations

import asyncio
import json
from collections import OrderedDict
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import BinaryIO

import numpy as np
from mcap.reader import make_reader

from cnc_ptp.machine.wiring import unit_kinds
from cnc_ptp.nodes.topics import BLOCK_CLASSES
from cnc_ptp.parameters import load_machine
from cnc_ptp.protocol.blocks import CycleBlock, Event
from cnc_ptp.recording.opened import OpenRecording
from cnc_ptp.recording.parts import files_of
from cnc_ptp.web.faces.description import describe_units
from cnc_ptp.web.faces.program_watch import Load, load_of
from cnc_ptp.web.faces.scope import HEAD, Signal
from cnc_ptp.wire.block_codec import codec_of

WINDOW = 1.0
"""Seconds of blocks that are read together …"""
WINDOWS_KEPT = 8
"""… and how many of them are kept for pages that come there next."""
MOST_SAMPLES = 200_000
"""Of a signal in one answer."""
NS = 1e-9
Blocks = Mapping[str, list[CycleBlock]]


class RecordedFile:
    """Read by all pages that look at it, one window after the other."""

    def __init__(self, path: str) -> None:
        """Raises CncError 26001 to 26003, 26005, 26011."""
        self._recording = OpenRecording(path)
        self.parameters = load_machine(self._recording.attached("machine.yaml"), path)
        self.kinds = unit_kinds(self.parameters)
        self.sets = {unit: self.parameters.sets[unit] for unit, kind in self.kinds.items() if kind != "plc"}
        self.cycle_time = self.parameters.cycle_time_us * 1e-6
        self._files: list[BinaryIO] = [Path(file).open("rb") for file in files_of(Path(path))]  # noqa: SIM115  # until close
        self.units = describe_units(self.kinds, self.sets, self.cycle_time)
        self.end = self._end()
        self.events = self._read_events()
        self.programs = self._read_programs()
        self._reading = asyncio.Lock()
        self._windows: OrderedDict[int, Blocks] = OrderedDict()
        self.first = self._read_window(0)
        """The window of its begin."""

    async def window(self, number: int) -> Blocks:
        """Blocks of the units from `number` seconds on, for a second."""
        async with self._reading:
            if number not in self._windows:
                self._windows[number] = await asyncio.to_thread(self._read_window, number)
            self._windows.move_to_end(number)
            while len(self._windows) > WINDOWS_KEPT:
                self._windows.popitem(last=False)
            return self._windows[number]

    def samples(self, signals: Sequence[Signal], begin: float, end: float, points: int, *, bits: int) -> bytes:
        """A frame as of the scope, with the cycles between two samples in place of its stream; from and to in s."""
        columns = {}
        for signal in signals:
            found = self._recording.columns(f"/{signal.unit}/state", signal.field, "cycle", start=begin, end=end)
            values = np.asarray(found[signal.field], dtype="<f8" if bits == 64 else "<f4")
            columns[signal] = np.asarray(found["cycle"], dtype="<u8"), values
        count = min(len(values) for _, values in columns.values())
        step = max(1, -(-count // min(points, MOST_SAMPLES)))
        first = int(next(iter(columns.values()))[0][0]) if count else 0
        picked = [values[:count:step] for _, values in columns.values()]
        head = HEAD.pack(step, first & 0xFFFFFFFF, first >> 32, len(picked), len(picked[0]))
        return head + np.concatenate(picked).tobytes()

    def _end(self) -> float:
        summaries = [make_reader(file).get_summary() for file in self._files]
        last = max(summary.statistics.message_end_time for summary in summaries if summary and summary.statistics)
        return float(last - self._recording.start_ns) * NS

    def _read_window(self, number: int) -> Blocks:
        begin = self._recording.start_ns + round(number * WINDOW / NS)
        topics = {f"/{unit}/block": unit for unit in self.kinds}
        codecs = {unit: codec_of(BLOCK_CLASSES[kind]) for unit, kind in self.kinds.items()}
        blocks: dict[str, list[CycleBlock]] = {unit: [] for unit in self.kinds}
        for file in self._files:
            file.seek(0)
            end = begin + round(WINDOW / NS)
            read = make_reader(file).iter_messages([*topics], starting_at=begin, ending_before=end)
            for _, channel, message in read:
                unit = topics[channel.topic]
                blocks[unit].append(codecs[unit].decode(message.data))
        return blocks

    def _read_events(self) -> list[Event]:
        if "/events" not in self._recording.topics:
            return []
        names = ("cycle", "source", "severity", "error_id", "text", "line")
        columns = self._recording.columns("/events", *names)
        rows = zip(*(columns[name].tolist() for name in names), strict=True)
        return sorted((Event(*row) for row in rows), key=lambda event: event.cycle)

    def _read_programs(self) -> list[tuple[int, str, Load]]:
        """Cycle, channel, and each program that was loaded."""
        if "/commands" not in self._recording.topics:
            return []
        names = ("cycle", "target", "command", "accepted", "arguments_json")
        columns = self._recording.columns("/commands", *names)
        rows = zip(*(columns[name].tolist() for name in names), strict=True)
        loaded = [
            (cycle, unit, load_of(json.loads(given)))
            for cycle, unit, command, ok, given in rows
            if command == "load" and ok
        ]
        return sorted(loaded, key=lambda load: load[0])

    def close(self) -> None:
        self._recording.close()
        for file in self._files:
            file.close()
