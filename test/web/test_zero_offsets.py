"""Zero offsets of a channel as pages have them, and the backplot with those of now."""

import asyncio
from dataclasses import replace

import numpy as np
import pytest
from web_support import MILL, ROOT, site

from cnc_ptp.parameters import machine_text, read_machine
from cnc_ptp.protocol.blocks import AxisBlock, ChannelOffsets, CommandRecord
from cnc_ptp.web.faces.offset_table import OffsetTable, below_zero_offset
from cnc_ptp.web.programs.backplot import HEAD


def mill_table():
    machine = read_machine(MILL)
    sets = {unit: own for unit, own in machine.sets.items() if unit != "machine"}
    return OffsetTable(sets["channel"], sets)


def active(cycle, index=0, x=0.0, *, clamp=0.0, tool=0.0):
    """What a mill tells: the values of its X axis."""
    none, no_lists = [0.0] * 3, ([0.0] * 3, [0.0] * 3)
    values = [x, 0.0, 0.0], *no_lists, 0, [clamp, 0.0, 0.0], [tool, 0.0, 0.0]
    plain = [1.0] * 3, [False] * 3, False, 0.0, [], False, [1.0, 0, 0, 0, 1.0, 0, 0, 0, 1.0], none
    return ChannelOffsets(cycle, 0, ["X", "Y", "Z"], index, "", *values, *plain)


@pytest.mark.parametrize("lacking", ["clamp_offset", "tool_offset"])
def test_offsets_that_no_channel_sends_are_not_known(lacking):
    assert below_zero_offset(active(0, clamp=2.0, tool=0.5), "X") == 2.5
    assert below_zero_offset(replace(active(0), **{lacking: []}), "X") is None


def changed(cycle, command, **arguments):
    return CommandRecord(cycle, "channel", command, arguments, True, 0, "")


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


async def ends(here):
    """Of the lines of a backplot."""
    drawn = await (await here.client.get("/api/backplot")).read()
    rows = np.frombuffer(drawn, "<f4", offset=HEAD.size).reshape(-1, 5)
    return [tuple(map(float, row[:3])) for row in rows[1:]]


def test_a_taught_offset_is_what_a_program_finds():
    """The page computes it; the channel tells it when it becomes active."""

    async def story():
        async with site() as here:
            page = await here.page()
            assert (await page.command("x", "move_absolute", target=1.23456789))["ok"]
            await page.state_of("x", lambda x: x["state"] == "Standstill" and x["set_position"] > 1)
            assert (await page.command("channel", "teach_zero_offset", index=2, value=0.5))["ok"]
            taught = rows_of(await page.wait_for("zero_offsets"))[2]
            assert (await page.command("channel", "mdi", text="G55"))["ok"]
            active = await page.wait_for("offsets", lambda offsets: offsets["zero_index"] == 2)
            assert [*taught.values()] == pytest.approx(active["zero_offset"], abs=1e-6)

    asyncio.run(story())


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


def test_an_offset_that_was_taught_before_the_server_began_is_not_known_until_it_is_active():
    """The record comes again to who begins later; the axes have gone on since."""

    async def story():
        async with site() as here:
            page = await here.page()
            assert (await page.ask("load", name="part.nc", text="G55 G01 X10 Y0 Z0 F1000\nX20\nM30\n"))["ok"]
            await page.wait_for("program")
            await page.wait_for("state", lambda state: state["time"] > 1.0)
            taught = CommandRecord(5, "channel", "teach_zero_offset", '{"index": 2}', True, 0, "")
            here.hub.face._link.seen.take_record(taught)
            assert rows_of(await page.wait_for("zero_offsets"))[2] == {"X": None, "Y": None, "Z": None}
            assert (await ends(here)) == [(10.0, 0.0, 0.0), (20.0, 0.0, 0.0)]
            assert (await page.command("channel", "mdi", text="G55"))["ok"]
            assert None not in rows_of(await page.wait_for("zero_offsets"))[2].values()

    asyncio.run(story())


def test_an_offset_is_taught_where_its_axis_was_in_the_cycle_of_the_command():
    """Not where it is when the record comes."""
    machine = read_machine(str(ROOT / "config" / "mill.yaml"))
    sets = {unit: own for unit, own in machine.sets.items() if unit != "machine"}
    table = OffsetTable(sets["channel"], sets)
    table.take_active(active(90, clamp=1.0, tool=0.25))
    blocks = [("x", AxisBlock(100 + n, 10, set_position=[n + 0.5] * 10, set_velocity=[0.0] * 10)) for n in (0, 10, 20)]
    taught = CommandRecord(113, "channel", "teach_zero_offset", '{"index": 2, "axis": "x", "value": 2}', True, 0, "")
    table.take_record(taught, blocks)
    assert table.rows[2] == {"X": 7.25, "Y": 0.0, "Z": 0.0}


def test_offsets_of_a_facing_axis_are_diameters_where_the_machine_wants_that(tmp_path):
    """P-CHAN-00091: commands and the table have diameters; the axis goes by radii, and topics show them."""
    lathe = tmp_path / "lathe.yaml"
    text = machine_text(str(ROOT / "config" / "lathe.yaml"))
    lathe.write_text(
        text.replace("    spdl_anzahl: 2", "    versch_im_durchm: 1\n    spdl_anzahl: 2"), encoding="utf-8"
    )

    async def story():
        async with site(str(lathe)) as here:
            page = await here.page()
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


def test_what_lies_below_a_taught_offset_must_be_known():
    """Without it the page does not know the value; as under #MCS and #FACE, where axes are not what programs name."""
    standing = [("x", AxisBlock(100, 10, set_position=[8.0] * 10, set_velocity=[0.0] * 10))]
    teach = changed(105, "teach_zero_offset", index=2, axis="X")
    known = active(90, clamp=1.0)
    for offsets, taught in (
        (None, None),
        (replace(known, machine_coordinates=True), None),
        (replace(known, origin=[0.0, 0.0, 0.0]), None),
        (known, 7.0),
    ):
        table = mill_table()
        if offsets is not None:
            table.take_active(offsets)
        table.take_record(teach, standing)
        assert table.rows[2]["X"] == taught


def test_of_commands_and_active_offsets_that_come_in_any_order_the_newest_counts():
    changes = [
        lambda table: table.take_active(active(0)),
        lambda table: table.take_active(active(50, 2, 3.0)),
        lambda table: table.take_record(changed(100, "set_zero_offset", index=2, axis="X", value=5), ()),
        lambda table: table.take_active(replace(active(150), clamp_index=1)),
    ]
    for order in ((0, 1, 2, 3), (2, 3, 0, 1), (3, 2, 1, 0), (2, 0, 1, 3)):
        table = mill_table()
        for place in order:
            changes[place](table)
        assert (table.rows[2]["X"], table.clamp_index) == (5.0, 1), order


def test_a_new_value_is_shown_while_the_former_one_is_active():
    """It counts when the offset is selected next; until then other offsets change beside the old value."""

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
