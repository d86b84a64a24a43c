"""A recording as pages see it: played, or looked at anywhere."""

from __future__ import annotations

import asyncio
import json
from collections import OrderedDict
from collections.abc import Mapping
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from mcap.reader import make_reader

from cnc_ptp.client.link import Reply
from cnc_ptp.errors import CncError
from cnc_ptp.machine.wiring import unit_kinds
from cnc_ptp.nodes.topics import BLOCK_CLASSES
from cnc_ptp.parameters import load_machine
from cnc_ptp.protocol.blocks import CycleBlock, Event
from cnc_ptp.recording.opened import OpenRecording
from cnc_ptp.recording.parts import files_of
from cnc_ptp.web.faces.description import describe_commands, describe_units
from cnc_ptp.web.faces.face import Face, News, State
from cnc_ptp.web.faces.program_watch import Load, load_of
from cnc_ptp.web.faces.scope import HEAD, Signal, signals_of
from cnc_ptp.web.faces.unit_fields import unit_states
from cnc_ptp.web.numbers import A_RECORDING
from cnc_ptp.web.protocol import NOTHING
from cnc_ptp.wire.block_codec import codec_of

WINDOW = 1.0
"""Seconds of blocks that are read together …"""
WINDOWS_KEPT = 8
"""… and how many of them are kept."""
STEP = 0.02
"""Seconds between two steps of the time that is played."""
MOST_SAMPLES = 200_000
"""Of a signal in one answer."""
NS = 1e-9
Blocks = Mapping[str, list[CycleBlock]]


class RecordedFace(Face):
    """Its time stands until a page plays it or looks at another one."""

    is_recording = True

    def __init__(self, path: str) -> None:
        """Raises CncError 26001 to 26003, 26005, 26011."""
        self._path = path
        self._recording = OpenRecording(path)
        self._parameters = load_machine(self._recording.attached("machine.yaml"), path)
        self.kinds = unit_kinds(self._parameters)
        self.sets = {unit: self._parameters.sets[unit] for unit, kind in self.kinds.items() if kind != "plc"}
        self.cycle_time = self._parameters.cycle_time_us * 1e-6
        self._files: list[BinaryIO] = [Path(file).open("rb") for file in files_of(Path(path))]  # noqa: SIM115  # until close
        self._units = describe_units(self.kinds, self.sets, self.cycle_time)
        self.end = self._end()
        self._events = self._read_events()
        self._programs = self._read_programs()
        self._windows: OrderedDict[int, Blocks] = OrderedDict()
        self._time = self._told = 0.0
        self._speed = 0.0
        self._reading = asyncio.Lock()
        self._seeks = 0
        self._windows[0] = self._read_window(0)

    def machine(self) -> dict[str, Any]:
        return {
            "units": self._units,
            "commands": describe_commands(),
            "signals": signals_of(self.kinds, {unit["name"]: unit.get("unit", "mm") for unit in self._units}),
            "cycle_time": self.cycle_time,
            "block_cycles": self._parameters.block_cycles,
            "start": 0.0,
            "end": self.end,
        }

    # time

    @property
    def time(self) -> float:
        return self._time

    async def seek(self, time: float) -> None:
        """Another time, within the recording."""
        wanted = min(max(0.0, time), self.end)
        self._seeks += 1
        seek = self._seeks
        await self._have(wanted)
        if seek == self._seeks:  # no page has looked elsewhere meanwhile
            self._time = self._told = wanted
            self._seeks += 1  # a step of the play that has begun meanwhile does not count

    def play(self, speed: float) -> None:
        """Seconds of the recording in a second; 0 stops it."""
        self._speed = min(max(0.0, speed), 100.0)
        if self._time >= self.end:
            self._time = self._told = 0.0

    async def run(self) -> None:
        loop = asyncio.get_running_loop()
        before = loop.time()
        while True:
            await asyncio.sleep(STEP)
            now = loop.time()
            if self._speed:
                wanted, seeks = min(self.end, self._time + self._speed * (now - before)), self._seeks
                await self._have(wanted)
                if seeks == self._seeks:
                    self._time = wanted
                    self._speed *= wanted < self.end
            before = now

    async def _have(self, time: float) -> None:
        """The window of a time, and the next one, are read: one after the other, they have one file."""
        async with self._reading:
            for number in (int(time / WINDOW), int(time / WINDOW) + 1):
                if number not in self._windows and number * WINDOW <= self.end:
                    self._windows[number] = await asyncio.to_thread(self._read_window, number)
                while len(self._windows) > WINDOWS_KEPT:
                    self._windows.popitem(last=False)

    # what pages see

    def state(self) -> State:
        """Of the last block that has ended by now."""
        blocks = {unit: block for unit in self.kinds if (block := self._block_at(unit)) is not None}
        states = unit_states(blocks)
        for channel, load in self.loads().items():
            if channel in states:
                states[channel]["program"] = load.path
        return states

    def _block_at(self, unit: str) -> CycleBlock | None:
        cycle = round(self._time / self.cycle_time)
        found = None
        for block in self._windows.get(int(self._time / WINDOW), {}).get(unit, []):
            if found is not None and block.first_cycle > cycle:
                break
            found = block
        return found

    def loads(self) -> dict[str, Load]:
        cycle = self._time / self.cycle_time
        return {channel: load for at, channel, load in self._programs if at <= cycle}

    def news(self) -> News:
        begin, end = self._told / self.cycle_time, self._time / self.cycle_time
        self._told = self._time
        if end <= begin:
            return News()
        windows = [
            self._windows.get(number, {})
            for number in range(int(begin * self.cycle_time / WINDOW), int(self._time / WINDOW) + 1)
        ]
        blocks = [
            (unit, block)
            for window in windows
            for unit, found in window.items()
            for block in found
            if begin <= block.first_cycle < end
        ]
        return News([event for event in self._events if begin <= event.cycle < end], blocks=blocks)

    async def ask(self, unit: str, command: str, arguments: Mapping[str, Any], *, user: str) -> Reply:
        raise is_recording(f"{unit}: {command}")

    def jog(self, axis: str, velocity: float, *, user: str) -> None:
        raise is_recording(f"{axis}: jog")

    def note(self, cycle: int, text: str) -> None:
        """Nothing is written."""

    def samples(self, signals: list[Signal], begin: float, end: float, points: int) -> bytes:
        """A frame as of the scope, with the cycles between two samples in place of its stream."""
        columns = {}
        for signal in signals:
            found = self._recording.columns(f"/{signal.unit}/state", signal.field, "cycle", start=begin, end=end)
            columns[signal] = np.asarray(found["cycle"], dtype="<u8"), np.asarray(found[signal.field], dtype="<f4")
        count = min(len(values) for _, values in columns.values())
        step = max(1, -(-count // min(points, MOST_SAMPLES)))
        first = int(next(iter(columns.values()))[0][0]) if count else 0
        picked = [values[:count:step] for _, values in columns.values()]
        head = HEAD.pack(step, first & 0xFFFFFFFF, first >> 32, len(picked), len(picked[0]))
        return head + np.concatenate(picked).tobytes()

    # the file

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
        return [Event(*row) for row in rows]

    def _read_programs(self) -> list[tuple[int, str, Load]]:
        """Cycle, channel, and each program that was loaded."""
        if "/commands" not in self._recording.topics:
            return []
        names = ("cycle", "target", "command", "accepted", "arguments_json")
        columns = self._recording.columns("/commands", *names)
        rows = zip(*(columns[name].tolist() for name in names), strict=True)
        return [
            (cycle, unit, load_of(json.loads(given)))
            for cycle, unit, command, ok, given in rows
            if command == "load" and ok
        ]

    def close(self) -> None:
        self._recording.close()
        for file in self._files:
            file.close()


def is_recording(what: str) -> CncError:
    return CncError(A_RECORDING, f"{what}: this is a recording", NOTHING)
