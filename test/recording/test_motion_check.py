"""The motion checker: closed forms of its bounds, each kind of violation at its cycle, exact texts for bad input."""

from __future__ import annotations

import itertools
import json
import shutil
from collections.abc import Callable, Sequence
from math import inf
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner
from machine_support import ROOT
from recording_support import Blocks

from cnc_ptp.cli import main
from cnc_ptp.errors import CncError
from cnc_ptp.machine.wiring import build_units, unit_kinds
from cnc_ptp.parameters import machine_text, read_machine
from cnc_ptp.plc.scenario import parse_scenario
from cnc_ptp.recording.mcap_file import McapFile
from cnc_ptp.recording.motion_check.check import check_motion, check_recording, steps_from
from cnc_ptp.recording.motion_check.continuity import PEANO
from cnc_ptp.recording.motion_check.findings import MotionResult
from cnc_ptp.recording.motion_check.inputs import MotionInputs, orders_by_unit, read_inputs
from cnc_ptp.recording.offline_run import OfflineRun
from cnc_ptp.recording.opened import OpenRecording
from cnc_ptp.recording.writer import Recording

MILL = ROOT / "config" / "mill.yaml"
SCENARIO = """
- {at: 0.0, to: x, do: move_absolute, target: 20, velocity: 100}
- {at: 0.0, to: z, do: couple, master: y, factor: -0.5}
- {at: 0.05, to: y, do: move_absolute, target: 10, velocity: 100}
- {at: 0.0, to: s, do: start, direction: cw, speed_rpm: 600}
- {at: 0.6, to: s, do: stop}
- {at: 0.7, to: x, do: power, enabled: false}
- {at: 1.0, to: x, do: power, enabled: true}
"""


def make_run(
    path: Path, scenario: str = SCENARIO, machine: Path = MILL, change: Callable[..., None] | None = None
) -> Path:
    """Records a run; `change(name, block)` bends blocks before they are written."""
    parameters = read_machine(str(machine))
    entries = parse_scenario(scenario, "test.yaml", unit_kinds(parameters))
    units = build_units(parameters, scenario=entries)
    text = machine_text(str(machine))
    with OfflineRun(parameters, units, record=str(path), machine_text=text, checkpoint_seconds=0.0) as run:
        if change is None:
            for _ in run.run():
                pass
        else:
            recording: Any = run._recording
            write = recording.block

            def bent(name: str, block: Any) -> None:
                change(name, block)
                write(name, block)

            recording.block = bent
            for _ in run.run():
                pass
    return path


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return make_run(tmp_path_factory.mktemp("motion") / "run.mcap")


@pytest.fixture
def inputs(path: Path) -> MotionInputs:
    with OpenRecording(path) as recording:
        return read_inputs(recording)


def bent(inputs: MotionInputs, unit: str, column: str, cycle: int, by: float) -> MotionResult:
    """The run with one value changed."""
    columns = {**(inputs.axes | inputs.spindles)[unit]}
    columns[column] = columns[column].astype(float).copy()
    columns[column][int(np.searchsorted(columns["cycle"], cycle))] += by
    (inputs.axes if unit in inputs.axes else inputs.spindles)[unit] = columns
    return check_motion(inputs)


def found(result: MotionResult) -> set[tuple[str, str, int, int]]:
    return {(each.unit, each.what, each.cycle, each.cycles) for each in result.violations}


def test_a_good_run_has_no_violation(path: Path) -> None:
    result = check_recording(path)
    assert result.violations == []
    assert sorted(result.units) == ["s", "x", "y", "z"]
    assert result.text() == f"{path}: motion of {result.cycles} cycles of 4 units: no violation"


BENT = [
    ("x", "set_position", 100, 1e-5, ("step of position", 100, 2)),
    ("x", "set_velocity", 100, 0.05, ("step of velocity", 100, 2)),
    ("x", "set_acceleration", 100, 120.0, ("step of acceleration", 100, 2)),
    ("x", "set_velocity", 100, 1e5, ("velocity", 100, 1)),
    ("x", "set_acceleration", 100, 1e6, ("acceleration", 100, 1)),
    ("x", "set_position", 800, 1e-9, ("set position changes without power", 800, 2)),
    ("x", "set_velocity", 800, 1e-9, ("set velocity without power", 800, 1)),
    ("x", "set_acceleration", 800, 1e-9, ("set acceleration without power", 800, 1)),
    ("x", "set_velocity", 1010, 1e-9, ("set velocity at a standstill", 1010, 1)),
    ("z", "set_velocity", 120, 1e-6, ("velocity beside that of the master", 120, 1)),
    ("z", "set_acceleration", 120, 1e-6, ("acceleration beside that of the master", 120, 1)),
    ("z", "set_position", 120, 1e-6, ("distance beside that of the master", 120, 2)),
    ("s", "set_speed_rpm", 300, 12000.0, ("velocity", 300, 1)),
    ("s", "set_position_deg", 300, 0.5, ("step of position", 300, 2)),
    ("s", "set_speed_rpm", 300, 50.0, ("step of velocity", 300, 2)),
    ("s", "set_acceleration_deg_s2", 300, 1e6, ("acceleration", 300, 1)),
]


@pytest.mark.parametrize(("unit", "column", "cycle", "by", "wanted"), BENT, ids=lambda value: str(value))
def test_one_bent_value_is_told_at_its_cycle(
    inputs: MotionInputs, unit: str, column: str, cycle: int, by: float, wanted: tuple[str, int, int]
) -> None:
    result = bent(inputs, unit, column, cycle, by)
    assert (unit, *wanted) in found(result)
    assert {each[0] for each in found(result)} == {unit}
    assert {each[2] for each in found(result)} <= {cycle, cycle + 1}


@pytest.mark.parametrize("column", ["set_position", "set_velocity", "set_acceleration"])
def test_no_number(inputs: MotionInputs, column: str) -> None:
    result = bent(inputs, "x", column, 100, float("nan"))
    assert ("x", f"{column.removeprefix('set_')} is no number", 100, 1) in found(result)


def test_beyond_a_soft_limit(inputs: MotionInputs) -> None:
    columns = {**inputs.axes["x"]}
    limit = inputs.machine.axes["x"].soft_limit_positive
    columns["set_position"] = columns["set_position"] + (limit - 5.0)
    inputs.axes["x"] = columns
    found_there = [each for each in check_motion(inputs).violations if "soft limit" in each.what]
    (violation,) = found_there
    first = int(columns["cycle"][np.flatnonzero(columns["set_position"] > limit)[0]])
    assert (violation.what, violation.cycle, violation.limit) == ("beyond the positive soft limit", first, limit)


def test_a_spindle_that_nobody_turns(inputs: MotionInputs) -> None:
    inputs.orders["s"] = [order for order in inputs.orders["s"] if order.command != "start"]
    (violation,) = check_motion(inputs).violations
    assert (violation.unit, violation.what, violation.cycle) == ("s", "speeds up without an owner", 1)


def test_a_spindle_whose_channel_is_gone(inputs: MotionInputs) -> None:
    """Behind its last cycle and the time of the watchdog the spindle may only slow down: here it keeps its speed."""
    inputs.channels["channel"] = inputs.channels["channel"][:100]
    (start,) = (order for order in inputs.orders["s"] if order.command == "start")
    inputs.orders["s"] = [type(start)(0, "start", {"source": "channel"})]
    found_there = [each for each in check_motion(inputs).violations if each.unit == "s"]
    machine = inputs.machine
    patience = machine.watchdog_ms * 1000 // machine.cycle_time_us + 3 * machine.block_cycles
    assert (found_there[0].what, found_there[0].cycle) == ("turns for a channel that is gone", 100 + patience)


@pytest.mark.parametrize(
    ("commands", "wanted"),
    [
        ([("stop", {"source": "plc"})], True),
        ([("stop", {"source": "plc", "own": True})], False),
        ([("set_emergency_stop", {"enabled": True})], True),
        ([("set_emergency_stop", {"enabled": False})], False),
    ],
)
def test_a_stop_ends_ownership_where_it_has_an_effect(
    inputs: MotionInputs, commands: list[tuple[str, dict[str, Any]]], wanted: bool
) -> None:
    """The spindle speeds up; a stop of somebody else that counts for his own commands alone does not end that."""
    (start,) = (order for order in inputs.orders["s"] if order.command == "start")
    ended = [type(start)(10, *each) for each in commands]
    inputs.orders["s"] = [type(start)(0, "start", {"source": "channel"}), *ended]
    violations = [each for each in check_motion(inputs).violations if each.what == "speeds up without an owner"]
    assert bool(violations) == wanted
    assert {each.cycle for each in violations} <= {11}


def test_velocity_without_power(inputs: MotionInputs) -> None:
    result = bent(inputs, "x", "actual_velocity", 990, 50.0)
    assert ("x", "actual velocity without power", 990, 1) in found(result)


def test_beyond_the_negative_soft_limit(inputs: MotionInputs) -> None:
    """The same motion mirrored."""
    names = ("set_position", "set_velocity", "set_acceleration", "actual_position", "actual_velocity")
    columns = {**inputs.axes["x"]} | {name: -inputs.axes["x"][name] for name in names}
    limit = inputs.machine.axes["x"].soft_limit_negative
    columns["set_position"] = columns["set_position"] + (limit + 5.0)
    inputs.axes["x"] = columns
    (violation,) = (each for each in check_motion(inputs).violations if "soft limit" in each.what)
    first = int(columns["cycle"][np.flatnonzero(columns["set_position"] < limit)[0]])
    assert (violation.what, violation.cycle, violation.limit) == ("beyond the negative soft limit", first, limit)


def test_motion_without_commands_is_not_guessed(path: Path, inputs: MotionInputs) -> None:
    """A recording of blocks alone says nothing about who has commanded what moves."""
    with OpenRecording(path) as recording:
        recording.topics = {name: topic for name, topic in recording.topics.items() if name != "/commands"}
        with pytest.raises(CncError) as refused:
            read_inputs(recording)
    text = f"P-ERR-26264 recording {path}: was recorded without /commands; no motion was checked"
    assert str(refused.value) == text


def test_a_recording_that_begins_within_a_trajectory(tmp_path: Path) -> None:
    """Its kinks are meant, but the command that says so was before the recording."""
    machine = ROOT / "config" / "ptp.yaml"
    whole = make_run(tmp_path / "run.mcap", (ROOT / "examples" / "trajectory.yaml").read_text(), machine=machine)
    with OpenRecording(whole) as recording:
        late = read_inputs(recording)
    assert check_motion(late).violations == []
    for units in (late.axes, late.spindles):
        for name, columns in units.items():
            begin = int(np.searchsorted(columns["cycle"], 1000))
            units[name] = {key: column[begin:] for key, column in columns.items()}
    late.orders = {unit: [each for each in orders if each.cycle >= 1000] for unit, orders in late.orders.items()}
    assert check_motion(late).violations == []


def test_an_axis_that_starts_behind_a_stop(inputs: MotionInputs) -> None:
    (move,) = (order for order in inputs.orders["y"] if order.command == "move_absolute")
    inputs.orders["y"].remove(move)
    inputs.orders["y"].append(type(move)(0, "stop", {}))
    (violation,) = check_motion(inputs).violations
    assert (violation.unit, violation.what) == ("y", "moves although it was stopped")


@pytest.mark.parametrize(
    ("arguments", "later", "what"),
    [
        ({}, (), {"moves on after a stop"}),
        ({"deceleration": 1.0}, (), set()),
        ({"enabled": False}, (), set()),
        ({}, ("move_velocity",), set()),
    ],
    ids=["ignored", "on a long ramp", "taken back", "another command"],
)
def test_a_stop_that_is_not_obeyed(
    arguments: dict[str, Any], later: Sequence[str], what: set[str], tmp_path: Path
) -> None:
    """At 50 mm/s for 4 s; a stop in between takes some tenths of a second."""
    path = make_run(tmp_path / "run.mcap", "- {at: 0.0, to: y, do: move_absolute, target: 190, velocity: 50}\n")
    with OpenRecording(path) as recording:
        inputs = read_inputs(recording)
    (move,) = inputs.orders["y"]
    kind = "set_emergency_stop" if "enabled" in arguments else "stop"
    inputs.orders["y"] += [type(move)(1000, kind, arguments), *(type(move)(1001, each, {}) for each in later)]
    assert {violation.what for violation in check_motion(inputs).violations} == what


def test_soft_limits_move_with_set_position(tmp_path: Path) -> None:
    """Seed 33 of `bench.random_commands`: at cycle 0 there is no cycle before from which the shift could be read."""
    scenario = """
- {at: 0.0, to: x, do: set_position, position: 150, relative: true}
- {at: 0.1, to: x, do: move_relative, distance: 5}
"""
    path = make_run(tmp_path / "run.mcap", scenario, machine=ROOT / "config" / "ptp.yaml")
    assert check_recording(path).violations == []


def test_homing_that_is_stopped_beyond_a_soft_limit(tmp_path: Path) -> None:
    """Seed 400751 of `bench.random_commands`: the reference is at the limit, and it brakes behind it."""
    scenario = """
- {at: 0.0, to: z, do: home, position: -150}
- {at: 0.07, to: z, do: stop}
"""
    path = make_run(tmp_path / "run.mcap", scenario)
    with OpenRecording(path) as recording:
        columns = recording.columns("/z/state", "set_position", "set_velocity")
        assert columns["set_position"][-1] < -150.1 and columns["set_velocity"][-1] == 0.0
    assert check_recording(path).violations == []


def test_an_abrupt_stop_is_told(tmp_path: Path) -> None:
    """Its deceleration is above A- of the axis (2400 mm/s²), within P-AXIS-00008: told, and no violation."""
    scenario = """
- {at: 0.0, to: x, do: move_absolute, target: 100, velocity: 200, acceleration: 500, deceleration: 500}
- {at: 0.3, to: x, do: emergency_stop, deceleration: 2800, jerk: 90000}
"""
    result = check_recording(make_run(tmp_path / "run.mcap", scenario))
    assert result.violations == []
    (told,) = result.told
    assert (told.unit, told.what) == ("x", "deceleration of an abrupt stop")
    assert (told.value, told.limit) == (-2800.0, 2400.0)


def test_a_flying_saw_that_leaves_a_path(tmp_path: Path) -> None:
    """Its velocity ends on the jerk of the axis while the circle continues: together they are above it."""
    machine = tmp_path / "conveyor.yaml"
    z = '          "2": {bezeichnung: Z, log_achs_nr: 3}\n'
    assert z in MILL.read_text()
    machine.write_text(MILL.read_text().replace("achs_anzahl: 3", "achs_anzahl: 2").replace(z, ""))
    shutil.copytree(MILL.parent / "tools", tmp_path / "tools")
    scenario = """
- {at: 0.0, to: channel, do: mdi, text: "G01 X20 Y0 F6000\\nG04 X1\\nG02 X20 Y0 I-20 J0 F3000\\nM30"}
- {at: 0.0, to: z, do: jog, velocity: 8}
- {at: 0.4, to: x, do: couple_flying_saw, master: z, factor: 1, master_position: 8, slave_position: 3}
- {at: 2.0, to: x, do: decouple}
- {at: 2.5, to: z, do: stop}
"""
    run = make_run(tmp_path / "run.mcap", scenario, machine)
    with OpenRecording(run) as recording:
        inputs = read_inputs(recording)
    assert check_motion(inputs).violations == []
    jerk = np.diff(inputs.axes["x"]["set_acceleration"]) / 1e-3
    assert np.abs(jerk[2000:2100]).max() > inputs.machine.axes["x"].jerk


UNTAKEN = [
    ("x", "move_absolute", '{"target":'),
    ("x", "move_absolute", "[1]"),
    ("x", "move_absolute", "null"),
    ("x", "move_absolute", "[" * 3000),
    ("x", "move_relative", '{"target": 1.0}'),
    ("x", "jump", "{}"),
    ("x", "write_parameter", '{"parameter": "P-AXIS-00008"}'),
    ("x", "write_parameter", '{"parameter": 8, "value": 1.0}'),
    ("x", "set_coupling_factor", "{}"),
    ("x", "couple", '{"factor": 1.0}'),
    ("x", "couple", '{"factor": [], "master": "y"}'),
    ("x", "begin_trajectory", '{"points": {}}'),
    ("s", "couple", "{}"),
    ("nobody", "stop", "{}"),
]


@pytest.mark.parametrize(("unit", "command", "arguments"), UNTAKEN)
def test_a_command_that_no_unit_can_take_is_left_out(
    inputs: MotionInputs, unit: str, command: str, arguments: str
) -> None:
    good = (5, unit, "reset", "", True)
    orders = orders_by_unit(inputs.machine, [(5, unit, command, arguments, True), good, (6, "x", "stop", "{}", False)])
    assert {name: [each.command for each in of_unit] for name, of_unit in orders.items()} == (
        {} if unit == "nobody" else {unit: ["reset"]}
    )


def test_commands_of_other_versions_are_taken(inputs: MotionInputs) -> None:
    """A former name, an argument that is no longer known, a table with the name of its file."""
    rows = [
        (0, "x", "power", '{"on": true, "slowly": 1}', True),
        (1, "x", "couple_cam", '{"master": "y", "table": [], "file": "cam.csv", "factor": []}', True),
        (2, "x", "stop", '{"deceleration": 1e9, "files": [1]}', True),
    ]
    power, cam, stop = orders_by_unit(inputs.machine, rows)["x"]
    assert (power.arguments, cam.command) == ({"enabled": True}, "couple_cam")
    assert "factor" not in cam.arguments and stop.arguments.keys() <= {"deceleration"}
    channel = orders_by_unit(inputs.machine, [(0, "channel", "start", '{"files": [1]}', True)])["channel"]
    assert channel[0].arguments == {}, "what no channel takes raises no limit"


@pytest.mark.parametrize(
    ("command", "arguments"),
    [
        ("write_parameter", {"parameter": "P-AXIS-99999", "value": 1.0}),
        ("begin_trajectory", {"points": [1]}),
        ("emergency_stop", {"deceleration": 10**400}),
        ("stop", {"deceleration": 1e-300, "jerk": 1e-300}),
    ],
)
def test_values_that_no_unit_can_have_taken_break_nothing(
    inputs: MotionInputs, command: str, arguments: dict[str, Any]
) -> None:
    order = inputs.orders["y"][-1]
    inputs.orders["y"].append(type(order)(inputs.axes["y"]["cycle"][-1] + 1, command, arguments))
    assert check_motion(inputs).violations == []
    inputs.orders["y"][-1] = type(order)(60, command, arguments)
    check_motion(inputs)


STRONGER = """
- {at: 0.0, to: x, do: move_absolute, target: 20, velocity: 100, acceleration: 20000, deceleration: 20000, jerk: 2e7}
- {at: 0.0, to: y, do: move_superimposed, distance: 5, acceleration: 20000, deceleration: 20000, jerk: 2e7}
"""


def test_no_command_raises_a_limit_above_the_largest_permitted(tmp_path: Path) -> None:
    """A kernel that takes what it has to refuse (23013): here one whose P-AXIS-00008 was larger than the file says."""
    machine, text = tmp_path / "stronger.yaml", MILL.read_text()
    machine.write_text(text.replace("a_max: 4000", "a_max: 40000"))
    shutil.copytree(MILL.parent / "tools", tmp_path / "tools")
    run = make_run(tmp_path / "run.mcap", STRONGER, machine)
    with OpenRecording(run) as recording:
        inputs = read_inputs(recording)
    assert check_motion(inputs).violations == []
    inputs.machine = read_machine(str(MILL))
    limits = {each.unit: each.limit for each in check_motion(inputs).violations if each.what == "acceleration"}
    assert limits == {"x": 4000.0, "y": 1800.0 + 4000.0}
    assert {each.unit for each in check_motion(inputs).violations if each.what == "step of acceleration"} == {"x"}


def test_a_slope_relaxes_the_axes_of_its_channel_from_its_text_on() -> None:
    machine = read_machine(str(ROOT / "examples" / "spindles" / "two_channels.yaml"))
    first, second = machine.channels.values()
    inputs = MotionInputs(machine, 1e-3, {name: {"cycle": np.arange(10)} for name in machine.axes})
    own, others = first.axes[0].node, second.axes[0].node
    assert (steps_from(inputs, own), steps_from(inputs, others)) == (inf, inf)
    load = {"program": "main.nc", "text": "G0 X1", "files": {"sub.nc": "#slope [TYPE=STEP]"}}
    orders = [(3, first.name, "load", json.dumps({"program": "#SLOPE"}), True)]
    orders += [(cycle, first.name, "load", json.dumps(load), True) for cycle in (7, 9)]
    inputs.orders = orders_by_unit(machine, orders)
    assert (steps_from(inputs, own), steps_from(inputs, others)) == (7, inf)
    inputs.axes[own] = {"cycle": np.arange(5, 10)}
    assert steps_from(inputs, own) == 0.0


# closed forms


def test_no_jerk_within_the_limit_exceeds_the_bounds() -> None:
    """All sequences of ±J, 0 over eighths of a cycle, integrated in parts: the bounds hold, and are reached."""
    worst_v = worst_x = 0.0
    for jerks in itertools.product((-1.0, 1.0), repeat=8):
        x = v = a = 0.0
        for jerk in jerks:
            d = 0.125
            x, v, a = x + d * (v + d * (a / 2 + d * jerk / 6)), v + d * (a + d * jerk / 2), a + d * jerk
        off_v, off_x = abs(v - 0.5 * a), abs(x - 0.5 * v + a / 12)
        assert off_v <= 0.25 * (1.0 - a * a) + 1e-15
        assert off_x <= PEANO + 1e-15
        worst_v, worst_x = max(worst_v, off_v), max(worst_x, off_x)
    assert worst_v == 0.25
    assert worst_x > 0.95 * PEANO


def test_the_largest_position_step_is_reached() -> None:
    """With jerk changes where the kernel (s² - 1/12)/2 changes its sign: s = ±1/√12 from the middle of the cycle."""
    inner = 1.0 / 12.0**0.5
    x = v = a = 0.0
    for d, jerk in ((0.5 - inner, 1.0), (2.0 * inner, -1.0), (0.5 - inner, 1.0)):
        x, v, a = x + d * (v + d * (a / 2 + d * jerk / 6)), v + d * (a + d * jerk / 2), a + d * jerk
    assert abs(x - 0.5 * v + a / 12) == pytest.approx(PEANO, rel=1e-12)


# command and bad input


def told(*words: str) -> tuple[int, str]:
    result = CliRunner().invoke(main, ["verify", *words])
    return result.exit_code, result.output if result.exception is None else f"{result.output}{result.exception}"


def test_command_of_a_good_run(path: Path) -> None:
    status, text = told("--motion", str(path))
    assert (status, text.splitlines()[0]) == (0, check_recording(path).text())


def test_command_as_json(path: Path) -> None:
    status, text = told("--motion", "--json", str(path))
    assert status == 0
    assert json.loads(text) == check_recording(path).as_json()


def test_json_needs_motion(path: Path) -> None:
    status, text = told("--json", str(path))
    assert status == 2
    assert "--json is an option of --motion; nothing was verified" in text


@pytest.mark.motion_unchecked("one value is bent")
def test_command_of_a_bent_recording(tmp_path: Path) -> None:
    def bend(name: str, block: Any) -> None:
        if name == "x" and block.first_cycle == 100:
            block.set_position[3] += 1e-3

    path = make_run(tmp_path / "run.mcap", change=bend)
    status, text = told("--motion", str(path))
    assert status == 1
    assert text.splitlines()[0] == f"{path}: 1 violations in {check_recording(path).cycles} cycles of 4 units"
    assert "step of position" in text


def record_as(path: Path, unit: str, block: Any, machine: str) -> None:
    with Recording(path, machine) as recording:
        recording.block(unit, block)


def refused(path: Path) -> str:
    with pytest.raises(CncError) as error:
        check_recording(path)
    return str(error.value)


def test_fields_that_were_not_recorded(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("cnc_ptp.recording.motion_check.inputs.AXIS_FIELDS", ("cycle", "set_snap"))
    assert (
        refused(path) == f"P-ERR-26264 recording {path}: /x/state was recorded without set_snap; no motion was checked"
    )


@pytest.mark.parametrize(
    ("topic", "column", "wrong"),
    [
        ("/x/state", "set_position", np.zeros((5, 2))),
        ("/x/state", "state", np.array(["a"] * 5)),
        ("/commands", "target", np.zeros(5)),
        ("/commands", "cycle", np.array(["a"] * 5, dtype=object)),
    ],
)
def test_fields_of_another_type(
    path: Path, monkeypatch: pytest.MonkeyPatch, topic: str, column: str, wrong: np.ndarray[Any, Any]
) -> None:
    read = OpenRecording.columns

    def columns(self: OpenRecording, name: str, *fields: str) -> dict[str, Any]:
        return {**read(self, name, *fields)} | ({column: wrong} if name == topic else {})

    monkeypatch.setattr(OpenRecording, "columns", columns)
    reason = f"{topic} was recorded with another type of {column}; no motion was checked"
    assert refused(path) == f"P-ERR-26264 recording {path}: {reason}"


def test_units_of_which_nothing_is_left(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """As in a damaged file, whose summary counts messages that no index names."""
    read = OpenRecording.columns

    def columns(self: OpenRecording, name: str, *fields: str) -> dict[str, Any]:
        return {field: column[:0] for field, column in read(self, name, *fields).items()}

    monkeypatch.setattr(OpenRecording, "columns", columns)
    reason = "holds no setpoints of an axis or a spindle; no motion was checked"
    assert refused(path) == f"P-ERR-26262 recording {path}: {reason}"


def test_a_missing_file(tmp_path: Path) -> None:
    path = tmp_path / "none.mcap"
    reason = "cannot be opened: No such file or directory; nothing was read, check the path"
    assert refused(path) == f"P-ERR-26001 recording {path}: {reason}"


def test_a_foreign_file(tmp_path: Path) -> None:
    path = tmp_path / "foreign.mcap"
    McapFile(path).close()
    assert refused(path) == f"P-ERR-26017 recording {path}: is not of cnc_ptp; no motion was checked"


def test_no_setpoints(tmp_path: Path) -> None:
    path = tmp_path / "channel.mcap"
    record_as(path, "channel", Blocks(1).channel(0), machine_text(str(MILL)))
    reason = "holds no setpoints of an axis or a spindle; no motion was checked"
    assert refused(path) == f"P-ERR-26262 recording {path}: {reason}"


def test_no_machine_file(tmp_path: Path) -> None:
    path = tmp_path / "none.mcap"
    record_as(path, "x", Blocks(1).axis(0), "")
    reason = "holds no attachment machine.yaml, which has the limits; no motion was checked"
    assert refused(path) == f"P-ERR-26263 recording {path}: {reason}"


def test_an_axis_without_parameters(tmp_path: Path) -> None:
    path = tmp_path / "other.mcap"
    record_as(path, "other", Blocks(1).axis(0), machine_text(str(MILL)))
    reason = "its machine.yaml has no axis 'other'; no motion was checked"
    assert refused(path) == f"P-ERR-26263 recording {path}: {reason}"
