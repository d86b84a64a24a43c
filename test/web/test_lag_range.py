"""The lag of an axis between two states that pages see: of every cycle."""

import asyncio

import pytest
from web_support import site

from cnc_ptp.protocol.blocks import AxisBlock, SpindleBlock
from cnc_ptp.web.faces.lag_range import lag_ranges


def test_all_blocks_of_an_axis_count_and_no_others():
    lags = ([0.1, -0.3, 0.2], [0.25, 0.4, 0.1])
    blocks = [("x", AxisBlock(3 * n, 3, following_error=lag)) for n, lag in enumerate(lags)]
    blocks += [("y", AxisBlock(0, 1, following_error=[0.0])), ("s", SpindleBlock(0, 1))]
    assert lag_ranges(blocks) == {"x": {"lag_low": -0.3, "lag_high": 0.4}, "y": {"lag_low": 0.0, "lag_high": 0.0}}
    assert lag_ranges([]) == {}


def test_a_page_gets_the_largest_lag_of_a_motion():
    """At constant velocity the lag is v/Kv; the states of a page are single cycles of it."""

    async def story():
        async with site() as here:
            page = await here.page()
            assert (await page.command("x", "move_absolute", target=10, velocity=50))["ok"]
            limits = next(unit for unit in here.hub.shared.face.machine()["units"] if unit["name"] == "x")["limits"]
            largest = 0.0
            while True:
                x = (await page.wait_for("state"))["units"].get("x", {})
                largest = max(largest, x.get("lag_high", 0.0))
                if x.get("set_position") == 10.0:
                    break
            assert largest == pytest.approx(50.0 / limits["kv"], rel=0.02)

    asyncio.run(story())
