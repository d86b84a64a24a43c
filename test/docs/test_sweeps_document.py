"""docs/sweeps.md: its sweeps run as they are written and find what it shows."""

from __future__ import annotations

import re
import shlex
import shutil
from pathlib import Path

import pytest
from click.testing import CliRunner
from long_support import long

from cnc_ptp.cli import main

ROOT = Path(__file__).parents[2]
TEXT = (ROOT / "docs" / "sweeps.md").read_text(encoding="utf-8").replace("\\\n", " ")
SWEEPS = re.findall(r"^    (cnc_ptp sweep .*)\n\n?((?:    .*\n)+)", TEXT, re.MULTILINE)
"""Each command, and what it prints."""
SECONDS = re.compile(r"; [\d.]+ s$")


def words_of(text: str) -> list[str]:
    """Lines without the time that they took."""
    return [SECONDS.sub("", " ".join(line.split())) for line in text.splitlines() if line.strip()]


@pytest.mark.parametrize("number", [0, *long(range(1, len(SWEEPS)))])
def test_a_sweep_prints_what_the_page_shows(number: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    command, shown = SWEEPS[number]
    for name in ("config", "examples"):
        shutil.copytree(ROOT / name, tmp_path / name)
    (tmp_path / "runs").mkdir()
    monkeypatch.chdir(tmp_path)
    result = CliRunner().invoke(main, shlex.split(command)[1:])
    assert result.exit_code == 0, result.output
    printed = words_of(result.output)
    assert [line for line in words_of(shown) if line not in printed] == []


def test_every_sweep_of_the_page_is_here() -> None:
    assert len(SWEEPS) == TEXT.count("    cnc_ptp sweep ") == 5
