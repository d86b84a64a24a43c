"""Which program pages see: the one that the channel has accepted, whenever it was loaded."""

import asyncio

from web_support import site

from cnc_ptp.protocol.blocks import CommandRecord
from cnc_ptp.web.faces.program_watch import ProgramWatch
from cnc_ptp.web.programs.programs import ProgramFolder


def run(story, **options):
    async def told():
        async with site(**options) as here:
            await asyncio.wait_for(story(here), 60.0)

    asyncio.run(told())


async def text_of(here, name="part.nc"):
    return await (await here.client.get(f"/api/programs/{name}?channel=channel")).text()


def test_the_same_name_again(tmp_path):
    file = tmp_path / "part.nc"

    async def story(here):
        page = await here.page()
        for text in ("G1 X1 F600\nM30\n", "G1 X2 F600\nM30\n"):
            assert (await page.ask("load", name="part.nc", text=text))["ok"]
            assert (await page.wait_for("program")) == {"type": "program", "channel": "channel", "name": "part.nc"}
            assert await text_of(here) == text
        file.write_text("G1 X3 F600\nM30\n")
        assert (await page.ask("load", name="part.nc"))["ok"]
        await page.wait_for("program")
        assert await text_of(here) == "G1 X3 F600\nM30\n"
        file.write_text("G1 X4 F600\nM30\n")
        assert await text_of(here) == "G1 X3 F600\nM30\n"  # what was loaded, not what the file has become

    run(story, programs=str(tmp_path))


def test_a_load_that_is_refused_shows_nothing_new(tmp_path):
    async def story(here):
        page = await here.page()
        assert (await page.ask("load", name="part.nc", text="G1 X1 F600\nM30\n"))["ok"]
        await page.wait_for("program")
        assert not (await page.ask("load", name="part.nc", text="G1 X1O F600\n"))["ok"]
        await page.state_of("channel", lambda channel: True)
        assert await text_of(here) == "G1 X1 F600\nM30\n"
        assert not [message for message in page.waiting if message["type"] == "program"]

    run(story, programs=str(tmp_path))


def loaded(channel, path, text, *, accepted=True):
    return CommandRecord(1, channel, "load", {"program": path, "text": text}, accepted, 0, "")


def test_what_no_channel_takes_as_a_program_is_none(tmp_path):
    """Anybody on the graph may publish a record."""
    watch = ProgramWatch(ProgramFolder(tmp_path))
    for path, text in ((5, "M30"), ("a.nc", 5), ("a.nc", ["M30"])):
        watch.take_record(loaded("channel", path, text))
    assert watch.all() == []


def test_two_channels_with_programs_of_one_name(tmp_path):
    watch = ProgramWatch(ProgramFolder(str(tmp_path)))
    watch.take_record(loaded("a", "/one/part.nc", "A"))
    watch.take_record(loaded("b", "/two/part.nc", "B"))
    assert (watch.text("part.nc", "a"), watch.text("part.nc", "b")) == ("A", "B")
    assert [told["channel"] for told in watch.news()] == ["a", "b"]
    assert watch.news() == []


def test_a_state_that_is_behind_its_records(tmp_path):
    watch = ProgramWatch(ProgramFolder(str(tmp_path)))
    watch.take_record(loaded("a", "/one.nc", "1"))
    watch.take_record(loaded("a", "/two.nc", "2"))
    for path, text in (("/one.nc", "1"), ("/two.nc", "2")):
        watch.take_state({"a": {"program": path}}, {})
        assert watch.loaded_text("a").text == text
