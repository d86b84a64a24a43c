"""The socket of a page, which says why it closes when a message is too large."""

from __future__ import annotations

import asyncio
from contextlib import suppress

from aiohttp import WSCloseCode, web

from cnc_ptp.errors import CncError
from cnc_ptp.web.numbers import TOO_LARGE_MESSAGE
from cnc_ptp.web.protocol import LARGEST_MESSAGE, error_fields, frame

FAREWELL = 0.5
"""Seconds in which the page sends the rest, which is not kept: what it has been told would be lost otherwise."""


class PageSocket(web.WebSocketResponse):
    """Of a page; its messages have at most LARGEST_MESSAGE bytes."""

    def __init__(self, *, heartbeat: float) -> None:
        """`heartbeat`: seconds between two pings, each to be answered within half of them."""
        limit = LARGEST_MESSAGE + 1  # aiohttp refuses frames of its limit, too
        super().__init__(max_msg_size=limit, heartbeat=heartbeat, autoping=True)

    async def close(self, *, code: int = WSCloseCode.OK, message: bytes = b"", drain: bool = True) -> bool:
        """As of aiohttp, which closes by itself when a message is too large."""
        if code == WSCloseCode.MESSAGE_TOO_BIG and not self.closed:
            error = too_large()
            with suppress(ConnectionError):
                await self.send_str(frame({"type": "error", **error_fields(error)}))
                await asyncio.sleep(FAREWELL)
            message = error.message.encode()
        return await super().close(code=code, message=message, drain=drain)


def too_large() -> CncError:
    """The message was not even read to its end."""
    reason = f"a message of the page is larger than {LARGEST_MESSAGE} bytes"
    return CncError(TOO_LARGE_MESSAGE, reason, "it was not read, and the page is cut off", limit=LARGEST_MESSAGE)
