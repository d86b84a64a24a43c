"""A page says hello, sees the machine, commands it."""

import asyncio

from web_support import ROOT, site

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


def test_zero_offsets_and_their_changes():
    async def story():
        async with site() as here:
            page = await here.page()
            assert (await page.ask("offsets"))["axes"] == ["X", "Y", "Z"]
            assert (await page.command("channel", "set_zero_offset", index=2, axis="X", value=12.5))["ok"]
            assert (await page.command("channel", "teach_zero_offset", index=3))["ok"]
            await page.wait_for("event", lambda event: "teach_zero_offset" in event["text"])
            rows = {row["index"]: row for row in (await page.ask("offsets"))["offsets"]}
            assert rows[2] == {"index": 2, "name": "G55", "values": {"X": 12.5, "Y": 0.0, "Z": 0.0}}
            assert rows[3]["values"] == {"X": None, "Y": None, "Z": None}

    asyncio.run(story())


def test_the_curve_of_a_spindle():
    async def story():
        async with site(str(ROOT / "config" / "spindle_curves.yaml")) as here:
            await here.page()
            machine = here.hub.face
            spindle = next(unit for unit, kind in machine.kinds.items() if kind == "spindle")
            told = await (await here.client.get("/api/curve", params={"spindle": spindle})).json()
            points = told["gears"][0]["points"]
            assert len(points) == 101 and points[0]["speed"] == 0.0
            assert points[-1]["acceleration"] < points[0]["acceleration"]

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
