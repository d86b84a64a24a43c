"""What goes wrong in one page, one process or one message stays there."""

import asyncio
import os
import signal
import time
from concurrent.futures import Future
from itertools import pairwise
from types import SimpleNamespace

import pytest
from web_support import MILL, PATIENCE, page_of, site, users_file

from cnc_ptp.errors import CncError
from cnc_ptp.nodes.client.calls_in_flight import Call, CallsInFlight
from cnc_ptp.web.access.guard import Names
from cnc_ptp.web.access.users import remove
from cnc_ptp.web.faces.machine_face import offline_face
from cnc_ptp.web.page_messages import PageMessages


def run(story, **options):
    async def told():
        async with site(**options) as here:
            await asyncio.wait_for(story(here), 60.0)

    asyncio.run(told())


class Slow:
    """The machine answers commands when a test says so."""

    def __init__(self, face, monkeypatch):
        self.begun, self.may_end = [], asyncio.Event()
        self._answer_to = face._answer_to
        monkeypatch.setattr(face, "_answer_to", self.answer)

    async def answer(self, unit, command, arguments, user):
        self.begun.append(command)
        if command == "move_absolute":
            await self.may_end.wait()
        return await self._answer_to(unit, command, arguments, user)


async def until(condition):
    async def wait():
        while not condition():
            await asyncio.sleep(0.01)

    await asyncio.wait_for(wait(), PATIENCE)


def test_a_command_whose_unit_is_gone_when_it_is_its_turn_is_refused():
    machine = offline_face(MILL, stands=True)
    faces = iter([SimpleNamespace(kinds={"q": "axis"}), machine])
    right = SimpleNamespace(require=lambda *_: None)
    hub = SimpleNamespace(require_face=lambda: next(faces), right=right, note=print, tasks=None)
    page = SimpleNamespace(hub=hub, user="anna", role="operator")
    asked = PageMessages(page).handle({"type": "command", "id": 1, "unit": "q", "command": "halt"})
    with pytest.raises(CncError, match=r"P-ERR-26111 the machine has no unit 'q'"):
        asyncio.run(asked)


def test_a_page_closes_while_its_command_is_on_its_way(monkeypatch):
    async def story(here):
        slow = Slow(here.hub.face, monkeypatch)
        other = await here.page(commands=False)
        page = await here.page()
        await page.send(type="command", id=9, unit="x", command="move_absolute", arguments={"target": 1})
        await until(lambda: slow.begun)
        await page.socket.close()
        await until(lambda: len(here.hub.sessions) == 1)
        slow.may_end.set()
        text = "web: axis x: move_absolute, carried out"
        assert await other.wait_for("event", lambda event: event["text"] == text)
        assert here.hub.face is not None

    run(story)


def test_an_answer_that_nobody_waits_for():
    """A cancelled future takes no result: the thread of the client would end."""
    cancelled, done = Future(), SimpleNamespace(done=lambda: True, result=lambda: 1)
    cancelled.cancel()
    calls = CallsInFlight()
    calls._calls = [Call("x", None, None, 0.0, 1.0, cancelled, done)]
    calls.go_on()
    assert calls._calls == []


def test_a_stop_waits_for_no_command(monkeypatch):
    async def story(here):
        slow = Slow(here.hub.face, monkeypatch)
        page = await here.page()
        for number, target in ((11, 1), (12, 2)):
            await page.send(type="command", id=number, unit="x", command="move_absolute", arguments={"target": target})
        await until(lambda: slow.begun)
        assert (await page.command("x", "halt"))["ok"]
        assert (await page.command("plc", "emergency_stop", enabled=True))["ok"]
        slow.may_end.set()
        dropped = await page.wait_for("answer", lambda answer: answer["id"] == 12)
        text = "axis x: move_absolute: a stop came before it; it was not sent"
        assert (dropped["number"], dropped["text"]) == (26261, text)
        assert slow.begun == ["move_absolute", "halt", "emergency_stop"]

    run(story)


@pytest.mark.parametrize("end", ["close", "log_out", "take_over"])
def test_commands_that_wait_end_with_the_right_of_their_page(monkeypatch, tmp_path, end):
    """The first one is on its way and is carried out; the second one waits for it and is not sent."""
    users = users_file(tmp_path)

    async def story(here):
        slow = Slow(here.hub.face, monkeypatch)
        other, page = await page_of(here, "cora"), await page_of(here, "otto")
        assert (await page.ask("take_command"))["ok"]
        for id, target in ((11, 1), (12, 2)):
            await page.send(type="command", id=id, unit="x", command="move_absolute", arguments={"target": target})
        assert (await page.ask("ping"))["ok"]
        await until(lambda: slow.begun)
        if end == "close":
            await page.socket.close()
            await until(lambda: len(here.hub.sessions) == 1)
        elif end == "log_out":
            remove(users, "otto")
        else:
            assert (await other.ask("take_command", force=True))["ok"]
        slow.may_end.set()
        if end == "take_over":
            refused = await page.wait_for("answer", lambda answer: answer["id"] == 12)
            held = f"cora (page {other.hello['page']}) holds it"
            text = f"axis x: move_absolute: this page does not hold the command, {held}; nothing was done"
            assert (refused["number"], refused["text"]) == (26236, text)
        for told in ("carried out", f"not sent, P-ERR-{26239 if end == 'log_out' else 26236}"):
            text = f"otto: axis x: move_absolute, {told}"
            assert await other.wait_for("event", lambda event, text=text: event["text"] == text)
        assert slow.begun == ["move_absolute"]

    run(story, users=users)


def test_a_feed_hold_drops_nothing(monkeypatch):
    async def story(here):
        slow = Slow(here.hub.face, monkeypatch)
        page = await here.page()
        for number in (11, 12):
            await page.send(
                type="command", id=number, unit="x", command="move_absolute", arguments={"target": number / 10}
            )
        await until(lambda: slow.begun)
        assert (await page.command("x", "feed_hold", enabled=True))["ok"]
        slow.may_end.set()
        held = await page.wait_for("answer", lambda answer: answer["id"] == 12)
        assert held["number"] == 23005, held  # of the axis: it came to it

    run(story)


def test_a_command_without_an_answer_is_noted(monkeypatch):
    async def story(here):
        async def no_answer(*arguments):
            raise CncError(26136, "axis x: halt: no answer within 5 s", "see `cnc_ptp status`")

        page = await here.page()
        monkeypatch.setattr(here.hub.face, "_answer_to", no_answer)
        answer = await page.command("x", "halt")
        assert answer["number"] == 26136
        text = "web: axis x: halt, no answer, P-ERR-26136"
        assert await page.wait_for("event", lambda event: event["text"] == text)

    run(story)


def test_half_a_character(monkeypatch):
    """JSON has them, UTF-8 has not."""

    async def story(here):
        page = await here.page()
        await page.socket.send_str('{"type": "command", "id": "\\ud800", "unit": "\\ud801", "command": "\\ud802"}')
        assert (await page.wait_for("answer"))["id"] == "\ud800"
        await page.socket.send_str('{"type": "\\ud800"}')
        assert (await page.wait_for("error"))["number"] == 26233
        assert (await page.ask("ping"))["ok"]
        socket = await here.client.ws_connect("/ws")
        await socket.send_str('{"type": "hello", "token": "\\ud800"}')
        assert (await socket.receive_json())["number"] == 26238

    run(story)


def test_a_mistake_of_ours_is_answered(capsys, monkeypatch):
    async def story(here):
        page = await here.page()
        text = "the server has failed: ZeroDivisionError('division by zero'); whether it was carried out is not known"

        async def fails(*arguments):
            return 1 / 0

        monkeypatch.setattr(here.hub.face, "_answer_to", fails)
        answer = await page.command("x", "halt")
        assert (answer["number"], answer["text"]) == (26260, text)
        monkeypatch.setattr(here.hub.right, "give", lambda session: 1 / 0)
        answer = await page.ask("give_command")
        assert (answer["number"], answer["text"]) == (26260, text)

    run(story)
    assert "ZeroDivisionError" in capsys.readouterr().err


@pytest.mark.parametrize("table", [5, "a", {}, [[1]]])
def test_a_command_with_a_wrong_value_is_answered(table):
    async def story(here):
        page = await here.page()
        answer = await page.command("y", "couple_cam", master="x", table=table)
        assert not answer["ok"] and answer["number"]

    run(story)


def test_a_page_that_takes_nothing_is_cut_off(monkeypatch):
    monkeypatch.setattr("cnc_ptp.web.session.MOST_OUTGOING", 50)

    async def story(here):
        await here.page(commands=False)
        [session] = here.hub.sessions
        for _ in range(1000):
            session.send({"type": "event"})
        assert len(session._outgoing) == 0
        await until(lambda: not here.hub.sessions)

    run(story)


@pytest.mark.long
def test_the_process_that_draws_dies_again_and_again():
    async def story(here):
        page = await here.page()
        for number in range(3):
            assert (await page.ask("load", name="part.nc", text=f"G1 X1{number} F600\nM30\n"))["ok"]
            await page.wait_for("program")
            assert (await here.client.get("/api/backplot")).status == 200
            [drawing] = here.hub.office._pool._processes
            os.kill(drawing, signal.SIGKILL)
            await asyncio.sleep(0.3)
        assert here.hub.face is not None
        assert (await page.ask("ping"))["ok"]

    run(story)


def test_a_drawing_that_has_failed_is_tried_again(monkeypatch):
    async def story(here):
        page = await here.page()
        assert (await page.ask("load", name="part.nc", text="G1 X10 F600\nM30\n"))["ok"]
        while "channel" not in here.hub.programs.loaded or here.hub.programs.loaded["channel"].text is None:
            await asyncio.sleep(0.01)  # the state may have its name before its record comes
        right = here.hub.office._started
        monkeypatch.setattr(here.hub.office, "_started", lambda: 1 / 0)
        failed = await here.client.get("/api/backplot")
        assert failed.status == 500, await failed.text()
        monkeypatch.setattr(here.hub.office, "_started", right)
        assert (await here.client.get("/api/backplot")).status == 200

    run(story)


def test_a_machine_that_cannot_be_shown_is_tried_again(monkeypatch, capsys):
    times = []

    def connect():
        times.append(1)
        if len(times) < 2:
            raise ValueError("a mistake")
        return offline_face(MILL)

    monkeypatch.setattr("cnc_ptp.web.hub.AGAIN", 0.3)

    async def story(here):
        page = await here.page(commands=False)
        text = "the server has failed: ValueError('a mistake'); the machine continues"
        assert (page.hello["why"]["number"], page.hello["why"]["text"]) in ((26171, text), (26244, text))
        assert await page.wait_for("back")

    run(story, connect=connect, waits=False)
    assert "a mistake" in capsys.readouterr().err


@pytest.mark.parametrize("error", [ZeroDivisionError("a mistake"), CncError(26135, "a refusal", "nothing was shown")])
@pytest.mark.parametrize("broken", ["last_loads", "state"])
def test_a_machine_that_can_never_be_shown_is_tried_again_after_a_pause_and_left_each_time(monkeypatch, broken, error):
    """Whether its first look fails or a later one."""
    begun, ended = [], []

    def fail():
        raise error

    def connect():
        face = offline_face(MILL, stands=True)
        begun.append(time.monotonic())
        close = face.close
        monkeypatch.setattr(face, "close", lambda: (ended.append(1), close()))
        monkeypatch.setattr(face, broken, fail)
        return face

    monkeypatch.setattr("cnc_ptp.web.hub.AGAIN", 0.5)

    async def story(here):
        while len(begun) < 3:
            await asyncio.sleep(0.01)
        assert all(after - before >= 0.5 for before, after in pairwise(begun)) and len(ended) >= 2

    run(story, connect=connect, waits=False)


def test_a_name_in_capitals_is_the_same_name():
    names = Names(("Mill.Example",))
    names.require_host(SimpleNamespace(headers={"Host": "mill.example:8080"}))
    names.require_host(SimpleNamespace(headers={"Host": "MILL.example:8080"}))
