"""Alarms that were acknowledged: as events, for a server that begins later, and in recordings."""

import asyncio
from pathlib import Path
from zlib import crc32

import pytest
from recording_support import smooth_blocks
from web_support import MILL, page_of, site, users_file

from cnc_ptp.client import Machine
from cnc_ptp.errors import CncError
from cnc_ptp.protocol.blocks import Event, EventValue, Severity
from cnc_ptp.recording.writer import Recording
from cnc_ptp.web.faces.alarms import KEPT, Alarms, event_fields
from cnc_ptp.web.faces.machine_face import OfflineFace
from cnc_ptp.web.faces.recorded_face import recorded_face

INFO, WARNING, ERROR = Severity.INFO, Severity.WARNING, Severity.ERROR
X, Y, LATER = (
    Event(100, "x", ERROR, 70100, "axis x: following error"),
    Event(100, "y", ERROR, 70100, "axis y: following error"),
    Event(120, "y", WARNING, 23010, "axis y: warning"),
)
ONE = Event(
    150, "web", INFO, 26269, "anna: P-ERR-70100 of x in cycle 100 acknowledged",
    values=[
        EventValue("anna", 1.0, "alarms"),
        EventValue("x", 100.0, "cycle"),
        EventValue("x", 70100.0, "P-ERR"),
        EventValue("x", float(crc32(b"axis x: following error")), "CRC-32 of its text"),
    ],
)  # fmt: skip
ALL = Event(
    150, "web", INFO, 26269, "anna: all alarms up to cycle 120 acknowledged",
    values=[
        EventValue("anna", 3.0, "alarms"),
        EventValue("x", 100.0, "up to cycle"),
        EventValue("y", 120.0, "up to cycle"),
    ],
)  # fmt: skip


def alarms_of(*events):
    """As a server takes events that come one after the other."""
    alarms = Alarms()
    for event in events:
        alarms.take(event_fields(event, 1e-3))
        alarms.acknowledge(event)
    return alarms


def by(alarms):
    """Source, cycle, and who has acknowledged it, None for nobody."""
    return [
        (alarm["source"], alarm["cycle"], alarm["acknowledged_by"] if alarm["acknowledged"] else None)
        for alarm in alarms.list()
    ]


def test_one_alarm_as_an_event():
    """It says which, whatever number another server gives it; one of another unit in the same cycle stays open."""
    assert alarms_of(X, Y).acknowledgement(1, "anna", 150) == ONE
    assert by(alarms_of(Y, X, ONE)) == [("y", 100, None), ("x", 100, "anna")]


def test_all_alarms_are_one_event():
    assert alarms_of(X, Y, LATER).acknowledgement(None, "anna", 150) == ALL
    after = Event(121, "x", ERROR, 70100, "axis x: following error")
    assert by(alarms_of(X, Y, LATER, ALL, after)) == [
        ("x", 100, "anna"), ("y", 100, "anna"), ("y", 120, "anna"), ("x", 121, None)
    ]  # fmt: skip


def test_an_alarm_that_came_after_those_of_another_unit_is_open():
    """y has told its own of the same time later: nobody had seen it."""
    given = alarms_of(X).acknowledgement(None, "anna", 150)
    assert by(alarms_of(X, given, Y)) == [("x", 100, "anna"), ("y", 100, None)]


@pytest.mark.parametrize("given", [ONE, ALL])
def test_an_acknowledgement_comes_before_its_alarm(given):
    """Late servers get the events of one node after those of another."""
    assert by(alarms_of(given, X)) == [("x", 100, "anna")]


def test_notices_that_differ_in_their_texts_alone():
    notices = [Event(0, "plc", WARNING, 70349, f"P-AXIS-00389 of /{axis}: delay") for axis in "xy"]
    given = alarms_of(*notices).acknowledgement(2, "anna", 150)
    assert by(alarms_of(*notices, given)) == [("plc", 0, None), ("plc", 0, "anna")]


def test_the_first_who_has_acknowledged_it_stays():
    alarms = alarms_of(X, Y, ONE)
    event = alarms.acknowledgement(None, "otto", 160)
    assert alarms.acknowledge(event) == {"alarms": [2], "user": "otto"}
    assert alarms.acknowledge(event) == {"alarms": [], "user": "otto"}
    assert by(alarms) == [("x", 100, "anna"), ("y", 100, "otto")]
    assert alarms.acknowledgement(None, "otto", 170) is None and alarms.acknowledgement(1, "otto", 170) is None


def test_an_alarm_that_is_no_longer_kept():
    others = [Event(cycle, "y", ERROR, 70100, "again") for cycle in range(1, KEPT + 1)]
    alarms = alarms_of(X, *others)
    assert alarms.acknowledge(ONE) == {"alarms": [], "user": "anna"}
    with pytest.raises(CncError, match="acknowledge: there is no alarm 1; nothing was done"):
        alarms.acknowledgement(1, "anna", 150)


@pytest.mark.parametrize("user", ["web", "a: b, c", "ä\n✓ 'acknowledged'", "up to cycle"])
def test_any_name_of_a_user(user):
    given = alarms_of(X).acknowledgement(None, user, 150)
    assert by(alarms_of(X, given)) == [("x", 100, user)]


@pytest.mark.parametrize(
    "event",
    [
        Event(150, "web", INFO, 0, ALL.text, values=ALL.values),  # a page can have this text written
        Event(150, "channel", INFO, 26269, ALL.text, values=ALL.values),
        Event(150, "web", INFO, 26269, ALL.text),
        Event(150, "web", INFO, 26269, "", values=[EventValue("anna", 1.0), EventValue("x", float("nan"), "cycle")]),
    ],
)
def test_what_is_no_acknowledgement(event):
    assert by(alarms_of(X, event)) == [("x", 100, None)]


def test_of_many_alarms_the_newest_are_known():
    alarms = Alarms()
    events = [Event(cycle, "x", ERROR, 0, f"error {cycle}") for cycle in range(KEPT + 5)]
    alarms.begin_again([*events, Event(9999, "x", INFO, 0, "no alarm")], 1e-3)
    known = alarms.list()
    assert (len(known), known[0]["alarm"], known[0]["text"]) == (KEPT, 6, "error 5")
    assert (known[-1]["alarm"], known[-1]["text"]) == (KEPT + 5, f"error {KEPT + 4}")
    alarms.begin_again(events[:2], 1e-3)
    assert [(alarm["alarm"], alarm["text"]) for alarm in alarms.list()] == [(1, "error 0"), (2, "error 1")]


# with a server


def face_with(history):
    """Of a machine whose units have told these events before."""
    face = OfflineFace(Machine.offline(MILL), stands=True)
    face._events.items.extend(history)
    return face


async def known_to(face, count):
    """Alarms of a page of a new server that begins with the face."""
    async with site(connect=lambda: face) as here:
        page = await here.page(commands=False)
        while len(here.hub.shared.alarms.list()) < count:
            await asyncio.sleep(0.01)
        assert page.hello["machine"]
        return by(here.hub.shared.alarms)


def test_a_later_server_knows_who_has_acknowledged(tmp_path):
    async def story():
        face = face_with([X, Y, LATER])
        told = face._link.seen.events()
        async with site(connect=lambda: face, users=users_file(tmp_path)) as here:
            otto = await page_of(here, "otto")
            while len(here.hub.shared.alarms.list()) < 3:
                await asyncio.sleep(0.01)
            vera = await page_of(here, "vera")
            refused = await vera.ask("acknowledge")
            assert refused["number"] == 26235 and not told.items
            number = next(alarm["alarm"] for alarm in vera.hello["alarms"] if alarm["source"] == "x")
            assert (await otto.ask("acknowledge", alarm=number))["ok"]
            for page in (otto, vera):
                assert (await page.wait_for("acknowledged"))["alarms"] == [number]
            event = await otto.wait_for("event", lambda event: event["number"] == 26269)
            assert event["text"] == "otto: P-ERR-70100 of x in cycle 100 acknowledged"
        history = [X, Y, LATER, *told.items]
        wanted = [("x", 100, "otto"), ("y", 100, None), ("y", 120, None)]
        assert await known_to(face_with(history), 3) == wanted
        assert await known_to(face_with(history[::-1]), 3) == wanted[::-1]

    asyncio.run(story())


def test_two_servers_of_a_machine():
    """What is acknowledged on a page of one is so on pages of the other."""

    async def story():
        face = face_with([X, Y])
        async with site(connect=lambda: face) as here:
            page = await here.page(commands=False)
            while len(here.hub.shared.alarms.list()) < 2:
                await asyncio.sleep(0.01)
            face.publish(ALL)
            told = await page.wait_for("acknowledged")
            assert (sorted(told["alarms"]), told["user"]) == ([1, 2], "anna")

    asyncio.run(story())


# of a recording


@pytest.fixture
def recording(tmp_path):
    """0.5 s: alarms of two axes in one cycle, one of them acknowledged after 0.15 s, a third one later."""
    path = tmp_path / "run.mcap"
    after = Event(300, "y", ERROR, 70100, "axis y: again")
    with Recording(path, Path(MILL).read_text()) as recording:
        for event in (Event(0, "x", INFO, 0, "begins"), X, Y, ONE, after):
            recording.event(event)
        for name, block in smooth_blocks(0.5):
            if name == "x":
                recording.block(name, block)
    return str(path)


@pytest.mark.motion_unchecked("its blocks are those of no machine")
def test_a_recording_has_an_alarm_acknowledged_from_then_on(recording):
    async def story():
        async with site(connect=lambda: recorded_face(recording)) as here:
            page = await here.page(commands=False)
            await page.wait_for("past")

            async def at(time):
                await page.ask("seek", time=time)
                past = await page.wait_for("past")
                return [(alarm["source"], alarm["acknowledged_by"]) for alarm in past["alarms"]]

            assert await at(0.05) == []
            assert await at(0.14) == [("x", ""), ("y", "")]
            assert await at(0.15) == [("x", "anna"), ("y", "")]
            assert await at(0.4) == [("x", "anna"), ("y", ""), ("y", "")]
            assert await at(0.14) == [("x", ""), ("y", "")]
            assert (await page.ask("play", speed=0.5))["ok"]
            assert await page.wait_for("acknowledged") == {"type": "acknowledged", "alarms": [1], "user": "anna"}

            await page.ask("play", speed=0.0)
            assert await at(0.2) == [("x", "anna"), ("y", "")]
            assert (await page.ask("acknowledge"))["ok"]
            assert await at(0.14) == [("x", ""), ("y", "web")]  # that of the page holds at every time
            assert await at(0.4) == [("x", "anna"), ("y", "web"), ("y", "")]

    asyncio.run(story())
