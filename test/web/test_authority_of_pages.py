"""Command authority of pages: a unit that the machine file closes to them, and one that it closes to services."""

import asyncio
from pathlib import Path

import pytest
from web_support import MILL, site

PLACE = "    spindles: [s]\n"


def run(story, **options):
    async def told():
        async with site(**options) as here:
            await asyncio.wait_for(story(here), 60.0)

    asyncio.run(told())


def closed(folder, source):
    """The mill with x closed to a source."""
    text = Path(MILL).read_text()
    assert PLACE in text
    file = folder / "closed.yaml"
    file.write_text(text.replace(PLACE, f"{PLACE}    closed_to_{source}: [x]\n", 1))
    return str(file)


@pytest.mark.parametrize(("source", "number"), [("pages", "P-MACH-00084"), ("services", "P-MACH-00083")])
def test_a_command_of_a_page(tmp_path, source, number):
    async def story(here):
        page = await here.page()
        refused = await page.command("x", "move_absolute", target=1)
        text = f"axis x: move_absolute refused: the machine file closes it to {source} (closed_to_{source}, {number})"
        assert (refused["number"], refused["text"]) == (26218, f"{text}; nothing was changed")
        assert (await page.command("y", "move_absolute", target=1))["ok"]
        assert (await page.command("x", "halt")).get("number") != 26218
        told = await page.wait_for("event", lambda event: event["source"] == "web" and "refused" in event["text"])
        assert told["text"] == "web: axis x: move_absolute, refused with P-ERR-26218"

    run(story, machine=closed(tmp_path, source))


def test_a_trajectory_of_a_page(tmp_path):
    """It is a command to the PLC, which is open; the axis is not."""

    async def story(here):
        page = await here.page()
        points = [[1.0, 1.0]]
        refused = await page.command("plc", "follow_trajectory", axes=["y", "x"], points=points)
        rule = "the machine file closes it to pages (closed_to_pages, P-MACH-00084)"
        text = f"plc plc: follow_trajectory refused: axis x: {rule}; nothing was changed"
        assert (refused["number"], refused["text"]) == (26218, text)

    run(story, machine=closed(tmp_path, "pages"))


@pytest.mark.parametrize(
    ("source", "number"), [("pages", "P-MACH-00084"), ("services", "P-MACH-00083"), ("topics", "P-MACH-00082")]
)
def test_a_jog_of_a_page(tmp_path, source, number):
    """It leaves on a topic, whatever it was on its way to it; a jog of 0 is open."""

    async def story(here):
        page = await here.page()
        await page.send(type="jog", axis="x", velocity=5.0, sequence=1, time=0.0)
        error = await page.wait_for("error")
        rule = f"the machine file closes it to {source} (closed_to_{source}, {number})"
        assert (error["number"], error["text"]) == (26218, f"axis x: jog refused: {rule}; nothing was changed")
        here.hub.face.jog("x", 0.0, user="web")
        here.hub.face.jog("y", 5.0, user="web")

    run(story, machine=closed(tmp_path, source))
