"""External setpoints from files of a scenario: what is read, what is refused, how the PLC plays them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner
from hypothesis import given, settings
from hypothesis import strategies as st
from long_support import examples
from machine_support import MILL, PTP, ROOT, MachineBench
from superposition_support import generator

from cnc_ptp import cli
from cnc_ptp.errors import CncError
from cnc_ptp.machine.offline import OfflineMachine
from cnc_ptp.machine.run_entries import read_entries
from cnc_ptp.machine.wiring import build_units, unit_kinds
from cnc_ptp.plc.plc_unit import PlcUnit
from cnc_ptp.plc.scenario import Entry, ScenarioError, parse_scenario
from cnc_ptp.plc.setpoint_file import parse_setpoints, placed
from cnc_ptp.protocol.blocks import Command, CycleTick

HEADER = "cycle,position,velocity,acceleration,direction\n"
COLUMNS = "cycle, position, velocity, acceleration, direction"
KINDS = unit_kinds(PTP)


def fault(text: str) -> str:
    with pytest.raises(CncError) as caught:
        parse_setpoints(text, "s.csv")
    assert caught.value.number == 25102
    where, _, reason = caught.value.message.partition(": ")
    reason, _, end = reason.rpartition("; ")
    assert end == "nothing was started"
    return f"{where.removeprefix('setpoint file s.csv:')} {reason}"


# reading


@pytest.mark.parametrize(
    "text",
    [
        HEADER + "0,1.5,2,3e2,1\n10,-2,-.5,0,-1\n",
        "direction,acceleration,velocity,position,cycle\n1,3e2,2,1.5,0\n-1,0,-.5,-2,10\n",
        " cycle , position , velocity , acceleration , direction \n 0 , 1.5 , 2 , 3e2 , 1 \n\n10,-2,-.5,0,-1",
        "note,cycle,position,velocity,acceleration,direction,more\nx,0,1.5,2,3e2,1,\ny,10,-2,-.5,0,-1,z\n",
        '"cycle","position","velocity","acceleration","direction"\r\n"0","1.5",2,300,+1\r\n10,-2,-0.5,0,-1\r\n',
        "\ufeff" + HEADER + "0,1.5,2,300,1\n,,,,\n10,-2,-0.5,0,-1\n   \n",
    ],
    ids=["plain", "other order", "spaces", "other columns", "quotes", "byte order mark"],
)
def test_what_is_read(text: str) -> None:
    rows = parse_setpoints(text, "s.csv")
    assert rows == [[0, 1.5, 2.0, 300.0, 1], [10, -2.0, -0.5, 0.0, -1]]
    assert [type(value) for value in rows[0]] == [int, float, float, float, int]


numbers = st.floats(-1e12, 1e12)


@settings(max_examples=examples(50), deadline=None, derandomize=True, database=None)
@given(
    cycles=st.lists(st.integers(0, 10**12), min_size=1, unique=True).map(sorted),
    values=st.tuples(numbers, numbers, numbers),
    direction=st.sampled_from([-1, 0, 1]),
)
def test_numbers_survive_to_the_bit(cycles: list[int], values: tuple[float, ...], direction: int) -> None:
    text = HEADER + "".join(f"{cycle},{','.join(map(repr, values))},{direction}\n" for cycle in cycles)
    assert list(map(repr, parse_setpoints(text, "s.csv"))) == [repr([cycle, *values, direction]) for cycle in cycles]


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("", f"1 column 'cycle' is missing; the first line must name {COLUMNS}"),
        ("\n", f"1 column 'cycle' is missing; the first line must name {COLUMNS}"),
        ("0,1,2,3,1\n", f"1 column 'cycle' is missing; the first line must name {COLUMNS}"),
        (
            "cycle,position,velocity,direction\n0,0,0,1\n",
            f"1 column 'acceleration' is missing; the first line must name {COLUMNS}",
        ),
        (
            "cycle;position;velocity;acceleration;direction\n",
            f"1 column 'cycle' is missing; the first line must name {COLUMNS}",
        ),
        (HEADER.replace("velocity", "cycle"), f"1 column 'cycle' occurs twice; the first line must name {COLUMNS}"),
        (HEADER, "1 no setpoint follows the first line"),
        (HEADER + "\n \n,,,,\n", "1 no setpoint follows the first line"),
        (HEADER + "0,0,0,0\n", "2 '0,0,0,0' has 4 values instead of 5"),
        (HEADER + "0,0,0,0,1\n5\n", "3 '5' has 1 values instead of 5"),
        (HEADER + "0,0,0,0,1\n\n1,x,0,0,1\n", "4 could not convert string to float: 'x'"),
        (HEADER + "0,,0,0,1\n", "2 could not convert string to float: ''"),
        (HEADER + "1.0,0,0,0,1\n", "2 invalid literal for int() with base 10: '1.0'"),
        (HEADER + "1,0,0,0,up\n", "2 invalid literal for int() with base 10: 'up'"),
        (HEADER + "1,nan,0,0,1\n", "2 position = nan is not a number within ±1e+12"),
        (HEADER + "1,0,inf,0,1\n", "2 velocity = inf is not a number within ±1e+12"),
        (HEADER + "1,0,0,-1e13,1\n", "2 acceleration = -10000000000000.0 is not a number within ±1e+12"),
        (HEADER + "-1,0,0,0,1\n", "2 cycle = -1 is not a whole number from 0 on"),
        (HEADER + "7,0,0,0,2\n", "2 setpoint of cycle 7: direction = 2 is not one of -1, 0, 1"),
        (
            HEADER + "0,0,0,0,1\n1234567,0,0,0,1\n1234567,0,0,0,1\n",
            "4 cycle 1234567 comes after cycle 1234567; cycles must ascend",
        ),
        (HEADER + "5,0,0,0,1\n4,0,0,0,1\n", "3 cycle 4 comes after cycle 5; cycles must ascend"),
        (HEADER + "5,0,0,0,1\n6," + "1" * 200_000 + ",0,0,1\n", "3 field larger than field limit (131072)"),
    ],
)
def test_bad_files(text: str, reason: str) -> None:
    assert fault(text) == reason


@pytest.mark.parametrize(
    ("rows", "cycle", "expected"),
    [
        ([[0, 1.0], [5, 2.0]], 250, [[250, 1.0], [255, 2.0]]),
        ([[249, 1.0], [260, 2.0]], 250, [[499, 1.0], [510, 2.0]]),
        ([[250, 1.0], [260, 2.0]], 250, [[250, 1.0], [260, 2.0]]),
        ([[300, 1.0]], 250, [[300, 1.0]]),
        ([[0, 1.0]], 0, [[0, 1.0]]),
        ([], 250, []),
    ],
)
def test_a_file_that_begins_before_its_command_counts_from_it_on(rows: Any, cycle: int, expected: Any) -> None:
    assert placed(rows, cycle) == expected


# in a scenario


def write(folder: Path, scenario: str, **files: str) -> str:
    for name, text in files.items():
        (folder / f"{name}.csv").write_text(text, encoding="utf-8")
    path = folder / "s.yaml"
    path.write_text(scenario, encoding="utf-8")
    return str(path)


def scenario_fault(path: str) -> str:
    with pytest.raises(ScenarioError) as caught:
        read_entries(PTP, program=None, scenario=path)
    assert caught.value.number == 25101
    return str(caught.value)


def csv(rows: list[list[float]]) -> str:
    return HEADER + "".join(",".join([str(int(r[0])), *map(repr, r[1:4]), str(int(r[4]))]) + "\n" for r in rows)


MOVE = "- {at: 0.05, to: x, do: external_enable, mode: absolute}\n- {at: 0.25, to: x, do: external_setpoints, file: a.csv}\n"


def test_the_path_is_relative_to_the_scenario(tmp_path: Path) -> None:
    rows = generator(300.0, first_cycle=0)
    entries = read_entries(PTP, program=None, scenario=write(tmp_path, MOVE, a=csv(rows)))
    assert entries[1].command.arguments == {"setpoints": rows}


def test_faults_of_a_file_stand_with_the_line_of_the_scenario(tmp_path: Path) -> None:
    path = write(
        tmp_path,
        MOVE + "- {at: 1, to: x, do: external_setpoints, file: none.csv}\n- {at: 1, to: y, do: external_setpoints}\n"
        "- {at: 1, to: x, do: external_setpoints, file: 5}\n",
        a=HEADER + "0,0,0,0,1\n0,0,0,0,1\n",
    )
    assert scenario_fault(path).splitlines() == [
        f"P-ERR-25101 {path}:2: setpoint file a.csv:3: cycle 0 comes after cycle 0; cycles must ascend; nothing was started",
        f"P-ERR-25101 {path}:3: setpoint file {tmp_path / 'none.csv'} cannot be read: No such file or directory; "
        "nothing was started",
        f"P-ERR-25101 {path}:4: axis y: external_setpoints refused: argument 'file' is missing; nothing was changed",
        f"P-ERR-25101 {path}:5: axis x: external_setpoints refused: argument 'file' is missing; nothing was changed",
        "nothing was started",
    ]


def test_a_file_that_is_no_text(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_bytes(b"\xff\xfe\x00")
    path = write(tmp_path, MOVE)
    assert f"setpoint file {tmp_path / 'a.csv'} cannot be read: it is UTF-16 text; save it as UTF-8" in scenario_fault(
        path
    )


@pytest.mark.parametrize(
    ("setpoints", "reason"),
    [
        ("5", "setpoints = 5 is not a list of rows"),
        ("[5]", f"a setpoint needs {COLUMNS}; 5 is not a list of them"),
        ("[[]]", f"a setpoint needs {COLUMNS}; [] has 0 values"),
        ("[[a, 0, 0, 0, 1]]", "cycle = 'a' is not a number within ±1e+12"),
        ("[[5, .nan, 0, 0, 1]]", "position = nan is not a number within ±1e+12"),
        ("[[5, 0, 0, 0, 1], [5, 0, 0, 0, 1]]", "setpoint of cycle 5: comes after cycle 5; cycles must ascend"),
        (
            "[{1: 2, 2: 3, 3: 4, 4: 5, 5: 6}]",
            f"a setpoint needs {COLUMNS}; {{1: 2, 2: 3, 3: 4, 4: 5, 5: 6}} is not a list of them",
        ),
    ],
)
def test_setpoints_in_the_scenario_itself(setpoints: str, reason: str) -> None:
    with pytest.raises(ScenarioError) as caught:
        parse_scenario(f"- {{at: 0, to: x, do: external_setpoints, setpoints: {setpoints}}}", "s.yaml", KINDS)
    assert str(caught.value).splitlines()[0] == (
        f"P-ERR-25101 s.yaml:1: axis x: external_setpoints refused: {reason}; nothing was changed"
    )


def test_setpoints_in_the_scenario_move_the_axis() -> None:
    scenario = (
        "- {at: 0, to: x, do: external_enable, mode: relative}\n"
        "- {at: 0.1, to: x, do: external_setpoints, setpoints: [[0, 0, 0, 0, 1], [1, 0.5, 0, 0, 1], [2, 0.5, 0, 0, 0]]}\n"
    )
    bench = MachineBench(None, scenario, machine=PTP).run()
    assert bench.column("x", "set_position")[99:104] == [0.0, 0.0, 0.5, 0.5, 0.5]
    assert not bench.failed


@pytest.mark.parametrize(
    ("do", "kind"), [("external_setpoints, file: a.csv", "channel"), ("external_setpoints", "spindle")]
)
def test_other_units_know_no_setpoints(do: str, kind: str) -> None:
    unit = {"channel": "channel", "spindle": "s"}[kind]
    with pytest.raises(ScenarioError) as caught:
        parse_scenario(f"- {{at: 0, to: {unit}, do: {do}}}", "s.yaml", unit_kinds(MILL), lambda what, path: "")
    assert f"{kind} {unit}: unknown command 'external_setpoints'" in str(caught.value)


# played by the PLC


def plc(*entries: tuple[float, Command]) -> PlcUnit:
    scenario = [Entry(at, command) for at, command in entries]
    return PlcUnit("plc", kinds={"x": "axis"}, scenario=scenario, cycle_time=0.001)


def sent(unit: PlcUnit, blocks: int, count: int = 10) -> list[tuple[int, list[tuple[str, Any]]]]:
    """Per block with commands: its first cycle, and (command, rows or arguments)."""
    result = []
    for number in range(blocks):
        block = unit.step(CycleTick(number * count, count), {})
        commands = [(c.command, c.arguments.get("setpoints", c.arguments)) for c in block.commands]
        if commands:
            result.append((number * count, commands))
    return result


def test_rows_go_out_with_their_block_after_the_commands() -> None:
    rows = [[0, 0.0, 0.0, 0.0, 1], [9, 1.0, 0.0, 0.0, 1], [10, 2.0, 0.0, 0.0, 1], [35, 3.0, 0.0, 0.0, 0]]
    unit = plc((0.02, Command("x", "external_setpoints", {"setpoints": rows})), (0.02, Command("x", "stop", {})))
    at_20 = [[row[0] + 20, *row[1:]] for row in rows]
    assert sent(unit, 8) == [
        (20, [("stop", {}), ("external_setpoints", at_20[:2])]),
        (30, [("external_setpoints", at_20[2:3])]),
        (50, [("external_setpoints", at_20[3:])]),
    ]


def test_a_file_for_later_cycles_waits_for_them() -> None:
    rows = [[57, 0.0, 0.0, 0.0, 1]]
    unit = plc((0.0, Command("x", "external_setpoints", {"setpoints": rows})))
    assert sent(unit, 10) == [(50, [("external_setpoints", rows)])]


def test_the_scenario_is_not_through_while_rows_wait() -> None:
    unit = plc((0.0, Command("x", "external_setpoints", {"setpoints": [[57, 0.0, 0.0, 0.0, 1]]})))
    done = [unit.step(CycleTick(10 * number, 10), {}).scenario_done for number in range(8)]
    assert done == [False] * 5 + [True] * 3


def test_stop_all_drops_the_rows() -> None:
    unit = plc((0.0, Command("x", "external_setpoints", {"setpoints": [[57, 0.0, 0.0, 0.0, 1]]})))
    unit.step(CycleTick(0, 10), {})
    unit.command(Command("plc", "stop_all", {}), 10)
    assert [command for _, commands in sent(unit, 10) for command in commands if command[0] != "stop"] == []


def test_a_run_waits_for_the_rows_and_ends_with_external_setpoints_enabled(tmp_path: Path) -> None:
    """Rows wait for 3 s in which nothing moves; the run ends 0.2 s after the last motion, still enabled."""
    rows = generator(300.0, first_cycle=3000)
    entries = read_entries(PTP, program=None, scenario=write(tmp_path, MOVE, a=csv(rows)))
    units = build_units(PTP, scenario=entries)
    blocks: list[Any] = [outputs["x"].block for outputs in OfflineMachine(PTP, units).run()]
    positions = [value for block in blocks for value in block.set_position]
    for row in rows:
        assert positions[int(row[0])] == row[1]
    assert blocks[-1].status_bits[-1] & (1 << 14) and blocks[-1].state[-1] == 4
    assert 0.2 <= (len(positions) - rows[-1][0]) * 0.001 <= 0.24


def call(*arguments: Any) -> Any:
    return CliRunner().invoke(cli.main, [str(argument) for argument in arguments])


@pytest.mark.long
def test_a_recorded_run_is_replayed_bit_for_bit(tmp_path: Path) -> None:
    """External setpoints from two files, alone and on a PTP motion, with compensation; simulate --record, replay --verify."""
    scenario = (
        MOVE
        + "- {at: 1.3, to: x, do: external_disable}\n"
        + "- {at: 1.4, to: x, do: move_absolute, target: 5000, velocity: 2000}\n"
        + "- {at: 1.5, to: x, do: external_enable, mode: relative, target: 77.7}\n"
        + "- {at: 1.6, to: x, do: external_setpoints, file: b.csv}\n"
        + "- {at: 2.0, to: x, do: compensation_start, length: 2000, difference: 55.5, process_velocity: 2000, "
        "velocity_increase: 300}\n"
        + "- {at: 2.4, to: x, do: set_override, percent: 30}\n"
        + "- {at: 2.9, to: x, do: compensation_stop}\n"
        + "- {at: 3.2, to: x, do: set_override, percent: 100}\n"
        + "- {at: 2.0, to: c, do: external_enable, mode: relative}\n"
        + "- {at: 2.0, to: c, do: external_setpoints, file: c.csv}\n"
        + "- {at: 2.3, to: c, do: stop}\n"
    )
    path = write(
        tmp_path,
        scenario,
        a=csv(generator(321.0, first_cycle=3)),
        b=csv(generator(77.7, first_cycle=0, velocity=300.0, every=7)),
        c=csv(generator(-90.0, first_cycle=0, velocity=180.0)),
    )
    machine, recording = ROOT / "config" / "ptp.yaml", tmp_path / "r.mcap"
    done = call("simulate", machine, "--scenario", path, "--record", recording)
    assert done.exit_code == 0, done.output
    verified = call("replay", recording, "--verify")
    assert verified.exit_code == 0, verified.output
    assert "states of 4 topics are equal to the bit" in verified.output


def test_a_bad_file_is_told_before_anything_runs(tmp_path: Path) -> None:
    path = write(tmp_path, MOVE, a=HEADER + "0,0,0,0,9\n")
    done = call("simulate", ROOT / "config" / "ptp.yaml", "--scenario", path, "--record", tmp_path / "r.mcap")
    assert done.exit_code == 2
    assert "setpoint file a.csv:2: setpoint of cycle 0: direction = 9 is not one of -1, 0, 1" in done.output.replace(
        "\n", " "
    )
    assert not (tmp_path / "r.mcap").exists()
