"""Pages of a recording, on the true server: each page has a time of its own."""

import asyncio
import threading
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from web_browser_support import InThread, open_page, until
from web_support import EXAMPLES, MILL

from cnc_ptp.client import Machine
from cnc_ptp.errors import CncError
from cnc_ptp.recording.opened import OpenRecording
from cnc_ptp.web.access.access import Access
from cnc_ptp.web.access.guard import Names
from cnc_ptp.web.faces.recorded_face import RecordedFace, recorded_face
from cnc_ptp.web.hub import Hub
from cnc_ptp.web.programs.programs import ProgramFolder
from cnc_ptp.web.server import Server

SLIDER = "document.querySelector('.recording-bar input')"


def recorded(file, run):
    """The recording of a run of the mill, made in another thread: in this one the loop of the browser runs."""

    def record():
        with Machine.offline(MILL, record=file) as m:
            run(m)

    with ThreadPoolExecutor(1) as thread:
        thread.submit(record).result()
    return str(file)


@pytest.fixture(scope="module")
def recording(tmp_path_factory):
    def run(m):
        m.channel.load("part.nc", text="G1 X40 F240\nM30\n")  # 10 s
        m.channel.start().wait(timeout=60)

    return recorded(tmp_path_factory.mktemp("recorded") / "run.mcap", run)


@pytest.fixture(scope="module")
def failed(tmp_path_factory):
    """Two programs that fail, one after the other."""

    def run(m):
        for target in (10, 20):
            job = m.channel.run("part.nc", text=f"N10 G1 X{target} F6000\nN20 G1 X=V.A.ACT_POS.X*100\nM30\n")
            with pytest.raises(CncError, match="line 2 "):
                job.wait()
            m.run_for(0.2)
            m.channel.reset().wait()

    return recorded(tmp_path_factory.mktemp("failed") / "run.mcap", run)


@pytest.fixture
def look_at(browser, request):
    """Opens pages of a recording, which a test may choose."""
    recording = request.getfixturevalue(getattr(request, "param", "recording"))
    hub = Hub(lambda: recorded_face(recording), name="run", folder=ProgramFolder(EXAMPLES))
    with InThread(Server(hub, Access(None), Names()).app) as server:
        pages = []

        def open_one(name="watch"):
            pages.append(open_page(browser, f"{server.url}#{name}"))
            return pages[-1]

        yield open_one
        complaints = [text for page in pages for text in page.complaints.texts]
        for page in pages:
            page.close()
        assert complaints == []


def seek(page, time):
    page.evaluate(f"() => {{ {SLIDER}.value = {time}; {SLIDER}.dispatchEvent(new Event('change')); }}")
    until(page, f"Math.abs(app.store.time - {time}) < 1e-3")


def test_what_one_page_plays_moves_no_other(look_at):
    playing, standing = look_at(), look_at()
    seek(standing, 2.0)
    there = standing.evaluate("app.store.units.x.set_position")
    playing.click("button:text-is('Play')")
    playing.wait_for_selector("button:text-is('Pause')")
    until(playing, "app.store.units.x.set_position > 1")
    assert standing.locator("button:text-is('Play')").count() == 1
    assert standing.evaluate("[app.store.time, app.store.units.x.set_position]") == [2.0, there]
    seek(standing, 4.0)
    until(standing, f"app.store.units.x.set_position > {there}")
    before = playing.evaluate("app.store.time")
    until(playing, f"app.store.time > {before}")
    standing.click("button:text-is('Play')")
    standing.wait_for_selector("button:text-is('Pause')")
    playing.click("button:text-is('Pause')")
    playing.wait_for_selector("button:text-is('Play')")
    paused = playing.evaluate("app.store.time")
    until(standing, "app.store.time > 4.5")
    assert playing.evaluate("app.store.time") - paused < 0.2  # the states that were on their way
    assert standing.locator("button:text-is('Pause')").count() == 1


def test_a_seek_that_takes_long_does_not_jump_back(look_at, monkeypatch):
    page, may_answer = look_at(), threading.Event()
    answered = RecordedFace.seek

    async def slow(self, time):
        while not may_answer.is_set():
            await asyncio.sleep(0.01)
        return await answered(self, time)

    monkeypatch.setattr(RecordedFace, "seek", slow)
    page.evaluate(f"() => {{ {SLIDER}.value = 5; {SLIDER}.dispatchEvent(new Event('change')); }}")
    page.wait_for_selector("output:text-is('5.000 s is read …')")
    page.wait_for_timeout(1000)
    assert page.evaluate(f"{SLIDER}.value") == "5"
    may_answer.set()
    until(page, "app.store.time === 5")
    page.wait_for_selector("output:text-matches('^5.000 s of')")


def test_it_plays_to_its_end_and_begins_again(look_at):
    page = look_at()
    end = page.evaluate("app.store.machine.end")
    seek(page, end - 0.5)
    page.click("button:text-is('Play')")
    until(page, f"Math.abs(app.store.time - {end}) < 1e-3")
    page.wait_for_selector("button:text-is('Play')")
    assert page.evaluate("app.store.units.x.set_position") == 40
    page.click("button:text-is('Play')")
    until(page, "app.store.units.x.set_position < 20")


def test_the_scope_of_a_recording_is_not_rounded(look_at):
    page = look_at("scope")
    seek(page, 3.0)
    until(page, "document.querySelector('main').innerText.includes('2001 samples')")
    rounded = page.evaluate(
        """async () => {
        const { readRecorded } = await import("/static/scope/samples.js");
        const read = (bits) => app.connection.http(`/api/recorded?signals=x.set_position&from=2&to=3&points=1001&bits=${bits}`, { as: "bytes" });
        const [exact, short] = [readRecorded(await read(64)), readRecorded(await read(32))];
        return [exact.count, short.count, exact.columns[0].some((value) => value !== Math.fround(value)), exact.columns[0].every((value, i) => Math.fround(value) === short.columns[0][i])];
    }"""
    )
    assert rounded == [1001, 1001, True, True]


def test_the_backplot_is_that_of_the_program_of_its_time(look_at):
    page = look_at()
    seek(page, 5.0)
    page.wait_for_selector("[data-ms]")
    page.wait_for_selector("text=1 segments")


def columns(file, *names, **times):
    """Fields of axis x, as the recording has them."""
    with OpenRecording(file) as opened:
        found = opened.columns("/x/state", *names, **times)
        return [found[name] for name in names]


def test_the_scope_has_every_cycle_of_a_long_window(look_at, recording):
    page = look_at("scope")
    page.select_option("label:text-is('Window') + select", "10")
    seek(page, 5.0)
    until(page, "document.querySelector('main').innerText.includes('10001 samples')")
    assert "one of every" not in page.inner_text("main")
    with page.expect_download() as download:
        page.click("text=Export CSV")
    lines = Path(download.value.path()).read_text(encoding="utf-8").splitlines()
    assert lines[0] == "cycle,time,x.set_velocity,x.following_error"
    rows = np.array([[float(text) for text in line.split(",")] for line in lines[1:]])
    cycles, velocity, error = columns(recording, "cycle", "set_velocity", "following_error", start=0.0, end=10.0)
    assert len(rows) == 10_000
    assert rows[:, 0].tolist() == cycles[1:].tolist()
    assert np.abs(rows[:, 1] - rows[:, 0] * 1e-3).max() < 1e-9
    assert (rows[:, 2:] == np.column_stack([velocity, error])[1:]).all()


def test_a_thinned_window_says_so_and_keeps_its_cycles(look_at, recording):
    """The ring is made so small here that the window does not fit."""
    page = look_at("scope")
    until(page, "document.querySelector('main').innerText.includes('2001 samples')")
    page.evaluate(
        """async () => {
        const { Ring } = await import("/static/scope/samples.js");
        Ring.prototype.clear = function () { Object.assign(this, { capacity: 600, end: 0, length: 0, lost: 0 }); };
    }"""
    )
    seek(page, 2.5)
    seek(page, 3.002)
    until(page, "document.querySelector('main').innerText.includes('501 samples, one of every 4 cycles')")
    page.click("button:text-is('Freeze')")
    with page.expect_download() as download:
        page.click("text=Export CSV")
    lines = Path(download.value.path()).read_text(encoding="utf-8").splitlines()
    rows = np.array([[float(text) for text in line.split(",")] for line in lines[1:]])
    cycles, velocity = columns(recording, "cycle", "set_velocity", start=2.002, end=4.002)
    assert rows[:, 0].tolist() == cycles[4::4].tolist()
    assert np.abs(rows[:, 1] - rows[:, 0] * 1e-3).max() < 1e-9
    assert (rows[:, 2] == velocity[4::4]).all()


ALARMS = "app.store.alarms.map(({ alarm, text }) => [alarm, text])"


@pytest.mark.parametrize("look_at", ["failed"], indirect=True)
def test_alarms_are_those_of_the_time_that_is_shown(look_at):
    page = look_at("alarms")
    end = page.evaluate("app.store.machine.end")
    cards, rows = page.locator(".alarm"), page.locator(".events tbody tr")
    assert page.inner_text(".alarm-count") == "No alarms"
    page.evaluate(f"() => {{ {SLIDER}.value = {end}; {SLIDER}.dispatchEvent(new Event('change')); }}")
    page.wait_for_selector(".alarm-count[data-kind=bad]")
    whole = page.evaluate(ALARMS)
    assert [number for number, _ in whole] == [*range(1, len(whole) + 1)] and len(whole) >= 2
    assert cards.count() == len(whole) and page.inner_text(".alarm-count") == f"{len(whole)} alarms"
    events = rows.count()
    assert events >= len(whole)

    last = page.evaluate("app.store.alarms.findLast(({ severity }) => severity === 'error').time")
    seek(page, round(last - 0.01, 3))
    until(page, f"app.store.alarms.length < {len(whole)}")
    early = page.evaluate(ALARMS)
    assert early == whole[: len(early)] and cards.count() == len(early) >= 1
    assert rows.count() < events
    page.click("button:text-is('Play')")
    until(page, f"Math.abs(app.store.time - {end}) < 1e-3")
    page.wait_for_selector("button:text-is('Play')")
    assert page.evaluate(ALARMS) == whole
    assert (cards.count(), rows.count()) == (len(whole), events)

    seek(page, 0)
    page.wait_for_selector(".alarm-count[data-kind=off]")
    assert cards.count() == 0 and page.inner_text(".alarm-count") == "No alarms"
