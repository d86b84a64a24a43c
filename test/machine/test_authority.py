"""Command authority: the machine file closes units to sources; a refusal names the rule and changes nothing."""

import pytest
from graph_support import verified
from machine_support import ROOT, MachineBench

from cnc_ptp.client import CncError, Machine, MC_MoveAbsolute
from cnc_ptp.commands.run.what_if import what_if
from cnc_ptp.parameters import ParameterError, load_machine
from cnc_ptp.parameters.view.authority import CLOSED_TO, OF_CHANNELS, OF_PLC, OF_SERVICES, OF_TOPICS
from cnc_ptp.protocol.authority import is_open
from cnc_ptp.protocol.blocks import Command
from cnc_ptp.protocol.commands import COMMANDS
from cnc_ptp.recording.reader import read_recording

FILE = ROOT / "config" / "mill.yaml"
PLACE = "    spindles: [s]\n"
NUMBERS = {"plc": 80, "channels": 81, "topics": 82, "services": 83, "pages": 84}


def closed_text(**lists):
    """The mill with units closed to sources."""
    rules = "".join(f"    closed_to_{source}: [{', '.join(units)}]\n" for source, units in lists.items())
    text = FILE.read_text()
    assert PLACE in text
    return text.replace(PLACE, PLACE + rules, 1)


def closed_machine(**lists):
    return load_machine(closed_text(**lists), "closed.yaml")


def refusal(kind, unit, command, source, who=None):
    rule = f"closed_to_{source}, P-MACH-{NUMBERS[source]:05d}"
    return (
        f"P-ERR-26218 {kind} {unit}: {command} refused: the machine file closes it to {who or source} ({rule}); "
        "nothing was changed"
    )


def text_of(record):
    return f"P-ERR-{record.error_id} {record.message}"


def test_everything_is_open_by_default():
    assert load_machine(FILE.read_text(), "mill.yaml").closed == {}


def test_units_and_the_sources_that_do_not_command_them():
    closed = closed_machine(services=["x", "plc"], topics=["x"], plc=["s"]).closed
    assert closed == {"plc": (OF_SERVICES,), "s": (OF_PLC,), "x": (OF_TOPICS, OF_SERVICES)}


def test_a_unit_that_there_is_not():
    with pytest.raises(ParameterError) as caught:
        closed_machine(services=["xx"])
    assert str(caught.value) == (
        "P-ERR-25015 closed.yaml:10:25: machine list, P-MACH-00083 closed_to_services of /machine: 'xx' is no unit; did "
        "you mean x? There are channel, x, y, z, s, plc; the node does not start"
    )


@pytest.mark.parametrize("source", [OF_SERVICES, OF_TOPICS])
def test_a_command_from_outside(source):
    bench = MachineBench(machine=closed_machine(services=["x"], topics=["x"]), end_when_idle=False)
    bench.run(0.02)
    runner = bench.offline.runner("x")
    record = runner.asked(Command("x", "move_absolute", {"target": 5.0}), source)
    assert text_of(record) == refusal("axis", "x", "move_absolute", source)
    assert bench.offline.runner("y").asked(Command("y", "move_absolute", {"target": 5.0}), source).accepted
    bench.run(1.0)
    assert bench.position("x") == 0.0
    assert bench.position("y") == 5.0
    assert runner.asked(Command("x", "stop", {}), source).error_id != record.error_id


def test_a_scenario():
    """It is refused like a command that the unit cannot carry out, and the PLC gets the answer."""
    scenario = "- {at: 0.1, to: x, do: move_absolute, target: 5}\n- {at: 0.1, to: y, do: move_absolute, target: 5}\n"
    bench = MachineBench(None, scenario, machine=closed_machine(plc=["x"])).run()
    refused = [record for record in bench.records if not record.accepted]
    assert [text_of(record) for record in refused] == [refusal("axis", "x", "move_absolute", "plc", "the PLC")]
    answers = [answer for block in bench.blocks["x"] for answer in block.answers]
    assert [answer.error_id for answer in answers] == [26218]
    assert (bench.position("x"), bench.position("y")) == (0.0, 5.0)


def test_a_program_whose_spindle_is_closed_to_channels():
    bench = MachineBench("N10 M3 S1000\nN20 M30\n", machine=closed_machine(channels=["s"]))
    bench.run(1.0)
    refused = {text_of(record) for record in bench.records if not record.accepted}
    assert refusal("spindle", "s", "start", "channels") in refused
    assert set(bench.column("s", "set_speed_rpm")) == {0.0}


@pytest.mark.parametrize(
    ("kind", "command", "arguments"),
    [
        ("axis", "halt", {}),
        ("axis", "feed_hold", {"enabled": True}),
        ("axis", "power", {"enabled": False}),
        ("axis", "jog", {"velocity": 0.0}),
        ("axis", "overlay", {"control_unit": "feed_hold", "enabled": True, "value": 1.0}),
        ("axis", "overlay", {"control_unit": "feed_hold", "enabled": False}),
        ("channel", "overlay", {"control_unit": "emergency_stop", "enabled": True, "value": 1.0}),
        ("axis", "upstream_lost", {"source": "plc"}),
        ("spindle", "stop", {}),
        ("channel", "reset", {}),
        ("channel", "acknowledge", {"id": 1}),
        ("plc", "emergency_stop", {"enabled": True}),
        ("plc", "stop_all", {}),
    ],
)
def test_what_brings_to_rest_is_open(kind, command, arguments):
    assert is_open(kind, command, arguments)


@pytest.mark.parametrize(
    ("kind", "command", "arguments"),
    [
        ("axis", "move_absolute", {"target": 1.0}),
        ("axis", "feed_hold", {"enabled": False}),
        ("axis", "power", {"enabled": True}),
        ("axis", "jog", {"velocity": 1.0}),
        ("axis", "overlay", {"control_unit": "override", "enabled": True, "value": 100.0}),
        ("axis", "overlay", {"control_unit": "override", "enabled": False}),
        ("axis", "overlay", {"control_unit": "feed_hold", "enabled": True, "value": 0.0}),
        ("axis", "overlay", {"control_unit": "feed_hold", "enabled": True}),
        ("axis", "overlay", {}),
        ("axis", "begin_trajectory", {}),
        ("axis", "write_parameter", {}),
        ("spindle", "start", {}),
        ("channel", "start", {}),
        ("plc", "emergency_stop", {"enabled": False}),
        ("plc", "follow_trajectory", {}),
    ],
)
def test_what_moves_or_releases_is_not(kind, command, arguments):
    assert command in COMMANDS[kind]
    assert not is_open(kind, command, arguments)


def test_an_overlay_of_a_closed_source_holds_and_releases_nobody():
    bench = MachineBench(machine=closed_machine(plc=["x"]), end_when_idle=False)
    bench.run(0.02)
    runner = bench.offline.runner("x")
    assert runner.asked(Command("x", "move_absolute", {"target": 20.0}), OF_SERVICES).accepted
    assert runner.asked(Command("x", "feed_hold", {"enabled": True}), OF_SERVICES).accepted
    bench.run(1.0)
    held = bench.position("x")
    overlay = {"control_unit": "feed_hold", "enabled": True, "holder": "hli"}
    record = runner.asked(Command("x", "overlay", {**overlay, "value": 0.0}), OF_PLC)
    assert text_of(record) == refusal("axis", "x", "overlay", "plc", "the PLC")
    for change in ({**overlay, "value": 1.0}, {"control_unit": "feed_hold", "enabled": False}):
        assert runner.asked(Command("x", "overlay", change), OF_PLC).accepted
        bench.run(1.0)
        assert bench.position("x") == held < 20.0
    assert runner.asked(Command("x", "feed_hold", {"enabled": False}), OF_SERVICES).accepted
    bench.run(2.0)
    assert bench.position("x") == 20.0


@pytest.fixture
def closed_file(tmp_path):
    file = tmp_path / "closed.yaml"
    file.write_text(closed_text(services=["x"]))
    return file


HALVED = {
    "begin": 0.0,
    "end": None,
    "parameters": (),
    "override": 50.0,
    "program": None,
    "commands": None,
    "diff": False,
}
"""A changed run: the same one with another override of its channels."""


def refused_call(call):
    with pytest.raises(CncError) as caught:
        call()
    return str(caught.value)


def test_an_offline_client_and_the_replay_of_its_run(closed_file, tmp_path):
    """Commands, couplings, setpoints, function blocks and trajectories of a client; the replay keeps the refusals."""
    recording = tmp_path / "closed.mcap"
    with Machine.offline(closed_file, record=recording) as m:
        assert refused_call(lambda: m.x.move_absolute(target=5)) == refusal("axis", "x", "move_absolute", "services")
        assert refused_call(lambda: m.x.couple(master="y", factor=1.0)) == refusal("axis", "x", "couple", "services")
        rows = [[0, 0.0, 0.0, 0.0, 1]]
        text = refused_call(lambda: m.x.external_setpoints(setpoints=rows))
        assert text == refusal("axis", "x", "external_setpoints", "services")
        text = refused_call(lambda: m.plc.follow_trajectory(axes=["y", "x"], points=[[1.0, [1.0, 1.0]]]))
        rule = "the machine file closes it to services (closed_to_services, P-MACH-00083)"
        assert text == f"P-ERR-26218 plc plc: follow_trajectory refused: axis x: {rule}; nothing was changed"
        block = MC_MoveAbsolute(m.x)
        for _ in m.plc_cycles(0.1):
            block(True, position=5.0)
        assert block.error_id == 26218
        m.y.move_absolute(target=5).wait()
    recorded = verified(recording)
    assert not recorded.states["/x/state"]["set_position"].any()
    refused = [record for record in recorded.commands if record.error_id == 26218]
    assert "move_absolute" in [record.command for record in refused]
    changed = tmp_path / "changed.mcap"
    assert what_if(str(recording), output=str(changed), **HALVED) == 0
    kept = [record for record in read_recording(changed).commands if record.error_id == 26218]
    assert [(record.cycle, record.command, record.message) for record in kept] == [
        (record.cycle, record.command, record.message) for record in refused if record.target != "plc"
    ]


def test_every_source_has_a_parameter():
    assert [*CLOSED_TO] == [OF_PLC, OF_CHANNELS, OF_TOPICS, OF_SERVICES, "pages"]
