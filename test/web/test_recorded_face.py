"""Pages of a recording."""

import asyncio

import numpy as np
import pytest
from web_support import MILL, site

from cnc_ptp.client import Machine
from cnc_ptp.commands.run.web import connector
from cnc_ptp.web.faces.program_watch import Load
from cnc_ptp.web.faces.recorded_face import RecordedFace
from cnc_ptp.web.faces.scope import HEAD


@pytest.fixture(scope="module")
def recording(tmp_path_factory):
    file = tmp_path_factory.mktemp("recorded") / "run.mcap"
    with Machine.offline(MILL, record=file) as m:
        m.channel.load("part.nc", text="G1 X10 F600\nX20\nM30\n")
        m.channel.start().wait()
    return str(file)


def test_a_page_looks_at_any_time_and_plays(recording):
    async def story():
        async with site(connect=lambda: RecordedFace(recording)) as here:
            page = await here.page(commands=False)
            machine = page.hello["machine"] or (await page.wait_for("hello"))["machine"]
            assert machine["recording"] and machine["end"] > 2.0
            assert (await page.ask("seek", time=1.5))["ok"]
            middle = await page.state_of("x", lambda x: 5.0 < x["set_position"] < 20.0)
            assert middle["state"] == "SynchronizedMotion"
            assert (await page.ask("play", speed=10))["ok"]
            await page.state_of("x", lambda x: x["set_position"] == 20.0)
            text = await (await here.client.get("/api/programs/part.nc")).text()
            assert text == "G1 X10 F600\nX20\nM30\n"

    asyncio.run(story())


def test_its_samples_and_its_parameters(recording):
    async def story():
        async with site(connect=lambda: RecordedFace(recording)) as here:
            await here.page(commands=False)
            query = {"signals": "x.set_position,y.state", "from": "0", "to": "1", "points": "100"}
            data = await (await here.client.get("/api/recorded", params=query)).read()
            step, low, high, signals, samples = HEAD.unpack_from(data)
            assert (low, high, signals) == (0, 0, 2)
            assert len(data) == HEAD.size + signals * samples * 4 and samples <= 100 and step * samples >= 1000
            listed = await (await here.client.get("/api/parameters", params={"unit": "x"})).json()
            assert {"id", "name", "value", "min", "max", "change"} <= listed["parameters"][0].keys()

    asyncio.run(story())


def test_nothing_is_commanded(recording):
    async def story():
        async with site(connect=lambda: RecordedFace(recording)) as here:
            page = await here.page()
            answer = await page.command("x", "halt")
            assert (answer["number"], answer["text"]) == (26248, "x: halt: this is a recording; nothing was done")

    asyncio.run(story())


def test_a_recording_without_a_text_reads_no_file(recording, tmp_path, monkeypatch):
    """The path of its program is one of another computer, or of today."""
    program = tmp_path / "part.nc"
    program.write_text("SECRET\n")

    def without_text(path):
        face = RecordedFace(path)
        face._programs = [(cycle, unit, Load(str(program), None)) for cycle, unit, _ in face._programs]
        return face

    async def story():
        async with site(connect=lambda: without_text(recording), programs=str(tmp_path)) as here:
            page = await here.page(commands=False)
            await page.ask("seek", time=1.5)
            await page.state_of("channel", lambda channel: channel.get("program"))
            text = "program 'part.nc': the recording does not have its text; nothing was read"
            for path in ("/api/programs/part.nc", "/api/programs/part.nc?channel=channel", "/api/backplot"):
                answer = await here.client.get(path)
                assert (answer.status, (await answer.json())["text"]) == (404, text)

    asyncio.run(story())


def test_seeks_while_it_plays_read_one_after_the_other(recording):
    async def story():
        face = RecordedFace(recording)
        running = asyncio.create_task(face.run())
        face.play(5.0)
        for _ in range(5):
            face._windows.clear()
            await asyncio.gather(*(face.seek(time) for time in (0.2, 1.4, 0.7)))
            assert face.time == pytest.approx(0.7, abs=0.2)
            assert all(block.first_cycle * 1e-3 < 2.0 for block in face._windows[0]["x"])
        running.cancel()
        face.close()

    asyncio.run(story())


def test_its_backplot_reads_only_what_it_has(tmp_path):
    file, called = tmp_path / "run.mcap", tmp_path / "sub.nc"
    called.write_text("G1 X77 F600\nM29\n")
    with Machine.offline(MILL, record=file) as m:
        m.channel.load(str(tmp_path / "part.nc"), text="L sub.nc\nM30\n")
        m.channel.start().wait()
    called.unlink()

    async def story():
        async with site(connect=lambda: RecordedFace(str(file)), programs=str(tmp_path)) as here:
            page = await here.page(commands=False)
            await page.ask("seek", time=1.0)
            await page.wait_for("program")
            answer = await here.client.get("/api/backplot")
            points = np.frombuffer(await answer.read(), "<f4", offset=16).reshape(-1, 5)
            assert points[:, 0].max() == 77.0

    asyncio.run(story())


def test_another_connection_reads_it_again(recording):
    connect = connector(recording)
    first, second = connect(), connect()
    first.close()
    assert asyncio.run(second.seek(1.5)) is None
    second.close()
