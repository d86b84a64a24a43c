"""The application: routes, static files, the socket of the pages."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from itertools import count
from typing import Any

from aiohttp import WSCloseCode, WSMsgType, web

from cnc_ptp.errors import CncError
from cnc_ptp.web.access.access import Access, cookie_name
from cnc_ptp.web.access.guard import Names, make_guard
from cnc_ptp.web.access.logins import Login
from cnc_ptp.web.data_routes import DataRoutes, Words
from cnc_ptp.web.hub import Hub
from cnc_ptp.web.numbers import BAD_MESSAGE, TOO_MANY_SESSIONS
from cnc_ptp.web.page_socket import PageSocket
from cnc_ptp.web.programs.program_routes import ProgramRoutes
from cnc_ptp.web.protocol import LARGEST_MESSAGE, NOTHING, error_fields, field, frame, read_body, read_message
from cnc_ptp.web.session import Session
from cnc_ptp.web.static_files import StaticFiles

MOST_SESSIONS = 50
MOST_OF_USER = 20
"""Pages of one user, so that nobody takes the places of all."""
FIRST_MESSAGE = 5.0
"""Seconds within which a page says who it is."""
SILENCE = 20.0
"""Seconds without an answer to a ping of the socket after which a page is gone."""
NUMBERS = count(1)
"""Of pages."""


def no_words(_dialect: str) -> Sequence[tuple[str, str]]:
    return ()


class Server:
    """Routes of one machine; `app` is what aiohttp runs."""

    def __init__(self, hub: Hub, access: Access, names: Names, *, words: Words = no_words) -> None:
        """`words` that MDI completes."""
        self.hub, self.access = hub, access
        self._places: Counter[str] = Counter()
        """User -> pages that are open, or have not said hello yet."""
        self._static = StaticFiles()
        self.app = web.Application(middlewares=[make_guard(names)], client_max_size=LARGEST_MESSAGE)
        self.app.on_startup.append(self._begin)
        self.app.on_shutdown.append(self._end)
        self.app.router.add_get("/", self._index)
        self.app.router.add_get("/api/session", self._session)
        self.app.router.add_post("/api/login", self._log_in)
        self.app.router.add_post("/api/logout", self._log_out)
        self.app.router.add_get("/ws", self._socket)
        self.app.router.add_get("/static/{name:.+}", self._static.serve)
        ProgramRoutes(hub, access).add_to(self.app)
        DataRoutes(hub, access, words).add_to(self.app)

    async def _begin(self, _app: web.Application) -> None:
        self.hub.begin()

    async def _end(self, _app: web.Application) -> None:
        await self.hub.end()

    async def _index(self, request: web.Request) -> web.StreamResponse:
        response = self._static.response(request, "index.html")
        key = self.access.welcome(request)
        if key is not None:
            self.access.remember(request, response, key)
        return response

    async def _session(self, request: web.Request) -> web.StreamResponse:
        """Who the page is, and its token; 401 where a login is needed."""
        key = self.access.welcome(request)  # of a server that has begun again, or a browser without its cookie
        login = self.access.login_of(request) if key is None else self.access.logins.find(key)
        assert login is not None
        fields = {"user": login.user, "role": login.role, "token": login.token, "login": self.access.needs_login}
        response = web.json_response(fields, headers={"Cache-Control": "no-store"})
        if key is not None:
            self.access.remember(request, response, key)
        return response

    async def _log_in(self, request: web.Request) -> web.StreamResponse:
        """{"user": …, "password": …}"""
        message = {"type": "login", **read_body(await request.read())}
        user, password = field(message, "user", "text"), field(message, "password", "text")
        key = await self.access.log_in(user, password, request.remote or "")
        response = web.json_response({"user": user})
        self.access.remember(request, response, key)
        return response

    async def _log_out(self, request: web.Request) -> web.StreamResponse:
        self.access.require_page(request)
        self.access.log_out(request)
        response = web.json_response({})
        response.del_cookie(cookie_name(request))
        return response

    async def _socket(self, request: web.Request) -> web.StreamResponse:
        login = self.access.login_of(request)
        with self._place(login):
            socket = PageSocket(request, heartbeat=SILENCE)
            await socket.prepare(request)
            if await self._is_own_page(socket, login):
                session = Session(self.hub, socket, self.access, login, number=next(NUMBERS))
                self.hub.add(session)
                try:
                    await session.run()
                finally:
                    self.hub.remove(session)
        return socket

    @contextmanager
    def _place(self, login: Login) -> Iterator[None]:
        """That of a page, from before its socket is there until it has ended. Raises CncError 26245."""
        if self._places[login.user] >= MOST_OF_USER and self.access.needs_login:
            reason = f"the limit of open pages of {login.user} is reached, {MOST_OF_USER}"
            raise CncError(TOO_MANY_SESSIONS, reason, f"{NOTHING}; close one")
        if self._places.total() >= MOST_SESSIONS:
            reason = f"the limit of open pages is reached, {MOST_SESSIONS}"
            raise CncError(TOO_MANY_SESSIONS, reason, f"{NOTHING}; close one")
        self._places[login.user] += 1
        login.pages += 1
        try:
            yield
        finally:
            self._places[login.user] -= 1
            login.pages -= 1

    async def _is_own_page(self, socket: web.WebSocketResponse, login: Login) -> bool:
        """Its first message is `hello` with its token; others get the reason why they are not wanted."""
        try:
            first: Any = await socket.receive(FIRST_MESSAGE)
            message = read_message(first.data if first.type is WSMsgType.TEXT else "")
            if message["type"] != "hello":
                raise CncError(BAD_MESSAGE, "the first message is not hello", NOTHING)
            self.access.require_token(login, field(message, "token", "text"))
        except TimeoutError:
            error = CncError(BAD_MESSAGE, f"no hello within {FIRST_MESSAGE:g} s", NOTHING)
        except CncError as refused:
            error = refused
        else:
            return True
        if not socket.closed:
            await socket.send_str(frame({"type": "error", **error_fields(error)}))
            await socket.close(code=WSCloseCode.POLICY_VIOLATION)
        return False
