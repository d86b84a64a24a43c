"""Pages of a recording."""

import asyncio

import pytest
from web_support import MILL, site

from cnc_ptp.client import Machine
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
