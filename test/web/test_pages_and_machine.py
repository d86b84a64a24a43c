"""A page says hello, sees the machine, commands it."""

import asyncio
from math import sqrt

import numpy as np
import pytest
from web_support import ROOT, site

from cnc_ptp.commands.run.web import words_of
from cnc_ptp.parameters import CurveParameters, machine_text, read_machine
from cnc_ptp.protocol.blocks import AxisBlock, CommandRecord
from cnc_ptp.spindle.acceleration_curves import AccelerationCurve
from cnc_ptp.web.commissioning.spindle_curve import curve_points, spindle_curve
from cnc_ptp.web.faces.offset_table import OffsetTable
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
    blocks = [("x", AxisBlock(100 + n, 10, set_position=[n + 0.5] * 10, set_velocity=[0.0] * 10)) for n in (0, 10, 20)]
    taught = CommandRecord(113, "channel", "teach_zero_offset", '{"index": 2, "axis": "x", "value": 2}', True, 0, "")
    table.take_record(taught, blocks)
    assert table.rows[2] == {"X": 8.5, "Y": 0.0, "Z": 0.0}


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
