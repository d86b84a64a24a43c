"""Notices about a machine file: printed by every command that uses the file, and kept in recordings."""

import pytest
from commands_support import MILL, call

from cnc_ptp.recording.reader import read_recording


@pytest.fixture
def files(tmp_path):
    """The mill whose spindle has a resolution of 0, and a program."""
    machine = tmp_path / "m.yaml"
    lines = MILL.read_text().splitlines()
    at = lines.index("/s:")
    gear = next(number for number, line in enumerate(lines) if number > at and line.strip().startswith("getriebe"))
    lines.insert(gear + 2, "        wegaufz: 0")
    machine.write_text("\n".join(lines))
    program = tmp_path / "p.nc"
    program.write_text("%p\nG00 X1\nM30\n")
    column = "        wegaufz: 0".index("0") + 1
    place = f"{machine}:{gear + 3}:{column}"
    text = f"{place}: P-AXIS-00234 getriebe[0].wegaufz of /s: value 0 is corrected to 1"
    return machine, program, text


def test_simulate_tells_them_and_they_are_events(files, tmp_path):
    machine, program, text = files
    result = call("simulate", machine, "--program", program, "--record", tmp_path / "a.mcap")
    assert (result.exit_code, result.stderr) == (0, "")
    assert result.stdout.splitlines()[-1] == f"warning: P-WARN-110386 {text}"
    events = [event for event in read_recording(tmp_path / "a.mcap").events if event.severity == 1]
    assert [(event.cycle, event.source, event.error_id, event.text) for event in events] == [(0, "plc", 110386, text)]
    faulty, corrected = events[0].faulty, events[0].corrected
    assert tuple(faulty) == ("P-AXIS-00234", 0.0, "increments", "faulty")
    assert tuple(corrected) == ("corrected", 1.0, "increments", "corrected")
    assert call("replay", tmp_path / "a.mcap").exit_code == 0


def test_check_tells_them(files):
    machine, program, text = files
    result = call("check", program, "--machine", machine)
    assert (result.exit_code, result.stdout) == (0, "p.nc: no errors in 3 lines\n")
    assert result.stderr == f"warning: P-WARN-110386 {text}\n"
    assert call("check", program, "--machine", MILL).stderr == ""
