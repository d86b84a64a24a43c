"""`cnc_ptp replay` with changes: a recorded command that is refused now is named, one that was refused before is not."""

from pathlib import Path

import pytest
from click.testing import CliRunner, Result
from machine_support import ROOT

from cnc_ptp import cli
from cnc_ptp.commands.run import what_if
from cnc_ptp.recording.reader import read_recording

PTP = ROOT / "config" / "ptp.yaml"
STORY = """
- {at: 0.1, to: x, do: move_absolute, target: 20, velocity: 100}
- {at: 0.5, to: y, do: move_absolute, target: 99999, velocity: 100}
- {at: 1.0, to: x, do: move_absolute, target: 50, velocity: 100}
"""


def call(*arguments: object) -> Result:
    return CliRunner().invoke(cli.main, [str(argument) for argument in arguments])


def test_commands_that_are_refused_now_are_named(tmp_path: Path) -> None:
    story, more, path = (tmp_path / name for name in ("story.yaml", "more.yaml", "run.mcap"))
    story.write_text(STORY)
    more.write_text("- {at: 0.8, to: x, do: power, enabled: off}\n")
    assert call("simulate", PTP, "--scenario", story, "--duration", 2, "--record", path).exit_code == 0
    result = call("replay", path, "--commands", more, "-o", tmp_path / "new.mcap")
    assert result.exit_code == 0, result.output
    notes = [line for line in result.output.splitlines() if "is refused" in line]
    assert notes == [
        "note: move_absolute to x at 1 s is refused: axis x: move_absolute refused: the axis is in Disabled, it must be in "
        "Standstill; nothing was changed"
    ]
    assert "to x at 1 s" not in call("replay", path, "--override", 100, "-o", tmp_path / "same.mcap").output


def test_a_change_that_the_machine_refuses_is_status_1(tmp_path: Path) -> None:
    lines, path, more = (tmp_path / name for name in ("lines.nc", "run.mcap", "more.yaml"))
    lines.write_text("G01 X50 F2400\nM30\n")
    more.write_text("- {at: 0, to: channel, do: set_override, percent: 500}\n")
    mill = ROOT / "config" / "mill.yaml"
    assert call("simulate", mill, "--program", lines, "--record", path).exit_code == 0
    result = call("replay", path, "--override", 500, "-o", tmp_path / "new.mcap")
    assert (result.exit_code, result.output) == (
        2,
        "P-ERR-26153 --override 500 is not within 0 ... 150 of channel (P-CHAN-00056); nothing was computed\n",
    )
    result = call("replay", path, "--commands", more)
    assert result.exit_code == 1
    assert result.stderr.splitlines() == [
        "error: set_override to channel at 0 s is refused: channel channel: set_override refused: percent = 500.0 "
        "is not within 0 ... 150 (P-CHAN-00056); nothing was changed"
    ]


def test_a_program_that_no_channel_can_read_is_refused_before_anything(tmp_path: Path) -> None:
    run, new = recorded_run(tmp_path), tmp_path / "new.mcap"
    assert call("replay", run, "--override", 50, "-o", new).exit_code == 0
    former = new.read_bytes()
    result = call("replay", run, "--from", 0.5, "--program", tmp_path / "bad.nc", "-o", new)
    assert (result.exit_code, result.stdout) == (2, "")
    assert result.stderr.startswith(
        f"P-ERR-21003 {tmp_path / 'bad.nc'} line 1 column 15 'G01 X50 F2400 Q': 'Q' is not a letter with a number; "
        "nothing was computed\n"
    )
    assert new.read_bytes() == former


MILL = ROOT / "config" / "mill.yaml"


def recorded_run(folder: Path, scenario: str = "") -> Path:
    lines, story, path = folder / "lines.nc", folder / "story.yaml", folder / "run.mcap"
    lines.write_text("G01 X50 F2400\nX0\nM30\n")
    (folder / "bad.nc").write_text("G01 X50 F2400 Q\n")
    (folder / "other.nc").write_text("G01 X20 F2400\nM30\n")
    story.write_text(scenario or "[]")
    given = ("--scenario", story) if scenario else ("--program", lines)
    assert call("simulate", MILL, *given, "--duration", 4, "--record", path).exit_code == 0
    return path


def given_to_channel(path: Path) -> list[tuple[str, bool]]:
    return [(record.command, record.accepted) for record in read_recording(path).commands if record.target == "channel"]


def test_without_the_other_program_nothing_is_started(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Another channel could read it: each has a vocabulary of its own."""
    monkeypatch.setattr(what_if, "require_syntax", lambda *_: None)
    run, new = recorded_run(tmp_path), tmp_path / "new.mcap"
    result = call("replay", run, "--from", 0.5, "--program", tmp_path / "bad.nc", "-o", new)
    assert result.exit_code == 1
    assert f" s is refused: {tmp_path / 'bad.nc'} line 1 column 15 " in result.stderr
    assert result.stderr.startswith("error: load to channel at 0.")
    assert given_to_channel(new) == [("reset", True), ("load", False)]


def test_a_program_that_is_started_later_is_loaded_only(tmp_path: Path) -> None:
    story = f"""
- {{at: 0.2, to: channel, do: load, program: {tmp_path / "lines.nc"}}}
- {{at: 2.0, to: channel, do: start}}
"""
    run, new = recorded_run(tmp_path, story), tmp_path / "new.mcap"
    result = call("replay", run, "--from", 1, "--program", tmp_path / "other.nc", "-o", new)
    assert result.exit_code == 0, result.output
    assert given_to_channel(new) == [("load", True), ("start", True)]


def test_a_path_that_does_not_stand_before_the_end_is_told(tmp_path: Path) -> None:
    run = recorded_run(tmp_path)
    result = call("replay", run, "--from", 0.5, "--to", 0.54, "--program", tmp_path / "other.nc")
    assert result.exit_code == 1
    assert result.stderr == "error: the program is not loaded: channel is in state STOPPING\n"


def test_of_two_channels_the_one_that_runs_gets_the_program(tmp_path: Path) -> None:
    """Both run: the first one, for which simulate has loaded a program."""
    spindles, run, new = ROOT / "examples" / "spindles", tmp_path / "run.mcap", tmp_path / "new.mcap"
    words = ("--program", spindles / "channel1.nc", "--scenario", spindles / "two_channels_start.yaml", "--record", run)
    assert call("simulate", spindles / "two_channels.yaml", *words).exit_code == 0
    (tmp_path / "other.nc").write_text("G04 0.1\nM30\n")
    assert call("replay", run, "--from", 0.5, "--program", tmp_path / "other.nc", "-o", new).exit_code == 0
    given = [
        (record.target, record.command)
        for record in read_recording(new).commands
        if record.command in ("reset", "load")
    ]
    assert given == [("channel1", "reset"), ("channel1", "load")]


def test_a_recorded_load_that_was_refused_is_none(tmp_path: Path) -> None:
    """At 1 s the program runs: the other one comes in at 0.5 s all the same."""
    story = f"""
- {{at: 0, to: channel, do: load, program: {tmp_path / "lines.nc"}}}
- {{at: 0, to: channel, do: start}}
- {{at: 1.0, to: channel, do: load, program: {tmp_path / "other.nc"}}}
"""
    run, new = recorded_run(tmp_path, story), tmp_path / "new.mcap"
    result = call("replay", run, "--from", 0.5, "--program", tmp_path / "other.nc", "-o", new)
    assert result.exit_code == 0, result.output
    assert given_to_channel(new)[:3] == [("reset", True), ("load", True), ("start", True)]
