"""What pages and other programs send to the web face: messages of a socket, and requests of HTTP, in this process."""

from __future__ import annotations

import asyncio
import json
import logging
import random
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any
from unittest.mock import patch

from aiohttp import web_app
from aiohttp.test_utils import TestServer

from bench.fuzzing.engine import Broken, Target
from bench.fuzzing.mutation import VALUES, mutated_bytes, mutated_message, mutated_text
from bench.fuzzing.texts import MILL
from cnc_ptp.catalogue import entry
from cnc_ptp.errors import CncError
from cnc_ptp.web.access.access import Access
from cnc_ptp.web.access.guard import Names
from cnc_ptp.web.faces.machine_face import offline_face
from cnc_ptp.web.hub import Hub
from cnc_ptp.web.numbers import SERVER_FAILED
from cnc_ptp.web.programs.programs import ProgramFolder
from cnc_ptp.web.server import Server
from cnc_ptp.web.session import Session

PATIENCE = 20.0
"""Seconds for the answer to a request that is whole."""
SHORT_PATIENCE = 0.2
"""Seconds for a request that is not whole: the server may wait for its rest."""
NO_ANSWER = 0
"""Stands for the status of an answer that did not come."""
LASTS = 200
"""Messages of a server, then it is made anew."""
MESSAGES: tuple[dict[str, Any], ...] = (
    {"type": "command", "id": 1, "unit": "x", "command": "move_absolute", "arguments": {"target": 10, "velocity": 20}},
    {"type": "command", "id": 1, "unit": "s", "command": "start", "arguments": {"direction": "cw", "speed_rpm": 500}},
    {"type": "command", "id": 1, "unit": "channel", "command": "mdi", "arguments": {"text": "G1 X1 F500"}},
    {
        "type": "command",
        "id": 1,
        "unit": "channel",
        "command": "set_zero_offset",
        "arguments": {"index": 1, "axis": "x", "value": 1.5},
    },
    {"type": "command", "id": 1, "unit": "plc", "command": "acknowledge", "arguments": {"id": 1}},
    {"type": "command", "id": 1, "unit": "y", "command": "couple", "arguments": {"master": "x", "factor": 1.0}},
    {"type": "command", "id": 1, "unit": "x", "command": "reset", "arguments": {}},
    {"type": "jog", "axis": "x", "velocity": 10, "sequence": 1, "time": 0},
    {"type": "jog_stop", "axis": "x"},
    {"type": "take_command", "id": 2, "force": True},
    {"type": "ask_command", "id": 2},
    {"type": "give_command", "id": 2},
    {"type": "acknowledge", "id": 3, "alarm": 1},
    {"type": "load", "id": 4, "channel": "channel", "name": "part.nc", "text": "G0 X1\nM30\n", "dialect": "iso"},
    {"type": "offsets", "id": 5, "channel": "channel"},
    {"type": "scope", "id": 6, "signals": ["x.set_position", "s.actual_speed_rpm"], "bits": 64},
    {"type": "scope_stop", "id": 6},
    {"type": "seek", "id": 7, "time": 1.0},
    {"type": "play", "id": 7, "speed": 2.0},
    {"type": "ping", "id": 8, "time": 5, "round_trip": 3},
    {"type": "identify", "id": 9, "axis": "x", "what": "friction"},
    {"type": "circle", "id": 9, "radius": 5, "feed": 500, "plane": "XY", "feedforward": True},
    {"type": "cancel_task", "id": 9, "task": 1},
    {"type": "accept", "id": 9, "task": 1, "file": "m2.yaml"},
)
WORDS = (
    "x",
    "y",
    "z",
    "s",
    "channel",
    "plc",
    "halt",
    "stop",
    "power",
    "home",
    "x.set_position",
    "part.nc",
    "../x.nc",
    "target",
    "velocity",
    "unit",
    "type",
    "file",
)


class Socket:
    """Stands for the socket of a page; `sent` has what the page would get."""

    def __init__(self) -> None:
        self.sent: list[str | bytes] = []
        self.closed = False

    async def send_str(self, data: str) -> None:
        self.sent.append(data)

    async def send_bytes(self, data: bytes) -> None:
        self.sent.append(data)

    async def close(self, **_options: Any) -> None:
        self.closed = True


class Free:
    """A rate without a limit: what is limited is how much a page may send, not what."""

    def __init__(self, *_limits: float) -> None:
        """As Rate."""

    def permits(self) -> bool:
        return True


class Site:
    """The server with a machine that stands still between messages."""

    def __init__(self, folder: Path) -> None:
        programs = folder / "programs"
        programs.mkdir(exist_ok=True)
        (programs / "part.nc").write_text("G0 X1\nM30\n")
        self.loop = asyncio.new_event_loop()
        self._folder = str(programs)
        self.loop.run_until_complete(self._begin())

    async def _begin(self) -> None:
        self.hub = Hub(lambda: offline_face(str(MILL), stands=True), folder=ProgramFolder(self._folder), name="mill")
        self.access = Access()
        with patch("cnc_ptp.web.data_routes.Rate", Free), patch("cnc_ptp.web.programs.program_routes.Rate", Free):
            self.server = Server(self.hub, self.access, Names())
        self.http = TestServer(self.server.app)
        await self.http.start_server()
        while self.hub.face is None:
            await asyncio.sleep(0.001)
        login = self.access.logins.find(self.access.logins.begin("web", "commissioner"))
        assert login is not None
        self.login, self.socket = login, Socket()
        self.cookie = next(key for key, each in self.access.logins._logins.items() if each is login)
        page: Any = self.socket
        self.session = Session(self.hub, page, self.access, login, number=1)
        self.hub.add(self.session)
        self.hub.right.take(self.session, force=True)

    def close(self) -> None:
        self.hub.sessions.clear()  # the session has no socket that could be closed
        self.loop.run_until_complete(self.http.close())
        self.loop.close()
        web_app._cached_build_middleware.cache_clear()  # it would keep the last servers

    async def settle(self) -> None:
        """Until all that was begun has been answered."""
        while self.hub._kept:
            await asyncio.wait({*self.hub._kept}, timeout=0.05)
            self.hub._tell()
        self.hub._tell()

    def take(self, text: str) -> list[Mapping[str, Any]]:
        """What the page gets for a message."""

        async def taken() -> None:
            self.session._take(text)
            await self.settle()

        self.loop.run_until_complete(taken())
        outgoing = [*self.session._outgoing]
        self.session._outgoing.clear()
        return [json.loads(each) for each in outgoing if isinstance(each, str)]


logging.getLogger("aiohttp.server").setLevel(logging.CRITICAL)


class Sites:
    """The site for the next input, one after another."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._now = Site(folder)

    def next_one(self) -> Site:
        """A new one where a message has ended its machine."""
        if self._now.hub.face is None:
            self.renew()
        return self._now

    def renew(self) -> None:
        self._now.close()
        self._now = Site(self._folder)

    def close(self) -> None:
        self._now.close()


def socket_messages(folder: Path) -> Target:
    """JSON of a page, with other fields, other values, or as no JSON at all."""
    sites = Sites(folder)
    texts = [json.dumps(message) for message in MESSAGES]

    def make(draw: random.Random) -> str:
        kind = draw.random()
        if kind < 0.15:
            return mutated_text(texts, draw)
        message = draw.choice(MESSAGES)
        if message["type"] in ("identify", "circle") and kind < 0.8:
            message = MESSAGES[0]
        if kind < 0.2:
            depth = draw.choice((50, 5000))
            return f'{{"type": "{message["type"]}", "id": {"[" * depth}{"]" * depth}}}'
        return json.dumps(mutated_message(message, draw, WORDS))

    def call(text: str) -> None:
        if begins_task(text):
            return
        got = sites.next_one().take(text)
        refused = [message for message in got if message.get("ok") is False or message["type"] == "error"]
        for message in refused:
            if message["number"] == SERVER_FAILED or entry(message["number"]) is None or not message["text"]:
                raise Broken(f"answer {message}")
        if refused:
            raise CncError(refused[0]["number"], refused[0]["text"])

    return Target(make, call, sites.close, sites.renew, LASTS)


def begins_task(text: str) -> bool:
    """It would start a process: identification, circle test."""
    try:
        return json.loads(text)["type"] in ("identify", "circle")
    except Exception:  # no JSON, no type
        return False


PATHS = (
    *("/", "/api/session", "/api/login", "/api/logout", "/ws", "/static/app.js", "/static/../server.py", "/nothing"),
    *("/api/programs", "/api/programs/part.nc", "/api/programs?name=a.nc&replace=1", "/api/backplot?channel=nothing"),
    *("/api/parameters?unit=x", "/api/curve?spindle=s", "/api/snapshot.mcap?seconds=1"),
    "/api/recorded?signals=x.set_position&from=0&to=1&points=5",
)
HTTP_WORDS = (
    *VALUES,
    "%00",
    "%2F",
    "%2e%2e",
    "../",
    "?",
    "&",
    "=",
    "#",
    "%",
    "%ff",
    "%u0041",
    "//",
    "unit=",
    "x" * 9000,
    "nan",
    "1e999",
)


def http_requests(folder: Path) -> Target:
    """Raw requests over a socket of this computer: path, query, headers and body with changes."""
    sites = Sites(folder)

    def make(draw: random.Random) -> bytes:
        path = draw.choice(PATHS)
        if draw.random() < 0.7:
            path = mutated_text([path], draw, HTTP_WORDS, longest=20_000)
        method = draw.choice(("GET", "GET", "GET", "POST", "POST", "HEAD", "PUT", "DELETE", "OPTIONS", "X", ""))
        body = draw.choice(
            (
                b"",
                b"M30\n",
                b'{"user": "a", "password": "b"}',
                b"\xff\xfe",
                b"{",
                b"[" * 3000,
                b"x" * 100_000,
                b'{"user": 1}',
            )
        )
        headers = {
            "Host": "localhost",
            "Cookie": "cnc_ptp_PORT=COOKIE",
            "X-Token": "TOKEN",
            "Content-Length": str(len(body)),
        }
        if draw.random() < 0.5:
            name = draw.choice(
                [
                    *headers,
                    "Origin",
                    "Authorization",
                    "Range",
                    "If-None-Match",
                    "Content-Encoding",
                    "Transfer-Encoding",
                    "Upgrade",
                ]
            )
            headers[name] = draw.choice(HTTP_WORDS).replace("\n", "")
        head = f"{method} {path.replace(' ', '+')} HTTP/1.1\r\n" + "".join(
            f"{name}: {value}\r\n" for name, value in headers.items()
        )
        data = head.encode("utf-8", "replace") + b"Connection: close\r\n\r\n" + body
        return mutated_bytes(data, draw) if draw.random() < 0.1 else data

    def call(data: bytes) -> None:
        here = sites.next_one()
        cookie = f"cnc_ptp_{here.http.port}={here.cookie}".encode()
        data = data.replace(b"cnc_ptp_PORT=COOKIE", cookie).replace(b"TOKEN", here.login.token.encode())
        status = here.loop.run_until_complete(asked(here, data))
        if status == NO_ANSWER and is_whole(data):
            raise Broken(f"no answer to a whole request within {PATIENCE:g} s, or a connection closed without one")
        if status >= 500:
            raise Broken(f"status {status}")
        if status >= 400:
            raise CncError(26233, f"status {status}")

    return Target(make, call, sites.close, sites.renew, LASTS)


def is_whole(data: bytes) -> bool:
    """Its headers have an end, and its body is not shorter than they say."""
    head, end, body = data.partition(b"\r\n\r\n")
    lengths = [int(digits) for digits in LENGTH.findall(head)]
    return bool(end) and max(lengths, default=0) <= len(body) and b"chunked" not in head.lower()


LENGTH = re.compile(rb"(?i)\bcontent-length\s*:\s*([0-9]{1,18})")


async def asked(here: Site, data: bytes) -> int:
    """The status of the answer, which was read to the end of its headers, and to its own end if the server closes."""
    reader, writer = await asyncio.open_connection("127.0.0.1", here.http.port)
    try:
        async with asyncio.timeout(PATIENCE if is_whole(data) else SHORT_PATIENCE):
            writer.write(data)
            head = await reader.readuntil(b"\r\n\r\n")
            if b"connection: close" in head.lower():
                await reader.read()
    except (OSError, TimeoutError, asyncio.IncompleteReadError):
        return NO_ANSWER
    finally:
        writer.close()
    return int(head.split()[1])
