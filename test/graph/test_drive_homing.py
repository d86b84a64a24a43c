"""A SERCOS drive that homes its axis, in the graph: the same numbers as offline, services of its parameters."""

import json

import pytest
from client_support import beside_composed_run
from graph_support import ROOT, run, states_equal, verified

from cnc_ptp.protocol.axis_states import AxisStateCode
from cnc_ptp.recording.reader import read_recording

MACHINE = ROOT / "examples" / "sercos.yaml"
ABORTED = "- {at: 0.0, to: x, do: home}\n- {at: 0.63, to: x, do: stop}\n- {at: 1.5, to: x, do: home, position: 55}\n"


@pytest.fixture(scope="module")
def client():
    with beside_composed_run(MACHINE) as node:
        yield node


def told(recording):
    """Events of the axis, and what its drive was asked, as the recording has them."""
    recorded = read_recording(recording)
    events = [(event.cycle, event.text) for event in recorded.events if event.source == "x"]
    return events, [(record.cycle, record.message) for record in recorded.commands if "parameter" in record.command]


@pytest.mark.parametrize("scenario", ["example", "aborted"])
def test_the_graph_equals_the_offline_run(tmp_path, scenario):
    file = ROOT / "examples" / "sercos_homing.yaml"
    if scenario == "aborted":
        file = tmp_path / "aborted.yaml"
        file.write_text(ABORTED)
    job = (MACHINE, "--scenario", file)
    first = run("simulate", *job, "--record", tmp_path / "a.mcap").stdout
    run("run", *job, "--composed", "--free-run", "--record", tmp_path / "b.mcap")
    assert "warning" not in first
    assert states_equal(tmp_path / "a.mcap", tmp_path / "b.mcap") == []
    verified(tmp_path / "b.mcap")
    events, answers = told(tmp_path / "a.mcap")
    assert (events, answers) == told(tmp_path / "b.mcap")
    assert "axis x: the reference of the drive is taken over (S-0-0403 is set)" in [text for _, text in events]
    assert answers == ([(0, "S-0-0044 = 65"), (4500, "S-0-0403 = 3")] if scenario == "example" else [])


def test_services_of_drive_parameters(client):
    scaling = client.done("x", "read_drive_parameter", idn="S-0-0044")
    assert (scaling.message, json.loads(scaling.values_json), scaling.job) == ("S-0-0044 = 65", {"S-0-0044": 65}, 0)
    client.done("x", "write_drive_parameter", idn="S-0-0042", value=800_000)
    assert json.loads(client.done("x", "read_drive_parameter", idn="S-0-0042").values_json) == {"S-0-0042": 800_000}
    refused = client.refused(
        "x",
        "write_drive_parameter",
        23121,
        "axis x: write_drive_parameter refused: S-0-0403 (position feedback value status) can only be read (SERCOS error "
        "0x7004); nothing was changed",
        idn="S-0-0403",
        value=1,
    )
    assert json.loads(refused.values_json) == {"code": 0x7004}


def test_the_service_of_homing(client):
    client.refused(
        "x",
        "home",
        23126,
        "axis x: home refused: position 500.0 mm is not within the soft limits -10 ... 400 mm (P-AXIS-00177, "
        "P-AXIS-00178); nothing was changed",
        position=500.0,
    )
    assert client.done("x", "home", position=50.0).job == 1
    client.wait_last("x", lambda block: block.state[-1] == AxisStateCode.HOMING, "the homing")
    client.wait_last("x", lambda block: block.state[-1] == AxisStateCode.STANDSTILL, "its end")
    assert client.blocks["x"][-1].set_position[-1] == pytest.approx(50.0, abs=1e-3)
