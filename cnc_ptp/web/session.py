"""One page: its messages, its rights, what it gets."""

from __future__ import annotations

import asyncio
import traceback
from collections import deque
from collections.abc import Mapping, Sequence
from contextlib import suppress
from typing import Any

from aiohttp import WSCloseCode, WSMsgType

from cnc_ptp.errors import CncError
from cnc_ptp.protocol.blocks import CycleBlock
from cnc_ptp.web.access.access import Access
from cnc_ptp.web.access.logins import Login
from cnc_ptp.web.faces.face import State
from cnc_ptp.web.faces.scope import Stream
from cnc_ptp.web.numbers import SERVER_FAILED, SESSION_ENDED, TOO_MANY_MESSAGES
from cnc_ptp.web.page import Shared
from cnc_ptp.web.page_messages import PageMessages
from cnc_ptp.web.page_socket import PageSocket
from cnc_ptp.web.protocol import Message, error_fields, frame, read_message, refusal
from cnc_ptp.web.rate import Rate
from cnc_ptp.web.view import View

MOST_PER_SECOND = 200
BURST = 400
"""Messages of a page; jogs of several axes are 20 a second each."""
MOST_WAITING = 400
"""Frames that a page may be behind; more, and its states are left out until it follows again."""
MOST_OUTGOING = 10_000
"""Frames of any kind that a page may be behind; more, and it is cut off."""
LONGEST_STALL = 10.0
"""Seconds that a page may take nothing."""


class Session:
    """A page. Its messages are handled in their order, but for commands, which wait for their answers beside."""

    def __init__(self, hub: Shared, socket: PageSocket, access: Access, login: Login, *, number: int) -> None:
        self.hub = hub
        self.user, self.role, self.number = login.user, login.role, number
        self._access, self.login = access, login
        self.is_behind = True
        """It gets the whole state next."""
        self.view: View | None = None
        """What it sees; None until there is a machine."""
        self.scope: Stream | None = None
        self._is_ending = self._is_cut_off = False
        self._socket = socket
        self._outgoing: deque[str | bytes] = deque()
        self._something, self._is_sent = asyncio.Event(), asyncio.Event()
        self._reader: asyncio.Task[None] | None = None
        self._rate = Rate(MOST_PER_SECOND, BURST)
        self._messages = PageMessages(self)

    @property
    def label(self) -> str:
        """For people: user and page."""
        return f"{self.user} (page {self.number})"

    def end_jogs(self) -> None:
        """The page no longer holds the command, or is gone."""
        self._messages.end()

    def shown(self) -> dict[str, Any]:
        return {"user": self.user, "page": self.number}

    # to the page

    def send(self, message: Mapping[str, Any]) -> None:
        self.send_frame(frame(message))

    def send_frame(self, data: str | bytes) -> None:
        """In the order of the calls."""
        if self._is_cut_off:
            return
        if len(self._outgoing) >= MOST_OUTGOING:
            self._is_cut_off = True
            self._outgoing.clear()
            self.abort()
            return
        self._outgoing.append(data)
        self._is_sent.clear()
        self._something.set()

    @property
    def is_stalled(self) -> bool:
        """The page does not take what it gets."""
        return len(self._outgoing) > MOST_WAITING

    def send_state(self, time: float, state: State, changes: State) -> None:
        """What has changed; the whole state for a page that has missed something."""
        if self.is_stalled:
            self.is_behind = True
            return
        shown = state if self.is_behind else changes
        self.is_behind = False
        self.send({"type": "state", "time": round(time, 3), "units": shown})

    def take_blocks(self, blocks: Sequence[tuple[str, CycleBlock]]) -> None:
        """New blocks, for its scope; a page that does not follow gets none, and its scope shows the gap."""
        if self.scope is None:
            return
        for data in self.scope.take(blocks):
            if not self.is_stalled:
                self.send_frame(data)

    # from the page

    async def run(self) -> None:
        """Until its socket closes, or it is cut off."""
        self._reader, writer = asyncio.create_task(self._read()), asyncio.create_task(self._write())
        try:
            await asyncio.wait([self._reader])
            if not self._reader.cancelled():
                self._reader.result()
        finally:
            self._messages.end()
            self._reader.cancel()
            writer.cancel()

    async def _read(self) -> None:
        async for received in self._socket:
            if not self._rate.permits():
                await self._refuse_rate()
                return
            if received.type is WSMsgType.ERROR:
                return  # its socket has said why
            if received.type is WSMsgType.TEXT:
                self._take(received.data)
            else:
                self._take("a binary message")

    async def _refuse_rate(self) -> None:
        error = CncError(TOO_MANY_MESSAGES, f"more than {MOST_PER_SECOND} messages a second", "the page is cut off")
        with suppress(ConnectionError, asyncio.TimeoutError):
            await asyncio.wait_for(self._socket.send_str(frame({"type": "error", **error_fields(error)})), 1.0)
        await self.close(WSCloseCode.POLICY_VIOLATION, error.message)

    def require_login(self) -> None:
        """Raises CncError 26239 when the login of the page has ended."""
        if not self._access.is_valid(self.login):
            raise CncError(SESSION_ENDED, f"the login of {self.user} has ended", "the page is cut off; log in")

    def end_without_login(self) -> None:
        """Ends the page of a login that has ended."""
        if self._is_ending:
            return
        try:
            self.require_login()
        except CncError as error:
            self._is_ending = True
            self._messages.end()
            self.send({"type": "error", **error_fields(error)})
            self.hub.keep(asyncio.create_task(self._say_goodbye()))

    async def _say_goodbye(self) -> None:
        with suppress(asyncio.TimeoutError):
            await asyncio.wait_for(self._is_sent.wait(), 1.0)  # the error first
        await self.close(WSCloseCode.POLICY_VIOLATION)

    def _take(self, text: str) -> None:
        message: Message = {}
        try:
            message = read_message(text)
            self.require_login()
            if message["type"] != "ping":
                self._access.logins.use(self.login)
            handled = self._messages.handle(message)
        except CncError as error:
            self._refuse(message, error)
            return
        except Exception as error:  # a mistake of ours is answered too
            self._refuse(message, failed(error))
            return
        if handled is not None:
            self.hub.keep(asyncio.create_task(self._answer(message, handled)))  # to its end, without its page too

    async def _answer(self, message: Message, handled: Any) -> None:
        try:
            self.send(await handled)
        except CncError as error:
            self._refuse(message, error)
        except Exception as error:  # as in _take
            self._refuse(message, failed(error))

    def _refuse(self, message: Message, error: CncError) -> None:
        known = message.get("id") is not None
        self.send(refusal(message, error) if known else {"type": "error", **error_fields(error)})

    async def _write(self) -> None:
        while True:
            await self._something.wait()
            self._something.clear()
            while self._outgoing:
                data = self._outgoing.popleft()
                sending = self._socket.send_bytes(data) if isinstance(data, bytes) else self._socket.send_str(data)
                try:
                    async with asyncio.timeout(LONGEST_STALL):  # in Python 3.11 wait_for may swallow a cancel
                        await sending
                except TimeoutError:
                    self.abort()
                    return
                except Exception:  # the socket, whose farewell may be under way, or what was to be sent
                    await self._leave()
                    return
            self._is_sent.set()

    # the end

    async def close(
        self, code: int = WSCloseCode.GOING_AWAY, reason: str = "", *, patience: float | None = None
    ) -> None:
        """With a farewell; a page that does not even take that in `patience` (s, None: LONGEST_STALL) is cut off."""
        try:
            async with asyncio.timeout(LONGEST_STALL if patience is None else patience):
                await self._socket.close(code=code, message=reason.encode()[:120])
        except TimeoutError:
            self.abort()

    async def _leave(self) -> None:
        """Its reader gets the end, and ends this, too; a page that stays is cut off."""
        self._messages.end()
        await self.close()
        await asyncio.sleep(LONGEST_STALL)
        self.abort()

    def abort(self) -> None:
        """A page that takes nothing answers no farewell either: it loses the command, and its jogs end, at once."""
        self._socket.abort()
        if self._reader is not None:
            self._reader.cancel()  # `run` ends, and what follows it
        self._messages.end()


def failed(error: Exception) -> CncError:
    """What a page gets after a mistake of ours."""
    traceback.print_exception(error)
    return CncError(SERVER_FAILED, f"the server has failed: {error!r}", "whether it was carried out is not known")
