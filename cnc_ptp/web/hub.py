"""The machine and all pages that look at it: what has come goes to all of them."""

from __future__ import annotations

import asyncio
import contextlib
import traceback
from collections.abc import Callable, Mapping
from typing import Any

from cnc_ptp.client.faults import GONE
from cnc_ptp.errors import CncError
from cnc_ptp.web.access.command_right import CommandRight
from cnc_ptp.web.commissioning.tasks import Tasks
from cnc_ptp.web.faces.face import Face
from cnc_ptp.web.faces.program_watch import ProgramWatch
from cnc_ptp.web.numbers import NO_MACHINE_YET
from cnc_ptp.web.programs.drawing_office import DrawingOffice
from cnc_ptp.web.programs.programs import ProgramFolder
from cnc_ptp.web.protocol import VERSION, error_fields
from cnc_ptp.web.session import Session
from cnc_ptp.web.view import View

PERIOD = 0.04
"""Seconds between two states: 25 a second, so that it is more than 20 on a busy computer too."""
AGAIN = 1.0
"""Seconds until a machine that was not found is looked for again."""
FAREWELL = 1.0
"""Seconds in which pages take the end of their server."""
LOGINS_PERIOD = 0.5
"""Seconds between two looks at whether the logins of pages have ended."""
WAITING = CncError(NO_MACHINE_YET, "no machine is found", "the page is filled as soon as there is one")


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
        """Of the machine that runs; of a recording those that it has loaded in the end."""
        self.office = DrawingOffice()
        self.tasks = Tasks(machine_file)
        self._kept: set[asyncio.Task[None]] = set()
        self.face: Face | None = None
        self.sessions: list[Session] = []
        self.right = CommandRight()
        self.shared: View | None = None
        """Of all pages of a machine that runs."""
        self._views: list[View] = []
        self.why_none = WAITING
        """Why there is no machine now."""
        self._tasks: list[asyncio.Task[None]] = []

    # its life

    def begin(self) -> None:
        self._tasks = [asyncio.create_task(self._live()), asyncio.create_task(self._watch_logins())]

    async def end(self) -> None:
        """All sessions end; their jogs first, as a page that takes nothing holds up its farewell."""
        sessions = [*self.sessions]
        for session in sessions:
            session.end_jogs()
        await asyncio.gather(*(session.close(patience=FAREWELL) for session in sessions))
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
                self.face, self.why_none = None, self._failed(error)
                await asyncio.sleep(AGAIN)

    async def _live_with(self, face: Face) -> None:
        """Until its machine is gone, or cannot be shown; raises why, when pages and face know it."""
        running = asyncio.create_task(face.run())
        try:
            self._begin_with(face)
            while not running.done():
                await asyncio.sleep(PERIOD)
                self._tell()
            running.result()
        except Exception as error:  # also a mistake of ours must not leave pages that show the past
            self._tell_gone(error if isinstance(error, CncError) else self._failed(error))
            await asyncio.to_thread(face.close)
            raise
        finally:
            running.cancel()

    def _begin_with(self, face: Face) -> None:
        self.face, self._views = face, []
        self.programs = ProgramWatch(self.folder, is_recording=face.is_recording)
        self.programs.take_state({}, face.last_loads())
        self.shared = None if face.is_recording else self._view(face, self.programs)
        for session in self.sessions:
            self._show(session, face)
            session.send({"type": "back"})
            session.send(self.hello(session))

    def _failed(self, error: Exception) -> CncError:
        continues = "the recording is opened again" if self.programs.is_recording else "the machine continues"
        return CncError(GONE, f"the server has failed: {error!r}", continues)

    def _tell_gone(self, error: CncError) -> None:
        self.face, self.why_none = None, error
        self.to_all({"type": "gone", **error_fields(error)})

    # what goes to pages

    def _view(self, face: Face, programs: ProgramWatch) -> View:
        view = View(face, programs)
        self._views.append(view)
        return view

    def _show(self, session: Session, face: Face) -> None:
        """A page sees a machine; of a recording at a time of its own."""
        self._hide(session)
        if self.shared is None:
            session.view = self._view(face.for_page(), ProgramWatch(self.folder, is_recording=True))
        else:
            session.view = self.shared
        session.view.pages.append(session)

    def _hide(self, session: Session) -> None:
        view = session.view
        if view is not None and session in view.pages:
            view.pages.remove(session)
            if view.face.is_recording:
                self._views = [each for each in self._views if each is not view]
                view.face.close()

    def hello(self, session: Session) -> dict[str, Any]:
        """The first message to a page, and another one when a machine has come."""
        shared = {"type": "hello", "version": VERSION, "user": session.user, "role": session.role}
        shared["page"] = session.number
        if self.face is None or session.view is None:
            return {**shared, "machine": None, "operator": self.right.shown(), "why": error_fields(self.why_none)}
        session.is_behind = True
        return {
            **shared,
            "machine": {"name": self._name, "recording": self.face.is_recording, **self.face.machine()},
            "operator": self.right.shown(),
            **session.view.known(),
        }

    def _tell(self) -> None:
        """What has come since the last time, to all pages."""
        for view in [*self._views]:
            if view.tell() and self.sessions:
                self.office.prepare()

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
        if self.face is not None:
            self._show(session, self.face)
        session.send(self.hello(session))

    def remove(self, session: Session) -> None:
        if session in self.sessions:
            self.sessions.remove(session)
            self._hide(session)
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
