"""Zero offsets by commands, clamp position, what programs keep, and what the channel shows of its offsets."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest
from machine_support import MILL, MachineBench
from replay_support import bits, replay

from cnc_ptp.parameters import MachineParameters, OffsetTables, Tool, ToolTable
from cnc_ptp.protocol.blocks import ChannelOffsets

TABLES = OffsetTables(
    zero={1: (10.0, 20.0, 30.0), 2: (1.0, 2.0, 3.0)},
    names={1: "left vice"},
    clamp={0: (0.0, 0.0, 0.0), 4: (0.5, 0.0, -0.5)},
)


def machine(tables: OffsetTables = TABLES, **settings: Any) -> MachineParameters:
    channel = replace(MILL.channels["channel"], offsets=tables, **settings)
    return replace(MILL, channels={"channel": channel})


def bench(program: str | None = None, scenario: str = "", *, tables: OffsetTables = TABLES) -> MachineBench:
    return MachineBench(program, scenario, machine=machine(tables), end_when_idle=False)


def start(at: MachineBench, text: str, seconds: float = 1.0) -> None:
    assert at.give("channel", "load", program="next.nc", text=text).accepted
    assert at.give("channel", "start").accepted
    at.run(seconds)


def offsets(at: MachineBench) -> list[ChannelOffsets]:
    return [shown for block in at.blocks["channel"] for shown in block.offsets]


def mdi(at: MachineBench, text: str) -> None:
    assert at.give("channel", "mdi", text=text).accepted
    at.run(1.0)


# commands


def test_a_zero_offset_set_by_command_counts_when_it_is_selected_next() -> None:
    at = bench().run(0.1)
    mdi(at, "G54 G00 X0")
    assert at.position("x") == 10.0
    assert at.give("channel", "set_zero_offset", index=1, axis="X", value=40).accepted
    mdi(at, "X1")
    assert at.position("x") == 11.0
    mdi(at, "G54 X1 Y0")
    assert (at.position("x"), at.position("y")) == (41.0, 20.0)
    start(at, "G54 G00 X2\nM30")
    assert at.position("x") == 42.0


def test_teach_in_makes_the_present_position_the_zero() -> None:
    at = bench().run(0.1)
    mdi(at, "G00 X12.5 Y7")
    assert at.give("channel", "teach_zero_offset", index=3, axis="X").accepted
    assert at.give("channel", "teach_zero_offset", index=3, axis="Y", value=2).accepted
    start(at, "G56 G00 X1 Y2 Z3\nM30")
    assert [at.position(axis) for axis in "xyz"] == [13.5, 7.0, 3.0]
    assert at.give("channel", "teach_zero_offset", index=96).accepted
    start(at, "G159=96\nP1 = V.A.PROG.X + V.A.PROG.Y + V.A.PROG.Z\nG53 G00 X[P1]\nM30")
    assert at.position("x") == 0.0


def test_teach_in_with_a_clamp_position_below_the_offset() -> None:
    at = bench().run(0.1)
    assert at.give("channel", "set_clamp_position", index=4).accepted
    mdi(at, "G00 X10 Z2")
    assert (at.position("x"), at.position("z")) == (10.5, 1.5)
    assert at.give("channel", "teach_zero_offset", index=5).accepted
    start(at, "G58 G00 X0 Z0\nM30")
    assert (at.position("x"), at.position("z")) == (10.5, 1.5)


def test_teach_in_with_a_tool_below_the_offset() -> None:
    """The tip is at Z10, so the zero becomes 10; between #MCS ON and #MCS OFF the tool is below it, too."""
    tools = ToolTable({1: Tool(1, length=75.0)}, True)
    at = MachineBench(None, "", machine=machine(tool_table=tools), end_when_idle=False).run(0.1)
    mdi(at, "D1 G00 Z10")
    assert at.position("z") == 85.0
    for text in ("G56 Z1", "#MCS ON"):
        assert at.give("channel", "teach_zero_offset", index=3, axis="Z").accepted
        mdi(at, text)
    assert at.position("z") == 86.0
    assert at.give("channel", "teach_zero_offset", index=3, axis="Z").accepted
    mdi(at, "#MCS OFF")
    mdi(at, "G56 Z0")
    assert at.position("z") == 86.0
    assert offsets(at)[-1].tool_offset == [0.0, 0.0, 75.0]


def test_a_clamp_position_chosen_between_mcs_on_and_off() -> None:
    at = bench().run(0.1)
    mdi(at, "#MCS ON")
    assert at.give("channel", "set_clamp_position", index=4).accepted
    mdi(at, "G00 X10")
    assert at.position("x") == 10.0
    mdi(at, "#MCS OFF")
    mdi(at, "X10")
    assert at.position("x") == 10.5


def test_the_clamp_position_counts_for_all_that_starts_later() -> None:
    at = bench("G00 X10 Z1\nM30").run(2.0)
    assert (at.position("x"), at.position("z")) == (10.0, 1.0)
    assert at.give("channel", "set_clamp_position", index=4).accepted
    start(at, "G00 X10 Z1\nP1 = V.A.PZV.X\nY[P1]\nM30")
    assert (at.position("x"), at.position("y"), at.position("z")) == (10.5, 0.5, 0.5)
    assert at.give("channel", "set_clamp_position", index=0).accepted
    start(at, "G00 X10 Z1\nM30")
    assert at.position("x") == 10.0


NOTHING = "; nothing was changed"


@pytest.mark.parametrize(
    ("command", "arguments", "error"),
    [
        ("set_zero_offset", {"index": 0, "axis": "X", "value": 1}, "22030 {}: index = 0 is not within 1 ... 96; G53 selects no offset (P-ZERO-00001)"),
        ("set_zero_offset", {"index": 97, "axis": "X", "value": 1}, "22030 {}: index = 97 is not within 1 ... 96"),
        ("set_zero_offset", {"index": -1, "axis": "X", "value": 1}, "22030 {}: index = -1 is not within 1 ... 96"),
        ("set_zero_offset", {"index": 1, "axis": "XX", "value": 1}, "22031 {}: 'XX' is no axis of the channel (X, Y, Z); did you mean X?"),
        ("set_zero_offset", {"index": 1, "axis": "W", "value": 1}, "22031 {}: 'W' is no axis of the channel (X, Y, Z)"),
        ("set_zero_offset", {"index": 1, "axis": "X", "value": 214748.4}, "22032 {}: axis X: 214748 mm is not within -214748.3647 ... 214748.3647 mm"),
        ("set_zero_offset", {"index": 1, "axis": "X"}, "22001 {}: argument 'value' is missing"),
        ("set_zero_offset", {"index": 1.5, "axis": "X", "value": 1}, "22001 {}: index = 1.5 is not an integer"),
        ("teach_zero_offset", {"index": 97}, "22030 {}: index = 97 is not within 1 ... 96"),
        ("teach_zero_offset", {"index": 1, "axis": "A"}, "22031 {}: 'A' is no axis of the channel (X, Y, Z)"),
        ("set_clamp_position", {"index": 150}, "22033 {}: index = 150 is not within 0 ... 149"),
        ("set_clamp_position", {"index": 3}, "22033 {}: the machine file has no clamp position 3 (P-CLMP-00001: 0, 4)"),
    ],
)  # fmt: skip
def test_refusals(command: str, arguments: dict[str, Any], error: str) -> None:
    at = bench().run(0.1)
    told = at.refused("channel", command, **arguments)
    assert told == f"P-ERR-{error.format(f'channel channel: {command} refused')}{NOTHING}"
    start(at, "G54 G00 X0\nM30")
    assert at.position("x") == 10.0


def test_with_g53_the_index_0_is_one_of_them() -> None:
    at = bench(tables=TABLES._replace(g53=True)).run(0.1)
    assert at.give("channel", "set_zero_offset", index=0, axis="Z", value=5).accepted
    start(at, "G53 G00 Z1\nM30")
    assert at.position("z") == 6.0


@pytest.mark.parametrize("command", ["set_zero_offset", "teach_zero_offset", "set_clamp_position"])
def test_a_running_program_keeps_its_offsets(command: str) -> None:
    at = bench("G01 X50 F600\nM30").run(0.5)
    arguments = {"set_zero_offset": {"axis": "X", "value": 1.0}}.get(command, {})
    told = at.refused("channel", command, index=1, **arguments)
    assert told == f"P-ERR-22004 channel channel: {command} refused: a program is running (line 1){NOTHING}"


def test_a_load_in_another_vocabulary_keeps_clamp_position_and_offsets_for_manual_blocks() -> None:
    at = bench().run(0.1)
    assert at.give("channel", "set_clamp_position", index=4).accepted
    assert at.give("channel", "set_zero_offset", index=1, axis="X", value=40).accepted
    for dialect, x, z in (("iso", 50.5, 30.5), ("twincat", 10.5, 0.5)):  # G54 is on from the start in iso
        assert at.give("channel", "load", program="a.nc", text="M30", dialect=dialect).accepted
        mdi(at, "G00 X10 Z1")
        assert (at.position("x"), at.position("z")) == (x, z), dialect
        mdi(at, "G54 X2")
        assert at.position("x") == 42.5, dialect


# what programs change


def test_what_a_program_changes_counts_when_it_was_carried_out_to_its_end() -> None:
    at = bench("V.G.NP[1].V.X = 5\nG160=2 X1\nV.G.NP_DEFAULT = 1\nG00 Y1\nM30").run(1.0)
    start(at, "G00 X0 Y0\nG55 X0\nM30")
    assert (at.position("x"), at.position("y")) == (0.0, 20.0)
    assert [report.zero_index for report in offsets(at)] == [0, 1, 2, 1]
    start(at, "V.G.NP[1].V.X = 7\nG04 5\nM30", 0.5)
    assert at.give("channel", "reset").accepted
    at.run(1.0)
    start(at, "G54 G00 X0\nM30")
    assert at.position("x") == 5.0


def test_a_program_prepared_ahead_is_interpreted_again_when_an_offset_was_changed_since() -> None:
    at = bench()
    text = "G54 G00 X0\nM30"
    at.units["channel"].prepare("next.nc", text)
    assert at.give("channel", "set_zero_offset", index=1, axis="X", value=1).accepted
    start(at, text)
    assert at.position("x") == 1.0


# what is shown


def test_offsets_are_shown_from_the_block_on_that_has_changed_them() -> None:
    """The first motion of 100 mm takes longer than a block: what stands behind it is not yet shown."""
    at = bench("G01 X20 F6000\nG54 X20\nG92 Y3\nX20 Y1\nM30").run(3.0)
    first, second, third, after = offsets(at)
    assert (first.cycle, first.line, first.zero_index, first.zero_name) == (0, 0, 0, "")
    lines = at.column("channel", "line")
    assert (second.line, second.zero_index, second.zero_name) == (2, 1, "left vice")
    assert lines[second.cycle] == 2 and lines[second.cycle - 1] == 1
    assert second.zero_offset == [10.0, 20.0, 30.0] and second.axes == ["X", "Y", "Z"]
    assert third.line == 4 and third.reference_offset == [0.0, 3.0, 0.0] and third.shift == [10.0, 23.0, 30.0]
    assert lines[third.cycle] == 4 and lines[third.cycle - 1] == 2
    assert (after.zero_index, after.line, after.reference_offset) == (0, 0, [0.0, 0.0, 0.0])


def test_programmed_position_beside_that_of_the_machine() -> None:
    at = bench("#ROTATION ON [ANGLE=90]\nG54 G01 X3 Y4 F6000\nM00\nM30").run(2.0)
    block = at.last("channel")
    machine_position = [block.set_position[axis * block.count + block.count - 1] for axis in range(3)]
    assert machine_position == [6.0, 23.0, 0.0]
    assert block.programmed_position == pytest.approx([3.0, 4.0, -30.0], abs=1e-12)
    moving = [each for each in at.blocks["channel"] if each.path_velocity[-1] > 1.0]
    for each in moving:
        x, y = (each.set_position[axis * each.count + each.count - 1] for axis in (0, 1))
        assert each.programmed_position[:2] == pytest.approx([y - 20.0, -(x - 10.0)], abs=1e-9)


def test_axes_that_others_move_are_shown_as_programs_name_them() -> None:
    at = bench().run(0.1)
    mdi(at, "G54")
    assert offsets(at)[-1].zero_index == 1
    assert at.give("x", "move_absolute", target=15.0, velocity=50.0).accepted
    at.run(2.0)
    assert at.last("channel").programmed_position[0] == 5.0


def test_commands_show_what_the_next_manual_block_starts_with() -> None:
    at = bench().run(0.1)
    assert at.give("channel", "set_clamp_position", index=4).accepted
    at.run(0.1)
    shown = offsets(at)[-1]
    assert (shown.clamp_index, shown.clamp_offset, shown.shift) == (4, [0.5, 0.0, -0.5], [0.5, 0.0, -0.5])
    assert at.give("channel", "set_zero_offset", index=1, axis="X", value=3).accepted
    at.run(0.1)
    assert offsets(at)[-1].shift == shown.shift  # it is not active


def test_the_tables_as_they_are_changed_are_shown() -> None:
    """What the next program finds: by a command at once, of a program at its end; also of an offset that is not active."""
    at = bench().run(0.1)
    assert told(at) == (0, {})
    assert at.give("channel", "set_zero_offset", index=2, axis="Y", value=4.5).accepted
    at.run(0.1)
    assert told(at) == (0, {2: ((1.0, 4.5, 3.0), ())})
    start(at, "G160=1 X1 Z1\nV.G.NP[3].V.Z = 7\nV.G.NP_DEFAULT = 1\nG00 X200\nM30", 0.1)
    assert told(at) == (0, {2: ((1.0, 4.5, 3.0), ())})
    at.run(3.0)
    changed = {1: ((10.0, 20.0, 30.0), (0, 2)), 2: ((1.0, 4.5, 3.0), ()), 3: ((0.0, 0.0, 7.0), ())}
    assert told(at) == (1, changed)
    assert (offsets(at)[-1].zero_index, offsets(at)[-1].zero_offset) == (1, [0.0, 20.0, 0.0])


def test_a_changed_table_is_shown_once() -> None:
    at = bench().run(0.1)
    assert at.give("channel", "set_zero_offset", index=2, axis="Y", value=4.5).accepted
    at.run(1.0)
    assert at.give("channel", "set_zero_offset", index=2, axis="Y", value=4.5).accepted
    at.run(1.0)
    assert len(offsets(at)) == 2


def test_of_a_program_that_is_reset_no_change_is_shown() -> None:
    at = bench().run(0.1)
    start(at, "V.G.NP[3].V.Z = 7\nG00 X200\nM30", 0.1)
    assert at.give("channel", "reset").accepted
    at.run(3.0)
    assert told(at) == (0, {})


def told(at: MachineBench) -> tuple[int, dict[int, tuple[tuple[float, ...], tuple[int, ...]]]]:
    """Index at program start; index -> values and places of inactive axes, of what was changed."""
    newest, count = offsets(at)[-1], len(offsets(at)[-1].axes)
    changed = {}
    for number, index in enumerate(newest.changed_indices):
        row = slice(count * number, count * (number + 1))
        inactive = tuple(place for place, off in enumerate(newest.changed_inactive[row]) if off)
        changed[index] = (tuple(newest.changed_offsets[row]), inactive)
    return newest.default_index, changed


def test_a_fault_ends_with_the_offsets_of_the_start() -> None:
    at = bench("G54 G01 X20 F600\nM30").run(0.5)
    assert offsets(at)[-1].zero_index == 1
    assert at.give("channel", "reset").accepted
    at.run(1.0)
    assert offsets(at)[-1].zero_index == 0


# settings of the interpreter


def test_more_calls_within_each_other_than_the_machine_permits() -> None:
    at = MachineBench(machine=machine(call_depth=2), end_when_idle=False).run(0.1)
    text = "%L A\nLL B\nM29\n%L B\nG00 X1\nLL C\nM29\n%L C\nX2\nM29\n%MAIN\nLL A\nM30"
    assert at.give("channel", "load", program="deep.nc", text=text).accepted
    told = at.refused("channel", "start")
    fault = "P-ERR-21020 deep.nc line 6 column 1 'LL C': call of subroutine C at depth 3, the limit is 2"
    assert told.startswith(fault)
    assert at.position("x") == 0.0


def test_more_repeats_than_the_machine_permits() -> None:
    at = MachineBench(machine=machine(repeats=10), end_when_idle=False).run(0.1)
    assert at.give("channel", "load", program="loop.nc", text="$FOR P1 = 1, 20, 1\nG00 XP1\n$ENDFOR\nM30").accepted
    assert "10" in at.refused("channel", "start")


# replay

SCENARIO = """
- {at: 0.0, to: channel, do: set_zero_offset, index: 1, axis: X, value: 12.25}
- {at: 0.1, to: channel, do: mdi, text: "G54 G00 X1 Y1"}
- {at: 1.0, to: channel, do: teach_zero_offset, index: 7, value: 2}
- {at: 1.1, to: channel, do: teach_zero_offset, index: 99}
- {at: 1.2, to: channel, do: set_clamp_position, index: 4}
- {at: 1.3, to: channel, do: mdi, text: "G159=7 G00 X3 Y3 Z3"}
- {at: 2.0, to: channel, do: mdi, text: "V.G.NP[8].V.Z = V.A.ACT_POS.Z G159=8 Z0"}
"""


@pytest.mark.long
def test_a_run_with_offsets_is_computed_again_bit_by_bit() -> None:
    first = bench("G55 G00 X5\n#MCS ON\nX6\n#MCS OFF\nX7\nM30", SCENARIO).run(4.0)
    blocks = len(first.blocks["channel"])
    assert sum(not record.accepted for record in first.records) >= 1
    again = replay(machine(), [record for record in first.records if record.target != "plc"], blocks)
    assert {unit: again[unit] for unit in again if unit != "plc"} == {
        unit: lines for unit, lines in bits(first).items() if unit != "plc"
    }
