"""Pages that do not follow, and pages that look at much."""

import asyncio
from types import SimpleNamespace

import pytest
from diagnostic_msgs.msg import DiagnosticStatus, KeyValue
from web_support import site

from cnc_ptp.web.access.logins import Logins
from cnc_ptp.web.faces.live_face import diagnostics_fields
from cnc_ptp.web.session import MOST_WAITING, Session


class Socket:
    """Takes nothing until a test says so."""

    def __init__(self):
        self.may_take, self.taken, self.closed = asyncio.Event(), [], False

    async def send_str(self, data):
        await self.may_take.wait()
        self.taken.append(data)

    send_bytes = send_str

    def abort(self):
        self.closed = True

    def __aiter__(self):
        return self

    async def __anext__(self):
        await asyncio.sleep(3600)


def slow_session(socket):
    login = Logins().of_machine("anna", "viewer", "")
    hub = SimpleNamespace(face=None, keep=lambda task: None, tasks=None, right=None)
    return Session(hub, socket, SimpleNamespace(), login, number=1)


def test_states_are_left_out_and_the_whole_state_follows():
    async def story():
        socket = Socket()
        session = slow_session(socket)
        running = asyncio.create_task(session.run())
        state = {"x": {"a": 1, "b": 2}}
        session.send_state(0.0, state, {})
        assert not session.is_behind
        for _ in range(MOST_WAITING + 2):
            session.send({"type": "event"})
        assert session.is_stalled
        before = len(session._outgoing)
        session.send_state(0.1, state, {"x": {"a": 1}})
        assert session.is_behind and len(session._outgoing) == before
        socket.may_take.set()
        await asyncio.sleep(0.2)
        session.send_state(0.2, state, {"x": {"a": 1}})
        await asyncio.sleep(0.05)
        assert socket.taken[-1] == '{"type":"state","time":0.2,"units":{"x":{"a":1,"b":2}}}'
        running.cancel()

    asyncio.run(story())


def test_a_page_that_takes_nothing_for_long_is_cut_off(monkeypatch):
    monkeypatch.setattr("cnc_ptp.web.session.LONGEST_STALL", 0.1)

    async def story():
        socket = Socket()
        session = slow_session(socket)
        running = asyncio.create_task(session.run())
        session.send({"type": "event"})
        await asyncio.wait_for(running, 5.0)
        assert socket.closed

    asyncio.run(story())


def test_a_page_whose_connection_is_full_loses_the_command(monkeypatch):
    """It reads nothing, and no farewell gets through."""
    monkeypatch.setattr("cnc_ptp.web.session.LONGEST_STALL", 0.5)

    async def story():
        async with site() as here:
            page, other = await here.page(), await here.page(commands=False)
            session = here.hub.right.holder
            connection = page.socket._response.connection.transport
            connection.pause_reading()
            for _ in range(16):
                session.send({"type": "event", "text": "x" * (1 << 20)})
            await asyncio.wait_for(other.wait_for("operator", lambda told: told["holder"] is None), 10.0)
            assert session not in here.hub.sessions
            assert (await other.ask("take_command"))["ok"]
            connection.resume_reading()

    asyncio.run(story())


def test_two_pages_with_a_scope_each():
    async def story():
        async with site() as here:
            one, two = await here.page(), await here.page(commands=False)
            assert (await one.ask("scope", signals=["x.set_position"]))["ok"]
            assert (await two.ask("scope", signals=["y.set_position", "y.state"], bits=64))["bits"] == 64
            for page, bits, count in ((one, 32, 1), (two, 64, 2)):
                before, values = await page.frame(bits)
                first, _ = await page.frame(bits)
                assert first == before + values.shape[1] and len(values) == count

    asyncio.run(story())


def test_diagnostics_of_a_node():
    status = DiagnosticStatus(
        level=DiagnosticStatus.WARN, name="x", message="late", values=[KeyValue(key="a", value="1")]
    )
    assert diagnostics_fields(status) == {"name": "x", "level": 1, "text": "late", "values": {"a": "1"}}


class Broken(Socket):
    """Takes no messages, and no farewell either."""

    async def send_str(self, data):
        raise ConnectionResetError

    async def close(self, **how):
        await asyncio.sleep(3600)


@pytest.mark.parametrize("end", ["it sends", "it is closed"])
def test_a_page_that_takes_no_farewell_is_cut_off(monkeypatch, end):
    monkeypatch.setattr("cnc_ptp.web.session.LONGEST_STALL", 0.1)

    async def story():
        socket = Broken()
        session = slow_session(socket)
        running = asyncio.create_task(session.run())
        await asyncio.sleep(0)
        if end == "it sends":
            session.send({"type": "event"})
        else:
            await session.close()
        await asyncio.wait_for(running, 5.0)
        assert socket.closed

    asyncio.run(story())


@pytest.mark.parametrize("name", ["source", "own"])
def test_no_page_speaks_for_a_channel(name):
    async def story():
        async with site() as here:
            page = await here.page()
            answer = await page.command("s", "start", speed=100, direction="cw", **{name: "channel"})
            text = f"spindle s: start refused: pages do not give the argument '{name}'; nothing was done"
            assert (answer["number"], answer["text"]) == (26249, text)

    asyncio.run(story())
