"""Loopback by default: from another computer nobody sees a topic or gets a command through while a machine runs."""

import signal

import psutil
import pytest
from graph_support import Running, one_axis_machine
from network_support import (
    FAR,
    LOOK,
    NEAR,
    NOBODY,
    PATIENT,
    foreign,
    other_computer,
    udp_addresses,
    why_no_namespaces,
    wide_open,
)

from cnc_ptp.recording.reader import read_recording

pytestmark = pytest.mark.skipif(bool(why_no_namespaces()), reason=why_no_namespaces())
LOOPBACK = "0100007F"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("other_computer")
    one_axis_machine(folder)
    return folder


@pytest.fixture
def computer():
    with other_computer() as name:
        yield name


def running(folder, name):
    return Running(folder / "one.yaml", "--composed", "--stay", "--record", folder / name)


def ended(run, recording):
    """What was commanded in a run that a person ends."""
    run.process.send_signal(signal.SIGINT)
    run.finish(0)
    return read_recording(recording)


def looking(computer, seconds):
    """From the other computer, which knows the address of this one."""
    environment = wide_open(ROS_STATIC_PEERS=NEAR)
    return foreign(seconds, inside=("ip", "netns", "exec", computer), environment=environment)


def test_nobody_on_another_computer_sees_or_commands_a_machine(folder, computer):
    run = running(folder, "closed.mcap")
    try:
        run.wait_until_recorded(folder / "closed.mcap", 1)
        assert looking(computer, LOOK) == NOBODY
        processes = [run.process.pid, *(child.pid for child in psutil.Process(run.process.pid).children(True))]
        assert udp_addresses(processes) == {LOOPBACK}
        recorded = ended(run, folder / "closed.mcap")
    finally:
        run.end()
    assert [record.command for record in recorded.commands if record.target == "x" and record.command != "stop"] == []
    assert set(recorded.states["/x/state"]["set_position"]) == {0.0}


def test_the_same_participant_reaches_a_machine_that_was_opened(folder, computer, monkeypatch):
    """Otherwise the test above would prove nothing."""
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "SUBNET")
    monkeypatch.setenv("ROS_STATIC_PEERS", FAR)
    run = running(folder, "open.mcap")
    try:
        run.wait_until_recorded(folder / "open.mcap", 1)
        found = looking(computer, PATIENT)
        assert {"/events", "/clock/tick"} <= set(found["topics"])
        assert found["setpoints"]
        assert found["accepted"] is not None
        recorded = ended(run, folder / "open.mcap")
    finally:
        run.end()
    assert "move_absolute" in {record.command for record in recorded.commands}
