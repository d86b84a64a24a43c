"""The index of a long recording waits in a file without a name, and is the same as one in memory."""

import errno
from pathlib import Path
from unittest.mock import patch

import pytest
from mcap.reader import make_reader
from recording_support import record

from cnc_ptp.errors import CncError
from cnc_ptp.recording import kept_records
from cnc_ptp.recording.kept_records import KeptRecords
from cnc_ptp.recording.reader import read_recording


@pytest.fixture
def pieces(monkeypatch):
    monkeypatch.setattr(kept_records, "PIECE", 250)


@pytest.fixture
def run(blocks):
    return list(blocks.machine(120))


def recorded(path: Path, run) -> bytes:
    record(path, run, chunk_seconds=0.25)
    return path.read_bytes()


def test_a_recording_is_the_same_wherever_its_index_waits(tmp_path, run, monkeypatch):
    in_memory = recorded(tmp_path / "run.mcap", run)
    monkeypatch.setattr(kept_records, "PIECE", 250)
    with patch.object(KeptRecords, "_put_away", autospec=True, side_effect=KeptRecords._put_away) as put_away:
        assert recorded(tmp_path / "run.mcap", run) == in_memory
    assert put_away.call_count >= 10
    assert {file.name for file in tmp_path.iterdir()} == {"run.mcap", "metadata.yaml"}
    with (tmp_path / "run.mcap").open("rb") as stream:
        summary = make_reader(stream, validate_crcs=True).get_summary()
    assert len(summary.chunk_indexes) == 30
    assert [index.name for index in summary.attachment_indexes] == ["machine.yaml"]


@pytest.mark.usefixtures("pieces")
def test_a_folder_that_takes_no_other_file_keeps_it_in_memory(tmp_path, run):
    usual = recorded(tmp_path / "run.mcap", run)
    with patch.object(kept_records, "TemporaryFile", side_effect=OSError(errno.EACCES, "Permission denied")):
        assert recorded(tmp_path / "run.mcap", run) == usual


@pytest.mark.usefixtures("pieces")
def test_what_a_full_disk_does_not_take_stays_in_memory(tmp_path):
    class Full:
        """Takes seven bytes at a time, and every third time nothing."""

        def __init__(self) -> None:
            self.content, self.calls = b"", 0

        def seek(self, place: int) -> None:
            self.content = self.content[:place] if place else self.content

        def write(self, data: bytes) -> int:
            self.calls += 1
            if self.calls % 3 == 0:
                raise OSError(errno.ENOSPC, "No space left on device")
            self.content += data[:7]
            return min(7, len(data))

        def read(self, size: int) -> bytes:
            return self.content[:size]

    kept, expected = KeptRecords(tmp_path), b""
    with patch.object(kept_records, "TemporaryFile", side_effect=lambda **_options: Full()):
        for number in range(100):
            kept.add(f"record {number};".encode())
            expected += f"record {number};".encode()
    assert (kept.contents(), len(kept)) == (expected, len(expected))


def test_an_index_that_cannot_be_read_again_is_an_error(tmp_path, run):
    path = tmp_path / "run.mcap"
    failure = OSError(errno.EIO, "Input/output error")
    with patch.object(KeptRecords, "contents", side_effect=failure), pytest.raises(CncError) as error:
        recorded(path, run)
    assert (error.value.number, error.value.reason) == (
        26007,
        f"recording {path}: cannot be written at offset {path.stat().st_size}: Input/output error",
    )
    assert len(read_recording(path).states["/x/state"]) == 1200
