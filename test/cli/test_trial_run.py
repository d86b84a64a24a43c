"""Runs that are made to be evaluated: what is kept, how they end, what a terminal sees."""

import os
import pty
import signal
import subprocess
import sys
import time
from types import SimpleNamespace

import pytest
from commands_support import MILL, changed_mill

from cnc_ptp.commands.commissioning.trial_run import TrialProgress, run_trial
from cnc_ptp.commissioning import progress_lines
from cnc_ptp.parameters import read_machine
from cnc_ptp.plc.scenario import Entry
from cnc_ptp.protocol.blocks import Command, PlcBlock
from cnc_ptp.protocol.unit import PLC


@pytest.fixture(scope="module")
def mill():
    return read_machine(str(MILL))


def trial(machine, *entries, fields=("set_position",)):
    job = [Entry(at, Command(to, do, arguments)) for at, to, do, arguments in entries]
    return run_trial(machine, job, fields={"z": fields}, seconds=1.0, label="test")


def test_fields_and_cycles_are_kept(mill):
    run = trial(mill, (0.1, "z", "move_relative", {"distance": 10.0}), fields=("set_position", "set_velocity"))
    assert not run.failed
    columns = run.columns["z"]
    assert set(columns) == {"cycle", "set_position", "set_velocity"}
    assert columns["cycle"].tolist() == list(range(len(columns["cycle"])))
    assert columns["set_position"][0] == 0.0 and columns["set_position"][-1] == 10.0


def test_a_refused_command_ends_the_run(mill, capsys):
    after = (2.0, "z", "move_relative", {"distance": 10.0})
    run = trial(mill, (0.1, "z", "move_absolute", {"target": 1000.0}), after)
    assert run.failed and len(run.columns["z"]["cycle"]) < 500
    run.print_faults()
    assert capsys.readouterr().err == (
        "refused: P-ERR-120002 axis z: move_absolute refused: target 1000.0 mm lies beyond the positive soft limit "
        "150.0 mm (P-AXIS-00178); nothing was changed\n"
    )


def test_a_fault_ends_the_run(tmp_path):
    strict = read_machine(str(changed_mill(tmp_path / "strict.yaml", "z", getriebe={"0": {"slep_max": 100}})))
    later = (60.0, "z", "reset", {})
    run = trial(strict, (0.1, "z", "move_absolute", {"target": 140.0}), later)
    assert run.failed and run.result.errors[0].startswith("P-ERR-17744 axis z: following error")
    assert len(run.columns["z"]["cycle"]) < 1000


def slow_circle(*options):
    """A circle test that takes minutes of machine time."""
    words = ["circle", MILL, "--radius", 100, "--feed", 200, "--direction", "ccw", *options]
    return [sys.executable, "-m", "cnc_ptp", *map(str, words)]


@pytest.mark.long
def test_interrupted_runs_stop_on_their_ramps_and_are_status_1(tmp_path):
    recording = tmp_path / "circle.mcap"
    job = slow_circle("--record", recording)
    with subprocess.Popen(job, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as running:
        while running.poll() is None and not recording.is_file():  # its first block is under way then
            time.sleep(0.1)
        time.sleep(1.0)
        running.send_signal(signal.SIGINT)
        output, errors = running.communicate(timeout=100)
    assert running.returncode == 1
    assert "failed: P-ERR-26106 the run was interrupted (SIGINT); everything stops on its ramps" in errors
    assert output == "" and "Traceback" not in errors


def test_a_program_gets_lines(monkeypatch, capsys):
    """5 % or more from one line to the next."""
    monkeypatch.setenv(progress_lines.WANTED, "1")
    with TrialProgress("friction of x", 300) as progress:
        for first in range(0, 330, 10):
            progress.show({PLC: SimpleNamespace(block=PlcBlock(first, 10))})
    lines = capsys.readouterr().err.splitlines()
    assert lines[:2] == ["friction of x: 6 %", "friction of x: 13 %"]
    assert lines[-1] == "friction of x: 100 %" and len(lines) == 15
    monkeypatch.delenv(progress_lines.WANTED)
    with TrialProgress("friction of x", 300) as progress:
        progress.show({PLC: SimpleNamespace(block=PlcBlock(0, 300))})
    assert capsys.readouterr().err == ""


def test_a_terminal_sees_a_bar():
    terminal, other_end = pty.openpty()
    environment = {**os.environ, "TERM": "xterm", "COLUMNS": "120"}
    words = ["circle", MILL, "--radius", 5, "--feed", 3000, "--direction", "ccw"]
    job = [sys.executable, "-m", "cnc_ptp", *map(str, words)]
    running = subprocess.Popen(job, stdout=subprocess.DEVNULL, stderr=other_end, env=environment)
    os.close(other_end)
    shown = b""
    while True:
        try:
            part = os.read(terminal, 65536)
        except OSError:  # the other end is closed
            break
        if not part:
            break
        shown += part
    os.close(terminal)
    assert running.wait(60) == 0
    text = shown.decode()
    assert "without feedforward" in text and " %" in text
