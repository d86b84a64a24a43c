"""Distances to go of axes: on a path, in feed hold, of a positioning; and the tool on the path that is drawn."""

import asyncio

import numpy as np
import pytest
from web_support import MILL, ROOT, site

from cnc_ptp.web.faces.machine_face import offline_face
from cnc_ptp.web.programs.backplot import COLUMNS, HEAD, Drawing, draw

LINE = "G01 X30 Y40 F3000\nM30\n"


def test_an_axis_in_feed_hold_keeps_its_part_of_the_distance(tmp_path):
    """50 mm along a line, 30 of them in x and 40 in y."""

    (tmp_path / "line.nc").write_text(LINE)

    async def story():
        async with site(programs=str(tmp_path)) as here:
            page = await here.page()
            assert (await page.ask("load", name="line.nc"))["ok"]
            assert (await page.command("channel", "start"))["ok"]
            await page.state_of("x", lambda x: x.get("set_position", 0.0) > 2.0)
            assert (await page.command("channel", "feed_hold", enabled=True))["ok"]
            channel = await page.state_of(
                "channel", lambda each: each.get("state") == "hold" and each.get("feed") == 0.0
            )
            view = here.hub.shared
            states = view._state
            assert 0.0 < channel["distance_to_go"] < 48.0
            for axis, share in (("x", 0.6), ("y", 0.8), ("z", 0.0)):
                left = share * states["channel"]["distance_to_go"]
                assert states[axis]["distance_to_go"] == pytest.approx(left, abs=1e-3)
            assert states["x"]["set_position"] + states["x"]["distance_to_go"] == pytest.approx(30.0, abs=1e-3)
            assert (await page.command("channel", "feed_hold", enabled=False))["ok"]
            await page.state_of("x", lambda x: x.get("set_position") == 30.0 and x.get("distance_to_go") == 0.0)

    asyncio.run(story())


def test_an_axis_that_is_positioned_has_the_distance_to_its_target():
    async def story():
        async with site() as here:
            page = await here.page()
            assert (await page.command("x", "move_absolute", target=20, velocity=10))["ok"]
            moving = await page.state_of("x", lambda x: 3.0 < x.get("set_position", 0.0) < 19.0)
            assert moving["distance_to_go"] == pytest.approx(20.0 - moving["set_position"], abs=1e-3)
            assert (await page.command("x", "stop"))["ok"]
            await page.state_of("x", lambda x: x.get("state") == "Standstill" and x.get("distance_to_go") == 0.0)

    asyncio.run(story())


@pytest.mark.parametrize("program", ["pocket.nc", "bracket.nc"])
def test_the_tool_is_on_the_path_that_is_drawn(program):
    """Set positions of the axes, whatever offsets programs use."""
    face = offline_face(MILL, stands=True)
    file = ROOT / "examples" / program
    drawn = draw(Drawing("channel", face.kinds, face.sets, face.cycle_time, file.read_text(), str(file)))
    path = np.frombuffer(drawn, "<f4", offset=HEAD.size).reshape(-1, COLUMNS)[:, :3].astype(float)

    async def story():
        assert (await face.ask("channel", "load", {"program": str(file)}, user="u")).error_id == 0
        assert (await face.ask("channel", "start", {}, user="u")).error_id == 0

    asyncio.run(story())
    farthest = shift = 0.0
    for _ in range(20):
        for _ in range(20):
            face.step()
        states = face.state()
        tool = np.array([states[axis]["set_position"] for axis in "xyz"])
        farthest = max(farthest, distance(path, tool))
        shift = max(shift, *(abs(states[axis]["set_position"] - states[axis]["work_position"]) for axis in "xyz"))
    face.close()
    assert farthest < 0.01
    assert (shift > 1.0) == (program == "pocket.nc")


def distance(path, point):
    """Of a point from a polyline."""
    begin, along = path[:-1], np.diff(path, axis=0)
    squares = np.maximum((along**2).sum(1), 1e-12)
    share = np.clip(((point - begin) * along).sum(1) / squares, 0.0, 1.0)
    return float(np.sqrt(((begin + share[:, None] * along - point) ** 2).sum(1)).min())
