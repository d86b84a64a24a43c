"""What the fixture that checks the motion of all recordings looks at (test/support/recorded_motion.py)."""

import pytest
import recorded_motion
from recorded_motion import MAGIC, RECENT, RecordedMotion

from cnc_ptp.errors import CncError

pytestmark = pytest.mark.motion_unchecked("no recordings")


@pytest.fixture
def motion(monkeypatch):
    """Its recordings are good, but for those with a number as content, which are refused with it."""

    def check(path):
        content = path.read_bytes().removesuffix(MAGIC)
        if content.isdigit():
            raise CncError(int(content), "refused", "no motion was checked")
        return type("Result", (), {"clean": True})

    monkeypatch.setattr(recorded_motion, "check_recording", check)
    return RecordedMotion()


def folder_with(tmp_path, number, content=b"", end=MAGIC):
    folder = tmp_path / str(number)
    folder.mkdir()
    (folder / "run.mcap").write_bytes(content + end)
    return folder


def test_every_folder_is_looked_at_in_the_end(motion, tmp_path):
    motion.folders = [folder_with(tmp_path, number) for number in range(RECENT + 2)]
    assert [file.parent for file in motion.new_files()] == motion.folders[2:]
    motion.folders.append(folder_with(tmp_path, "being written", end=b""))
    assert motion.new_files() == []
    rest = [*motion.folders[:2], motion.folders[-1]]
    assert [file.parent for file in motion.all_new_files()] == rest
    assert motion.all_new_files() == []


def test_what_is_forgotten_is_not_looked_at(motion, tmp_path):
    motion.folders = [folder_with(tmp_path, number) for number in range(2)]
    motion.forget(1)
    assert [file.parent.name for file in motion.all_new_files()] == ["0"]


def test_a_refusal_for_which_tests_have_no_reason_is_told(motion, tmp_path):
    motion.folders = [folder_with(tmp_path, number, str(number).encode()) for number in (26262, 26001)]
    (told,) = motion.violations(motion.new_files())
    path = motion.folders[1] / "run.mcap"
    assert told == f"{path}: its motion was not checked: P-ERR-26001 refused; no motion was checked"
    assert motion.summary() == "motion of 0 recordings checked; not of 1 x P-ERR-26001, 1 x P-ERR-26262"


def test_long_recordings_are_counted(motion, tmp_path, monkeypatch):
    monkeypatch.setattr(recorded_motion, "LARGEST", 100)
    motion.folders = [folder_with(tmp_path, size, bytes(size)) for size in (10, 200)]
    assert motion.violations(motion.new_files()) == []
    monkeypatch.undo()
    assert motion.new_files() == []
    assert motion.summary() == "motion of 1 recordings checked; not of 1 above 64 MB"
