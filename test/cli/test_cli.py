"""The command line as users and scripts meet it: help, exit statuses, refusals word for word."""

import importlib
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from click.testing import CliRunner
from long_support import long

from cnc_ptp import __main__ as entries
from cnc_ptp import cli
from cnc_ptp.channel.program_report import ProgramReport
from cnc_ptp.commands.run.simulate import Result, print_summary
from cnc_ptp.parameters import read_machine
from cnc_ptp.protocol.blocks import CommandRecord, Event, Severity
from cnc_ptp.protocol.notes import Note, Notes
from cnc_ptp.recording.reader import read_recording

ROOT = Path(__file__).parents[2]
MILL = ROOT / "config" / "mill.yaml"
PTP = ROOT / "config" / "ptp.yaml"
TWO_CHANNELS = ROOT / "examples" / "spindles" / "two_channels.yaml"
BRACKET = ROOT / "examples" / "bracket.nc"
PROGRAM = "%p\nN10 G1 X5 F1000\nM30\n"


def call(*arguments):
    return CliRunner().invoke(cli.main, [str(argument) for argument in arguments])


@pytest.fixture
def program(tmp_path):
    path = tmp_path / "p.nc"
    path.write_text(PROGRAM)
    return path


@pytest.mark.parametrize("command", [[], *([name] for name in cli.main.commands)])
def test_help_everywhere(command):
    for option in ("--help", "-h"):
        result = call(*command, option)
        assert result.exit_code == 0, result.output
        assert "Usage:" in result.output


def test_no_summary_of_a_command_is_cut_off():
    assert "..." not in call("--help").output.split("Commands:")[1]


def test_a_word_is_no_number():
    result = call("run", MILL, "--state-rate", "abc")
    assert result.exit_code == 2 and "'--state-rate': 'abc' is not a valid number.\n" in result.stderr


@pytest.mark.parametrize(
    "node", ["axis", "player", *long(["nc_channel", "spindle", "plc_bridge", "clock", "recorder"])]
)
def test_nodes_have_help(node):
    done = subprocess.run(
        [sys.executable, "-m", f"cnc_ptp.nodes.{node}", "--help"],
        capture_output=True,
        text=True,
        timeout=60,
        check=True,
    )
    assert "Usage:" in done.stdout


@pytest.mark.parametrize(
    "arguments",
    [
        ["simulate"],
        ["fly"],
        ["simulate", MILL, "--speed", "3"],
        ["simulate", MILL, "--duration", "-1"],
        ["report", "a.mcap"],
    ],
)
def test_wrong_usage_is_status_2(arguments):
    result = call(*arguments)
    assert result.exit_code == 2
    assert "Usage:" in result.output


@pytest.mark.parametrize(
    ("arguments", "option"),
    [
        (["simulate", MILL, "--duration"], "duration"),
        (["run", MILL, "--duration"], "duration"),
        (["simulate", MILL, "--checkpoints"], "checkpoints"),
        (["run", MILL, "--checkpoints"], "checkpoints"),
        (["replay", "a.mcap", "--rate"], "rate"),
    ],
)
def test_what_is_no_number_is_wrong_usage(arguments, option):
    for value in ("nan", "-NaN"):
        result = call(*arguments, value)
        assert result.exit_code == 2
        assert result.stderr.endswith(f"\nError: Invalid value for '--{option}': {value} is not a number.\n")


@pytest.mark.parametrize(("node", "option"), [("clock", "duration"), ("player", "rate")])
def test_what_is_no_number_is_wrong_usage_of_a_node(node, option):
    command = importlib.import_module(f"cnc_ptp.nodes.{node}").command
    result = CliRunner().invoke(command, [str(MILL), f"--{option}", "nan"])
    assert result.exit_code == 2
    assert result.stderr.endswith(f"\nError: Invalid value for '--{option}': nan is not a number.\n")


def test_simulate_tells_a_summary(program, tmp_path):
    result = call("simulate", MILL, "--program", program, "--record", tmp_path / "a.mcap")
    assert result.exit_code == 0
    assert "program time" in result.output
    assert "largest following error x:" in result.output
    assert read_recording(tmp_path / "a.mcap").complete


@pytest.mark.parametrize("command", ["simulate", "run"])
@pytest.mark.parametrize(
    ("text", "error"),
    [
        (
            "%p\nN10 G1 X5\nM30\n",
            "P-ERR-20008 {file} line 2 column 5 'N10 G1 X5': G01 without a feed: no F greater than 0 was programmed",
        ),
        (
            "%p\nN10 G0 A5\nM30\n",
            "P-ERR-20797 {file} line 2 column 8 'N10 G0 A5': axis A is not in the machine; axes of this channel: X, Y, Z",
        ),
        (
            "%p\nN10 G0 Z-151\nM30\n",
            "P-ERR-120003 {file} line 2 column 1 'N10 G0 Z-151': axis Z: -151 mm lies beyond the negative soft limit "
            "-150 mm (P-AXIS-00177)",
        ),
        (
            "%p\nN10 M3 S99999\nM30\n",
            "P-ERR-22010 {file} line 2 column 8 'N10 M3 S99999': spindle S: 99999 rpm is above the maximum 12000 rpm "
            "(P-AXIS-00212)",
        ),
        (
            "%p\nN10 G77\nM30\n",
            "P-ERR-20131 {file} line 2 column 5 'N10 G77': unknown G function G77",
        ),
    ],
)
def test_bad_programs_are_refused_before_anything_starts(command, text, error, tmp_path):
    path = tmp_path / "bad.nc"
    path.write_text(text)
    result = call(command, MILL, "--program", path)
    assert result.exit_code == 2
    assert result.stderr.splitlines()[0] == f"{error.format(file=path)}; nothing has moved"
    assert result.stderr.splitlines()[1] == text.splitlines()[1]
    assert result.stderr.splitlines()[2].strip() == "^"


def test_check_counts_lines_or_shows_every_bad_line(tmp_path):
    assert call("check", BRACKET).output == f"bracket.nc: no errors in {len(BRACKET.read_text().splitlines())} lines\n"
    assert call("check", BRACKET, "--machine", MILL).exit_code == 0
    path = tmp_path / "bad.nc"
    path.write_text("%p\nN10 G77\nN20 Q\nN30 G1 X5 F100\nM30\n")
    result = call("check", path, "--machine", MILL)
    assert result.exit_code == 2
    assert "line 2 column 5" in result.stderr
    assert "line 3 column 5" in result.stderr


def test_check_knows_the_limits_of_a_machine_only(tmp_path):
    path = tmp_path / "far.nc"
    path.write_text("%p\nG0 X1000\nM30\n")
    assert call("check", path).exit_code == 0
    assert "soft limit 300 mm" in call("check", path, "--machine", MILL).stderr


@pytest.mark.parametrize(
    ("arguments", "error"),
    [
        (
            ["simulate", MILL, "--program", "nowhere.nc"],
            "P-ERR-26110 NC program nowhere.nc cannot be read: No such file or directory; nothing was started",
        ),
        (
            ["simulate", MILL, "--scenario", "nowhere.yaml"],
            "P-ERR-26110 scenario nowhere.yaml cannot be read: No such file or directory; nothing was started",
        ),
        (
            ["simulate", PTP, "--program", BRACKET],
            f"P-ERR-26112 the machine has no channel to run {BRACKET}; nothing was started",
        ),
        (
            ["simulate", MILL, "--record", "/nowhere/a.mcap"],
            "P-ERR-26113 recording /nowhere/a.mcap cannot be written: there is no folder /nowhere, make it or give another "
            "name; nothing was started",
        ),
        (
            ["run", MILL, "--record", "/nowhere/a.mcap"],
            "P-ERR-26113 recording /nowhere/a.mcap cannot be written: there is no folder /nowhere, make it or give another "
            "name; nothing was started",
        ),
        (
            ["replay", "nowhere.mcap"],
            "P-ERR-26001 recording nowhere.mcap: cannot be opened: No such file or directory; nothing was read, check the "
            "path",
        ),
        (["params", "kvv"], "P-ERR-25018 no parameter is called 'kvv'; did you mean P-AXIS-00099 getriebe[i].kv?"),
    ],
)
def test_unusable_input_is_status_2(arguments, error):
    result = call(*arguments)
    assert result.exit_code == 2
    assert result.stderr.strip() == error


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("", "P-ERR-21014 {file} line 1 column 1 '': no main program; nothing has moved"),
        ("\n\n", "P-ERR-21014 {file} line 1 column 1 '': no main program; nothing has moved"),
        ("G1 XX", "P-ERR-21002 {file} line 1 column 4 'G1 XX': unknown word 'XX'; nothing has moved\nG1 XX\n   ^"),
    ],
)  # fmt: skip
def test_a_place_without_a_text_is_not_marked(text, shown, tmp_path):
    file = tmp_path / "part.nc"
    file.write_text(text)
    result = call("simulate", MILL, "--program", file)
    assert (result.exit_code, result.stderr) == (2, shown.format(file=file) + "\n")


@pytest.mark.parametrize("command", ["simulate", "run"])
def test_a_typo_in_the_machine_file_starts_nothing(command, tmp_path):
    path = tmp_path / "typo.yaml"
    path.write_text(MILL.read_text().replace("slep_max: 150000", "slepp_max: 150000", 1))
    result = call(command, path)
    assert result.exit_code == 2
    assert (
        "axis /x has no parameter 'getriebe.0.slepp_max'; did you mean getriebe[i].slep_max (P-AXIS-00168)?"
        in result.stderr
    )
    assert result.stderr.strip().endswith("; nothing was started")


def test_a_bad_scenario_lists_every_fault(tmp_path):
    path = tmp_path / "s.yaml"
    path.write_text("- {at: 0, to: q, do: stop}\n- {at: 0, to: x, do: jump}\n- {at: -1, to: x, do: stop}\n")
    result = call("simulate", MILL, "--scenario", path)
    assert result.exit_code == 2
    for line in (1, 2, 3):
        assert f"P-ERR-25101 {path}:{line}: " in result.stderr


def test_a_refused_command_is_no_failed_run(tmp_path):
    path = tmp_path / "s.yaml"
    path.write_text("- {at: 0, to: x, do: move_absolute, target: 400}\n")
    result = call("simulate", MILL, "--scenario", path)
    assert result.exit_code == 0
    assert "refused: P-ERR-120002 axis x: move_absolute refused: target 400.0 mm lies beyond" in result.output
    assert result.output.splitlines()[-1] == "1 command was refused"


@pytest.mark.parametrize(("targets", "status"), [((400, 400, 5), 1), ((5, 6), 0)])
def test_strict_makes_a_refused_command_a_failed_run(targets, status, tmp_path):
    path = tmp_path / "s.yaml"
    entries = (f"- {{at: {n}, to: x, do: move_absolute, target: {target}}}\n" for n, target in enumerate(targets))
    path.write_text("".join(entries))
    result = call("simulate", MILL, "--scenario", path, "--strict")
    assert result.exit_code == status
    assert (result.output.splitlines()[-1] == "2 commands were refused") == bool(status)


def test_an_empty_scenario_and_an_unknown_master_are_told_before_the_run(tmp_path):
    path = tmp_path / "s.yaml"
    path.write_text("# nothing\n")
    result = call("simulate", MILL, "--scenario", path)
    assert (result.exit_code, result.stderr.strip()) == (
        2,
        f"P-ERR-25101 scenario {path} has no entries; nothing was started",
    )
    path.write_text("- {at: 0, to: x, do: couple, master: q, factor: 1}\n")
    result = call("simulate", MILL, "--scenario", path)
    reason = "axis x: couple refused: there is no axis 'q'. Known: y, z; nothing was changed"
    assert result.exit_code == 2 and result.stderr.startswith(f"P-ERR-25101 {path}:1: {reason}")


def test_a_refusal_is_told_once(tmp_path):
    path = tmp_path / "s.yaml"
    path.write_text("- {at: 0, to: channel, do: mdi, text: G77}\n- {at: 0.1, to: y, do: stop}\n")
    result = call("simulate", MILL, "--scenario", path)
    assert [line for line in result.output.splitlines() if "largest" not in line and "time" not in line] == [
        "refused: P-ERR-20131 mdi line 1 column 1 'G77': unknown G function G77; nothing was executed",
        "warning: P-WARN-23073 axis y: stop without effect in Standstill",
        "1 command was refused",
    ]


def test_a_refusal_is_told_once_in_whatever_order_command_and_event_come():
    event = Note.of_event(Event(0, "c", Severity.WARNING, 20131, "mdi: unknown"))
    refusal = Note.of_command(CommandRecord(0, "c", "mdi", "{}", False, 20131, "mdi: unknown"))
    other = Note(20132, "mdi: unknown")
    assert (str(refusal), str(event)) == ("refused: P-ERR-20131 mdi: unknown", "warning: P-WARN-20131 mdi: unknown")
    for order in ((refusal, event), (event, refusal), (event, None, refusal, event, refusal)):
        notes = Notes()
        for note in (other, *order):
            notes.add(note)
        assert [*notes] == [other, refusal]
    assert Note.of_event(Event(0, "y", Severity.INFO, 0, "y: Standstill -> Stopping")) is None
    assert Note.of_command(CommandRecord(0, "y", "stop", "{}", True, 0, "")) is None


def test_a_warning_is_told_once_whether_command_or_event_tells_it():
    notes = Notes()
    notes.add(
        Note.of_command(
            CommandRecord(0, "s", "orient", "{}", True, 0, "P-WARN-24003 spindle s: no limit", warning_id=24003)
        )
    )
    notes.add(Note.of_event(Event(0, "s", Severity.WARNING, 24003, "spindle s: no limit")))
    notes.add(Note.of_command(CommandRecord(0, "s", "orient", "{}", True, 0, "spindle s: no limit")))
    assert [*map(str, notes)] == ["warning: P-WARN-24003 spindle s: no limit", "warning: spindle s: no limit"]


@pytest.mark.parametrize(
    ("command", "number", "message", "idle"),
    [
        ("stop", 23073, "P-WARN-23073 axis x: stop without effect in Standstill", True),
        ("stop", 23073, "P-WARN-23073 whatever the words are", True),
        ("stop", 0, "axis x: stop without effect in Standstill", False),
        ("stop", 0, "axis x: stop cancels the waiting new target; the axis stops", False),
        ("halt", 23073, "P-WARN-23073 axis x: halt without effect in Standstill", False),
    ],
)
def test_a_stop_of_an_axis_that_stands_is_known(command, number, message, idle):
    """By the number of the warning, not by its words; an older recording has none."""
    note = Note.of_command(CommandRecord(0, "x", command, "{}", True, 0, message, warning_id=number))
    assert note.idle_stop == idle and str(note) == f"warning: {message}"


def test_a_run_that_ends_in_an_error_is_status_1(program, tmp_path):
    path = tmp_path / "s.yaml"
    path.write_text("- {at: 0.1, to: x, do: power, enabled: off}\n")
    result = call("simulate", MILL, "--program", program, "--scenario", path)
    assert result.exit_code == 1
    assert "error: P-ERR-23010 axis x: the enable was removed during path motion" in result.output
    assert "stop without effect" not in result.output


def test_a_duration_that_ends_in_the_block_of_a_fault_is_status_1(program, tmp_path):
    """The PLC would know of it in the next block; a fault that comes after the end is none."""
    path = tmp_path / "s.yaml"
    path.write_text("- {at: 0.1, to: x, do: power, enabled: off}\n")
    for duration, status in (("0.1", 0), ("0.11", 1), ("0.12", 1)):
        result = call("simulate", MILL, "--program", program, "--scenario", path, "--duration", duration)
        assert result.exit_code == status, duration
        assert ("error: P-ERR-23010" in result.output) == bool(status)


def test_duration_ends_the_run(program, tmp_path):
    result = call("simulate", MILL, "--program", program, "--duration", "0.255", "--record", tmp_path / "a.mcap")
    assert result.exit_code == 0
    assert read_recording(tmp_path / "a.mcap").last_cycle == 259


@pytest.mark.parametrize(
    ("duration", "note"),
    [
        ("0.3", "warning: P-WARN-26121 channel channel: --duration 0.3 s has cut off the program in line 3, state WAITING"),
        ("0.05", "warning: P-WARN-26121 channel channel: --duration 0.05 s has cut off the program in line 2, state RUNNING"),
        ("30", None),
    ],
)  # fmt: skip
def test_a_program_that_the_duration_cuts_off_is_told(duration, note, tmp_path):
    """1 mm takes less than 0.2 s, the dwell after it half a second."""
    path = tmp_path / "p.nc"
    path.write_text("%p\nN10 G1 X1 F1000\nN20 G04 0.5\nM30\n")
    result = call("simulate", MILL, "--program", path, "--duration", duration)
    assert result.exit_code == 0
    notes = [line for line in result.stdout.splitlines() if line.startswith("warning")]
    assert notes == ([note] if note else [])


def test_an_interrupted_program_is_not_cut_off_by_the_duration(tmp_path, capsys):
    result = Result(programs={"channel": ProgramReport(done=False)}, interrupted="P-ERR-26106 interrupted")
    print_summary(read_machine(MILL), result, 1.0, 5.0)
    assert "P-WARN-26121" not in capsys.readouterr().out


def test_the_program_time_of_each_channel(tmp_path):
    """Dwells of half a second and of one."""
    scenario = tmp_path / "s.yaml"
    dwell = "- {{at: 0, to: {}, do: mdi, text: G04 {}}}\n".format
    scenario.write_text(dwell("channel1", 0.5) + dwell("channel2", 1))
    result = call("simulate", TWO_CHANNELS, "--scenario", scenario)
    assert result.exit_code == 0
    assert [line for line in result.stdout.splitlines() if line.startswith("program time")] == [
        "program time channel1: 0.500 s",
        "program time channel2: 1.000 s",
    ]
    result = call("simulate", TWO_CHANNELS, "--scenario", scenario, "--duration", 0.7)
    assert result.stdout.splitlines()[-1] == (
        "warning: P-WARN-26121 channel channel2: --duration 0.7 s has cut off the program in line 1, state WAITING"
    )


def test_a_run_without_anything_to_do_says_so(program, tmp_path):
    note = "note: there was nothing to do, give --program, --scenario, --plc or --duration"
    result = call("simulate", MILL)
    assert (result.exit_code, result.stdout.splitlines()[-1]) == (0, note)
    (tmp_path / "s.yaml").write_text("[]")
    for job in (["--program", program], ["--duration", 0.1], ["--scenario", tmp_path / "s.yaml"]):
        assert "nothing to do" not in call("simulate", MILL, *job).output


def test_report_and_replay_of_a_cut_off_recording(program, tmp_path):
    call("simulate", MILL, "--program", program, "--record", tmp_path / "a.mcap")
    whole = (tmp_path / "a.mcap").read_bytes()
    (tmp_path / "cut.mcap").write_bytes(whole[: len(whole) * 2 // 3])
    report = call("report", tmp_path / "cut.mcap", "-o", tmp_path / "cut.html")
    assert report.exit_code == 0
    assert "note: the file ends at offset" in report.output
    assert (tmp_path / "cut.html").read_text().startswith("<!DOCTYPE html>")
    replay = call("replay", tmp_path / "cut.mcap")
    assert "note: the file ends at offset" in replay.output


def test_a_report_overwrites_neither_its_recording_nor_other_files(tmp_path):
    recording = tmp_path / "a.mcap"
    call("simulate", PTP, "--duration", "0.1", "--record", recording)
    (tmp_path / "link.html").symlink_to(recording)
    before = recording.read_bytes(), MILL.read_bytes()
    own = f"P-ERR-27030 {{}} would overwrite the recording {recording}; nothing was started\n"
    page = "P-ERR-27030 {}: the file name of a report must end in .html; nothing was started\n"
    for output, text in ((tmp_path / "link.html", own), (recording, own), (MILL, page), (tmp_path / "a.htm", page)):
        result = call("report", recording, "-o", output)
        assert (result.exit_code, result.stderr, result.stdout) == (2, text.format(output), "")
    assert (recording.read_bytes(), MILL.read_bytes()) == before
    assert not (tmp_path / "a.htm").exists()
    assert call("report", recording, "-o", tmp_path / "A.HTML").exit_code == 0


@pytest.fixture
def handlers():
    """The entry points take the interrupt; afterwards it is pytest's again."""
    before = signal.getsignal(signal.SIGINT)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.mark.usefixtures("handlers")
@pytest.mark.parametrize("name", [*cli.main.commands, "main"])
def test_commands_are_executables_of_their_own(name, monkeypatch, capsys):
    """`ros2 run cnc_ptp simulate ...`"""
    monkeypatch.setattr(sys, "argv", [name, "--help"])
    with pytest.raises(SystemExit) as ended:
        getattr(entries, name)()
    assert ended.value.code == 0
    assert f"Usage: cnc_ptp {'[OPTIONS]' if name == 'main' else name} " in capsys.readouterr().out


def test_help_needs_no_numerics():
    """What takes its time to load comes with the command that needs it, behind the handler of the interrupt."""
    code = "import sys, cnc_ptp.cli; print({'numpy', 'scipy', 'matplotlib', 'rclpy', 'yaml'} & set(sys.modules))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60, check=True)
    assert done.stdout == "set()\n"


INTERRUPTED = "P-ERR-26106 the command was interrupted (SIGINT); no run was active\n"


@pytest.mark.usefixtures("handlers")
def test_an_interrupt_during_the_start_is_told(monkeypatch, capsys):
    monkeypatch.setattr("cnc_ptp.commands.run.simulate.read_machine", lambda path: os.kill(os.getpid(), signal.SIGINT))
    monkeypatch.setattr(sys, "argv", ["cnc_ptp", "simulate", str(MILL)])
    with pytest.raises(SystemExit) as ended:
        entries.main()
    assert (ended.value.code, capsys.readouterr()) == (130, ("", INTERRUPTED))


def test_an_interrupt_while_the_command_line_is_loaded_is_told(tmp_path):
    """It comes in the first package that is loaded."""
    (tmp_path / "click.py").write_text("import os, signal\nos.kill(os.getpid(), signal.SIGINT)\n")
    done = subprocess.run(
        [sys.executable, "-m", "cnc_ptp", "simulate", MILL],
        env={**os.environ, "PYTHONPATH": str(tmp_path)},
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert (done.returncode, done.stdout, done.stderr) == (130, "", INTERRUPTED)


def test_no_progress_and_no_escape_codes_without_a_terminal(program):
    done = subprocess.run(
        [sys.executable, "-m", "cnc_ptp", "simulate", MILL, "--program", program],
        capture_output=True,
        text=True,
        timeout=60,
        check=True,
    )
    assert done.stderr == ""
    assert "\x1b" not in done.stdout
