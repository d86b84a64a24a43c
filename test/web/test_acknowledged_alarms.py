"""An alarm that was acknowledged is not open again for a server that begins later."""

import json
import stat
from dataclasses import replace

import pytest

from cnc_ptp.protocol.blocks import Event, Severity
from cnc_ptp.web.faces.acknowledged_file import MOST, AcknowledgedFile, file_of_machine
from cnc_ptp.web.faces.alarms import Alarms, acknowledged_text, event_fields

START = 1_800_000_000_000_000_000
"""Stamp of cycle 0, in ns."""
FAULT = Event(120, "x", Severity.ERROR, 50001, "axis x: following error")
EVENTS = (FAULT, replace(FAULT, source="y"), replace(FAULT, cycle=140, severity=Severity.WARNING))


@pytest.fixture
def file(tmp_path):
    return tmp_path / "cnc_ptp" / "acknowledged_7.json"


def server(file, *, start=START, events=EVENTS):
    """The alarms of a server that has just begun, of a run that has had these events."""
    alarms = Alarms(AcknowledgedFile(file, start))
    for event in events:
        alarms.take(event_fields(event, 1e-3))
    return alarms


def users(alarms):
    """Who has acknowledged each alarm, empty for an open one."""
    return [alarm["acknowledged_by"] for alarm in alarms.list()]


def acknowledge(alarms, number=None, user="anna"):
    return alarms.keep(alarms.acknowledge(number, user))


def test_one_of_two_units_in_the_same_cycle(file):
    assert acknowledge(server(file), 2) == ""
    assert users(server(file)) == ["", "anna", ""]
    assert [alarm["acknowledged"] for alarm in server(file).list()] == [False, True, False]
    assert stat.S_IMODE(file.stat().st_mode) == 0o600


def test_all_by_two_users_and_two_servers(file):
    """Each adds to what the other one has written."""
    one, other = server(file), server(file)
    assert acknowledge(one, 1) == acknowledge(other, 3, "bert") == ""
    assert users(server(file)) == ["anna", "", "bert"]
    assert acknowledge(server(file), user="carl") == ""
    assert users(server(file)) == ["anna", "carl", "bert"]


def test_an_alarm_that_comes_late_or_again(file):
    """What was acknowledged is known before it comes; one more of the same is another alarm, and open."""
    acknowledge(server(file), 1)
    late = server(file, events=EVENTS[1:])
    acknowledge(late, 1, "bert")
    assert users(server(file, events=(*EVENTS, FAULT))) == ["anna", "bert", "", ""]


def test_alarms_of_another_run_are_open(file):
    acknowledge(server(file))
    other = server(file, start=START + 1)
    assert users(other) == ["", "", ""]
    acknowledge(other, 3)
    assert users(server(file, start=START + 1)) == ["", "", "anna"]
    assert users(server(file)) == ["", "", ""]


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"\xff\xfe",
        b"{",
        b"[" * 100_000,
        b"[]",
        b"7",
        b"{}",
        b'{"start_ns": %d}' % START,
        b'{"start_ns": %d, "acknowledged": 7}' % START,
        b'{"start_ns": %d, "acknowledged": [7]}' % START,
        b'{"start_ns": %d, "acknowledged": [["x", 120]]}' % START,
        b'{"start_ns": %d, "acknowledged": [["x", 120, 50001, ["axis x: following error"], "eve"]]}' % START,
        b'{"start_ns": %d, "acknowledged": [["x", 120, 50001, "axis x: following error", null]]}' % START,
    ],
)
def test_a_damaged_file_is_replaced(file, content):
    file.parent.mkdir()
    file.write_bytes(content)
    alarms = server(file)
    assert users(alarms) == ["", "", ""]
    assert acknowledge(alarms, 1) == ""
    assert users(server(file)) == ["anna", "", ""]


def test_a_file_that_cannot_be_written(tmp_path):
    """Its place is a folder, or has no folder that can be made."""
    (tmp_path / "taken").write_text("")
    for file, reason in ((tmp_path, "Is a directory"), (tmp_path / "taken" / "file.json", "File exists")):
        alarms = server(file)
        effect = "a server that begins later shows these alarms open"
        assert acknowledge(alarms) == f"{file} cannot be written: {reason}; {effect}"
        assert users(alarms) == ["anna"] * 3 and users(server(file)) == [""] * 3


def test_the_file_has_the_last_ones(file):
    events = [replace(FAULT, cycle=cycle) for cycle in range(MOST)]
    acknowledge(server(file, events=events))
    acknowledge(server(file), user="bert")
    rows = json.loads(file.read_text())["acknowledged"]
    assert len(rows) == MOST and rows[0] == ["x", 1, 50001, FAULT.text, "anna"]
    assert rows[-2:] == [["x", 999, 50001, FAULT.text, "anna"], ["y", 120, 50001, FAULT.text, "bert"]]


def test_alarms_without_a_file():
    alarms = Alarms()
    alarms.take(event_fields(FAULT, 1e-3))
    assert acknowledge(alarms) == "" and users(alarms) == ["anna"]


def test_each_machine_has_a_file(monkeypatch, tmp_path):
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    assert file_of_machine(0, "/") == tmp_path / "cnc_ptp" / "acknowledged_0.json"
    assert file_of_machine(7, "/hall/cell") == tmp_path / "cnc_ptp" / "acknowledged_7.hall.cell.json"
    monkeypatch.delenv("XDG_STATE_HOME")
    monkeypatch.setenv("HOME", "/home/anna")
    assert str(file_of_machine(7, "/")) == "/home/anna/.local/state/cnc_ptp/acknowledged_7.json"


def test_the_event_says_which_alarms():
    alarms = [event_fields(event, 1e-3) for event in (*EVENTS, replace(FAULT, error_id=0), FAULT)]
    assert acknowledged_text(alarms[:1]) == "P-ERR-50001 of x in cycle 120"
    assert acknowledged_text(alarms[2:4]) == "P-WARN-50001 of x in cycle 140, error of x in cycle 120"
    shown = "P-ERR-50001 of x in cycle 120, P-ERR-50001 of y in cycle 120, P-WARN-50001 of x in cycle 140 and 2 more"
    assert acknowledged_text(alarms) == shown
