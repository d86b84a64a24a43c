"""The farewell of a page whose message is too large (26205)."""

import asyncio
import json
from types import SimpleNamespace

import pytest

from cnc_ptp.web.page_socket import PageSocket


class Farewell(PageSocket):
    """A socket without a connection: `stays` is whether the page leaves; what was sent to it is kept."""

    def __init__(self, *, stays=False, breaks=False):
        super().__init__(SimpleNamespace(transport=object() if stays else None), heartbeat=None)
        self.sent, self.closed_with, self._breaks = [], [], breaks
        self._writer = SimpleNamespace(close=self._note)

    async def send_str(self, data):
        if self._breaks:
            raise ConnectionResetError
        self.sent.append(json.loads(data)["number"])

    async def _note(self, code, message):
        self.closed_with.append(code)


@pytest.fixture
def closings(monkeypatch):
    """Codes with which aiohttp closes a socket."""
    found = []

    async def close(self, *, code, message, drain):
        found.append(code)
        return True

    monkeypatch.setattr("cnc_ptp.web.page_socket.web.WebSocketResponse.close", close)
    return found


@pytest.mark.parametrize(
    ("how", "told"),
    [({}, [26205]), ({"stays": True}, [26205]), ({"breaks": True}, [])],
    ids=["leaves", "stays", "is gone"],
)
def test_a_page_whose_message_is_too_large(monkeypatch, closings, how, told):
    """Once it has left, once its time is over, and once it hears nothing: the socket closes in any case."""
    monkeypatch.setattr("cnc_ptp.web.page_socket.FAREWELL", 0.05)

    async def story():
        socket = Farewell(**how)
        assert await socket.close(code=1009)
        assert (socket.sent, socket.closed_with, closings) == (told, [1009] * len(told), [1009])
        assert await socket.close() and closings == [1009, 1000]

    asyncio.run(story())


def test_a_page_that_is_leaving_is_not_closed_before(closings):
    async def story():
        socket = Farewell(stays=True)
        leaving = asyncio.create_task(socket.close(code=1009))
        while not socket.closed_with:
            await asyncio.sleep(0)
        assert not await socket.close() and closings == []
        socket._request.transport = None
        assert await leaving and closings == [1009]

    asyncio.run(story())
