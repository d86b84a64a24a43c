"""Pages of a recording."""

import asyncio

import numpy as np
import pytest
from web_support import MILL, site

from cnc_ptp.client import Machine
from cnc_ptp.commands.run.web import connector
from cnc_ptp.recording.opened import OpenRecording
from cnc_ptp.web.faces.program_watch import Load
from cnc_ptp.web.faces.recorded_face import recorded_face
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
        async with site(connect=lambda: recorded_face(recording)) as here:
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
        async with site(connect=lambda: recorded_face(recording)) as here:
            await here.page(commands=False)
            query = {"signals": "x.set_position,y.state", "from": "0", "to": "1", "points": "100"}
            data = await (await here.client.get("/api/recorded", params=query)).read()
            step, low, high, signals, samples = HEAD.unpack_from(data)
            assert (low, high, signals) == (0, 0, 2)
            assert len(data) == HEAD.size + signals * samples * 8 and samples <= 100 and step * samples >= 1000
            listed = await (await here.client.get("/api/parameters", params={"unit": "x"})).json()
            assert {"id", "name", "value", "min", "max", "change"} <= listed["parameters"][0].keys()

    asyncio.run(story())


def test_its_samples_are_not_rounded(recording):
    """As the recording has them, to the last bit; with 32 bits where a page draws only."""

    async def story():
        async with site(connect=lambda: recorded_face(recording)) as here:
            await here.page(commands=False)
            query = {"signals": "x.set_position", "from": "0.5", "to": "1", "points": "1000"}
            exact = await (await here.client.get("/api/recorded", params=query)).read()
            short = await (await here.client.get("/api/recorded", params={**query, "bits": "32"})).read()
            samples = np.frombuffer(exact, "<f8", offset=HEAD.size)
            with OpenRecording(recording) as opened:
                wanted = opened.columns("/x/state", "set_position", start=0.5, end=1.0)["set_position"]
            assert samples.tobytes() == wanted.tobytes() and len(samples) >= 500
            assert np.frombuffer(short, "<f4", offset=HEAD.size).tobytes() == wanted.astype("<f4").tobytes()
            assert (wanted != wanted.astype("<f4")).any()

    asyncio.run(story())


def positions(page):
    """x of all states that have come and nobody has waited for."""
    states = [message["units"].get("x", {}) for message in page.waiting if message["type"] == "state"]
    return [state["set_position"] for state in states if "set_position" in state]


def test_each_page_has_its_own_time(recording):
    """What one plays, and where it looks, moves nothing on another."""

    async def story():
        async with site(connect=lambda: recorded_face(recording)) as here:
            playing, looking = await here.page(commands=False), await here.page(commands=False)
            begin = await playing.state_of("x", lambda x: True)
            assert begin["set_position"] == 0.0
            assert (await looking.ask("seek", time=1.5))["time"] == 1.5
            there = await looking.state_of("x", lambda x: 5.0 < x["set_position"] < 20.0)
            assert (await playing.ask("play", speed=20))["ok"]
            await playing.state_of("x", lambda x: x["set_position"] == 20.0)
            assert (await looking.ask("ping"))["ok"]
            assert set(positions(looking)) <= {there["set_position"]}
            assert (await looking.ask("seek", time=0.0))["time"] == 0.0
            await looking.state_of("x", lambda x: x["set_position"] == 0.0)
            assert (await playing.ask("ping"))["ok"]
            assert set(positions(playing)) <= {20.0}
            assert (await looking.ask("play", speed=0.0))["ok"]

    asyncio.run(story())


def test_each_page_has_the_program_of_its_time(tmp_path):
    file = tmp_path / "run.mcap"
    with Machine.offline(MILL, record=file) as m:
        for target in (10, 20):
            m.channel.load("part.nc", text=f"G1 X{target} F6000\nM30\n")
            m.channel.start().wait()

    async def furthest(here, **query):
        points = np.frombuffer(await (await here.client.get("/api/backplot", params=query)).read(), "<f4", offset=16)
        return points.reshape(-1, 5)[:, 0].max()

    async def story():
        async with site(connect=lambda: recorded_face(str(file))) as here:
            early, late = await here.page(commands=False), await here.page(commands=False)
            await early.ask("seek", time=0.05)
            await early.wait_for("program")
            await late.ask("seek", time=here.hub.face.end)
            await late.wait_for("program")
            drawn = [await furthest(here, page=page.hello["page"]) for page in (early, late)]
            assert drawn == [10.0, 20.0]
            assert await furthest(here) == 20.0
            text = await (await here.client.get(f"/api/programs/part.nc?page={early.hello['page']}")).text()
            assert text == "G1 X10 F6000\nM30\n"

    asyncio.run(story())


def test_the_end_of_a_recording_stays_until_it_is_played_again(recording):
    async def story():
        async with site(connect=lambda: recorded_face(recording)) as here:
            page = await here.page(commands=False)
            end = here.hub.face.end
            assert (await page.ask("seek", time=end + 1.0))["time"] == end
            assert (await page.ask("play", speed=0.0))["ok"]
            await page.state_of("x", lambda x: x["set_position"] == 20.0)
            assert (await page.ask("play", speed=1.0))["ok"]
            await page.state_of("x", lambda x: x["set_position"] < 10.0)

    asyncio.run(story())


def test_a_page_that_leaves_closes_no_file_of_another(recording):
    async def story():
        async with site(connect=lambda: recorded_face(recording)) as here:
            leaving, staying = await here.page(commands=False), await here.page(commands=False)
            await leaving.socket.close()
            while len(here.hub.sessions) > 1:
                await asyncio.sleep(0.01)
            assert (await staying.ask("seek", time=1.5))["ok"]
            await staying.state_of("x", lambda x: 5.0 < x["set_position"] < 20.0)

    asyncio.run(story())


def test_nothing_is_commanded(recording):
    async def story():
        async with site(connect=lambda: recorded_face(recording)) as here:
            page = await here.page()
            answer = await page.command("x", "halt")
            assert (answer["number"], answer["text"]) == (26248, "x: halt: this is a recording; nothing was done")

    asyncio.run(story())


def test_a_recording_without_a_text_reads_no_file(recording, tmp_path, monkeypatch):
    """The path of its program is one of another computer, or of today."""
    program = tmp_path / "part.nc"
    program.write_text("SECRET\n")

    def without_text(path):
        face = recorded_face(path)
        face.file.programs = [(cycle, unit, Load(str(program), None)) for cycle, unit, _ in face.file.programs]
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
        face = recorded_face(recording)
        running = asyncio.create_task(face.run())
        face.play(1.0)
        for _ in range(5):
            face.file._windows.clear()
            face._windows.clear()
            await asyncio.gather(*(face.seek(time) for time in (0.2, 1.4, 0.7)))
            assert 0.7 <= face.time < 1.4
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
        async with site(connect=lambda: recorded_face(str(file)), programs=str(tmp_path)) as here:
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


def test_no_snapshot_and_no_jog_of_a_recording(recording):
    async def story():
        async with site(connect=lambda: recorded_face(recording)) as here:
            page = await here.page()
            answer = await here.client.get("/api/snapshot.mcap")
            assert (await answer.json())["text"] == "snapshot: this is a recording; nothing was done"
            await page.send(type="jog", axis="x", velocity=1.0, sequence=1, time=0.0)
            assert (await page.wait_for("error"))["text"] == "x: jog: this is a recording; nothing was done"
            await page.socket.close()
            while here.hub.sessions:
                await asyncio.sleep(0.01)
            assert here.hub.right.holder is None

    asyncio.run(story())
