"""Refused commands with numbers that JSON does not know: what is recorded can be read by anyone, and replayed."""

import json
import math
from pathlib import Path

import pytest
from click.testing import CliRunner

from cnc_ptp import cli
from cnc_ptp.machine.offline import OfflineMachine
from cnc_ptp.machine.wiring import build_units
from cnc_ptp.parameters import read_machine
from cnc_ptp.protocol.blocks import Command
from cnc_ptp.recording.offline_run import write
from cnc_ptp.recording.reader import read_recording
from cnc_ptp.recording.writer import Recording

PTP = Path(__file__).parents[2] / "config" / "ptp.yaml"
MOVE = {"target": 100.0, "velocity": 200.0}
NAN, INFINITE, NEGATIVE = ({"$numberDouble": text} for text in ("NaN", "Infinity", "-Infinity"))
REFUSED = (
    ({"target": math.nan, "velocity": 100.0}, {"target": NAN, "velocity": 100.0}),
    ({"target": math.inf}, {"target": INFINITE}),
    ({"target": 1, "velocity": -math.inf}, {"target": 1, "velocity": NEGATIVE}),
    ({"target": [1.0, math.nan]}, {"target": [1.0, NAN]}),
    ({"target": {"a": (math.inf, 2)}}, {"target": {"a": [INFINITE, 2]}}),
)


def not_json(constant):
    raise AssertionError(f"{constant} is not JSON")


def test_what_is_recorded_of_them_is_json_and_replays_to_the_bit(tmp_path):
    machine, path = read_machine(str(PTP)), tmp_path / "a.mcap"
    offline = OfflineMachine(machine, build_units(machine, end_when_idle=False))
    with Recording(str(path), PTP.read_text(), 0, 1_000_000) as recording:
        runner = offline.runner("x")
        assert runner.command(Command("x", "move_absolute", MOVE)).accepted
        for arguments, _ in REFUSED:
            write(recording, offline.tick())
            assert not runner.command(Command("x", "move_absolute", arguments)).accepted
        for _ in range(50):
            write(recording, offline.tick())
    recorded = [json.loads(record.arguments_json, parse_constant=not_json) for record in read_recording(path).commands]
    assert recorded == [MOVE, *(shown for _, shown in REFUSED)]
    result = CliRunner().invoke(cli.main, ["replay", "--verify", str(path)])
    assert result.exit_code == 0 and "equal to the bit" in result.output


@pytest.mark.parametrize("value", [0.0, -1.5, 1e300, 5, True, "nan", None])
def test_what_json_knows_is_as_it_was(value):
    assert json.loads(Command("x", "stop", {"a": value}).arguments_json) == {"a": value}
