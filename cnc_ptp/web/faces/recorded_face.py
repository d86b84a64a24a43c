"""A recording as a page sees it: played, or looked at anywhere; each page has a time of its own."""

from __future__ import annotations

import asyncio
from bisect import bisect_right
from collections.abc import Callable, Iterator, Mapping
from math import inf
from operator import attrgetter
from typing import Any

from cnc_ptp.client.link import Reply
from cnc_ptp.errors import CncError
from cnc_ptp.protocol.blocks import CycleBlock, Event
from cnc_ptp.web.faces.description import describe_commands
from cnc_ptp.web.faces.face import Face, News, Past, State, nothing
from cnc_ptp.web.faces.program_watch import Load
from cnc_ptp.web.faces.recorded_file import WINDOW, NodeReport, RecordedFile, Window
from cnc_ptp.web.faces.scope import signals_of
from cnc_ptp.web.faces.unit_fields import unit_states
from cnc_ptp.web.numbers import A_RECORDING
from cnc_ptp.web.protocol import NOTHING

STEP = 0.02
"""Seconds between two steps of the time that is played."""
FIRST_CYCLE, CYCLE = attrgetter("first_cycle"), attrgetter("cycle")
NEAR = 1e-3
"""Of a cycle: a time in s may be off by rounding."""
FASTEST = 100.0
"""Seconds of a recording in a second."""


class RecordedFace(Face):
    """Its time stands until its page plays it or looks at another one."""

    is_recording = True

    def __init__(self, file: RecordedFile, faces: list[RecordedFace]) -> None:
        """`faces`: all that look at the file, this one too; the last one that ends closes it."""
        self.file = file
        self._faces = faces
        faces.append(self)
        self.kinds, self.sets, self.cycle_time, self.end = file.kinds, file.sets, file.cycle_time, file.end
        self.machine_set = file.parameters.sets["machine"]
        self._windows: dict[int, Window] = {0: file.first}
        self._time = self._told = 0.0
        self._speed = 0.0
        self._is_elsewhere = True
        """Its page knows nothing of this time yet."""
        self._shown: tuple[float, dict[str, Load], State] | None = None
        """Time, programs and state of the last look: most pages of a recording stand."""
        self._turn = asyncio.Lock()

    def for_page(self) -> RecordedFace:
        return RecordedFace(self.file, self._faces)

    def machine(self) -> dict[str, Any]:
        units = self.file.units
        return {
            "units": units,
            "commands": describe_commands(),
            "signals": signals_of(self.kinds, {unit["name"]: unit.get("unit", "mm") for unit in units}),
            "cycle_time": self.cycle_time,
            "block_cycles": self.file.parameters.block_cycles,
            "start": 0.0,
            "end": self.end,
        }

    # time

    @property
    def time(self) -> float:
        return self._time

    async def seek(self, time: float) -> None:
        """Another time, within the recording; of several the last one that was asked for."""
        wanted = min(max(0.0, time), self.end)
        async with self._turn:
            await self._have(wanted)
            self._jump(wanted)

    def play(self, speed: float) -> None:
        """Seconds of the recording in a second; 0 stops it."""
        self._speed = min(max(0.0, speed), FASTEST)
        if self._speed and self._time >= self.end:
            self._jump(0.0)
            self._windows[0] = self.file.first

    def _jump(self, time: float) -> None:
        self._time = self._told = time
        self._is_elsewhere = True

    async def run(self) -> None:
        """Plays the faces of all pages."""
        loop = asyncio.get_running_loop()
        before = loop.time()
        while True:
            await asyncio.sleep(STEP)
            now = loop.time()
            for face in [*self._faces]:
                await face._play_on(now - before)
            before = now

    async def _play_on(self, seconds: float) -> None:
        if self._speed == 0.0 or self._turn.locked():
            return  # its page looks elsewhere, and continues from there
        async with self._turn:
            wanted = min(self.end, self._time + self._speed * seconds)
            await self._have(wanted)
            self._time = wanted
            if wanted >= self.end:
                self._speed = 0.0

    async def _have(self, time: float) -> None:
        """The windows around a time are there; those that nobody looks at again are left."""
        number, told = int(time / WINDOW), int(self._told / WINDOW)
        around = range(max(0, number - 1), number + 2)
        for needed in around:
            if needed not in self._windows and needed * WINDOW <= self.end:
                self._windows[needed] = await self.file.window(needed)
        kept = {int(self._time / WINDOW), *around, *range(told, number)}
        self._windows = {each: window for each, window in self._windows.items() if each in kept}

    # what its page sees

    def state(self) -> State:
        """Of the last block that has ended by now."""
        return self._look()[1]

    def loads(self) -> dict[str, Load]:
        return self._look()[0]

    def _look(self) -> tuple[dict[str, Load], State]:
        if self._shown is None or self._shown[0] != self._time:
            loads = self._loads_until(self._time / self.cycle_time)
            self._shown = self._time, loads, self._state_with(loads)
        return self._shown[1:]

    def _state_with(self, loads: Mapping[str, Load]) -> State:
        blocks = {unit: block for unit in self.kinds if (block := self._block_at(unit)) is not None}
        states = unit_states(blocks)
        for channel, load in loads.items():
            if channel in states:
                states[channel]["program"] = load.path
        return states

    def _block_at(self, unit: str) -> CycleBlock | None:
        window = self._windows.get(int(self._time / WINDOW))
        blocks = window.blocks[unit] if window else []
        if not blocks:
            return None
        after = bisect_right(blocks, round(self._time / self.cycle_time), key=FIRST_CYCLE)
        return blocks[max(0, after - 1)]

    def last_loads(self) -> dict[str, Load]:
        return self._loads_until(inf)

    def _loads_until(self, cycle: float) -> dict[str, Load]:
        until = bisect_right(self.file.programs, cycle, key=lambda program: program[0])
        return {channel: load for _, channel, load in self.file.programs[:until]}

    def past(self) -> Past | None:
        if not self._is_elsewhere:
            return None
        self._is_elsewhere, self._told = False, self._time
        until = self._time / self.cycle_time + self.file.parameters.block_cycles  # those of a block come with its begin
        offsets = bisect_right(self.file.offsets, until, key=lambda each: each[1].cycle)
        lately = (int(self._time / WINDOW) - 1) * WINDOW  # each node tells once a second
        last = {report.fields["name"]: report.fields for report in self._reports(lately, self._time)}
        return Past(self.file.events[: self._events_by(self._time)], self.file.offsets[:offsets], [*last.values()])

    def news(self) -> News:
        begin, end = self._told, self._time
        self._told = self._time
        if end <= begin:
            return News()
        events = self.file.events[self._events_by(begin) : self._events_by(end)]
        diagnostics = [report.fields for report in self._reports(begin, end)]
        return News(events, blocks=[*self._blocks(begin, end)], diagnostics=diagnostics)

    def _events_by(self, time: float) -> int:
        """How many events have come by a time; at the end all, though its last digits be lost."""
        if time >= self.end:
            return len(self.file.events)
        return bisect_right(self.file.events, time / self.cycle_time + NEAR, key=CYCLE)

    def _reports(self, begin: float, end: float) -> Iterator[NodeReport]:
        """Of the windows that are there, behind `begin` and up to `end`."""
        for _, window in sorted(self._windows.items()):
            yield from (report for report in window.reports if begin < report.time <= end)

    def _blocks(self, begin: float, end: float) -> Iterator[tuple[str, CycleBlock]]:
        """Those that begin in that time."""
        first, behind = begin / self.cycle_time, end / self.cycle_time
        for number in range(int(begin / WINDOW), int(end / WINDOW) + 1):
            blocks = self._windows[number].blocks if number in self._windows else {}
            for unit, found in blocks.items():
                yield from ((unit, block) for block in found if first <= block.first_cycle < behind)

    async def ask(
        self, unit: str, command: str, arguments: Mapping[str, Any], *, user: str, require: Callable[[], None] = nothing
    ) -> Reply:
        raise is_recording(f"{unit}: {command}")

    async def snapshot(self, file: str, seconds: float, until: float) -> int:
        raise is_recording("snapshot")

    def jog(self, axis: str, velocity: float, *, user: str) -> None:
        raise is_recording(f"{axis}: jog")

    def publish(self, event: Event) -> None:
        """Nothing is written."""

    def close(self) -> None:
        if self in self._faces:
            self._faces.remove(self)
            if not self._faces:
                self.file.close()


def recorded_face(path: str) -> RecordedFace:
    """Raises CncError 26001 to 26003, 26005, 26011."""
    return RecordedFace(RecordedFile(path), [])


def is_recording(what: str) -> CncError:
    return CncError(A_RECORDING, f"{what}: this is a recording", NOTHING)
