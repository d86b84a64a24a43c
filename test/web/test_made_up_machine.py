"""The made-up machine of the browser tests speaks as the real server does."""

import asyncio
import importlib.util

import pytest
from web_support import ROOT, site


@pytest.fixture(scope="module")
def fake():
    specification = importlib.util.spec_from_file_location("fake_machine", ROOT / "test/web_browser/fake_machine.py")
    module = importlib.util.module_from_spec(specification)
    specification.loader.exec_module(module)
    made_up = module.Fake()
    asyncio.run(made_up.step())
    return made_up


async def told_by_the_server():
    async with site() as here:
        page = await here.page(commands=False)
        state = await page.wait_for("state", lambda state: "x" in state["units"])
        return page.hello, state["units"]


def test_the_made_up_machine_has_the_fields_of_the_real_one(fake):
    hello, state = asyncio.run(told_by_the_server())
    made_up = fake.hello(1)
    assert made_up.keys() == hello.keys()
    assert made_up["machine"].keys() == hello["machine"].keys()
    assert made_up["operator"].keys() == hello["operator"].keys()
    units = {unit["kind"]: unit for unit in hello["machine"]["units"]}
    for unit in made_up["machine"]["units"]:
        assert unit.keys() == units[unit["kind"]].keys()
        assert unit.get("limits", {}).keys() == units[unit["kind"]].get("limits", {}).keys()
    for unit, fields in fake.state.items():
        assert fields.keys() == state[unit].keys(), unit


def test_the_made_up_machine_has_only_commands_of_the_real_one(fake):
    hello, _ = asyncio.run(told_by_the_server())
    for kind, commands in fake.hello(1)["machine"]["commands"].items():
        for command, arguments in commands.items():
            known = hello["machine"]["commands"][kind][command]
            assert arguments.keys() <= known.keys(), command
