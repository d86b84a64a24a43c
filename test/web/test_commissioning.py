"""Identification from a page: the result becomes a new machine file, beside the old one."""

import asyncio
import shutil

import pytest
from web_support import MILL, site

from cnc_ptp.errors import CncError
from cnc_ptp.parameters import read_machine
from cnc_ptp.web.commissioning.changed_machine import write_changed
from cnc_ptp.web.faces.description import describe_commands, plain

VALUES = "/x:\n  ros__parameters:\n    lr_param: {frict_comp: 0}\n"


@pytest.fixture
def machine(tmp_path):
    return shutil.copy(MILL, tmp_path / "mill.yaml")


@pytest.mark.long
def test_an_axis_is_identified_and_accepted(machine, tmp_path):
    async def story():
        async with site(machine) as here:
            page = await here.page()
            answer = await page.ask("identify", axis="x", what="friction")
            assert answer["ok"], answer
            result = await page.wait_for("result")
            assert result["ok"] and "frict_comp" in result["values"], result
            accepted = await page.ask("accept", task=answer["task"], file="identified.yaml")
            assert accepted["file"] == str(tmp_path / "identified.yaml")
            text = f"web: result of task {answer['task']} accepted, machine file {accepted['file']} written"
            assert await page.wait_for("event", lambda event: event["text"] == text)
            assert read_machine(accepted["file"]).axes["x"].name == "x"
            again = await page.ask("accept", task=answer["task"], file="identified.yaml")
            text = "identified.yaml is there already; nothing was written; give another name"
            assert (again["number"], again["text"]) == (26254, text)

    asyncio.run(story())


@pytest.mark.parametrize("name", ["../other.yaml", "mill.txt", ".hidden.yaml", "a/b.yaml"])
def test_a_name_beside_nothing(machine, tmp_path, name):
    with pytest.raises(CncError) as refused:
        write_changed(tmp_path / "mill.yaml", VALUES, name)
    text = f"'{name}' is no name of a machine file: letters, digits, _ . - and .yaml; nothing was written"
    assert (refused.value.number, refused.value.message) == (26254, text)


def test_the_machine_file_itself_is_never_written(machine, tmp_path):
    before = (tmp_path / "mill.yaml").read_text()
    with pytest.raises(CncError) as refused:
        write_changed(tmp_path / "mill.yaml", VALUES, "mill.yaml")
    assert refused.value.message == "mill.yaml is there already; nothing was written; give another name"
    assert (tmp_path / "mill.yaml").read_text() == before


def test_a_task_is_cancelled(machine):
    async def story():
        async with site(machine=str(machine)) as here:
            page = await here.page()
            task = (await page.ask("identify", axis="x", what="dynamics"))["task"]
            progress = await page.wait_for("progress")
            assert progress["text"] == "identify runs"
            assert (await page.ask("cancel_task", task=task))["ok"]
            for what in (f"task {task} begun: identify dynamics x ", f"task {task} cancelled"):
                told = await page.wait_for("event", lambda event, what=what: what in event["text"])
                assert told["text"].startswith("web: ")
            result = await page.wait_for("result")
            text = f"task {task} was cancelled; nothing was found"
            assert (result["ok"], result["number"], result["text"]) == (False, 26256, text)
            assert (await page.ask("identify", axis="x", what="friction"))["ok"]

    asyncio.run(story())


def test_arguments_have_their_texts_without_the_marks_of_a_document():
    commands = describe_commands()
    mode = commands["axis"]["move_absolute"]["buffer_mode"]
    assert (mode["unit"], mode["meaning"]) == ("", "how it follows an active motion")
    assert commands["axis"]["move_velocity"]["velocity"]["unit"] == "mm/s, °/s"
    texts = [
        text
        for kind in commands.values()
        for each in kind.values()
        for one in each.values()
        for text in (one["meaning"], one["left_out"])
    ]
    assert texts and not [text for text in texts if "](" in text or "`" in text]
    assert plain("a `switch` of [ptp](ptp.md) ([more](more.md))") == "a switch of ptp"
