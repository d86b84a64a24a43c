"""A recording that was cut before its first message: every command says so."""

import shutil
from pathlib import Path

import pytest
from click.testing import CliRunner, Result
from machine_support import ROOT

from cnc_ptp.cli import main
from cnc_ptp.recording.closing import close_cut

TEXT = "ends before its first message: it was cut, or has only just begun; nothing of a run is in it"


def call(*arguments: object) -> Result:
    return CliRunner().invoke(main, [str(argument) for argument in arguments])


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("run") / "run.mcap"
    assert call("simulate", ROOT / "config" / "ptp.yaml", "--duration", 0.1, "--record", path).exit_code == 0
    return path


@pytest.mark.parametrize("size", [1, 7, 8, 30, 60, 1000])
def test_every_command_says_that_nothing_is_left(whole: Path, size: int, tmp_path: Path) -> None:
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(whole.read_bytes()[:size])
    page, table = tmp_path / "a.html", tmp_path / "a.csv"
    for words in (
        ["replay", cut],
        ["replay", cut, "--from", 0],
        ["replay", cut, "--checkpoints", 1],
        ["report", cut, "-o", page],
        ["report", whole, "--compare", cut, "-o", page],
        ["diff", whole, cut],
        ["plot", cut, "-o", page],
        ["export", cut, "--topic", "x/state", "-o", table],
        ["verify", cut],
    ):
        result = call(*words)
        assert (result.exit_code, result.stderr.strip()) == (2, f"P-ERR-26224 recording {cut}: {TEXT}"), words
    assert sorted(tmp_path.iterdir()) == [cut]


def test_it_stays_so_when_the_file_was_closed(whole: Path, tmp_path: Path) -> None:
    """As the supervisor does it for a recorder that was killed."""
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(whole.read_bytes()[:1000])
    close_cut(cut)
    for words in (["replay", cut], ["diff", whole, cut]):
        assert call(*words).stderr.strip() == f"P-ERR-26224 recording {cut}: {TEXT}"


def test_a_last_part_that_has_only_just_begun_is_no_error(whole: Path, tmp_path: Path) -> None:
    folder = tmp_path / "run"
    folder.mkdir()
    shutil.copy(whole, folder / "run_0.mcap")
    (folder / "run_1.mcap").write_bytes(whole.read_bytes()[:60])
    result = call("export", folder, "--topic", "x/state", "-o", tmp_path / "a.csv")
    assert result.exit_code == 0 and "100 rows of /x/state" in result.output
