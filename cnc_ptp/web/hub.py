"""The machine and all pages that look at it: what has come goes to all of them."""

from __future__ import annotations

import asyncio
import contextlib
import json
import traceback
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, fields
from typing import Any

from cnc_ptp.client.faults import GONE
from cnc_ptp.errors import CncError
from cnc_ptp.protocol.blocks import ChannelBlock, CommandRecord, CycleBlock, Event, HandshakeRequest
from cnc_ptp.web.access.command_right import CommandRight
from cnc_ptp.web.commissioning.tasks import Tasks
from cnc_ptp.web.faces.alarms import Alarms, event_fields
from cnc_ptp.web.faces.face import Face, State
from cnc_ptp.web.faces.offset_table import OffsetTable
from cnc_ptp.web.faces.program_watch import ProgramWatch
from cnc_ptp.web.faces.switches import Switches
from cnc_ptp.web.faces.targets import Targets
from cnc_ptp.web.numbers import NO_MACHINE_YET
from cnc_ptp.web.programs.drawing_office import DrawingOffice
from cnc_ptp.web.programs.programs import ProgramFolder
from cnc_ptp.web.protocol import VERSION, difference, error_fields
from cnc_ptp.web.session import Session

PERIOD = 0.04
"""Seconds between two states: 25 a second, so that it is more than 20 on a busy computer too."""
AGAIN = 1.0
"""Seconds until a machine that was not found is looked for again."""
LOGINS_PERIOD = 0.5
"""Seconds between two looks at whether the logins of pages have ended."""
WAITING = CncError(NO_MACHINE_YET, "no machine runs", "the page is filled as soon as there is one")


class Hub:
    """Keeps the face of a machine, looks for it again when it is gone, and tells the sessions what has come."""

    def __init__(
        self, connect: Callable[[], Face], *, folder: ProgramFolder, name: str = "", machine_file: str | None = None
    ) -> None:
        """`connect` may block; it raises CncError while there is no machine. `name`: what pages call the machine."""
        self._connect = connect
        self._name = name
        self.folder = folder
        self.programs = ProgramWatch(folder)
        self.office = DrawingOffice()
        self.tasks = Tasks(machine_file)
        self._kept: set[asyncio.Task[None]] = set()
        self.face: Face | None = None
        self.sessions: list[Session] = []
        self.right = CommandRight()
        self.alarms = Alarms()
        self.handshakes: dict[int, dict[str, Any]] = {}
        self.tables: dict[str, OffsetTable] = {}
        self._switches = Switches()
        self.targets = Targets([])
        self.offsets: dict[str, dict[str, Any]] = {}
        """Channel -> what lies between programmed and machine positions."""
        self._state: State = {}
        self.why_none = WAITING
        """Why there is no machine now."""
        self._tasks: list[asyncio.Task[None]] = []

    # its life

    def begin(self) -> None:
        self._tasks = [asyncio.create_task(self._live()), asyncio.create_task(self._watch_logins())]

    async def end(self) -> None:
        """All sessions end; their jogs too."""
        for session in [*self.sessions]:
            await session.close()
        for task in self._tasks:
            task.cancel()
            with contextlib.suppress(asyncio.CancelledError):
                await task
        self.office.close()
        self.tasks.close()
        if self.face is not None:
            await asyncio.to_thread(self.face.close)
            self.face = None

    async def _watch_logins(self) -> None:
        while True:
            await asyncio.sleep(LOGINS_PERIOD)
            for session in [*self.sessions]:
                session.end_without_login()

    async def _live(self) -> None:
        while True:
            try:
                face = await asyncio.to_thread(self._connect)
                await self._live_with(face)
            except CncError as error:
                self.why_none = error
                await asyncio.sleep(AGAIN)
            except Exception as error:  # a mistake of ours: pages get a message, and it is tried again
                traceback.print_exc()
                self.face, self.why_none = None, server_failed(error)
                await asyncio.sleep(AGAIN)

    async def _live_with(self, face: Face) -> None:
        self.face, self._state, self.alarms = face, {}, Alarms()
        self.handshakes.clear()
        self.programs.forget(is_recording=face.is_recording)
        self.offsets.clear()
        self._switches = Switches()
        self.targets = Targets([unit for unit, kind in face.kinds.items() if kind == "axis"])
        channels = [unit for unit, kind in face.kinds.items() if kind == "channel"]
        self.tables = {unit: OffsetTable(face.sets[unit], face.sets) for unit in channels}
        for session in self.sessions:
            session.send({"type": "back"})
            session.send(self.hello(session))
        running = asyncio.create_task(face.run())
        try:
            while not running.done():
                await asyncio.sleep(PERIOD)
                self.tell(face)
            running.result()
        except CncError as error:
            self._tell_gone(error)
            await asyncio.to_thread(face.close)
        except Exception as error:  # a mistake of ours must not leave pages that show the past
            traceback.print_exc()
            self._tell_gone(server_failed(error))
            await asyncio.to_thread(face.close)
        finally:
            running.cancel()

    def _tell_gone(self, error: CncError) -> None:
        self.face, self.why_none = None, error
        self.to_all({"type": "gone", **error_fields(error)})

    # what goes to pages

    def hello(self, session: Session) -> dict[str, Any]:
        """The first message to a page, and another one when a machine has come."""
        shared = {"type": "hello", "version": VERSION, "user": session.user, "role": session.role}
        shared["page"] = session.number
        if self.face is None:
            return {**shared, "machine": None, "operator": self.right.shown(), "why": error_fields(self.why_none)}
        session.is_behind = True
        return {
            **shared,
            "machine": {"name": self._name, "recording": self.face.is_recording, **self.face.machine()},
            "operator": self.right.shown(),
            "alarms": self.alarms.list(),
            "handshakes": [*self.handshakes.values()],
            "programs": self.programs.all(),
            "offsets": self.offsets,
        }

    def tell(self, face: Face) -> None:
        """What has come since the last time, to all pages."""
        news = face.news()
        for event in news.events:
            self._tell_event(event, face.cycle_time)
        for request in news.requests:
            self._tell_request(request)
        for record in news.records:
            self._tell_answered(record, news.blocks)
        for unit, block in news.blocks:
            if isinstance(block, ChannelBlock):
                self._tell_offsets(unit, block)
                self._drop_handshakes(unit, block)
        if news.diagnostics:
            self.to_all({"type": "diagnostics", "nodes": [*news.diagnostics]})
        state = {
            unit: {**fields, **self._switches.fields.get(unit, {}), **self.targets.fields(unit)}
            for unit, fields in face.state().items()
        }
        changes = difference(state, self._state)
        self._state = state
        self._tell_programs(face, changes)
        for session in [*self.sessions]:
            session.send_state(face.time, state, changes)
            session.take_blocks(news.blocks)

    def _tell_programs(self, face: Face, changes: State) -> None:
        self.programs.take_state(changes, face.loads())
        for program in self.programs.news():
            if self.sessions:
                self.office.prepare()
            self.to_all({"type": "program", **program})

    def _tell_event(self, event: Event, cycle_time: float) -> None:
        fields = event_fields(event, cycle_time)
        alarm = self.alarms.take(fields)
        self.to_all({"type": "event", **(alarm or fields)})

    def _tell_request(self, request: HandshakeRequest) -> None:
        self._switches.take_request(request)
        if request.acknowledge_needed:
            self.handshakes[request.id] = request_fields(request)
            self.to_all({"type": "handshake", **request_fields(request)})

    def _tell_answered(self, record: CommandRecord, blocks: Sequence[tuple[str, CycleBlock]]) -> None:
        """A request that was acknowledged, an offset that was changed, by whomever."""
        self._switches.take_record(record)
        self.targets.take_record(record, blocks, self._state)
        self.programs.take_record(record)
        if record.target in self.tables:
            self.tables[record.target].take_record(record)
        if record.command == "acknowledge" and record.accepted:
            self._end_handshake(json.loads(record.arguments_json).get("id"))

    def _end_handshake(self, number: int) -> None:
        if self.handshakes.pop(number, None) is not None:
            self.to_all({"type": "handshake_done", "id": number})

    def _drop_handshakes(self, channel: str, block: ChannelBlock) -> None:
        """Those of a program that has ended, or was reset: nobody waits for them."""
        if block.done:
            for number, request in [*self.handshakes.items()]:
                if request["channel"] == channel and request["cycle"] < block.first_cycle:
                    self._end_handshake(number)

    def _tell_offsets(self, channel: str, block: ChannelBlock) -> None:
        for offsets in block.offsets:
            self.tables[channel].take_active(offsets)
            self.offsets[channel] = {"channel": channel, **asdict(offsets)}
            self.to_all({"type": "offsets", **self.offsets[channel]})

    def to_all(self, message: Mapping[str, Any]) -> None:
        for session in self.sessions:
            session.send(message)

    def note(self, text: str) -> None:
        """For the recording: who has done what besides commands."""
        if self.face is not None:
            self.face.note(round(self.face.time / self.face.cycle_time), text)

    def tell_operator(self) -> None:
        self.to_all({"type": "operator", **self.right.shown()})

    # sessions

    def add(self, session: Session) -> None:
        self.sessions.append(session)
        session.send(self.hello(session))

    def remove(self, session: Session) -> None:
        if session in self.sessions:
            self.sessions.remove(session)
        if self.right.leave(session):
            self.tell_operator()

    def keep(self, task: asyncio.Task[None]) -> None:
        """Until its end."""
        self._kept.add(task)
        task.add_done_callback(self._kept.discard)

    def require_face(self) -> Face:
        """Raises CncError 26171 or 26244 while there is no machine."""
        if self.face is None:
            number = GONE if self.why_none.number == GONE else NO_MACHINE_YET
            raise CncError(number, self.why_none.reason, "nothing was sent")
        return self.face


def server_failed(error: Exception) -> CncError:
    return CncError(GONE, f"the server has failed: {error!r}", "the machine continues")


def request_fields(request: HandshakeRequest) -> dict[str, Any]:
    return {each.name: getattr(request, each.name) for each in fields(HandshakeRequest)}
