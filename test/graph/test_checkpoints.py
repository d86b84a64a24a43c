"""Checkpoints of a graph: each unit has its state after the same block in the recording, and a replay begins there."""

from __future__ import annotations

from pathlib import Path

import pytest
from click.testing import CliRunner, Result
from graph_support import MILL, Running, run, states_equal
from long_support import long, long_sets
from machine_support import ROOT

from cnc_ptp import cli
from cnc_ptp.commands.run.run import run as run_machine
from cnc_ptp.errors import CncError
from cnc_ptp.nodes.unit import checkpoints as unit_checkpoints
from cnc_ptp.parameters import read_machine
from cnc_ptp.recording.checkpoints import state_before
from cnc_ptp.recording.reader import read_recording
from cnc_ptp.recording.run_inputs import RunInputs
from cnc_ptp.state.faults import DAMAGED, not_storable
from cnc_ptp.state.machine_state import MachineState, StateStore, together

PROGRAM = "G01 X50 Y20 F2400\nM8\nX0\nX50 Y0\nX0\nM30\n"
MOTIONS = {
    "thread": ("config/lathe.yaml", "--program", "examples/threads/longitudinal.nc"),
    "slaves": ("config/ptp.yaml", "--scenario", "examples/figures/slave_flying_saw.yaml"),
    "trajectory": ("config/ptp.yaml", "--scenario", "examples/trajectory.yaml"),
    "channels": (
        *("examples/spindles/two_channels.yaml", "--program", "examples/spindles/channel1.nc"),
        *("--scenario", "examples/spindles/two_channels_start.yaml"),
    ),
    "plc": (
        *("config/mill.yaml", "--program", "examples/plc_tool_changer.nc"),
        *("--scenario", "examples/plc_tool_changer.yaml", "--plc", "examples/plc_tool_changer.py"),
    ),
}


def call(*arguments: object) -> Result:
    return CliRunner().invoke(cli.main, [str(argument) for argument in arguments])


def program(folder: Path) -> Path:
    file = folder / "lines.nc"
    file.write_text(PROGRAM)
    return file


def checkpoints_of(path: Path) -> list[int]:
    with RunInputs(path) as recorded:
        return recorded.checkpoints


@pytest.mark.parametrize("options", [["--free-run"], *long([["--composed"], []])], ids=str)
def test_a_replay_of_a_graph_begins_at_a_checkpoint(options: list[str], tmp_path: Path) -> None:
    path = tmp_path / "graph.mcap"
    run("run", MILL, "--program", program(tmp_path), "--record", path, "--checkpoints", 1, *options)
    assert checkpoints_of(path) == [1000, 2000, 3000, 4000, 5000]
    result = call("replay", path, "--from", 3.2)
    assert "note: computed from the checkpoint at 3 s" in result.output
    assert "both runs are equal to the bit" in result.output
    changed = [tmp_path / "with.mcap", tmp_path / "from_0.mcap"]
    assert call("replay", path, "--from", 3.2, "--override", 50, "-o", changed[0]).exit_code == 0
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("cnc_ptp.recording.what_if.state_before", lambda *_: (None, "not looked for"))
        assert call("replay", path, "--from", 3.2, "--override", 50, "-o", changed[1]).exit_code == 0
    assert states_equal(*changed) == []


@pytest.mark.parametrize("motion", ["slaves", *long(["thread", "trajectory", "channels", "plc"])])
def test_states_of_all_kinds_of_motion_continue_to_the_bit(motion: str, tmp_path: Path) -> None:
    path = tmp_path / "graph.mcap"
    machine, *given = (ROOT / word if "/" in word else word for word in MOTIONS[motion])
    run("run", machine, *given, "--record", path, "--checkpoints", 0.5, "--free-run")
    found = checkpoints_of(path)
    assert len(found) > 3
    for cycle in (found[1], found[len(found) // 2], found[-1]):
        result = call("replay", path, "--from", f"{cycle * 1e-3 + 0.01:.3f}")
        assert f"note: computed from the checkpoint at {cycle * 1e-3:g} s" in result.output
        assert "both runs are equal to the bit" in result.output


def test_parts_have_checkpoints(tmp_path: Path) -> None:
    path = tmp_path / "parts"
    words = ("--split", "2s", "--checkpoints", 1, "--free-run")
    run("run", MILL, "--program", program(tmp_path), "--record", path, *words)
    result = call("replay", path, "--from", 4.2)
    assert "note: computed from the checkpoint at 4 s" in result.output
    assert "both runs are equal to the bit" in result.output


@pytest.mark.parametrize(
    ("words", "expected"), [*long_sets([(["--checkpoints", 0], [])]), ([], [])], ids=["none", "every 10 s"]
)
def test_without_checkpoints_they_are_made_beside_the_recording(
    words: list[object], expected: list[int], tmp_path: Path
) -> None:
    path = tmp_path / "graph.mcap"
    run("run", MILL, "--program", program(tmp_path), "--record", path, "--free-run", *words)
    assert checkpoints_of(path) == expected
    text = "computed from 0 s: the recording has no checkpoints; cnc_ptp replay --checkpoints makes them, once"
    assert text in call("replay", path, "--from", 3.2).output
    result = call("replay", path, "--verify", "--checkpoints", 1)
    assert result.output.endswith(f"{path}.checkpoints: 5 checkpoints, 1 s from one to the next\n")
    assert "note: computed from the checkpoint at 3 s" in call("replay", path, "--from", 3.2).output


@pytest.mark.long
def test_recordings_on_demand_and_snapshots_have_those_of_their_time_and_one_before(tmp_path: Path) -> None:
    path, snapshot = tmp_path / "late.mcap", tmp_path / "snapshot.mcap"
    words = ("--program", program(tmp_path), "--keep", 5, "--checkpoints", 1, "--stay")
    with Running(MILL, *words) as running:
        running.wait_for_nodes(8)
        run("do", "recorder", "start", path)
        running.wait_until_recorded(path, 300_000)
        run("do", "recorder", "snapshot", snapshot, "seconds=1.5")
        run("do", "recorder", "stop")
    for file in (path, snapshot):
        begin, end = read_recording(file).states["/x/state"]["cycle"][[0, -1]]
        before, *others = checkpoints_of(file)
        assert begin - 1500 < before <= begin + 1000  # that which has come last, and none before the first second
        assert others == [*range(before + 1000, int(end) + 2, 1000)]
    result = call("replay", snapshot, "--from", f"{(begin + 700) * 1e-3:.3f}")
    assert "note: computed from the checkpoint at" in result.output
    assert "both runs are equal to the bit" in result.output
    changed = call("replay", snapshot, "--from", f"{(begin + 700) * 1e-3:.3f}", "--override", 50)
    assert "note: computed from the checkpoint at" in changed.output and "the runs part at" in changed.output


def test_a_checkpoint_without_a_unit_is_passed_over(tmp_path: Path) -> None:
    path = tmp_path / "graph.mcap"
    run("run", MILL, "--program", program(tmp_path), "--record", path, "--checkpoints", 1, "--free-run")
    machine = read_machine(MILL)
    with RunInputs(path) as recorded:
        del recorded._attachments["checkpoint/3000/x"]
        state, why = state_before(recorded, machine, 3200)
        assert state is not None and state.next_cycle == 2000
        assert why == "P-ERR-26151 checkpoint: the state is damaged: it lacks x; nothing was restored"
    empty = [MachineState(cycle, {}, {}) for cycle in (1000, 2000)]
    with pytest.raises(CncError) as refused:
        together([*empty, state], machine)
    assert refused.value.number == DAMAGED
    assert "the state is damaged: its units are before the cycles 1000, 2000; nothing was restored" in str(
        refused.value
    )


def test_a_state_that_cannot_be_stored_is_told_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    class NoStates(StateStore):
        def encode_units(self, *_: object) -> bytes:
            raise not_storable("its place", "something")

    monkeypatch.setattr(unit_checkpoints, "StateStore", NoStates)
    path = tmp_path / "graph.mcap"
    files = str(MILL), str(program(tmp_path)), None, None, str(path)
    assert run_machine(*files, free_run=True, composed=True, checkpoints=1.0) == 0
    told = [event.text for event in read_recording(path).events if event.error_id == 26150 and event.source == "x"]
    assert told == [
        "x: the state holds something at its place; no state was stored, a replay begins at an older checkpoint, or "
        "cnc_ptp replay --checkpoints makes them"
    ]
    assert checkpoints_of(path) == []


def test_a_large_program_has_states_in_real_time(tmp_path: Path) -> None:
    lines = "".join(f"G01 X{n % 2} F3000\n" for n in range(1200))
    (tmp_path / "large.nc").write_text(f"%LARGE\n{lines}M30\n")
    path = tmp_path / "graph.mcap"
    words = ("--record", path, "--checkpoints", 0.5, "--duration", 2)
    run("run", MILL, "--program", tmp_path / "large.nc", *words)
    assert [event.text for event in read_recording(path).events if event.error_id == 26150] == []
    result = call("replay", path, "--from", 1.2)
    assert result.exit_code == 0 and "note: computed from the checkpoint at 1 s" in result.output
