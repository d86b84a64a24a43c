"""A recorded run computed again with something changed; without a change it is what was recorded, to the bit."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hli_support import message
from long_support import long_but
from machine_support import ROOT
from recording_support import smooth_blocks
from state_support import Run

from cnc_ptp.commands.run.replay import end_of
from cnc_ptp.commands.run.what_if import compute, what_if
from cnc_ptp.errors import CncError
from cnc_ptp.machine.wiring import unit_kinds
from cnc_ptp.parameters import machine_text
from cnc_ptp.plc.hli.hli import Hli
from cnc_ptp.plc.plc_unit import PlcUnit
from cnc_ptp.plc.scenario import Entry
from cnc_ptp.protocol.blocks import ChannelBlock, Command, CommandRecord
from cnc_ptp.recording.mcap_file import McapFile
from cnc_ptp.recording.offline_run import OfflineRun
from cnc_ptp.recording.reader import RawMessage, Recorded, read_recording
from cnc_ptp.recording.recorded_answers import CHANNEL_BLOCK, RecordedAnswers
from cnc_ptp.recording.run_difference import difference
from cnc_ptp.recording.run_inputs import RunInputs
from cnc_ptp.recording.trigger import Condition
from cnc_ptp.recording.what_if import Change, WhatIf
from cnc_ptp.wire.block_codec import BlockCodec, codec_of
from cnc_ptp.wire.stamps import Stamps

SPINDLES = "examples/spindles/"
OLD_KV = 5000
"""Of x in config/mill.yaml, as its parameter list has it."""
RUNS = [
    Run("config/mill.yaml", "examples/bracket.nc", "examples/bracket_overrides.yaml"),
    Run("examples/probe.yaml", "examples/probe.nc"),
    Run(SPINDLES + "gears_programmed.yaml", SPINDLES + "gears_programmed.nc"),
    Run(SPINDLES + "synchronous.yaml", SPINDLES + "override.nc", SPINDLES + "override.yaml"),
    Run("config/ptp.yaml", scenario="examples/figures/slave_flying_saw.yaml"),
    Run("config/lathe.yaml", "examples/threads/chain.nc"),
    Run("config/mill.yaml", "examples/tapping.nc"),
    Run("config/gantry.yaml", scenario="examples/figures/slave_gantry.yaml"),
    Run(SPINDLES + "two_channels.yaml", SPINDLES + "channel1.nc", SPINDLES + "two_channels_start.yaml"),
    # the PLC in a file: functions and gear changes that take their time, motions, homing, external setpoints
    Run("config/mill.yaml", "examples/plc_tool_changer.nc", "examples/plc_tool_changer.yaml", plc="examples/plc_tool_changer.py"),
    Run("config/ptp.yaml", scenario="examples/figures/plc_move_aborted.yaml", plc="examples/plc_move_axis.py"),
    Run("examples/homing.yaml", plc="examples/plc_homing.py"),
    Run("config/ptp.yaml", plc="examples/plc_setpoint_generator.py"),
    # handshakes by a person
    Run(SPINDLES + "gears.yaml", SPINDLES + "gears.nc", SPINDLES + "gears_plc.yaml"),
    Run(SPINDLES + "plc_spindle.yaml", SPINDLES + "din.nc", SPINDLES + "plc.yaml"),
    # trajectories, external setpoints, couplings, homing
    Run("config/ptp.yaml", scenario="examples/trajectory.yaml"),
    Run("config/ptp.yaml", scenario="examples/figures/ptp_external_setpoints.yaml"),
    Run("config/ptp.yaml", scenario="examples/figures/slave_cam.yaml"),
    Run("config/ptp.yaml", scenario="examples/figures/slave_cyclic.yaml"),
    Run("config/ptp.yaml", scenario="examples/figures/slave_decoupling_0_5.yaml"),
    Run("examples/sercos.yaml", scenario="examples/figures/ptp_drive_homing.yaml"),
]  # fmt: skip


def record(run: Run, path: Path, *, every: float = 1.0) -> Recorded:
    """The run with its checkpoints."""
    machine = run.parameters()
    text = machine_text(ROOT / run.machine)
    with OfflineRun(
        machine, run.units(machine), record=str(path), machine_text=text, checkpoint_seconds=every
    ) as offline:
        cycles = round(run.seconds * 1e6 / machine.cycle_time_us) if run.seconds else None
        for _ in offline.run(cycles=cycles):
            pass
    return read_recording(path)


def changed(recorded: Recorded, path: Path, change: Change) -> tuple[Recorded, str]:
    with RunInputs(recorded.path) as inputs:
        run = WhatIf(inputs, change)
        compute(run, inputs, path)
    return read_recording(path), run.note


@pytest.mark.parametrize("run", long_but(RUNS, RUNS[1:2]), ids=lambda run: run.name)
def test_a_run_without_a_change_is_the_recorded_one_from_anywhere(run: Run, tmp_path: Path) -> None:
    require_the_same_from_anywhere(record(run, tmp_path / "run.mcap"), tmp_path)


def require_the_same_from_anywhere(recorded: Recorded, folder: Path) -> None:
    duration = end_of(recorded) * recorded.cycle_time_ns * 1e-9
    for share in (0.0, 0.37, 0.8):
        again, note = changed(recorded, folder / f"again{share}.mcap", Change(share * duration))
        found = difference(recorded.path, again.path)
        assert found.parts_at is None, (share, note, [row for row in found.rows if row.parted >= 0][:3])
        assert not share or duration * share < 1.0 or note.startswith("computed from the checkpoint at ")
        require_equal_states(recorded, again)
        events = [event for event in recorded.events if event.cycle >= round(share * duration * 1000) + 20]
        texts = {(event.cycle, event.text) for event in again.events}
        assert all((event.cycle, event.text) in texts for event in events if event.source != "plc")


def require_equal_states(recorded: Recorded, again: Recorded) -> None:
    """All fields of all states, in the cycles of `again`."""
    for topic, rows in again.states.items():
        of_both = recorded.states[topic][np.isin(recorded.states[topic]["cycle"], rows["cycle"])]
        assert len(rows) == len(of_both) > 0
        for name in rows.dtype.names or ():
            assert rows[name].tobytes() == of_both[name].tobytes(), (topic, name)


@pytest.mark.long
def test_a_run_that_an_hli_and_a_jog_have_moved(tmp_path: Path) -> None:
    """The HLI takes over the override and the functions of the channel, and acknowledges M8 after 0.3 s."""
    run = Run("config/mill.yaml")
    machine = run.parameters()
    units, kinds = run.units(machine), unit_kinds(machine)
    plc = units["plc"]
    assert isinstance(plc, PlcUnit)
    hli = Hli(plc, kinds=kinds, largest_overrides=dict.fromkeys(kinds, 100.0), timeout=0.5, numbers={})
    path = tmp_path / "run.mcap"
    text = machine_text(ROOT / run.machine)
    with OfflineRun(machine, units, record=str(path), machine_text=text, checkpoint_seconds=1.0) as offline:
        commands = {
            5: Command("z", "jog", {"velocity": 5.0}),
            45: Command("z", "jog", {"velocity": 0.0}),
            60: Command("channel", "load", {"program": "hli.nc", "text": "G01 X20 F3000\nM8\nX40\nM30"}),
            61: Command("channel", "start", {}),
        }
        for block in range(300):
            done = [request.id for request in plc.requests_of("channel")] if block == 200 else []
            served = {"override": 50.0 + block / 10, "functions": True, "done": done}
            hli.take("channel", message("channel", "p1", block, **served), block * 0.01)
            if block in commands:
                plc.input(commands[block])
            offline.step()
    recorded = read_recording(path)
    assert {"overlay", "jog", "acknowledge"} <= {each.command for each in recorded.commands if each.accepted}
    require_the_same_from_anywhere(recorded, tmp_path)


@pytest.fixture(scope="module")
def mill(tmp_path_factory: pytest.TempPathFactory) -> Recorded:
    """Straight to and fro at constant feed, long enough to be steady."""
    folder = tmp_path_factory.mktemp("mill")
    (folder / "lines.nc").write_text("G01 X100 F2400\nX0\nX100\nX0\nM30\n")
    run = Run("config/mill.yaml", str(folder / "lines.nc"))
    return record(run, folder / "run.mcap")


def steady(recorded: Recorded, begin: float) -> tuple[float, float]:
    """Largest velocity of x and following error in the run from `begin` (s) on, where it is steady."""
    rows = recorded.states["/x/state"]
    rows = rows[rows["cycle"] >= begin * 1000]
    return float(np.max(np.abs(rows["set_velocity"]))), float(np.max(np.abs(rows["following_error"])))


def test_a_changed_kv_acts_from_its_time_on(mill: Recorded, tmp_path: Path) -> None:
    """In steady motion of a drive without feedforward the following error is v / Kv."""
    _, before = steady(mill, 4.0)
    again, _ = changed(mill, tmp_path / "kv.mcap", Change(3.0, parameters=["x.getriebe.0.kv=8000"]))
    velocity, after = steady(again, 5.5)
    assert velocity == pytest.approx(40.0)
    assert before / after == pytest.approx(8000 / OLD_KV, rel=2e-3)
    assert difference(mill.path, again.path).parts_at == pytest.approx(3.0, abs=0.02)


def test_an_override_of_half_makes_the_rest_of_the_program_twice_as_long(mill: Recorded, tmp_path: Path) -> None:
    again, note = changed(mill, tmp_path / "slow.mcap", Change(3.0, override=50.0))
    velocity, _ = steady(again, 4.0)
    assert velocity == pytest.approx(20.0) and note == "computed from the checkpoint at 3 s"


def test_the_spindle_gets_what_the_changed_program_says(mill: Recorded, tmp_path: Path) -> None:
    program = {"program": "other.nc", "text": "M3 S600\nG01 X10 F2400\nM5\nM30"}
    again, _ = changed(mill, tmp_path / "other.mcap", Change(program=program))
    assert float(np.max(again.states["/s/state"]["set_speed_rpm"])) == pytest.approx(600.0)


def refusal(mill: Recorded, change: Change) -> str:
    with RunInputs(mill.path) as inputs, pytest.raises(CncError) as refused:
        WhatIf(inputs, change)
    return str(refused.value)


def test_refusals(mill: Recorded, tmp_path: Path) -> None:
    end = end_of(mill) / 1000
    assert refusal(mill, Change(1e3)) == (
        f"P-ERR-26154 --from 1000 is not within the recorded time 0 ... {end:g} s; nothing was computed"
    )
    assert refusal(mill, Change(2.0, 1.0)) == ("P-ERR-26154 --to 1 is before --from 2; nothing was computed")
    assert refusal(mill, Change(parameters=["x.kv"])) == (
        "P-ERR-26153 --set 'x.kv' is not of the form unit.parameter=value, as x.getriebe.0.kv=8000; "
        "nothing was computed"
    )
    assert refusal(mill, Change(parameters=["u.kv=1"])) == (
        "P-ERR-26153 --set 'u.kv=1': the machine has no unit 'u'; nothing was computed"
    )
    assert refusal(mill, Change(parameters=["x.getriebe.0.kv=fast"])) == (
        "P-ERR-26153 --set 'x.getriebe.0.kv=fast': axis list, P-AXIS-00099 getriebe[0].kv of /x: value 'fast' is text, "
        "an integer is needed; nothing was computed"
    )


def test_a_program_takes_the_place_of_one(tmp_path: Path) -> None:
    other = record(Run("config/ptp.yaml", scenario="examples/trajectory.yaml", seconds=0.5), tmp_path / "ptp.mcap")
    assert refusal(other, Change(program={})) == (
        "P-ERR-26157 --program takes the place of a program, and none is loaded; nothing was computed"
    )


@pytest.mark.parametrize("begin", [2.0, 1e9])
def test_a_program_that_runs_is_reset_and_the_other_one_starts(mill: Recorded, tmp_path: Path, begin: float) -> None:
    """In motion at 2 s; at the end the channel rests, and nothing is reset."""
    begin = min(begin, end_of(mill) / 1000)
    program = {"program": "other.nc", "text": "G00 X10 Y10\nG01 X40 F2400\nM30"}
    again, _ = changed(mill, tmp_path / "other.mcap", Change(begin, begin + 4.0, program=program))
    x = again.states["/x/state"]["set_position"]
    assert x[-1] == 40.0 and again.states["/channel/state"]["path_velocity"][-1] == 0.0
    first = mill.states["/x/state"]["set_velocity"][round(begin * 1000) - 1]
    assert again.states["/x/state"]["set_velocity"][0] == pytest.approx(first, abs=20.0)
    given = [record.command for record in again.commands if record.target == "channel" and record.accepted]
    assert given == (["reset", "load", "start"] if begin == 2.0 else ["load", "start"])


def test_a_recording_without_a_machine_file_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "foreign.mcap"
    McapFile(path).close()
    assert refusal(Recorded(path), Change()) == (
        f"P-ERR-26155 recording {path}: holds no attachment machine.yaml; nothing was computed, record it with cnc_ptp"
    )


def test_recordings_of_different_machines_are_not_compared(mill: Recorded, tmp_path: Path) -> None:
    other = record(Run("config/ptp.yaml", scenario="examples/trajectory.yaml", seconds=0.5), tmp_path / "ptp.mcap")
    with pytest.raises(CncError) as refused:
        difference(mill.path, other.path)
    assert str(refused.value).startswith("P-ERR-26158 the recordings are of different machines: ")
    assert str(refused.value).endswith("; nothing was compared")


def test_the_command_prints_where_the_runs_part(mill: Recorded, capsys: pytest.CaptureFixture[str]) -> None:
    status = what_if(
        str(mill.path), begin=3.0, end=None, parameters=(), override=50.0, program=None, commands=None, output=None,
        diff=False,
    )  # fmt: skip
    printed = capsys.readouterr().out
    assert status == 0 and "computed from the checkpoint at 3 s" in printed and "the runs part at 3 s" in printed


@pytest.mark.parametrize("change", ["machine.cycle_time_us=2000", "machine.block_cycles=5"])
def test_the_cycle_is_that_of_the_recording(change: str, mill: Recorded, tmp_path: Path) -> None:
    with pytest.raises(CncError) as refused:
        changed(mill, tmp_path / "other.mcap", Change(2.0, parameters=[change]))
    assert str(refused.value) == (
        "P-ERR-26156 other parameters would give the machine another cycle time or other cycle blocks; "
        "nothing was computed"
    )


def test_a_recording_that_begins_late_is_computed_from_its_first_block_on(tmp_path: Path) -> None:
    """Before it nobody knows which of the recorded commands were those of channels."""
    (tmp_path / "late.nc").write_text("M3 S500\nG00 Z5\nG01 Z0 F2000\nM8\nX10\nM5\nM30\n")
    run = Run("config/mill.yaml", str(tmp_path / "late.nc"))
    machine = run.parameters()
    path = tmp_path / "late.mcap"
    text = machine_text(ROOT / run.machine)
    condition = Condition("z.set_velocity < 0", unit_kinds(machine))
    with OfflineRun(machine, run.units(machine), record=str(path), machine_text=text, condition=condition) as offline:
        for _ in offline.run():
            pass
    recorded = read_recording(path)
    with RunInputs(path) as inputs:
        begin, end = inputs.begin * 1e-3, inputs.end * 1e-3
    assert 0.0 < begin < 1.0
    assert refusal(recorded, Change()) == (
        f"P-ERR-26154 --from 0 is not within the recorded time {begin:g} ... {end:g} s; nothing was computed"
    )
    again, _ = changed(recorded, tmp_path / "again.mcap", Change(begin))
    assert difference(path, again.path).parts_at is None


def test_a_function_takes_as_long_as_in_the_recording_whenever_it_comes(tmp_path: Path) -> None:
    """M8 is acknowledged by hand. With half of the feed it comes later; what is new is acknowledged at once."""
    (tmp_path / "hand.nc").write_text("G01 X20 F2400\nM8\nX0\nM30\n")
    (tmp_path / "hand.yaml").write_text(
        "- {at: 0, to: plc, do: auto_acknowledge, enabled: off}\n- {at: 1.5, to: plc, do: acknowledge, id: 1}\n"
    )
    recorded = record(
        Run("config/mill.yaml", str(tmp_path / "hand.nc"), str(tmp_path / "hand.yaml")), tmp_path / "r.mcap"
    )
    ((begun, delay),) = delays(recorded.path)
    assert delay > 500
    slow, _ = changed(recorded, tmp_path / "slow.mcap", Change(end=5.0, override=50.0))
    ((later, same),) = delays(slow.path)
    assert later > begun + 300 and same == delay
    program = {"program": "other.nc", "text": "G01 X20 F2400\nM8\nM9\nX0\nM30"}
    other, _ = changed(recorded, tmp_path / "other.mcap", Change(program=program, end=5.0))
    assert [taken for _, taken in delays(other.path)] == [delay, 10]


def delays(path: Path) -> list[tuple[int, int]]:
    """First cycle of each block with a request, and the cycles to its acknowledgement."""
    with RunInputs(path) as inputs:
        blocks = [codec_of(ChannelBlock).decode(message.cdr) for message in inputs.messages([CHANNEL_BLOCK])]
        done = {
            Command.from_record(record).arguments["id"]: record.cycle
            for record in inputs.commands
            if record.command == "acknowledge" and record.accepted
        }
    asked = [(request.id, block.first_cycle) for block in blocks for request in block.requests]
    return [(cycle, done[number] - cycle) for number, cycle in asked]


def test_two_commands_that_differ_in_their_arguments_are_told_apart(tmp_path: Path) -> None:
    """In one cycle x gets one of the recording and one of the change; the recorded one is beyond a soft limit now."""
    (tmp_path / "move.yaml").write_text("- {at: 1.0, to: x, do: move_absolute, target: 100, velocity: 100}\n")
    recorded = record(Run("config/ptp.yaml", scenario=str(tmp_path / "move.yaml"), seconds=2.0), tmp_path / "r.mcap")
    for target, of_change in ((20.0, 0), (90.0, 1)):
        move = Command("x", "move_absolute", {"target": target, "velocity": 50.0})
        with RunInputs(recorded.path) as inputs:
            run = WhatIf(inputs, Change(parameters=["x.kenngr.swe_pos=800000"], commands=[Entry(1.0, move)]))  # 80 mm
            compute(run, inputs, tmp_path / "new.mcap")
        assert ['"target": 100' in each.arguments_json for each in run.refused_of_recording] == [True]
        assert ['"target": 90' in each.arguments_json for each in run.refused_of_change] == [True] * of_change


class OneBlock:
    """A recording of one block, in which a channel has given commands."""

    def __init__(self, block: ChannelBlock, commands: list[CommandRecord]) -> None:
        data = codec_of(ChannelBlock).encode(block, Stamps(0, 1_000_000))
        self.commands, self._message = commands, RawMessage("/channel/block", CHANNEL_BLOCK, 0, data)

    def codec(self, block_class: type) -> BlockCodec:
        return codec_of(block_class)

    def messages(self, types: list[str], _first_cycle: int) -> Iterator[RawMessage]:
        return iter([self._message] if CHANNEL_BLOCK in types else [])


def test_of_two_equal_commands_one_may_be_that_of_the_plc() -> None:
    stop, start = Command("s", "stop"), Command("s", "set_speed", {"rpm": 100.0})
    records = [CommandRecord(10, each.target, each.command, each.arguments_json, True, 0, "") for each in (stop, start)]
    block = next(block for name, block in smooth_blocks(0.1) if name == "channel" and block.first_cycle == 10)
    assert isinstance(block, ChannelBlock)
    block.commands = [stop, start]
    answers = RecordedAnswers(OneBlock(block, records), 0)  # type: ignore[arg-type]
    other = replace(records[1], arguments='{"rpm": 200.0}')
    assert [answers.gives(each) for each in (records[0], records[0], other, records[1])] == [True, False, False, True]


def two_channels(folder: Path, scenario: str, seconds: float) -> Recorded:
    """Channel 1 moves X to 50 for a second, channel 2 is loaded as the scenario says."""
    (folder / "long.nc").write_text("G01 X50 F3000\nM30\n")
    (folder / "y.nc").write_text("G01 Y20 F3000\nM30\n")
    (folder / "story.yaml").write_text(scenario)
    machine = Run(SPINDLES + "two_channels.yaml", str(folder / "long.nc"), str(folder / "story.yaml"), seconds=seconds)
    return record(machine, folder / "run.mcap")


def test_a_load_of_another_channel_leaves_the_program_that_runs_to_be_replaced(tmp_path: Path) -> None:
    story = "- {at: 0.7, to: channel2, do: load, program: y.nc}\n- {at: 0.7, to: channel2, do: start}\n"
    recorded = two_channels(tmp_path, story, 2.0)
    (tmp_path / "other.nc").write_text("G01 X10 F3000\nM30\n")
    status = what_if(
        str(recorded.path), begin=0.5, end=3.0, parameters=(), override=None, program=str(tmp_path / "other.nc"),
        commands=None, output=str(tmp_path / "new.mcap"), diff=False,
    )  # fmt: skip
    again = read_recording(tmp_path / "new.mcap")
    assert status == 0
    assert (again.states["/x/state"]["set_position"][-1], again.states["/y/state"]["set_position"][-1]) == (10.0, 20.0)
    loads = [
        (each.target, each.cycle, "X10" in each.arguments_json) for each in again.commands if each.command == "load"
    ]
    assert [(target, other) for target, _, other in loads] == [("channel1", True), ("channel2", False)]
    assert loads[1][1] == 700


@pytest.mark.parametrize("begin", [0.0, 1.8])
def test_the_channel_that_is_loaded_next_gets_the_other_program(tmp_path: Path, begin: float) -> None:
    """At 1.8 s both rest."""
    story = "- {at: 2.0, to: channel2, do: load, program: y.nc}\n- {at: 2.0, to: channel2, do: start}\n"
    recorded = two_channels(tmp_path, story, 3.0)
    axis = "x" if begin == 0.0 else "y"
    program = {"program": "other.nc", "text": f"G01 {axis.upper()}5 F3000\nM30"}
    with RunInputs(recorded.path) as inputs:
        run = WhatIf(inputs, Change(begin, program=program))
        compute(run, inputs, tmp_path / "new.mcap")
    assert run.replaced == ("channel1" if axis == "x" else "channel2")
    ends = {name: read_recording(tmp_path / "new.mcap").states[f"/{name}/state"]["set_position"][-1] for name in "xy"}
    assert ends == {"x": 50.0, "y": 20.0} | {axis: 5.0}
