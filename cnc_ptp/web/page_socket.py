"""The socket of a page, which says why it closes when a message is too large."""

from __future__ import annotations

import asyncio
from contextlib import suppress

from aiohttp import WSCloseCode, web

from cnc_ptp.errors import CncError
from cnc_ptp.web.numbers import TOO_LARGE_MESSAGE
from cnc_ptp.web.protocol import LARGEST_MESSAGE, error_fields, frame

FAREWELL = 5.0
"""Seconds in which the page may send the rest, which is not kept, and leave: a socket that is closed before loses what
the page has been told."""
LOOK_PERIOD = 0.02


class PageSocket(web.WebSocketResponse):
    """Of a page; its messages have at most LARGEST_MESSAGE bytes."""

    def __init__(self, request: web.Request, *, heartbeat: float) -> None:
        """`heartbeat`: seconds between two pings, each to be answered within half of them."""
        limit = LARGEST_MESSAGE + 1  # aiohttp refuses frames of its limit, too
        super().__init__(max_msg_size=limit, heartbeat=heartbeat, autoping=True)
        self._request = request
        self._is_leaving = False

    async def close(self, *, code: int = WSCloseCode.OK, message: bytes = b"", drain: bool = True) -> bool:
        """As of aiohttp, which closes the socket when a message is too large."""
        if self._is_leaving:
            return False  # it closes when the page has left
        if code == WSCloseCode.MESSAGE_TOO_BIG and not self.closed:
            self._is_leaving = True
            try:
                with suppress(ConnectionError, asyncio.TimeoutError):
                    await asyncio.wait_for(self._say_too_large(), FAREWELL)
            finally:
                self._is_leaving = False
        return await super().close(code=code, message=message, drain=drain)

    def abort(self) -> None:
        """The connection ends now, without what it has not sent; a farewell would wait behind that."""
        if (transport := self._request.transport) is not None:
            transport.abort()

    async def _say_too_large(self) -> None:
        error = too_large()
        await self.send_str(frame({"type": "error", **error_fields(error)}))
        assert self._writer is not None
        await self._writer.close(WSCloseCode.MESSAGE_TOO_BIG, error.message.encode())
        while self._request.transport is not None:
            await asyncio.sleep(LOOK_PERIOD)


def too_large() -> CncError:
    """The message was not even read to its end."""
    reason = f"a message of the page is larger than {LARGEST_MESSAGE} bytes"
    return CncError(TOO_LARGE_MESSAGE, reason, "it was not read, and the page is cut off", limit=LARGEST_MESSAGE)
