"""Zero offsets of a channel as pages have them, and the backplot with those of now."""

import asyncio
from dataclasses import replace

import numpy as np
import pytest
from web_support import MILL, ROOT, site

from cnc_ptp.parameters import machine_text, read_machine
from cnc_ptp.protocol.blocks import ChannelOffsets, CommandRecord
from cnc_ptp.web.faces.face import News
from cnc_ptp.web.faces.offset_table import OffsetTable
from cnc_ptp.web.programs.backplot import HEAD


def mill_table():
    machine = read_machine(MILL)
    sets = {unit: own for unit, own in machine.sets.items() if unit != "machine"}
    return OffsetTable(sets["channel"], sets)


def told(cycle, **changed):
    """What a mill tells when G55 is active with an X that a program has set for itself alone."""
    none, matrix = [0.0] * 3, [1.0, 0, 0, 0, 1.0, 0, 0, 0, 1.0]
    values = [99.0, 0.0, 0.0], none, none, 0, none, none
    plain = [1.0] * 3, [False] * 3, False, 0.0, [], False, matrix, none
    return ChannelOffsets(cycle, 0, ["X", "Y", "Z"], 2, "", *values, *plain, default_index=0, **changed)


def test_a_table_is_what_its_channel_has_told_last():
    """In whatever order it comes; the values of the active offset are not those of the table."""
    older = told(50, changed_indices=[2], changed_offsets=[1.0, 2.0, 3.0], changed_inactive=[False] * 3)
    newer = replace(told(150), changed_indices=[2, 7], changed_offsets=[5.0, 6.0, 7.0, 0.0, 0.0, 0.5])
    newer = replace(newer, changed_inactive=[False, True, False] + [False] * 3, clamp_index=1, default_index=7)
    for order in ((told(0), older, newer), (newer, told(0), older), (older, newer)):
        table = mill_table()
        for offsets in order:
            table.take(offsets)
        shown = table.shown()
        assert (shown["default"], table.clamp_index) == (7, 1)
        assert {row["index"]: row for row in shown["offsets"] if row["index"] in (2, 7)} == {
            2: {"index": 2, "name": "G55", "values": {"X": 5.0, "Y": 6.0, "Z": 7.0}, "inactive": ["Y"]},
            7: {"index": 7, "name": "G159=7", "values": {"X": 0.0, "Y": 0.0, "Z": 0.5}, "inactive": []},
        }
    table.begin_again()
    assert table.shown() == mill_table().shown()


def test_news_are_told_once():
    table = mill_table()
    assert table.news() is None
    table.take(told(50, changed_indices=[2], changed_offsets=[1.0, 2.0, 3.0], changed_inactive=[False] * 3))
    assert table.news() == table.shown() and table.news() is None
    table.take(told(60, changed_indices=[2], changed_offsets=[1.0, 2.0, 3.0], changed_inactive=[False] * 3))
    assert table.news() is None


@pytest.mark.parametrize(
    "foreign",
    [
        {"changed_offsets": [1.0, 2.0]},
        {"changed_inactive": []},
        {"changed_indices": [1, 2]},
        {"axes": ["X", "Y"]},
        {"axes": ["X", "Z", "Y"]},
    ],
)
def test_what_no_channel_with_these_axes_sends_changes_nothing(foreign):
    table = mill_table()
    whole = {"changed_indices": [2], "changed_offsets": [1.0, 2.0, 3.0], "changed_inactive": [False] * 3}
    table.take(replace(told(50, **whole), **foreign))
    assert table.news() is None


def test_a_recording_from_before_tables_were_told_has_those_of_its_parameters():
    table = mill_table()
    table.take(replace(told(50), default_index=-1))
    assert table.shown() == mill_table().shown()


def test_zero_offsets_and_their_changes():
    async def story():
        async with site() as here:
            page, other = await here.page(), await here.page(commands=False)
            assert (await page.ask("offsets"))["axes"] == ["X", "Y", "Z"]
            assert (await page.command("channel", "set_zero_offset", index=2, axis="X", value=12.5))["ok"]
            assert rows_of(await other.wait_for("zero_offsets"))[2] == {"X": 12.5, "Y": 0.0, "Z": 0.0}
            assert (await page.command("x", "move_absolute", target=1.5))["ok"]
            await page.state_of("x", lambda x: x["set_position"] == 1.5 and x["state"] == "Standstill")
            assert (await page.command("channel", "teach_zero_offset", index=3, value=-2))["ok"]
            told = await other.wait_for("zero_offsets")
            assert told["channel"] == "channel" and rows_of(told)[3] == {"X": 3.5, "Y": 2.0, "Z": 2.0}
            answer = await page.ask("offsets")
            assert [row["name"] for row in answer["offsets"] if row["index"] in (2, 3)] == ["G55", "G56"]
            assert rows_of(answer) == rows_of(told)

    asyncio.run(story())


def rows_of(message):
    return {row["index"]: row["values"] for row in message["offsets"]}


def test_a_backplot_has_the_zero_offsets_of_now():
    async def story():
        async with site() as here:
            page = await here.page()
            assert (await page.ask("load", name="part.nc", text="G55 G01 X10 Y0 Z0 F1000\nX20\nM30\n"))["ok"]
            await page.wait_for("program")
            before = await ends(here)
            for axis, value in (("X", 12.5), ("Z", -3.0)):
                assert (await page.command("channel", "set_zero_offset", index=2, axis=axis, value=value))["ok"]
                await page.wait_for("zero_offsets")
            assert before == [(10.0, 0.0, 0.0), (20.0, 0.0, 0.0)]
            assert await ends(here) == [(22.5, 0.0, -3.0), (32.5, 0.0, -3.0)]

    asyncio.run(story())


def test_offsets_of_a_lost_block_come_by_their_topic_and_those_that_come_twice_are_told_once():
    async def story():
        async with site() as here:
            page = await here.page()
            view, row = here.hub.shared, {"changed_offsets": [1.0, 2.0, 3.0], "changed_inactive": [False] * 3}
            for _ in range(2):
                view._tell_news(News(offsets=[("channel", told(10**9, changed_indices=[2], **row))]))
            assert rows_of(await page.wait_for("zero_offsets"))[2] == {"X": 1.0, "Y": 2.0, "Z": 3.0}
            assert (await page.wait_for("offsets", lambda offsets: offsets["cycle"] == 10**9))["zero_index"] == 2
            await page.ask("offsets")
            assert not [each for each in page.waiting if each["type"] == "zero_offsets" or each.get("cycle") == 10**9]

    asyncio.run(story())


def test_a_backplot_has_what_programs_have_changed_of_the_tables():
    """The zero offset at program start, and that one does not count for an axis."""

    async def story():
        async with site() as here:
            page = await here.page()
            for axis, value in (("X", 12.5), ("Y", 4.0), ("Z", -3.0)):
                assert (await page.command("channel", "set_zero_offset", index=2, axis=axis, value=value))["ok"]
                await page.wait_for("zero_offsets")
            assert (await page.command("channel", "mdi", text="G160=2 Y1\nV.G.NP_DEFAULT = 2"))["ok"]
            told = await page.wait_for("zero_offsets", lambda told: told["default"] == 2)
            assert [row["inactive"] for row in told["offsets"] if row["index"] == 2] == [["Y"]]
            assert rows_of(told)[2] == {"X": 12.5, "Y": 4.0, "Z": -3.0}
            assert (await page.ask("load", name="part.nc", text="G01 X10 Y0 Z0 F1000\nM30\n"))["ok"]
            await page.wait_for("program")
            assert (await ends(here))[-1] == (22.5, 0.0, -3.0)

    asyncio.run(story())


async def ends(here):
    """Of the lines of a backplot."""
    drawn = await (await here.client.get("/api/backplot")).read()
    rows = np.frombuffer(drawn, "<f4", offset=HEAD.size).reshape(-1, 5)
    return [tuple(map(float, row[:3])) for row in rows[1:]]


def test_a_c_axis_is_taught_and_the_pages_continue():
    """The channel of the lathe has X, Z, C; the table has no column for C, which is a spindle."""

    async def story():
        async with site(str(ROOT / "config" / "lathe.yaml")) as here:
            page = await here.page()
            assert (await page.command("channel", "teach_zero_offset", index=2, axis="C"))["ok"]
            assert (await page.command("channel", "set_zero_offset", index=2, axis="X", value=4))["ok"]
            told = await page.wait_for("zero_offsets")
            assert told["axes"] == ["X", "Z"] and rows_of(told)[2] == {"X": 4.0, "Z": 0.0}

    asyncio.run(story())


@pytest.mark.parametrize(
    "arguments", ["", "[]", "{}", '{"index": [2]}', '{"index": 2, "axis": 7, "value": 1}', "[" * 9999]
)
def test_accepted_records_of_others_with_wrong_arguments_change_nothing(arguments):
    async def story():
        async with site() as here:
            page = await here.page()
            before = await page.ask("offsets")
            for unit, command in (
                ("channel", "set_zero_offset"),
                ("channel", "teach_zero_offset"),
                ("channel", "load"),
                ("channel", "single_block"),
                ("x", "move_absolute"),
                ("x", "move_relative"),
                ("plc", "acknowledge"),
            ):
                here.hub.face._link.seen.take_record(CommandRecord(5, unit, command, arguments, True, 0, ""))
            assert (await page.command("channel", "set_zero_offset", index=2, axis="X", value=4))["ok"]
            assert rows_of(await page.wait_for("zero_offsets")) == {
                **rows_of(before),
                2: {"X": 4.0, "Y": 0.0, "Z": 0.0},
            }

    asyncio.run(story())


def test_offsets_of_a_facing_axis_are_diameters_where_the_machine_wants_that(tmp_path):
    """P-CHAN-00091: commands and the table have diameters; the axis goes by radii, and topics show them."""
    lathe = tmp_path / "lathe.yaml"
    text = machine_text(str(ROOT / "config" / "lathe.yaml"))
    own = '    versch_im_durchm: 1\n    np_grp: {"1": {achse: {"0": {versch: 300000}, "1": {versch: 20000}}}}\n'
    lathe.write_text(text.replace("    spdl_anzahl: 2", f"{own}    spdl_anzahl: 2"), encoding="utf-8")

    async def story():
        async with site(str(lathe)) as here:
            page = await here.page()
            assert rows_of(await page.ask("offsets"))[1] == {"X": 30.0, "Z": 2.0}, "of the machine file"
            assert (await page.command("channel", "set_zero_offset", index=2, axis="X", value=40))["ok"]
            assert rows_of(await page.wait_for("zero_offsets"))[2]["X"] == 40.0
            assert (await page.ask("load", name="part.nc", text="G18 G55 G00 X0 Z0\nM30\n"))["ok"]
            await page.wait_for("program")
            assert (await ends(here))[-1][0] == 20.0
            assert (await page.command("channel", "mdi", text="G55"))["ok"]
            active = await page.wait_for("offsets", lambda offsets: offsets["zero_index"] == 2)
            assert active["zero_offset"][active["axes"].index("X")] == 20.0
            assert rows_of(await page.ask("offsets"))[2]["X"] == 40.0
            assert (await page.command("channel", "teach_zero_offset", index=3, axis="X", value=-5))["ok"]
            taught = rows_of(await page.wait_for("zero_offsets"))[3]["X"]
            here_x = (await page.state_of("x", lambda x: "set_position" in x))["set_position"]
            assert taught == pytest.approx(2 * (here_x + 5))

    asyncio.run(story())


def test_a_new_value_is_shown_while_the_former_one_is_active():
    """It counts when the offset is selected next; until then other offsets change beside the old value. So does what a
    program sets for itself alone (V.G.NP_AKT).
    """

    async def story():
        async with site() as here:
            page = await here.page()
            assert (await page.command("channel", "mdi", text="G55"))["ok"]
            await page.wait_for("offsets", lambda offsets: offsets["zero_index"] == 2)
            assert (await page.command("channel", "set_zero_offset", index=2, axis="X", value=5))["ok"]
            assert (await page.command("channel", "mdi", text="G92 Y1"))["ok"]
            told = await page.wait_for("offsets", lambda offsets: offsets["reference_offset"][1] == 1.0)
            assert told["zero_offset"] == [0.0, 0.0, 0.0]
            assert rows_of(await page.ask("offsets"))[2]["X"] == 5.0
            assert (await page.command("channel", "mdi", text="G55"))["ok"]
            await page.wait_for("offsets", lambda offsets: offsets["zero_offset"][0] == 5.0)
            assert (await page.command("channel", "mdi", text="V.G.NP_AKT.V.X = 3"))["ok"]
            await page.wait_for("offsets", lambda offsets: offsets["zero_offset"][0] == 3.0)
            assert rows_of(await page.ask("offsets"))[2]["X"] == 5.0

    asyncio.run(story())


PALLETS = """    pzv_grp:
      "1": {achse: {"0": {versatz: 15000}, "2": {versatz: -20000}}}
    spdl_anzahl: 1
"""
"""Clamp position 1: X 1.5 mm, Z -2 mm."""


def test_a_backplot_has_the_clamp_position_of_now(tmp_path):
    mill = tmp_path / "mill.yaml"
    mill.write_text(machine_text(MILL).replace("    spdl_anzahl: 1\n", PALLETS), encoding="utf-8")

    async def story():
        async with site(str(mill)) as here:
            page = await here.page()
            assert (await page.ask("load", name="part.nc", text="G01 X10 Y0 Z0 F1000\nX20\nM30\n"))["ok"]
            await page.wait_for("program")
            before = await ends(here)
            assert (await page.command("channel", "set_clamp_position", index=1))["ok"]
            await page.wait_for("zero_offsets")  # with which a page draws again
            assert before == [(10.0, 0.0, 0.0), (20.0, 0.0, 0.0)]
            assert await ends(here) == [(11.5, 0.0, -2.0), (21.5, 0.0, -2.0)]

    asyncio.run(story())


FACE = """G55 M19 S.POS=0 S200
#CAX [S, C]
G00 X20 Z100
#FACE [X, C]
G01 G91 X5 F1000
#FACE OFF
M30
"""


def test_a_backplot_on_the_face_has_the_zero_offset_of_the_c_axis_and_shows_the_axes(tmp_path):
    """C stands at 0. With the offset of 90 deg the line leads from (0, -20) to (5, -20) on the face, else along X."""

    async def story():
        async with site(str(ROOT / "config" / "lathe.yaml")) as here:
            page = await here.page()
            for axis, value in (("X", 10), ("Z", 50)):
                assert (await page.command("channel", "set_zero_offset", index=2, axis=axis, value=value))["ok"]
                await page.wait_for("zero_offsets")
            assert (await page.ask("load", name="part.nc", text=FACE))["ok"]
            await page.wait_for("program")
            before = await ends(here)
            assert (await page.command("channel", "set_zero_offset", index=2, axis="C", value=90))["ok"]
            assert "C" not in (await page.wait_for("zero_offsets"))["axes"]
            after = await ends(here)
            assert before[0] == after[0] == (30.0, 0.0, 150.0)
            assert before[-1] == (35.0, 0.0, 150.0)
            xs = [10 + np.hypot(20.0, 0.5 * step) for step in range(11)]
            assert [x for x, _, _ in after] == pytest.approx(xs, abs=1e-5)
            assert {(y, z) for _, y, z in after} == {(0.0, 150.0)}

    asyncio.run(story())
