"""`m.recorder` of an offline machine: recordings on demand, snapshots, options; each file can be computed again."""

import math
import re

import pytest
from machine_support import ROOT

from cnc_ptp.client import CncError, Machine, RecorderOptions
from cnc_ptp.commands.run.replay import replay_blocks
from cnc_ptp.recording.reader import read_recording
from cnc_ptp.recording.verify import verify

PTP = ROOT / "config" / "ptp.yaml"


def computed_again(path):
    """First and last cycle, the same of all units, equal to a second computation."""
    recorded = read_recording(path)
    assert recorded.complete and verify(recorded, replay_blocks).equal
    [span] = {(int(rows["cycle"].min()), int(rows["cycle"].max())) for rows in recorded.states.values()}
    return span


def refused(call, *arguments, **options):
    with pytest.raises(CncError) as caught:
        call(*arguments, **options)
    return str(caught.value)


def test_recordings_begin_and_end_while_the_machine_moves(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with Machine.offline(PTP, recorder=RecorderOptions()) as m:
        m.x.move_absolute(200, velocity=100)
        m.run_for(0.5)
        began = m.recorder.start("a.mcap")
        assert refused(m.recorder.start, "b.mcap") == (
            f"P-ERR-26190 recorder: start refused: recording {tmp_path / 'a.mcap'} is being written; nothing was changed"
        )
        m.run_for(0.7)
        ended = m.recorder.stop()
        assert (began.cycle, began.warning, ended.cycle - began.cycle) == (m.cycle - 700, "", 700)
        assert computed_again("a.mcap") == (began.cycle, ended.cycle - 1)  # closed already
        assert refused(m.recorder.stop) == (
            "P-ERR-26191 recorder: stop refused: no recording is being written; nothing was changed"
        )
        assert refused(m.recorder.start, "a.mcap").startswith("P-ERR-26192 recorder: start refused: ")
        again = m.recorder.start(tmp_path / "b.mcap")
        m.run_for(0.2)
    assert computed_again("b.mcap")[0] == again.cycle
    [event] = [event for event in read_recording("b.mcap").events if event.error_id == 26220 and "b.mcap" in event.text]
    assert event.text == f"recorder: recording {tmp_path / 'b.mcap'} begins with cycle {again.cycle}"


def test_a_snapshot_has_the_last_seconds(tmp_path):
    with Machine.offline(PTP, recorder=RecorderOptions(keep=1.0, compression="lz4")) as m:
        m.x.move_absolute(200, velocity=100)
        m.run_for(2.0)
        assert m.recorder.snapshot(tmp_path / "a.mcap", 0.5).cycle == m.cycle - 500
        assert m.recorder.snapshot(tmp_path / "b.mcap").cycle == m.cycle - 1000
        short = m.recorder.snapshot(tmp_path / "c.mcap", seconds=60)
        assert re.fullmatch(r"recorder: 2\S* s were kept and are in the snapshot, 60 s were asked for", short.warning)
        assert refused(m.recorder.snapshot, tmp_path / "d.mcap", -1.0).startswith("P-ERR-26197 ")
        assert refused(m.recorder.snapshot, tmp_path / "d.mcap", until=m.time + 1.0).startswith("P-ERR-26197 ")
        end = m.cycle - 1
        assert m.recorder.snapshot(tmp_path / "d.mcap", 0.5, until=1.5).cycle == 1000
    spans = [(end - 499, end), (end - 999, end), (1000, 1499)]
    assert [computed_again(tmp_path / f"{name}.mcap") for name in "abd"] == spans


def test_the_recording_of_the_run_is_ended_by_stop_and_is_the_same_as_without_a_recorder(tmp_path):
    for name, options in (("a", None), ("b", RecorderOptions(split="1s"))):
        with Machine.offline(
            PTP, record=tmp_path / f"{name}.mcap" if options is None else tmp_path / name, recorder=options
        ) as m:
            m.x.move_absolute(50, velocity=100)
            m.run_for(1.5)
            end = m.recorder.stop().cycle
            m.run_for(0.3)
    assert computed_again(tmp_path / "a.mcap") == computed_again(tmp_path / "b") == (0, end - 1)
    assert sorted(path.name for path in (tmp_path / "b").glob("*.mcap")) == ["b_0.mcap", "b_1.mcap"]


def test_a_snapshot_is_taken_by_itself(tmp_path):
    options = RecorderOptions(keep=0.5, snapshots=str(tmp_path / "taken"), snapshot_when="x.set_velocity > 10")
    with Machine.offline(PTP, recorder=options) as m:
        m.run_for(1.0)
        m.x.move_absolute(50, velocity=100)
        m.run_for(0.2)
        m.recorder.snapshot(tmp_path / "asked.mcap")  # does not cut the other one short
        m.run_for(2.0)
    [taken] = (tmp_path / "taken").glob("trigger_*.mcap")
    first, last = computed_again(taken)
    cycle = int(taken.stem.removeprefix("trigger_"))
    assert (first, last) == (cycle - 500, cycle + 499)


def test_a_machine_without_a_recorder_says_so(tmp_path):
    with Machine.offline(PTP) as m:
        assert refused(m.recorder.start, tmp_path / "a.mcap") == (
            "P-ERR-26221 recorder: start refused: this machine has no recorder; nothing was changed, give record or "
            "recorder to Machine.start or Machine.offline"
        )
        with Machine.offline(PTP, recorder=RecorderOptions()) as other:
            assert refused(other.recorder.snapshot, tmp_path / "a.mcap").startswith("P-ERR-26193 ")
    assert refused(other.recorder.stop) == "P-ERR-26172 recorder: stop: the machine was closed; nothing was sent"


@pytest.mark.parametrize(
    ("options", "reason"),
    [
        ({"compression": "zip"}, "compression = 'zip' is none of zstd, lz4, none"),
        ({"keep": -1.0}, "keep = -1 s is no time"),
        ({"keep": math.nan}, "keep = nan s is no time"),
        ({"when": "x.set_velocity != 0"}, "when needs record: it is of the recording of the run"),
        ({"snapshots": "folder"}, "snapshots needs keep: they are of what is kept in memory"),
        ({"keep": 1.0, "snapshot_when": "x.set_velocity != 0"}, "snapshot_when needs snapshots"),
    ],
)
@pytest.mark.parametrize("make", [Machine.offline, Machine.start])
def test_options_without_sense_are_refused(make, options, reason):
    assert refused(make, PTP, recorder=RecorderOptions(**options)) == (
        f"P-ERR-26222 recorder options: {reason}; nothing was started"
    )


def test_a_file_in_place_of_the_folder_for_snapshots(tmp_path):
    file = tmp_path / "taken"
    file.write_text("mine")
    text = refused(Machine.offline, PTP, recorder=RecorderOptions(keep=1.0, snapshots=str(file)))
    assert text == f"P-ERR-26113 recording {file} cannot be written: it is no folder; nothing was started"
    assert file.read_text() == "mine"
