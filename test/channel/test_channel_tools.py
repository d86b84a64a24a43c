"""Tools of a channel: MDI and program starts, soft limits, refusals, the run from a recorded machine file."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from machine_support import MILL, MachineBench
from nc_support import MILLING, TOOLS
from replay_support import bits, replay

from cnc_ptp.channel.program_check import ProgramCheck
from cnc_ptp.machine.run_entries import read_entries
from cnc_ptp.nc.parser import parse_program
from cnc_ptp.parameters import MachineParameters, ToolTable, complete_text, load_machine, read_machine

EXAMPLES = Path(__file__).parents[2] / "examples"


def machine(tools: ToolTable = TOOLS["milling"]) -> MachineParameters:
    channel = replace(MILL.channels["channel"], tool_table=tools)
    return replace(MILL, channels={"channel": channel})


def run(program: str, scenario: str = "") -> MachineBench:
    return MachineBench(program, scenario, machine=machine()).run()


def places(bench: MachineBench) -> tuple[float, float, float]:
    return bench.position("x"), bench.position("y"), bench.position("z")


def test_length_wear_and_offsets_are_in_the_positions_of_the_axes() -> None:
    bench = run("T2 D2\nG00 X10 Y20 Z-30\nD1\nZ-30\nM30")
    assert bench.errors() == []
    assert places(bench) == (10.0 + 0.5, 20.0 - 0.25, -30.0 + 75.0 - 0.25)


def test_t_and_d_go_to_the_plc() -> None:
    bench = run("T2 D2\nD0\nM30")
    requests = [request for block in bench.blocks["channel"] for request in block.requests]
    assert [(request.kind, request.number) for request in requests] == [("T", 2), ("D", 2), ("D", 0)]


@pytest.mark.parametrize(
    ("line", "text"),
    [
        ("T4", "P-ERR-21650 test.nc line 2 column 1 'T4': tool T4 is not in the tool table; known are: T1, T2, T3, T7"),
        (
            "D5 Z1",
            "P-ERR-20296 test.nc line 2 column 1 'D5 Z1': D5: the tool table has no compensation data D5; "
            "known are: D1, D2, D3, D7, D13",
        ),
    ],
)
def test_an_unknown_tool_is_refused_before_anything_moves(line: str, text: str) -> None:
    bench = run(f"G00 X10\n{line}\nM30")
    assert bench.refusals() == [f"{text}; nothing was started"]
    assert places(bench) == (0.0, 0.0, 0.0)


def test_soft_limits_are_those_of_the_axis_with_the_tool() -> None:
    """Z ends at 150 mm: with a tool of 110.5 mm the tip comes to 39.5 mm."""
    assert run("T2 D2\nG00 Z39.5\nM30").errors() == []
    bench = run("T2 D2\nG00 Z39.6\nM30")
    assert bench.refusals() == [
        "P-ERR-120002 test.nc line 2 column 1 'G00 Z39.6': "
        "axis Z: 150.1 mm lies beyond the positive soft limit 150 mm (P-AXIS-00178); nothing was started"
    ]


def test_manual_blocks_keep_the_tool_until_a_program_ends() -> None:
    scenario = """
- {at: 0.0, to: channel, do: mdi, text: T1 D1}
- {at: 0.5, to: channel, do: mdi, text: G00 Z10}
- {at: 1.5, to: channel, do: mdi, text: "Y[V.G.D_AKT]"}
- {at: 2.5, to: channel, do: mdi, text: "D4 Z0"}
- {at: 3.0, to: channel, do: mdi, text: Z20}
"""
    bench = MachineBench(None, scenario, machine=machine()).run()
    assert places(bench) == (0.0, 1.0, 20.0 + 74.75)
    assert len(bench.refusals()) == 1 and "D4" in bench.refusals()[0]


def test_a_program_begins_without_a_tool() -> None:
    """After its M30 manual blocks have none either: Z0 is where the axis is without a tool."""
    bench = run("G00 X[V.G.D_AKT] Z5\nT1 D1\nG00 Z0\nM30", "- {at: 6, to: channel, do: mdi, text: Z7}")
    assert places(bench) == (0.0, 0.0, 7.0)
    scenario = (
        "- {at: 0, to: channel, do: mdi, text: D1}\n- {at: 1, to: channel, do: load, program: p.nc, text: 'Z5 M30'}\n"
    )
    bench = MachineBench(None, scenario + "- {at: 1.1, to: channel, do: start}", machine=machine()).run()
    assert bench.position("z") == 5.0


@pytest.mark.long
def test_two_runs_and_a_replay_are_the_same_bits() -> None:
    program = "T2 D2\nG01 F3000 X1 Z-1\nG18 Y[V.G.WZ_AKT.R]\nV.G.WZ_AKT.L = 20\nY1\nD0 X0 Y0 Z0\nM30"
    first, second = run(program), run(program)
    assert bits(first) == bits(second)
    again = replay(machine(), first.records, len(first.blocks["plc"]))
    assert all(again[unit] == bits(first)[unit] for unit in again if unit != "plc")


def test_the_lathe_runs_from_the_text_of_its_recording() -> None:
    """Positions by hand: X82.48 is 20 mm, the offset 62.5 mm and wear of -0.02 mm; Z 100 mm more for G54."""
    file, program = str(EXAMPLES.parent / "config" / "lathe.yaml"), str(EXAMPLES / "lathe.nc")
    plain = Path(file).read_text(encoding="utf-8")
    recorded = load_machine(complete_text(plain, file), "recording:machine.yaml")
    on_disk = read_machine(file)
    assert recorded.channels["channel"].tool_table == on_disk.channels["channel"].tool_table
    text = read_entries(recorded, program=program, scenario=None)[0].command.arguments["text"]
    found = [
        ProgramCheck.of_first_channel(each, program).known_blocks(
            parse_program(text, program),
            (150.0, 300.0, 0.0),
            ProgramCheck.of_first_channel(each, program).state({}, {}, {}),
        )
        for each in (recorded, on_disk)
    ]
    assert found[0] == found[1]
    targets = [block.motion.target for block in found[0].blocks if block.motion is not None]
    assert targets[1] == pytest.approx((20.0 + 62.5 - 0.02, 2.0 + 100.0 + 41.0 + 0.01, 0.0), abs=1e-12)
    assert targets[2][1] == pytest.approx(-15.0 + 100.0 + 41.0 + 0.01, abs=1e-12)
    assert targets[-1] == (0.0, pytest.approx(120.0 + 100.0 + 95.4 - 0.1, abs=1e-12), 0.0)


def test_the_table_of_the_tests_has_every_kind_of_tool() -> None:
    assert {tool.fixed for tool in MILLING.values()} == {tool.valid for tool in MILLING.values()} == {False, True}
