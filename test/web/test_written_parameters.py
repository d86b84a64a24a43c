"""Pages see parameters as they are now, whoever has written them."""

import asyncio

import pytest
from web_support import ROOT, site

from cnc_ptp.protocol.blocks import CommandRecord
from cnc_ptp.web.faces.machine_face import offline_face

PTP = str(ROOT / "config" / "ptp.yaml")
SOFT_LIMIT = "P-AXIS-00178"


def test_a_parameter_that_was_written_is_read_and_its_limit_is_told():
    async def story():
        async with site(PTP) as here:
            page, other = await here.page(), await here.page(commands=False)
            before = await parameter(here, SOFT_LIMIT)
            assert (await page.command("x", "write_parameter", parameter=SOFT_LIMIT, value=1500000))["ok"]
            for each in (page, other):
                told = await each.wait_for("parameters")
                assert told["unit"] == told["described"]["name"] == "x"
                assert told["described"]["limits"]["positions"][1] == 150.0
            after = await parameter(here, SOFT_LIMIT)
            assert before["value"] != after["value"] == 1500000
            late = await here.page(commands=False)
            (x,) = [unit for unit in late.hello["machine"]["units"] if unit["name"] == "x"]
            assert x["limits"]["positions"][1] == 150.0

    asyncio.run(story())


def test_a_parameter_that_was_refused_stays():
    async def story():
        async with site() as here:
            page = await here.page()
            before = await parameter(here, "P-AXIS-00099")
            assert (await page.command("x", "write_parameter", parameter="P-AXIS-00099.0", value=-5))["number"] == 23096
            assert await parameter(here, "P-AXIS-00099") == before

    asyncio.run(story())


def test_the_parameters_of_the_machine_are_those_of_the_plc():
    async def story():
        async with site() as here:
            await here.page(commands=False)
            listed = await (await here.client.get("/api/parameters", params={"unit": "plc"})).json()
            rows = {row["id"]: row for row in listed["parameters"]}
            assert rows.keys() >= {"P-MACH-00001", "P-MACH-00005", "P-MACH-00084"}
            assert all(number.startswith("P-MACH-") and row["change"] == "start" for number, row in rows.items())
            assert (rows["P-MACH-00001"]["value"], rows["P-MACH-00005"]["value"]) == (1000, ["x", "y", "z"])

    asyncio.run(story())


@pytest.mark.parametrize(
    "arguments",
    ["", "[]", "{", "[" * 3000, "{}", '{"parameter": 1, "value": 2}', '{"parameter": "kv", "value": []}',
     '{"parameter": "no such", "value": 2}'],
)  # fmt: skip
def test_records_of_others_that_name_no_parameter_end_nothing(arguments):
    face = offline_face(PTP)
    sets = dict(face.sets)
    record = CommandRecord(0, "x", "write_parameter", arguments, True, 0, "")
    face._take_parameter(record)
    assert face.sets == sets
    seen = face._link.seen
    before = dict(seen.written("x"))
    seen.take_record(record)
    assert seen.written("x") == (before if "no such" not in arguments else {"no such": 2})


async def parameter(here, number):
    listed = await (await here.client.get("/api/parameters", params={"unit": "x"})).json()
    return next(row for row in listed["parameters"] if row["id"].startswith(number))
