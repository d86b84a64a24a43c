"""A page says hello, sees the machine, commands it."""

import asyncio
from math import sqrt

import numpy as np
import pytest
from web_support import ROOT, site

from cnc_ptp.commands.run.web import words_of
from cnc_ptp.parameters import CurveParameters, read_machine
from cnc_ptp.spindle.acceleration_curves import AccelerationCurve
from cnc_ptp.web.commissioning.spindle_curve import curve_points, spindle_curve
from cnc_ptp.web.programs.backplot import HEAD


def test_a_page_sees_the_machine_and_moves_an_axis():
    async def story():
        async with site() as here:
            page = await here.page()
            names = [unit["name"] for unit in page.hello["machine"]["units"]]
            assert names == ["plc", "channel", "s", "x", "y", "z"]
            assert (page.hello["user"], page.hello["role"]) == ("web", "commissioner")
            answer = await page.command("x", "move_absolute", target=1.5)
            assert answer["ok"], answer
            await page.state_of("x", lambda x: x["set_position"] == 1.5 and x["state"] == "Standstill")

    asyncio.run(story())


def test_a_refusal_has_number_text_cause_and_remedy():
    async def story():
        async with site() as here:
            page = await here.page()
            answer = await page.command("x", "move_absolute", target=5000)
            assert answer == {
                "type": "answer",
                "id": 2,
                "ok": False,
                "number": answer["number"],
                "text": answer["text"],
                "cause": answer["cause"],
                "remedy": answer["remedy"],
            }
            assert answer["number"] and answer["cause"] and answer["remedy"]
            event = await page.wait_for("event", lambda event: event["number"] == answer["number"])
            assert (event["source"], event["severity"], event["acknowledged"]) == ("x", "warning", False)

    asyncio.run(story())


def test_a_program_is_listed_loaded_and_run():
    async def story():
        async with site() as here:
            page = await here.page()
            listed = await (await here.client.get("/api/programs")).json()
            assert "bracket.nc" in [program["name"] for program in listed["programs"]]
            assert (await page.ask("load", name="pocket.nc"))["ok"]
            assert (await page.wait_for("program"))["name"] == "pocket.nc"
            text = await (await here.client.get("/api/programs/pocket.nc")).text()
            assert text.startswith("; A pocket in layers")
            drawn = await (await here.client.get("/api/backplot", params={"channel": "channel"})).read()
            assert HEAD.unpack_from(drawn)[:3] == (1, (len(drawn) - HEAD.size) // 20, 0)
            assert (await page.command("channel", "start"))["ok"]
            await page.state_of("channel", lambda channel: channel["line"] > 3 and channel["active"])

    asyncio.run(story())


def test_the_scope_has_every_cycle():
    async def story():
        async with site() as here:
            page = await here.page()
            answer = await page.ask("scope", signals=["x.set_position", "channel.line"])
            assert answer["ok"], answer
            await page.command("x", "move_absolute", target=1)
            frames = [await page.frame() for _ in range(10)]
            cycles = [cycle for first, values in frames for cycle in range(first, first + values.shape[1])]
            assert cycles == [*range(cycles[0], cycles[0] + len(cycles))]
            assert frames[0][1].shape[0] == 2

    asyncio.run(story())


def test_the_curve_of_a_spindle():
    async def story():
        async with site(str(ROOT / "config" / "spindle_curves.yaml")) as here:
            await here.page()
            machine = here.hub.face
            spindle = next(unit for unit, kind in machine.kinds.items() if kind == "spindle")
            told = await (await here.client.get("/api/curve", params={"spindle": spindle})).json()
            points = told["gears"][0]["points"]
            assert [point["break"] for point in points].count(False) == 101 and points[0]["speed"] == 0.0
            assert points[-1]["acceleration"] < points[0]["acceleration"]

    asyncio.run(story())


BREAKS = {
    "polynomial": [(2000.0, 16000.0), (8000.0, 2000.0)],
    "hyperbola": [(2000.0, 16000.0)],
    "asynchronous": [(10000.0 / 6, 16000.0), (20000.0 / 6, 8000.0), (sqrt(16000.0 * 1e4 * 2e4 / 4000.0) / 6, 4000.0)],
}
"""Speed (rpm) and acceleration (deg/s²) of config/spindle_curves.yaml where the law changes: n_grenz, n1, n2, a_min."""


def test_the_break_points_of_the_curves_are_exact_and_in_their_order():
    machine = read_machine(str(ROOT / "config" / "spindle_curves.yaml"))
    for spindle, expected in BREAKS.items():
        (gear,) = spindle_curve(machine.sets[spindle], 1e-3)
        speeds = [point["speed"] for point in gear["points"]]
        assert speeds == sorted(speeds)
        found = [(point["speed"], point["acceleration"]) for point in gear["points"] if point["break"]]
        assert np.array(found) == pytest.approx(np.array(expected), rel=1e-6)


def test_both_sides_of_a_step_are_points():
    """A hyperbola whose b1 does not meet a_konst at n_grenz: 6000 °/s² before, 5000 °/s² behind it."""
    parameters = CurveParameters("hyperbola", 100.0, 6000.0, 6000.0, 5000.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    curve = AccelerationCurve(parameters, top_speed=12000.0)
    points = curve_points(curve, [0.0, 6000.0, 12000.0])
    assert points == [(0.0, 6000.0, False), (6000.0, 6000.0, True), (6000.0, 5000.0, True), (12000.0, 5000.0, False)]


def test_the_words_of_a_channel():
    async def story():
        async with site(words=words_of) as here:
            await here.page(commands=False)
            listed = (await (await here.client.get("/api/words", params={"channel": "channel"})).json())["words"]
            words = {word["name"]: word["meaning"] for word in listed}
            assert words["G00"] == "Straight at rapid speed." and "M03" in words and "#TIMER START" in words
            assert "G106" not in words  # not built
            assert (await here.client.get("/api/words", params={"channel": "x"})).status == 400
            query = {"channel": "channel"}
            answers = [(await here.client.get("/api/words", params=query)).status for _ in range(70)]
            assert answers[:20] == [200] * 20 and 429 in answers

    asyncio.run(story())


def test_switches_and_tools():
    async def story():
        async with site() as here:
            page = await here.page()
            assert (await page.command("channel", "single_block", enabled=True))["ok"]
            await page.state_of("channel", lambda channel: channel.get("single_block") is True)
            assert (await page.command("channel", "single_block", enabled=False))["ok"]
            assert (await page.ask("load", name="part.nc", text="T2\nM30\n"))["ok"]
            assert (await page.command("channel", "start"))["ok"]
            await page.state_of("channel", lambda channel: channel.get("tool") == 2)

    asyncio.run(story())
