"""Disks that are full or read-only: real ones, of a few pages."""

import pytest
from click.testing import CliRunner
from machine_support import ROOT
from mcap.writer import MCAP0_MAGIC
from recording_support import MACHINE
from rosbags.rosbag2 import Reader
from small_disk import read_only, small_disk

from cnc_ptp.cli import main
from cnc_ptp.client import Machine
from cnc_ptp.commands.output_file import write_output
from cnc_ptp.errors import CncError
from cnc_ptp.protocol.blocks import CycleTick
from cnc_ptp.recording.closing import close_cut_recording
from cnc_ptp.recording.reader import read_recording
from cnc_ptp.recording.recovery import recover
from cnc_ptp.recording.settings import Settings, Split
from cnc_ptp.recording.writer import Recording

SPLIT = Settings(split=Split(seconds=0.02))
NO_SPACE = "No space left on device"


@pytest.fixture
def disk(tmp_path):
    with small_disk(tmp_path / "disk", 64) as folder:
        yield folder


@pytest.fixture
def large_disk(tmp_path):
    with small_disk(tmp_path / "disk", 4096) as folder:
        yield folder


def refusal(call, *arguments):
    with pytest.raises(CncError) as refused:
        call(*arguments)
    return str(refused.value)


def leave(disk, pages):
    """Fills it up but for a few pages of 4 KiB."""
    with (disk / "fill").open("wb", buffering=0) as stream:
        try:
            while True:
                stream.write(bytes(4096))
        except OSError:
            stream.truncate(max(0, stream.tell() - 4096 * pages))


def ticks(recording, firsts):
    for first in firsts:
        recording.tick(CycleTick(first, 10))


@pytest.mark.parametrize("pages", range(4))
def test_a_disk_that_is_full_at_a_change_of_parts(disk, pages):
    """No part without a begin is left: the folder stays readable, and the recording is closed."""
    folder = disk / "run"
    recording = Recording(folder, MACHINE, settings=SPLIT, chunk_seconds=0.01)
    ticks(recording, range(0, 30, 10))
    leave(disk, pages)
    text = refusal(ticks, recording, range(30, 5000, 10))
    assert text.startswith(f"P-ERR-26007 recording {folder}/run_") and f": {NO_SPACE}; " in text
    recording.close()
    assert "came after the recording was closed" in refusal(ticks, recording, [6000])
    assert all(part.stat().st_size > 8 for part in folder.glob("*.mcap"))
    assert read_recording(folder).ticks["first_cycle"].tolist()[:2] == [0, 10]


def test_a_file_that_cannot_be_begun_is_not_left(disk):
    path = disk / "run.mcap"
    leave(disk, 0)
    assert refusal(Recording, path, MACHINE) == (
        f"P-ERR-26007 recording {path}: cannot be written: {NO_SPACE}; nothing is in it"
    )
    assert not path.exists()


def test_a_first_part_that_cannot_be_begun_leaves_nothing_to_be_closed(disk):
    folder = disk / "run"
    folder.mkdir()
    leave(disk, 0)
    assert refusal(lambda: Recording(folder, MACHINE, settings=SPLIT)) == (
        f"P-ERR-26007 recording {folder}/run_0.mcap: cannot be written: {NO_SPACE}; nothing is in it"
    )
    assert close_cut_recording(folder) == ""
    assert not [*folder.iterdir()]


def test_a_full_disk_leaves_the_former_page(disk):
    page = disk / "page.html"
    page.write_text("former")
    leave(disk, 0)
    assert refusal(write_output, str(page), "new" * 5000) == (
        f"P-ERR-27030 {page} cannot be written: {NO_SPACE}; the result above is all"
    )
    assert sorted(file.name for file in disk.iterdir()) == ["fill", "page.html"] and page.read_text() == "former"


def test_an_export_into_a_read_only_folder_is_refused(disk, tmp_path):
    recording = tmp_path / "run.mcap"
    with Recording(recording, MACHINE) as file:
        ticks(file, [0])
    read_only(disk)
    output = disk / "a.csv"
    result = CliRunner().invoke(main, ["export", str(recording), "--topic", "clock/tick", "-o", str(output)])
    assert (result.exit_code, " ".join(result.stderr.split())) == (
        2,
        f"P-ERR-27030 {output} cannot be written: Read-only file system; the recording is unchanged",
    )


def test_a_part_of_a_full_disk_by_the_command(disk):
    """The run ends as one whose recording could not be continued."""
    leave(disk, 8)
    folder = disk / "p"
    words = ["simulate", str(ROOT / "config" / "ptp.yaml"), "--duration", "3", "--record", str(folder), "--split", "1s"]
    result = CliRunner().invoke(main, words)
    assert result.exit_code == 1 and "cannot be written" in result.stderr and f"{NO_SPACE}; " in result.stderr
    assert result.exception is None or isinstance(result.exception, SystemExit)


def test_a_client_is_told_that_its_recording_has_ended(disk):
    path = disk / "a.mcap"
    leave(disk, 10)
    machine = Machine.offline(ROOT / "config" / "ptp.yaml", record=path)
    [event] = [event for event in machine.events(duration=5.0) if event.error_id == 26015]
    assert f"recording {path}: cannot be written at offset " in event.text
    assert f"{NO_SPACE}; the run continues without it, about cycle " in event.text
    ended = refusal(machine.recorder.stop)
    assert ended.startswith(f"P-ERR-26007 recording {path}: cannot be written at offset ")
    assert refusal(machine.recorder.stop).startswith("P-ERR-26191 ")
    machine.close()


def test_a_client_is_told_at_the_end_at_the_latest(disk):
    path = disk / "a.mcap"
    leave(disk, 10)
    machine = Machine.offline(ROOT / "config" / "ptp.yaml", record=path)
    machine.run_for(5.0)
    assert refusal(machine.close).startswith(f"P-ERR-26007 recording {path}: cannot be written at offset ")
    assert not read_recording(path).complete


def test_a_full_disk_leaves_what_was_recovered_before(disk, tmp_path):
    source, output = tmp_path / "run.mcap", disk / "saved.mcap"
    with Recording(source, MACHINE) as file:
        ticks(file, range(0, 2000, 10))
    output.write_bytes(MCAP0_MAGIC + b"former")
    leave(disk, 0)
    assert refusal(recover, source, output) == (
        f"P-ERR-26007 recording {output} cannot be written: {NO_SPACE}; nothing was written"
    )
    assert output.read_bytes() == MCAP0_MAGIC + b"former" and len([*disk.iterdir()]) == 2


def simulated(path, *options):
    words = ["simulate", str(ROOT / "config" / "ptp.yaml"), "--duration", "3", "--record", str(path), *options]
    assert CliRunner().invoke(main, words).exit_code == 0


def told(*words):
    """The error of a command that fails."""
    result = CliRunner().invoke(main, [*map(str, words)])
    assert result.exit_code == 2
    return " ".join(result.stderr.split())


def test_a_full_disk_leaves_what_a_replay_has_recorded_before(disk, tmp_path):
    run, output = tmp_path / "run.mcap", disk / "new.mcap"
    simulated(run)
    output.write_bytes(MCAP0_MAGIC + b"former")
    leave(disk, 8)
    assert told("replay", run, "--set", "x.getriebe.0.kv=8000", "-o", output) == (
        f"P-ERR-26007 recording {output} cannot be written: {NO_SPACE}; nothing was written"
    )
    assert output.read_bytes() == MCAP0_MAGIC + b"former" and len([*disk.iterdir()]) == 2


def test_a_full_disk_without_a_former_file_leaves_what_was_computed(large_disk, tmp_path):
    run, output = tmp_path / "run.mcap", large_disk / "new.mcap"
    simulated(run)
    leave(large_disk, run.stat().st_size * 2 // 3 // 4096)
    text = told("replay", run, "--set", "x.getriebe.0.kv=8000", "-o", output)
    assert text.startswith(f"P-ERR-26007 recording {output}: cannot be written at offset ")
    assert text.endswith(f": {NO_SPACE}; recording ends here, the chunks before it stay readable")
    assert not read_recording(output).complete


def test_a_full_disk_has_no_room_for_checkpoints_beside_a_recording(large_disk):
    run = large_disk / "run.mcap"
    simulated(run, "--checkpoints", "0")
    before = run.read_bytes()
    leave(large_disk, 0)
    assert told("replay", run, "--checkpoints", "1") == (
        f"P-ERR-26007 recording {run}.checkpoints cannot be written: {NO_SPACE}; nothing was written"
    )
    assert sorted(file.name for file in large_disk.iterdir()) == ["fill", "metadata.yaml", "run.mcap"]
    assert run.read_bytes() == before


@pytest.mark.parametrize("ending", ["csv", "parquet", "npz"])
def test_a_full_disk_has_no_room_for_an_export(disk, tmp_path, ending):
    run, output = tmp_path / "run.mcap", disk / f"x.{ending}"
    simulated(run)
    leave(disk, 1)
    assert told("export", run, "--topic", "x/state", "-o", output) == (
        f"P-ERR-27030 {output} cannot be written: {NO_SPACE}; the recording is unchanged"
    )
    assert [file.name for file in disk.iterdir()] == ["fill"]


def test_a_recording_that_is_replaced_is_described_anew(tmp_path):
    """Its own metadata and those beside it name the file and its messages."""
    run, output = tmp_path / "run.mcap", tmp_path / "out" / "new.mcap"
    output.parent.mkdir()
    simulated(run)
    for end in ("1", "2"):
        words = ["replay", str(run), "--to", end, "--set", "x.getriebe.0.kv=8000", "-o", str(output)]
        assert CliRunner().invoke(main, words).exit_code == 0
        with Reader(output.parent) as bag:
            counts = {each.topic: each.msgcount for each in bag.connections}
        assert counts["/x/state"] == int(end) * 1000
        assert sorted(file.name for file in output.parent.iterdir()) == ["metadata.yaml", "new.mcap"]
