"""A jog ends with its key, its page, its socket; nothing of the past starts one again."""

import asyncio
from types import SimpleNamespace

import pytest
from web_support import MILL, site

from cnc_ptp.nodes.bridge.jog_topics import JogTopics
from cnc_ptp.web import jog
from cnc_ptp.web.faces.live_face import PageJogs
from cnc_ptp.web.faces.machine_face import offline_face
from cnc_ptp.web.jog import Jogs

MOST_CYCLES = 250
"""From the key that comes up, or the last message, to the beginning of the stop: 250 ms."""
TIMES = 100


async def jogging(here, page, *, velocity=20.0):
    """The axis turns at the velocity of a key that is held; its time passes here alone."""
    face = here.hub.face
    for sequence in range(1, 20):
        await page.send(
            type="jog", axis="x", velocity=velocity, sequence=sequence, time=asyncio.get_running_loop().time() * 1e3
        )
        await page.ask("ping")
        for _ in range(5):
            face.step()
        if velocity_of(face) == velocity:
            return
    raise AssertionError("no jog")


def velocity_of(face):
    return face._link.seen.blocks["x"].set_velocity[-1]


def cycles_to_stop(face, velocity=20.0):
    """Cycles until the velocity falls."""
    begin = face._link.seen.cycle
    while True:
        face.step()
        block = face._link.seen.blocks["x"]
        slower = [n for n, value in enumerate(block.set_velocity) if abs(value) < velocity]
        if slower:
            return block.first_cycle + slower[0] - begin


def standing_site():
    return site(connect=lambda: offline_face(MILL, stands=True))


@pytest.fixture
def without_wall_clock(monkeypatch):
    """The time of the machine passes in steps here: what the server measures meanwhile means nothing."""
    monkeypatch.setattr(jog, "PATIENCE", 600.0)


@pytest.mark.usefixtures("without_wall_clock")
@pytest.mark.parametrize("phase", range(0, TIMES, 10))
def test_the_page_is_killed_and_the_axis_stops(phase):
    """Ten of a hundred times in each case, at another place of the jog."""

    async def story():
        async with standing_site() as here:
            for number in range(phase, phase + 10):
                page = await here.page()
                await jogging(here, page)
                for _ in range(number % 7):
                    here.hub.face.step()
                page.socket._response.connection.transport.abort()  # as of a process that is killed
                while here.hub.sessions:
                    await asyncio.sleep(0)
                assert cycles_to_stop(here.hub.face) <= 20
                while velocity_of(here.hub.face):
                    here.hub.face.step()

    asyncio.run(story())


@pytest.mark.usefixtures("without_wall_clock")
def test_the_socket_stalls_and_the_axis_stops():
    async def story():
        async with standing_site() as here:
            page = await here.page()
            for number in range(TIMES):
                await jogging(here, page, velocity=(-20.0, 20.0)[number % 2])
                for _ in range(number % 4):
                    here.hub.face.step()
                assert cycles_to_stop(here.hub.face) <= MOST_CYCLES
                while velocity_of(here.hub.face):
                    here.hub.face.step()
                await page.send(type="jog_stop", axis="x")

    asyncio.run(story())


@pytest.mark.usefixtures("without_wall_clock")
def test_the_key_comes_up():
    async def story():
        async with standing_site() as here:
            page = await here.page()
            await jogging(here, page)
            await page.send(type="jog_stop", axis="x")
            await page.ask("ping")
            assert cycles_to_stop(here.hub.face) <= 20

    asyncio.run(story())


class Heard:
    """A session, a face and a clock."""

    def __init__(self):
        self.now = 100.0
        self.jogs, self.told = [], []
        face = SimpleNamespace(
            kinds={"x": "axis"}, time=0.0, cycle_time=1e-3,
            jog=lambda axis, velocity, user: self.jogs.append(velocity),
            note=lambda cycle, text: None,
        )  # fmt: skip
        right = SimpleNamespace(require=lambda session, what: None)
        hub = SimpleNamespace(face=face, require_face=lambda: face, right=right)
        self.face = face
        self.session = SimpleNamespace(hub=hub, user="anna", role="operator", send=self.told.append)
        self.timers = []
        self.under_test = Jogs(self.session, now=lambda: self.now, later=self.later)

    def later(self, seconds, call):
        timer = SimpleNamespace(at=self.now + seconds, call=call, cancelled=False)
        timer.cancel = lambda: setattr(timer, "cancelled", True)
        self.timers.append(timer)
        return timer

    def pass_by(self, seconds):
        """Time, with the calls that are due."""
        self.now += seconds
        for timer in [each for each in self.timers if not each.cancelled and each.at <= self.now]:
            timer.cancel()
            timer.call()

    def message(self, sequence, *, sent):
        self.under_test.take({"type": "jog", "axis": "x", "velocity": 5.0, "sequence": sequence, "time": sent * 1e3})


def test_messages_of_the_past_start_nothing():
    heard = Heard()
    heard.message(1, sent=0.0)
    heard.now += 0.05
    heard.message(2, sent=0.05)
    assert heard.jogs == [5.0, 5.0]
    heard.now += 1.0  # the socket stalls, then all comes at once
    for number in range(3, 20):
        heard.message(number, sent=0.05 * number)
    assert heard.jogs == [5.0, 5.0, 0.0]
    assert [message["text"] for message in heard.told] == [
        "axis x: the messages of the jog came too late; the axis stops; press the key again"
    ]
    assert heard.told[0]["number"] == 26243


@pytest.mark.parametrize(("late", "round_trip"), [(0.0, 0.0), (0.1, 0.0), (0.0, 0.14), (0.05, 0.14)])
def test_the_stop_comes_a_fifth_of_a_second_after_the_last_message_was_sent(late, round_trip):
    """However long that message was on its way: 0.2 s less its lateness and half the round trip."""
    heard = Heard()
    heard.under_test.take_ping({"type": "ping", "time": heard.now * 1e3, "round_trip": round_trip * 1e3})
    for number in (1, 2):
        heard.message(number, sent=heard.now)
        heard.pass_by(0.05)
    heard.pass_by(late)
    heard.message(3, sent=heard.now - late)
    left = 0.2 - late - round_trip / 2
    heard.pass_by(left - 1e-3)
    assert heard.jogs == [5.0, 5.0, 5.0]
    heard.pass_by(2e-3)
    assert heard.jogs == [5.0, 5.0, 5.0, 0.0]
    assert [message["number"] for message in heard.told] == [26243]
    heard.message(4, sent=heard.now)
    assert heard.jogs == [5.0, 5.0, 5.0, 0.0], "of a jog that has ended"


@pytest.mark.parametrize("sequence", [1, 2])
def test_a_message_whose_time_is_over_moves_nothing(sequence):
    """0.14 s late, and 0.07 s on its way at the least."""
    heard = Heard()
    heard.under_test.take_ping({"type": "ping", "time": heard.now * 1e3, "round_trip": 140.0})
    if sequence == 2:
        heard.message(1, sent=heard.now)
        heard.pass_by(0.05)
    heard.now += 0.14
    heard.message(sequence, sent=heard.now - 0.14)
    assert heard.jogs == ([5.0, 0.0] if sequence == 2 else [])
    assert [message["number"] for message in heard.told] == [26243]


def test_a_round_trip_below_0_gives_no_more_time():
    heard = Heard()
    heard.under_test.take_ping({"type": "ping", "time": heard.now * 1e3, "round_trip": -100.0})
    heard.message(1, sent=heard.now)
    heard.pass_by(0.201)
    assert heard.jogs == [5.0, 0.0]


def test_the_server_ends_a_jog_by_its_own_clock():
    """The machine stands still: what ends the jog is the timer of the server."""

    async def story():
        async with standing_site() as here:
            page = await here.page()
            face, jogs = here.hub.face, []
            pass_on = face.jog
            face.jog = lambda axis, velocity, user: (jogs.append(velocity), pass_on(axis, velocity, user=user))
            now = asyncio.get_running_loop().time() * 1e3
            await page.send(type="jog", axis="x", velocity=20.0, sequence=1, time=now)
            ended = await page.wait_for("jog_ended")
            assert ended["number"] == 26243 and jogs == [20.0, 0.0]

    asyncio.run(story())


def test_a_key_that_came_up_has_no_end_of_its_own():
    heard = Heard()
    heard.message(1, sent=heard.now)
    heard.under_test.take_stop({"type": "jog_stop", "axis": "x"})
    heard.pass_by(1.0)
    assert heard.jogs == [5.0, 0.0] and heard.told == []


def test_a_press_of_the_past_is_none():
    heard = Heard()
    heard.message(1, sent=0.0)
    heard.under_test.take_stop({"type": "jog_stop", "axis": "x"})
    heard.now += 2.0
    heard.message(1, sent=1.0)  # a second late
    assert heard.jogs == [5.0, 0.0]
    text = "axis x: the jog came 1.00 s late; the axis stops; press the key again"
    assert [(message["type"], message["number"], message["text"]) for message in heard.told] == [
        ("jog_ended", 26243, text)
    ]


def test_clocks_that_drift_apart():
    """50 ppm: 0.36 s in two hours."""
    heard = Heard()
    for _ in range(12):
        heard.message(1, sent=(heard.now - 100.0) * (1.0 - 50e-6))
        heard.under_test.take_stop({"type": "jog_stop", "axis": "x"})
        heard.now += 600.0
    assert heard.jogs == [5.0, 0.0] * 12 and heard.told == []


def test_a_page_that_is_far_away():
    heard = Heard()
    heard.message(1, sent=0.0)
    assert heard.under_test.take_ping({"type": "ping", "time": 0.0, "round_trip": 151.0}) == 0.0
    heard.message(2, sent=0.0)
    heard.message(3, sent=0.0)
    heard.message(1, sent=0.0)
    assert heard.jogs == [5.0, 0.0]
    text = "axis x: 151 ms to the server and back, a jog takes at most 150 ms; the axis stops; press the key again"
    assert [(message["number"], message["text"]) for message in heard.told] == [(26259, text)] * 2
    heard.under_test.take_ping({"type": "ping", "time": 0.0, "round_trip": 20.0})
    heard.message(1, sent=0.0)
    assert heard.jogs == [5.0, 0.0, 5.0]


def test_a_ping_comes_back():
    async def story():
        async with site() as here:
            page = await here.page(commands=False)
            await page.send(type="ping", time=12.5)
            assert await page.wait_for("pong") == {"type": "pong", "time": 12.5}
            await page.send(type="ping", time="now")
            text = "ping: time = 'now' is not a number; nothing was done"
            assert (await page.wait_for("error"))["text"] == text

    asyncio.run(story())


def test_a_jog_that_the_machine_refuses_is_not_held():
    """Of a recording: there would be nothing to stop when the page ends."""
    heard = Heard()
    heard.face.jog = lambda axis, velocity, user: 1 / 0
    with pytest.raises(ZeroDivisionError):
        heard.message(1, sent=0.0)
    heard.under_test.end()


def test_a_whole_number_is_a_velocity_too():
    """JSON of a browser has 5 for 5.0, and a ROS message with it ends its process."""
    heard = Heard()
    heard.under_test.take({"type": "jog", "axis": "x", "velocity": 5, "sequence": 1, "time": 0})
    [velocity] = heard.jogs
    assert (velocity, type(velocity)) == (5.0, float)


def test_each_message_is_passed_on_once():
    heard = Heard()
    heard.message(1, sent=0.0)
    heard.now += 0.05
    heard.message(1, sent=0.05)  # the same number again is another press
    heard.now += 0.05
    heard.message(2, sent=0.1)
    heard.message(2, sent=0.1)  # twice: something is wrong with the page
    assert heard.jogs == [5.0, 5.0, 5.0, 0.0]


class Server:
    """What a server sends to the PLC."""

    def __init__(self, plc):
        self._jogs = PageJogs()
        self._plc, self._heard = plc, []
        for axis in ("x", "y"):
            self._jogs.add(axis, SimpleNamespace(publish=lambda message, axis=axis: self._take(axis, message)))

    def _take(self, axis, message):
        self._heard.append(self._plc.heard(axis, message, 0.0, paced=True))

    def jog(self, axis, velocity, client="web"):
        """The velocity that the PLC commands; None: it takes the message for an old one, or knows it already."""
        self._jogs.send(axis, velocity, client)
        return self._heard[-1]


def test_a_server_that_begins_again_jogs_each_axis():
    warned = []
    plc = JogTopics(lambda *warning: warned.append(warning))
    before, after = Server(plc), Server(plc)
    for velocity in (5.0, 6.0, 0.0):
        for axis in ("x", "y"):
            assert before.jog(axis, velocity) == velocity
    assert [after.jog(axis, 7.0) for axis in ("x", "y")] == [7.0, 7.0]
    assert warned == []


def test_a_server_that_begins_again_jogs_for_each_user():
    plc = JogTopics(lambda *warning: None)
    before, after = Server(plc), Server(plc)
    for client in ("web:anna", "web:otto"):
        assert [before.jog("x", velocity, client) for velocity in (5.0, 6.0, 0.0)] == [5.0, 6.0, 0.0]
    for client in ("web:otto", "web:anna"):
        assert [after.jog("x", velocity, client) for velocity in (7.0, 0.0)] == [7.0, 0.0]
