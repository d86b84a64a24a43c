"""Checkpoints of recordings without any, in a file beside them: as good as own ones, and only for their run."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from click.testing import CliRunner, Result
from long_support import long
from machine_support import ROOT

from cnc_ptp import cli
from cnc_ptp.commands.run.progress import RunProgress
from cnc_ptp.errors import CncError
from cnc_ptp.machine.offline import OfflineMachine, Outputs
from cnc_ptp.machine.run_entries import read_entries
from cnc_ptp.machine.wiring import build_units
from cnc_ptp.parameters import machine_text, read_machine
from cnc_ptp.protocol.blocks import AxisBlock
from cnc_ptp.recording.checkpoint_file import store_checkpoints
from cnc_ptp.recording.mcap_file import McapFile
from cnc_ptp.recording.offline_run import write
from cnc_ptp.recording.reader import read_recording
from cnc_ptp.recording.run_inputs import RunInputs
from cnc_ptp.recording.writer import Recording
from cnc_ptp.state import machine_state
from cnc_ptp.state.faults import not_storable
from cnc_ptp.state.machine_state import StateStore

MILL = ROOT / "config" / "mill.yaml"
PROGRAM = "G01 X50 Y20 F2400\nM8\nX0\nX50 Y0\nX0\nM30\n"


def call(*arguments: object) -> Result:
    return CliRunner().invoke(cli.main, [str(argument) for argument in arguments])


def simulated(path: Path, *options: object, program: str = PROGRAM, checkpoints: int = 0) -> Path:
    (path.parent / "lines.nc").write_text(program)
    given = ("--program", path.parent / "lines.nc", "--record", path, "--checkpoints", checkpoints)
    result = call("simulate", MILL, *given, *options)
    assert result.exit_code == 0, result.output
    return path


@pytest.mark.parametrize("options", [("--split", "2s"), ("--record-when", "x.set_position > 20"), *long([()])], ids=str)
def test_a_replay_begins_at_a_checkpoint_of_the_file(options: tuple[object, ...], tmp_path: Path) -> None:
    path = simulated(tmp_path / ("parts" if "--split" in options else "run.mcap"), *options)
    file = path.with_name(f"{path.name}.checkpoints")
    for _ in range(2):  # a file that is there is replaced
        result = call("replay", path, "--checkpoints", 1)
        assert result.output == f"{file}: 5 checkpoints, 1 s from one to the next\n"
    given = path / "metadata.yaml" if path.is_dir() else path
    result = call("replay", given, "--from", 3.2, "--diff")
    assert "note: computed from the checkpoint at 3 s" in result.output
    assert "both runs are equal to the bit" in result.output
    assert [each.name for each in tmp_path.iterdir() if ".part" in each.name] == []


def test_a_file_of_another_run_does_not_count(tmp_path: Path) -> None:
    path = simulated(tmp_path / "run.mcap")
    assert call("replay", path, "--checkpoints", 1).exit_code == 0
    simulated(path, program=PROGRAM.replace("X50", "X51"))
    result = call("replay", path, "--from", 3.2)
    assert f"note: computed from 0 s: {path}.checkpoints has the checkpoints of another run" in result.output
    assert "both runs are equal to the bit" in result.output


def test_a_damaged_file_does_not_count(tmp_path: Path) -> None:
    path = simulated(tmp_path / "run.mcap")
    Path(f"{path}.checkpoints").write_text("nothing good")
    result = call("replay", path, "--from", 3.2)
    assert f"note: computed from 0 s: P-ERR-26002 recording {path}.checkpoints: not an MCAP file" in result.output
    assert "both runs are equal to the bit" in result.output


def test_a_file_counts_where_another_kernel_has_recorded(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The recording has checkpoints, in the same cycles, that this kernel does not understand."""
    path = tmp_path / "run.mcap"
    with monkeypatch.context() as other:
        other.setattr(machine_state, "kernel_digest", lambda: bytes(16))
        simulated(path, checkpoints=1)
    older = call("replay", path, "--from", 3.2)
    assert "computed from 0 s: P-ERR-26152 checkpoint: the state is that of a kernel with other sources" in older.output
    assert call("replay", path, "--checkpoints", 1).exit_code == 0
    assert "note: computed from the checkpoint at 3 s" in call("replay", path, "--from", 3.2).output


def altered(path: Path, cycle: int) -> Path:
    """A recording with another actual position of y in one cycle than the machine had."""
    machine = read_machine(MILL)
    (path.parent / "lines.nc").write_text(PROGRAM)
    entries = read_entries(machine, program=str(path.parent / "lines.nc"), scenario=None)
    with Recording(path, machine_text(MILL), 10**18, machine.cycle_time_us * 1000) as recording:
        for outputs in OfflineMachine(machine, build_units(machine, scenario=entries)).run():
            block = outputs["y"].block
            if block.first_cycle <= cycle < block.first_cycle + block.count:
                assert isinstance(block, AxisBlock)
                positions = [*block.actual_position]
                positions[cycle - block.first_cycle] += 1e-9
                outputs["y"].block = replace(block, actual_position=positions)
            write(recording, outputs)
    return path


def test_a_recording_with_another_result_gets_none(tmp_path: Path) -> None:
    path = altered(tmp_path / "run.mcap", 1998)
    file = Path(f"{path}.checkpoints")
    file.write_text("older")
    result = call("replay", path, "--checkpoints", 1)
    assert result.exit_code == 2
    assert " ".join(result.output.split()) == (
        f"P-ERR-26210 recording {path}: actual_position of y at 1.998 s is another one when computed again; "
        "no checkpoints were written, `cnc_ptp replay --verify` lists all differences"
    )
    assert file.read_text() == "older" and not [*tmp_path.glob(".part*")]
    assert call("replay", path, "--verify", "--checkpoints", 1).exit_code == 1
    assert file.read_text() == "older"


def test_a_recording_without_a_machine_file_gets_none(tmp_path: Path) -> None:
    path = tmp_path / "foreign.mcap"
    McapFile(path).close()
    with RunInputs(path) as inputs, pytest.raises(CncError) as refused:
        store_checkpoints(inputs, 1.0)
    assert str(refused.value) == (
        f"P-ERR-26155 recording {path}: holds no attachment machine.yaml; nothing was computed, record it with cnc_ptp"
    )


def test_a_file_that_cannot_be_written(tmp_path: Path) -> None:
    path = simulated(tmp_path / "run.mcap")
    file = path.with_name(f"{path.name}.checkpoints")
    file.mkdir()
    result = call("replay", path, "--checkpoints", 1)
    assert (result.exit_code, " ".join(result.output.split())) == (
        2,
        f"P-ERR-26007 recording {file} cannot be written: Is a directory; nothing was written",
    )


def test_states_that_cannot_be_stored_are_said(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def encode(_store: object, _machine: object) -> bytes:
        raise not_storable("[][channel].unit", "an interpreter that cannot be made again")

    path = simulated(tmp_path / "run.mcap")
    monkeypatch.setattr(StateStore, "encode", encode)
    result = call("replay", path, "--checkpoints", 4)
    assert result.output == (
        f"{path}.checkpoints: 0 checkpoints, 4 s from one to the next\n"
        "note: P-ERR-26150 checkpoint: the state holds an interpreter that cannot be made again at "
        "[][channel].unit; no state was stored at 4 s: a replay from then on begins at an older checkpoint, or at 0 s\n"
    )


@pytest.mark.parametrize(
    ("options", "text"),
    [
        (("--checkpoints", 0), "Invalid value for '--checkpoints'"),
        (("--checkpoints", 1, "--from", 2), "--verify, --publish and --checkpoints do not go with a changed run"),
    ],
)
def test_options_that_are_refused(options: tuple[object, ...], text: str, tmp_path: Path) -> None:
    result = call("replay", tmp_path / "run.mcap", *options)
    assert result.exit_code == 2 and text in result.output


def test_a_changed_run_is_not_computed_again(tmp_path: Path) -> None:
    """It has no commands of the time before."""
    path, new = simulated(tmp_path / "run.mcap"), tmp_path / "new.mcap"
    assert call("replay", path, "--from", 2, "--override", 50, "-o", new).exit_code == 0
    result = call("replay", new, "--from", 3)
    assert " ".join(result.output.split()) == (
        f"P-ERR-26018 recording {new}: it is what became of run.mcap from cycle 2000 on, what was before is there; "
        "the run cannot be computed again, replay run.mcap with all changes"
    )
    whole = tmp_path / "whole.mcap"
    assert call("replay", path, "--set", "x.getriebe.0.kv=8000", "-o", whole).exit_code == 0
    assert "are equal to the bit" in call("replay", whole, "--verify").output


def test_a_run_that_is_too_short_for_a_checkpoint(tmp_path: Path) -> None:
    path = simulated(tmp_path / "run.mcap")
    with RunInputs(path) as recorded:
        seconds = recorded.end * 1e-3
    result = call("replay", path, "--checkpoints", 100)
    assert (result.exit_code, " ".join(result.stderr.split())) == (
        2,
        f"P-ERR-26223 recording {path}: has no checkpoint within {seconds:g} s when they are 100 s apart; no file was "
        "written, choose a shorter time",
    )
    assert not Path(f"{path}.checkpoints").exists()


def test_long_replays_show_their_progress(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    shown: list[int] = []

    class Watched(RunProgress):
        def show_block(self, outputs: Outputs) -> None:
            shown.append(outputs["x"].block.first_cycle)

    for module in ("replay", "what_if"):
        monkeypatch.setattr(f"cnc_ptp.commands.run.{module}.RunProgress", Watched)
    path = simulated(tmp_path / "run.mcap", program="G01 X50 F2400\nX0\nM30\n")
    every = [*range(0, read_recording(path).last_cycle + 1, 10)]
    for words in ((), ("--checkpoints", 1), ("--from", 0, "-o", tmp_path / "new.mcap")):
        shown.clear()
        assert call("replay", path, *words).exit_code == 0
        assert shown == every
