"""`--plc`: runs of the examples, faults, an endless cycle that the user interrupts; `--record-when`."""

from __future__ import annotations

import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner

from cnc_ptp import cli
from cnc_ptp.commands.run.replay import replay_blocks
from cnc_ptp.recording.reader import read_recording
from cnc_ptp.recording.verify import verify

ROOT = Path(__file__).parents[2]
PTP, MILL = ROOT / "config" / "ptp.yaml", ROOT / "config" / "mill.yaml"
MOVE = ROOT / "examples" / "plc_move_axis.py"


def simulate(*arguments: Any) -> Any:
    return CliRunner().invoke(cli.main, ["simulate", *map(str, arguments)])


def test_a_plc_alone_is_a_job_and_its_run_is_replayed_without_the_file(tmp_path: Path) -> None:
    recording = tmp_path / "run.mcap"
    result = simulate(PTP, "--plc", MOVE, "--record", recording)
    assert result.exit_code == 0, result.output
    assert "nothing to do" not in result.output and "refused" not in result.output
    recorded = read_recording(recording)
    assert verify(recorded, replay_blocks).equal
    assert recorded.states["/x/state"]["set_position"].max() == 2000.0


def test_what_a_plc_tells_is_printed_in_its_order(tmp_path: Path) -> None:
    file = tmp_path / "plc.py"
    file.write_text(
        "class Plc:\n    def cycle(self, io):\n        io.done(io.cycle > 20)\n"
        "        if io.cycle <= 20:\n            io.event(f'[block] {io.cycle}')\n"
    )
    recording = tmp_path / "run.mcap"
    result = simulate(PTP, "--plc", file, "--record", recording)
    assert result.exit_code == 0
    told = [line for line in result.output.splitlines() if "block" in line]
    assert told == [f"message: plc plc: [block] {cycle}" for cycle in (0, 10, 20)]
    events = [(event.cycle, event.error_id, event.text) for event in read_recording(recording).events]
    assert events == [(cycle, 22054, f"plc plc: [block] {cycle}") for cycle in (0, 10, 20)]


def test_a_plc_that_raises_makes_the_status_1(tmp_path: Path) -> None:
    file = tmp_path / "plc.py"
    file.write_text("class Plc:\n    def cycle(self, io):\n        if io.cycle == 50:\n            io.axis('q')\n")
    result = simulate(PTP, "--plc", file)
    assert result.exit_code == 1
    text = "plc.py:4 'io.axis('q')': LookupError: the machine has no axis 'q'. Known: x, y, z, c"
    assert (
        f"error: P-ERR-22161 plc plc: {text}; everything is stopped and the run ends (cycle 50, line 4)"
        in result.output
    )


def test_a_plc_file_that_cannot_be_used_starts_nothing(tmp_path: Path) -> None:
    file = tmp_path / "plc.py"
    file.write_text("class Plc:\n    pass\n")
    recording = tmp_path / "run.mcap"
    result = simulate(PTP, "--plc", file, "--record", recording)
    assert result.exit_code == 2 and not recording.exists()
    assert f"P-ERR-25104 PLC file {file}: class Plc has no method cycle(self, io); nothing was started" in result.output
    missing = simulate(PTP, "--plc", tmp_path / "none.py")
    assert missing.exit_code == 2 and "P-ERR-26110 PLC file" in missing.output


def test_a_recording_does_not_overwrite_the_plc_file(tmp_path: Path) -> None:
    file = tmp_path / "plc.py"
    file.write_text(MOVE.read_text())
    result = simulate(PTP, "--plc", file, "--record", file)
    assert result.exit_code == 2 and f"would overwrite the PLC file {file}; nothing was started" in result.output


def test_an_endless_cycle_is_interrupted_by_the_user(tmp_path: Path) -> None:
    file = tmp_path / "plc.py"
    file.write_text(
        "class Plc:\n    def cycle(self, io):\n        if io.cycle == 100:\n            print('hangs', flush=True)\n"
        "            while True:\n                pass\n"
    )
    job = [sys.executable, "-m", "cnc_ptp", "simulate", str(PTP), "--plc", str(file)]
    with subprocess.Popen(job, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as running:
        assert running.stdout is not None
        while "hangs" not in running.stdout.readline():
            pass
        time.sleep(1.5)
        running.send_signal(signal.SIGINT)
        output, _ = running.communicate(timeout=60)
    assert running.returncode == 1 and "Traceback" not in output
    assert "failed: P-ERR-26106 the run was interrupted (SIGINT); everything stops on its ramps" in output
    assert "error: P-ERR-22161 plc plc: plc.py:" in output and "KeyboardInterrupt; everything is stopped" in output


# recordings that begin with a trigger


def test_a_recording_that_begins_with_the_axis_is_verified(tmp_path: Path) -> None:
    whole, part = tmp_path / "whole.mcap", tmp_path / "part.mcap"
    for path, options in ((whole, []), (part, ["--record-when", "x.set_velocity != 0"])):
        assert simulate(PTP, "--plc", MOVE, "--record", path, *options).exit_code == 0
    all_states, states = (read_recording(path).states["/x/state"] for path in (whole, part))
    first = int(np.flatnonzero(all_states["set_velocity"])[0]) // 10 * 10
    assert first > 100 and states["cycle"][0] == first
    assert np.array_equal(all_states[first:], states)
    recorded = read_recording(part)
    assert int(recorded.ticks["first_cycle"][0]) == first  # type: ignore[index]
    assert [record.cycle for record in recorded.commands] == [record.cycle for record in read_recording(whole).commands]
    result = verify(recorded, replay_blocks)
    assert result.equal and result.compared == 4 * (len(all_states) - first)


def test_a_sample_that_is_missing_behind_the_trigger_is_found(tmp_path: Path) -> None:
    part = tmp_path / "part.mcap"
    assert simulate(PTP, "--plc", MOVE, "--record", part, "--record-when", "x.set_velocity != 0").exit_code == 0
    recorded = read_recording(part)
    rows = recorded.states["/y/state"]
    recorded.states["/y/state"] = np.delete(rows, 500)
    assert verify(recorded, replay_blocks).topics["/y/state"].missing == [int(rows["cycle"][500])]


def test_a_condition_that_never_comes_true_is_said(tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    result = simulate(PTP, "--duration", "0.1", "--record", path, "--record-when", "x.set_velocity > 5")
    assert result.exit_code == 0
    assert (
        "note: the condition of --record-when was never true; commands and events alone are recorded" in result.output
    )
    assert read_recording(path).states == {}
    again = CliRunner().invoke(cli.main, ["replay", str(path), "--to", "0.05", "-o", str(tmp_path / "again.mcap")])
    assert again.exit_code == 0, again.output
    assert read_recording(tmp_path / "again.mcap").last_cycle == 49


@pytest.mark.parametrize(
    ("condition", "reason"),
    [
        ("x moves", "it is not of the form x.set_velocity != 0"),
        ("q.set_velocity != 0", "the machine has no 'q'. Known: x, y, z, c"),
        ("x.set_velocit != 0", "'x' has no 'set_velocit'; did you mean set_velocity?"),
        ("x.set_velocity != fast", "'fast' is no number"),
        ("x.set_velocity > nan", "'nan' is no number"),
    ],
)
def test_conditions_that_are_refused(condition: str, reason: str, tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    result = simulate(PTP, "--duration", "0.1", "--record", path, "--record-when", condition)
    assert result.exit_code == 2 and not path.exists()
    assert f"P-ERR-26012 --record-when '{condition}': {reason}; nothing was started" in result.output


def test_a_condition_needs_a_recording() -> None:
    result = simulate(PTP, "--duration", "0.1", "--record-when", "x.set_velocity != 0")
    assert result.exit_code == 2 and "--record-when needs --record" in result.output
