"""A page says hello, sees the machine, commands it."""

import asyncio

from web_support import site


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
