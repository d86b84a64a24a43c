"""Programs over HTTP: the list, their texts, uploads."""

from __future__ import annotations

import asyncio
from dataclasses import replace

from aiohttp import web

from cnc_ptp.errors import CncError
from cnc_ptp.web.access.access import Access
from cnc_ptp.web.access.guard import refuse
from cnc_ptp.web.access.logins import Login
from cnc_ptp.web.access.rights import require_role
from cnc_ptp.web.faces.program_watch import ProgramWatch
from cnc_ptp.web.hub import Hub
from cnc_ptp.web.numbers import NO_COMMAND_RIGHT, PROGRAM_EXISTS, TOO_LARGE, TOO_MANY_MESSAGES
from cnc_ptp.web.programs.backplot import Drawing
from cnc_ptp.web.programs.programs import SUFFIXES, require_name
from cnc_ptp.web.rate import Rate
from cnc_ptp.web.view import View

PLAIN = "text/plain"
MOST_UPLOADS = 4
"""At once: each is in memory until it is whole."""
NOT_WRITTEN = "nothing was written"


class ProgramRoutes:
    """/api/programs"""

    def __init__(self, hub: Hub, access: Access) -> None:
        self._hub, self._access = hub, access
        self._rate = Rate(1.0, 20.0)
        self._uploads = 0
        self._drawings = Rate(10.0, 100.0)

    def add_to(self, app: web.Application) -> None:
        app.router.add_get("/api/programs", self._list)
        app.router.add_post("/api/programs", self._upload)
        app.router.add_get("/api/programs/{name}", self._text)
        app.router.add_get("/api/backplot", self._backplot)

    async def _list(self, request: web.Request) -> web.StreamResponse:
        self._access.login_of(request)
        folder = self._hub.folder
        programs = await asyncio.to_thread(folder.list)
        return web.json_response({"programs": programs, "limit": folder.largest, "endings": [*SUFFIXES]})

    async def _text(self, request: web.Request) -> web.StreamResponse:
        """Always as plain text: what is in a program is never taken for a page."""
        self._access.login_of(request)
        name, channel = request.match_info["name"], request.query.get("channel", "")
        text = await asyncio.to_thread(self._programs(request).text, name, channel)
        return web.Response(text=text, content_type=PLAIN, charset="utf-8", headers={"Cache-Control": "no-store"})

    async def _upload(self, request: web.Request) -> web.StreamResponse:
        """`?name=N`, and `&replace=1` for one that is there; the body is the program."""
        login = self._access.require_page(request)
        require_role("upload", login.user, login.role, "operator")
        if not self._rate.permits():
            raise CncError(TOO_MANY_MESSAGES, "upload: too many programs in a short time", f"{NOT_WRITTEN}; wait")
        name = request.query.get("name", "")
        require_name(name)
        replace = request.query.get("replace") == "1"
        if replace:
            self._require_command(login, name)
        if self._uploads >= MOST_UPLOADS:
            raise CncError(TOO_MANY_MESSAGES, f"upload: {MOST_UPLOADS} others are on their way", NOT_WRITTEN)
        self._uploads += 1
        try:
            content = await self._content(request)
            listed = await asyncio.to_thread(self._hub.folder.save, name, content, replace=replace)
        except CncError as error:
            if error.number == TOO_LARGE:
                request.protocol.close()  # the rest is not even read
            return refuse(error, {TOO_LARGE: 413, PROGRAM_EXISTS: 409}.get(error.number, 400))
        finally:
            self._uploads -= 1
        self._hub.note(f"{login.user}: program {name} {'replaced' if replace else 'uploaded'}, {listed.size} bytes")
        self._hub.to_all({"type": "programs"})
        return web.json_response(listed._asdict())

    def _require_command(self, login: Login, name: str) -> None:
        """A program may be replaced while it is loaded: by whoever commands. Raises CncError 26236."""
        holder = self._hub.right.holder
        if not any(session is holder and session.login.is_of(login) for session in self._hub.sessions):
            reason = f"upload: '{name}' is replaced only by a page that holds the command"
            raise CncError(NO_COMMAND_RIGHT, reason, NOT_WRITTEN)

    async def _backplot(self, request: web.Request) -> web.StreamResponse:
        """`?channel=C`: the path of its program (backplot.py says in which form), `&page=N`: as that page sees it."""
        self._access.login_of(request)
        face = self._hub.require_face()
        channel = request.query.get("channel", "channel")
        face.require_kind(channel, "channel")
        if not self._drawings.permits():
            raise CncError(TOO_MANY_MESSAGES, "backplot: too many requests in a short time", "nothing was read; wait")
        load = await asyncio.to_thread(self._programs(request).loaded_text, channel)
        files = load.files if load.files or face.is_recording else None
        drawing = Drawing(channel, face.kinds, face.sets, face.cycle_time, load.text or "", load.path, files=files)
        if (view := self._view(request)) is not None:
            table = view.tables[channel]
            drawing = replace(drawing, changes=table.changes, clamp_index=table.clamp_index)
        points = await self._hub.office.draw(drawing, replaces=not face.is_recording)
        headers = {"Cache-Control": "no-store"}
        response = web.Response(body=points, content_type="application/octet-stream", headers=headers)
        response.enable_compression()
        return response

    def _view(self, request: web.Request) -> View | None:
        """That of the page `?page=N`: of a recording, each is at another time; a recording has none without it."""
        number = request.query.get("page", "")
        for session in self._hub.sessions:
            if str(session.number) == number and session.view is not None:
                return session.view
        return self._hub.shared

    def _programs(self, request: web.Request) -> ProgramWatch:
        """Those of its page; without one the last ones."""
        view = self._view(request)
        return self._hub.programs if view is None else view.programs

    async def _content(self, request: web.Request) -> bytes:
        """Refused as soon as it is known to be too large."""
        folder = self._hub.folder
        folder.require_size(request.content_length or 0)
        content = bytearray()
        async for part in request.content.iter_chunked(1 << 16):
            content += part
            folder.require_size(len(content))
        return bytes(content)
