"""Scenario files: how they are read, the exact text of every fault, when and in which order commands act."""

from __future__ import annotations

from pathlib import Path

import pytest
from machine_support import AXIS_COMMANDS, MILL, PTP, ROOT, MachineBench

from bench.fuzzing.mutation import LAUGHS
from cnc_ptp.channel.program_check import ProgramCheck
from cnc_ptp.errors import CncError
from cnc_ptp.machine.run_entries import read_entries, read_file
from cnc_ptp.machine.wiring import unit_kinds
from cnc_ptp.nc.faults import ProgramError
from cnc_ptp.plc.plc_unit import PlcUnit
from cnc_ptp.plc.scenario import Entry, ScenarioError, parse_scenario
from cnc_ptp.protocol.blocks import Command, CycleTick

KINDS = unit_kinds(MILL)


def parse(text: str) -> list[Entry]:
    return parse_scenario(text, "s.yaml", KINDS)


def fault(text: str) -> str:
    with pytest.raises(ScenarioError) as caught:
        parse(text)
    return str(caught.value)


def test_entries_in_the_order_of_time_then_of_the_file() -> None:
    entries = parse(
        "- {at: 1, to: x, do: stop}\n- {at: 0.5, to: y, do: stop}\n- {at: 1.0, to: z, do: reset}\n- {at: 0, to: "
        "s, do: stop}\n"
    )
    assert [(e.at, e.command.target, e.command.command) for e in entries] == [
        (0.0, "s", "stop"),
        (0.5, "y", "stop"),
        (1.0, "x", "stop"),
        (1.0, "z", "reset"),
    ]


@pytest.mark.parametrize(
    ("word", "value"), [("on", True), ("off", False), ("true", True), ("False", False), ("TRUE", True)]
)
def test_switches_as_people_write_them(word: str, value: bool) -> None:
    assert parse(f"- {{at: 0, to: x, do: power, enabled: {word}}}")[0].command.arguments == {"enabled": value}
    assert parse(f"- {{at: 0, to: x, do: power, 'on': {word}}}")[0].command.arguments == {"enabled": value}


@pytest.mark.parametrize(
    ("text", "value"),
    [("1e3", 1e3), ("1.5e-2", 0.015), ("+7", 7), ("-.5", -0.5), ("12.", 12.0), ("2E+2", 200.0), ("1_000", 1000)],
)
def test_numbers_as_people_write_them(text: str, value: float) -> None:
    arguments = parse(f"- {{at: 0, to: x, do: move_absolute, target: {text}}}")[0].command.arguments
    assert arguments == {"target": value} and not isinstance(arguments["target"], str)


def test_the_axis_y_is_no_truth_value() -> None:
    assert parse("- {at: 0, to: y, do: stop}")[0].command.target == "y"


def test_an_empty_file_is_an_empty_scenario() -> None:
    assert parse("") == parse("# nothing\n") == parse("[]") == []


MISSING = "an entry needs at (seconds), to (unit) and do (command)"
KNOWN = "Known: channel, plc, s, x, y, z"
FAULTS = [
    ("- 5", MISSING),
    ("- [1, 2]", MISSING),
    ("- {at: 0, to: x}", MISSING),
    ("- {at: -1, to: x, do: stop}", "at = -1 must be a time in seconds, 0 to 10000000"),
    ("- {at: soon, to: x, do: stop}", "at = 'soon' must be a time in seconds, 0 to 10000000"),
    ("- {at: true, to: x, do: stop}", "at = True must be a time in seconds, 0 to 10000000"),
    ("- {at: .inf, to: x, do: stop}", "at = inf must be a time in seconds, 0 to 10000000"),
    ("- {at: .nan, to: x, do: stop}", "at = nan must be a time in seconds, 0 to 10000000"),
    ("- {at: 1e999, to: x, do: stop}", "at = inf must be a time in seconds, 0 to 10000000"),
    ("- {at: 1e18, to: x, do: stop}", "at = 1e+18 must be a time in seconds, 0 to 10000000"),
    ("- {at: 10000001, to: x, do: stop}", "at = 10000001 must be a time in seconds, 0 to 10000000"),
    ("- {at: [1], to: x, do: stop}", "at = [1] must be a time in seconds, 0 to 10000000"),
    (f"- {{at: {10**320}, to: x, do: stop}}", f"at = {10**320} must be a time in seconds, 0 to 10000000"),
    ("- {at: 0, to: a, do: stop}", f"unit 'a' does not exist in the machine. {KNOWN}"),
    ("- {at: 0, to: [x], do: stop}", f"unit '['x']' does not exist in the machine. {KNOWN}"),
    (
        "- {at: 0, to: x, do: [stop]}",
        "axis x: unknown command '['stop']'; did you mean stop?; nothing was changed. Known: " + AXIS_COMMANDS,
    ),
    ("- {at: 0, to: x, do: upstream_lost, source: plc}", "'upstream_lost' is given by watchdogs only"),
    ("- {at: 0, to: plc, do: abort, reason: x}", "'abort' is given by watchdogs only"),
    (
        "- {at: 0, to: s, do: stop, own: on}",
        "spindle s: stop refused: argument 'own' is for channels only; nothing was changed",
    ),
    (
        "- {at: 0, to: x, do: fly}",
        "axis x: unknown command 'fly'; nothing was changed. Known: " + AXIS_COMMANDS,
    ),
    (
        "- {at: 0, to: plc, do: fly}",
        "plc plc: unknown command 'fly'; nothing was changed. Known: acknowledge, auto_acknowledge, "
        "emergency_stop, follow_trajectory, reset, serve, set_input, set_life_sign, stop_all",
    ),
    (
        "- {at: 0, to: x, do: power, enabled: yes}",
        "axis x: power refused: enabled = 'yes' is not a switch; nothing was changed",
    ),
    ("- {at: 0, to: x, do: power, enabled: 1}", "axis x: power refused: enabled = 1 is not a switch; nothing was changed"),
    ("- {at: 0, to: x, do: power, enabled: [on]}", "axis x: power refused: enabled = ['on'] is not a switch; nothing was "
        "changed"),
    (
        "- {at: 0, to: x, do: move_absolute, target: 5mm}",
        "axis x: move_absolute refused: target = '5mm' is not a number; nothing was changed",
    ),
    (
        "- {at: 0, to: x, do: move_absolute, target: .inf}",
        "axis x: move_absolute refused: target = inf is not finite; nothing was changed",
    ),
    (
        "- {at: 0, to: x, do: move_absolute, taget: 5}",
        "axis x: move_absolute refused: unknown argument 'taget'; nothing was changed. Known: target, velocity, "
        "acceleration, deceleration, jerk, buffer_mode",
    ),
    (
        "- {at: 0, to: s, do: stop, source: plcs}",
        "spindle s: stop refused: unknown source 'plcs'; nothing was changed. Known: plc, channel",
    ),
    ("- {at: 0, to: s, do: stop, source: 1}", "spindle s: stop refused: source = 1 is not a source; nothing was "
     "changed"),
    ("- {at: 0, to: plc, do: acknowledge, id: one}", "plc plc: acknowledge refused: id = 'one' is not an integer; "
     "nothing was changed"),
    (
        "- {at: 0, to: x, do: couple, master: q, factor: 1}",
        "axis x: couple refused: there is no axis 'q'. Known: y, z; nothing was changed",
    ),
    (
        "- {at: 0, to: x, do: couple_gantry, master: s, difference_limit: 1}",
        "axis x: couple_gantry refused: there is no axis 's'. Known: y, z; nothing was changed",
    ),
    (
        "- {at: 0, to: s, do: couple, master: x}",
        "spindle s: couple refused: there is no spindle 'x'. Known: none; nothing was changed",
    ),
    (
        "- {at: 0, to: x, do: couple_cam, master: y, table: [[0, 0], [1, 1], [2, 0]], file: cam.csv}",
        "axis x: couple_cam refused: 'table' and 'file' are both given; nothing was changed. Give one",
    ),
    (
        "- {at: 0, to: x, do: change_cam, table: [[0, 0], [1, 1], [2, 0]], file: cam.csv}",
        "axis x: change_cam refused: 'table' and 'file' are both given; nothing was changed. Give one",
    ),
    (
        "- {at: 0, to: x, do: external_setpoints, setpoints: [[0, 0, 0, 0, 1]], file: set.csv}",
        "axis x: external_setpoints refused: 'setpoints' and 'file' are both given; nothing was changed. Give one",
    ),
    (
        "- {at: 0, to: x, do: couple, master: y, factor: 1, master_stands: true}",
        "axis x: couple refused: argument 'master_stands' is filled in by the PLC; nothing was changed",
    ),
    (
        "- {at: 0, to: x, do: couple, master: y, ratio: 1}",
        "axis x: couple refused: unknown argument 'ratio'; nothing was changed. Known: factor, master",
    ),
    ("- {at: 0, at: 1, to: x, do: stop}", "'at' appears twice in the entry"),
    ("- {at: !!int abc, to: x, do: stop}", "a value cannot be read: invalid literal for int() with base 10: 'abc'"),
    ("- {at: 2001-13-45, to: x, do: stop}", "a value cannot be read: month must be in 1..12"),
    (f"- {{at: {LAUGHS}, to: x, do: stop}}", "a value cannot be read: its aliases make more than 1000000 values of it"),
    (f"- {{at: [{'1, ' * 9999}1], to: x, do: stop}}", "at = [1, 1, 1, 1, 1, 1, ...] must be a time in seconds, 0 to 10000000"),
    ("- {at: &a [*a], to: x, do: stop}", "a value cannot be read: its aliases make more than 1000000 values of it"),
    (f"- {{at: {'[' * 900}{']' * 900}, to: x, do: stop}}", "a value cannot be read: lists in lists are too deep"),
    ("- {at: !!bool x, to: x, do: stop}", "a value cannot be read: it has not the form that its tag says"),
    ("- {at: !!timestamp x, to: x, do: stop}", "a value cannot be read: it has not the form that its tag says"),
    ("- {at: !!int _, to: x, do: stop}", "a value cannot be read: it has not the form that its tag says"),
    ("- {at: 0, to: x, do: stop, [1]: 2}", "a value cannot be read: found unhashable key"),
    (
        "- {at: 0, to: x, do: !!python/name:os.system }",
        "a value cannot be read: could not determine a constructor for the tag "
        "'tag:yaml.org,2002:python/name:os.system'",
    ),
]  # fmt: skip


@pytest.mark.parametrize(("text", "reason"), FAULTS)
def test_faults(text: str, reason: str) -> None:
    assert fault(f"\n{text}\n") == f"P-ERR-25101 s.yaml:2: {reason}\nnothing was started"


def test_all_faults_at_once_with_their_lines() -> None:
    text = "- {at: 0, to: x, do: stop}\n- {at: 0, to: q, do: stop}\n# comment\n- at: 0\n  to: x\n"
    assert fault(text) == (
        f"P-ERR-25101 s.yaml:2: unit 'q' does not exist in the machine. {KNOWN}\nP-ERR-25101 s.yaml:4: {MISSING}\n"
        "nothing was started"
    )


@pytest.mark.parametrize("text", ["at: 0", "5", "hello"])
def test_no_list(text: str) -> None:
    assert fault(text) == (
        "P-ERR-25101 scenario s.yaml: a list of entries {at, to, do, ...} is expected; nothing was started"
    )


@pytest.mark.parametrize("text", ["- {at: 0", "- {at: 0}\n- [", "\tx: 1", "- *unknown", "--- 1\n--- 2", "- {at: 0}}"])
def test_no_yaml(text: str) -> None:
    message = fault(text)
    assert message.startswith("P-ERR-25101 scenario s.yaml is not YAML: ") and message.endswith("; nothing was started")
    assert "line " in message


def test_load_takes_the_text_from_the_reader_unless_it_is_given() -> None:
    asked = []

    def read(what: str, path: str) -> str:
        asked.append((what, path))
        return "%P\nM30"

    entries = parse_scenario(
        "- {at: 0, to: channel, do: load, program: a.nc}\n- {at: 1, to: channel, do: load, program: b.nc, text: M30}",
        "s.yaml",
        KINDS,
        read,
    )
    assert [e.command.arguments["text"] for e in entries] == ["%P\nM30", "M30"] and asked == [("NC program", "a.nc")]
    without = parse("- {at: 0, to: channel, do: load, program: a.nc}")[0]
    assert without.command.arguments == {"program": "a.nc"}


def test_a_program_that_cannot_be_read() -> None:
    with pytest.raises(ScenarioError) as caught:
        parse_scenario("- {at: 0, to: channel, do: load, program: /no/such.nc}", "s.yaml", KINDS, read_file)
    assert str(caught.value) == (
        "P-ERR-25101 s.yaml:1: NC program /no/such.nc cannot be read: No such file or directory; nothing was started\n"
        "nothing was started"
    )


# ---------------------------------------------------------------- times


@pytest.mark.parametrize(("at", "cycle"), [(0.0, 0), (0.001, 10), (0.01, 10), (0.0100001, 20), (0.07, 70), (0.29, 290)])
def test_a_command_acts_at_the_first_block_that_begins_at_or_after_its_time(at: float, cycle: int) -> None:
    bench = MachineBench(None, f"- {{at: {at}, to: x, do: set_override, percent: 50}}").run()
    assert [(r.cycle, r.target, r.command) for r in bench.records] == [(cycle, "x", "set_override")]
    assert bench.column("x", "override_percent")[cycle - 1 if cycle else 0 : cycle + 1][-1] == 50.0
    assert cycle == 0 or bench.column("x", "override_percent")[cycle - 1] == 100.0


def test_every_tenth_of_a_millisecond_up_to_a_long_run() -> None:
    """Decimal times that are block begins never slip by a block."""
    times = [round(0.01 * n, 2) for n in range(0, 200_000, 97)]
    plc = PlcUnit(
        "plc",
        kinds=KINDS,
        scenario=[Entry(t, Command("x", "stop")) for t in times],
        cycle_time=0.001,
        end_when_idle=False,
    )
    sent = []
    for t in times:
        block = plc.step(CycleTick(round(t * 1000), 10), {})
        sent.append(len(block.commands))
    assert set(sent) == {1}


def test_commands_of_one_time_run_in_the_order_of_the_file() -> None:
    bench = MachineBench(
        None,
        "- {at: 0, to: x, do: move_absolute, target: 5}\n- {at: 0, to: x, do: stop}\n- {at: 0, to: x, do: "
        "set_override, "
        "percent: 10}\n- {at: 0, to: x, do: set_override, percent: 20}",
    ).run()
    assert [r.command for r in bench.records] == ["move_absolute", "stop", "set_override", "set_override"]
    assert bench.last("x").override_percent[-1] == 20.0 and bench.position("x") == 0.0


# ---------------------------------------------------------------- jobs


def test_a_job_is_the_program_at_0_and_the_scenario(tmp_path: Path) -> None:
    (tmp_path / "p.nc").write_text("%P\nG01 X5 F3000\nM30")
    (tmp_path / "q.nc").write_text("%Q\nM30")
    (tmp_path / "s.yaml").write_text(
        "- {at: 2, to: channel, do: load, program: q.nc}\n- {at: 0, to: x, do: set_override, percent: 5}"
    )
    entries = read_entries(MILL, program=str(tmp_path / "p.nc"), scenario=str(tmp_path / "s.yaml"))
    assert [(e.at, e.command.target, e.command.command) for e in entries] == [
        (0.0, "channel", "load"),
        (0.0, "channel", "start"),
        (0.0, "x", "set_override"),
        (2.0, "channel", "load"),
    ]
    assert entries[0].command.arguments == {"program": str(tmp_path / "p.nc"), "text": "%P\nG01 X5 F3000\nM30"}
    assert entries[3].command.arguments == {"program": str(tmp_path / "q.nc"), "text": "%Q\nM30"}
    assert read_entries(MILL, program=None, scenario=None) == []


def test_faults_of_a_job(tmp_path: Path) -> None:
    bad = tmp_path / "bad.nc"
    bad.write_text("%P\nG01 X1000 F3000\nM30")
    latin = tmp_path / "latin.nc"
    latin.write_bytes(b"%P\n(\xfc)\nM30")
    for path, machine, text in (
        (bad, MILL, "P-ERR-120002 {} line 2 column 1 'G01 X1000 F3000': axis X: 1000 mm lies beyond the "
            "positive soft limit "
         "300 mm (P-AXIS-00178); nothing has moved"),
        (latin, MILL, "P-ERR-26110 NC program {} cannot be read: it is not UTF-8 text, byte 0xFC in line 2 column 2 ('ü' in Latin-1); "
         "save it as UTF-8; nothing was started"),
        (tmp_path / "no.nc", MILL, "P-ERR-26110 NC program {} cannot be read: No such file or directory; "
         "nothing was started"),
        (bad, PTP, "P-ERR-26112 the machine has no channel to run {}; nothing was started"),
    ):  # fmt: skip
        with pytest.raises(CncError) as caught:
            read_entries(machine, program=str(path), scenario=None)
        assert str(caught.value) == text.format(path)
    with pytest.raises(CncError) as caught:
        read_entries(MILL, program=None, scenario=str(tmp_path / "no.yaml"))
    assert str(caught.value) == (
        f"P-ERR-26110 scenario {tmp_path / 'no.yaml'} cannot be read: No such file or directory; nothing was started"
    )


def test_the_check_of_a_program_finds_syntax_modal_and_machine_errors() -> None:
    check = ProgramCheck.of_first_channel(MILL, "p.nc")

    def ids(text: str) -> list[int]:
        errors = check.errors(text, "p.nc")
        assert all(isinstance(error, ProgramError) for error in errors)
        return [error.number for error in errors]

    assert ids("%P\nG01 X5 F3000\nM30") == []
    assert ids("%P\nG01 X1.2.3\nG77\nM30") == [21003, 20131]
    assert ids("%P\nG01 X5\nM30") == [20008]
    assert ids("%P\nG01 X500 F100\nM30") == [120002]
    assert ids("%P\nM55\nM30") == [22011] and ids("%P\nM03 S20000\nM30") == [22010]


def test_the_example_scenario_runs_on_the_example_program() -> None:
    scenario = (ROOT / "examples" / "bracket_overrides.yaml").read_text(encoding="utf-8")
    program = (ROOT / "examples" / "bracket.nc").read_text(encoding="utf-8")
    bench = MachineBench(program, scenario).run()
    assert bench.refusals() == [] and bench.errors() == [] and not bench.failed


@pytest.mark.parametrize("word", ["on", "off"])
def test_the_former_name_of_enabled_is_still_read(word: str) -> None:
    """Scenarios and recordings from before the field was called `enabled` still work."""
    (entry,) = parse(f"- {{at: 0, to: x, do: power, on: {word}}}")
    assert entry.command.arguments == {"enabled": word == "on"}


def test_both_names_at_once_are_refused() -> None:
    with pytest.raises(CncError) as refusal:
        parse("- {at: 0, to: x, do: power, on: on, enabled: off}")
    assert "power refused: unknown argument 'on'; nothing was changed. Known: enabled" in str(refusal.value)


@pytest.mark.parametrize("text", ["", "# nothing yet\n", "[]"])
def test_a_scenario_without_entries_is_told_before_the_run(text: str, tmp_path: Path) -> None:
    path, program = tmp_path / "s.yaml", tmp_path / "p.nc"
    path.write_text(text)
    program.write_text("%P\nM30")
    for with_program in (None, str(program)):
        with pytest.raises(ScenarioError) as caught:
            read_entries(MILL, program=with_program, scenario=str(path))
        assert str(caught.value) == f"P-ERR-25101 scenario {path} has no entries; nothing was started"
