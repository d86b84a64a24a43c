"""Completion in the shells, by click's own completion; the machine is given by --machine."""

import os
import subprocess
import sys

import pytest
from click.shell_completion import ShellComplete
from commands_support import MILL, PTP

from cnc_ptp import cli
from cnc_ptp.commands import completion
from cnc_ptp.ros_arguments import ros_arguments


def completed(*words, incomplete=""):
    shell = ShellComplete(cli.main, {}, "cnc_ptp", "_CNC_PTP_COMPLETE")
    return [item.value for item in shell.get_completions(list(map(str, words)), incomplete)]


def test_commands_of_the_command_line():
    assert {"status", "do", "jog", "watch", "run"} <= set(completed())
    assert completed(incomplete="wa") == ["watch"]


@pytest.mark.parametrize(("command", "plc", "recorder"), [("do", ["plc"], ["recorder"]), ("watch", [], [])])
def test_units(command, plc, recorder):
    """`watch` refuses the plc, which has no state, and the recorder, which is no unit."""
    assert completed(command, "--machine", MILL) == [*plc, "channel", "s", "x", "y", "z", *recorder]
    assert completed(command, "--machine", PTP, incomplete="c") == ["c"]


def test_several_units_to_watch():
    assert completed("watch", "--machine", PTP, "x") == ["x", "y", "z", "c"]


def test_axes_and_directions_to_jog():
    assert completed("jog", "--machine", MILL) == ["x", "y", "z"]
    assert completed("jog", "--machine", MILL, "x") == ["+", "-"]
    assert "--speed" in completed("jog", "--machine", MILL, "x", "+", incomplete="--")


def test_commands_and_arguments_of_a_unit():
    assert completed("do", "--machine", MILL, "x", incomplete="move") == [
        "move_absolute",
        "move_relative",
        "move_modulo",
        "move_additive",
        "move_velocity",
        "move_superimposed",
    ]
    assert "orient" in completed("do", "--machine", MILL, "s")
    assert completed("do", "--machine", MILL, "x", "move_absolute") == [
        "target=",
        "velocity=",
        "acceleration=",
        "deceleration=",
        "jerk=",
        "buffer_mode=",
    ]
    assert completed("do", "--machine", MILL, "x", "move_absolute", "target=1", incomplete="v") == ["velocity="]
    assert "target=" not in completed("do", "--machine", MILL, "x", "move_absolute", "target=1")
    assert completed("do", "--machine", MILL, "s", "start", incomplete="direction=") == [
        "direction=cw",
        "direction=ccw",
    ]
    assert completed("do", "--machine", MILL, "x", "power", incomplete="enabled=") == ["enabled=on", "enabled=off"]


def test_what_the_recorder_can_be_told():
    assert completed("do", "--machine", MILL, incomplete="re") == ["recorder"]
    assert sorted(completed("do", "recorder")) == ["snapshot", "start", "stop"]
    assert completed("do", "recorder", "start") == ["file="]
    assert completed("do", "recorder", "stop") == []
    assert completed("do", "recorder", "snapshot", "file=a.mcap") == ["seconds=", "until="]
    assert completed("do", "recorder", "rewind") == []


def test_nothing_is_completed_where_nothing_is_known(tmp_path):
    assert completed("do", "--machine", tmp_path / "none.yaml") == []
    assert completed("do", "--machine", MILL, "q") == []
    assert completed("do", "--machine", MILL, "x", "fly") == []


def test_a_running_machine_is_asked(monkeypatch):
    class Machine:
        def __init__(self):
            self.kinds = {"x": "axis", "channel": "channel"}

        def __enter__(self):
            return self

        def __exit__(self, *_):
            pass

    asked = []
    monkeypatch.setattr(
        "cnc_ptp.nodes.client.machine_client.connected",
        lambda patience: asked.append(ros_arguments().namespace) or Machine(),
    )
    assert completed("do", "--namespace", "/cell") == ["x", "channel", "recorder"]
    assert completed("jog") == ["x"]
    assert asked == ["/cell", ""] and completion.PATIENCE < 2.0


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_the_scripts_for_the_shells(shell):
    environment = {**os.environ, "_CNC_PTP_COMPLETE": f"{shell}_source"}
    done = subprocess.run(
        [sys.executable, "-m", "cnc_ptp"], env=environment, capture_output=True, text=True, timeout=60, check=False
    )
    if shell == "bash" and "bash" in done.stderr.lower() and not done.stdout:
        pytest.skip("no bash here")
    assert done.returncode == 0 and "_CNC_PTP_COMPLETE" in done.stdout and "cnc_ptp" in done.stdout
