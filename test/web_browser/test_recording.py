"""Pages of a recording, on the true server: each page has a time of its own."""

from concurrent.futures import ThreadPoolExecutor

import pytest
from web_browser_support import InThread, open_page, until
from web_support import EXAMPLES, MILL

from cnc_ptp.client import Machine
from cnc_ptp.web.access.access import Access
from cnc_ptp.web.access.guard import Names
from cnc_ptp.web.faces.recorded_face import recorded_face
from cnc_ptp.web.hub import Hub
from cnc_ptp.web.programs.programs import ProgramFolder
from cnc_ptp.web.server import Server

SLIDER = "document.querySelector('.recording-bar input')"


@pytest.fixture(scope="module")
def recording(tmp_path_factory):
    file = tmp_path_factory.mktemp("recorded") / "run.mcap"

    def record():
        with Machine.offline(MILL, record=file) as m:
            m.channel.load("part.nc", text="G1 X40 F240\nM30\n")  # 10 s
            m.channel.start().wait(timeout=60)

    with ThreadPoolExecutor(1) as thread:  # in this one the loop of the browser runs
        thread.submit(record).result()
    return str(file)


@pytest.fixture
def look_at(browser, recording):
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
