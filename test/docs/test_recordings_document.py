"""docs/recordings.md: its commands run as they are written, one after another, and print what it shows.

Runs of the graph need real time: here `simulate` makes their recordings, test/graph/test_recordings_document.py runs
those with a recorder.
"""

from __future__ import annotations

import os
import re
import shlex
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest
from click.testing import CliRunner

from cnc_ptp.cli import main

ROOT = Path(__file__).parents[2]
BLOCK = re.compile(r"^```(python)?\n(.*?)^```$", re.MULTILINE | re.DOTALL)
NOT_HERE = ("chromium", "cnc_ptp do ")
"""A browser may not be there; commands to a graph that runs."""


def blocks() -> Iterator[tuple[str, str]]:
    """Language and text of the blocks, in the order of the document."""
    text = (ROOT / "docs" / "recordings.md").read_text(encoding="utf-8")
    yield from ((language, block.replace("\\\n", " ")) for language, block in BLOCK.findall(text))


def is_commands(block: str) -> bool:
    return any(line.startswith(("cnc_ptp ", "chromium ")) for line in block.splitlines())


def execute(line: str) -> str:
    """What a line prints; fails where its status is not 0."""
    if not line.startswith("cnc_ptp "):
        return subprocess.run(line, shell=True, capture_output=True, text=True, check=True).stdout
    words = shlex.split(line)[1:]
    if words[0] == "run":
        if "--record" not in words:
            return ""
        words = ["simulate", *words[1:]]
    result = CliRunner().invoke(main, words)
    assert result.exit_code == 0, (line, result.output, result.exception)
    return result.output


def lines_of(text: str) -> list[str]:
    """Without what depends on the width of a table or on sizes."""
    lines = [" ".join(line.split()) for line in text.splitlines()]
    return [line for line in lines if line and "MB" not in line and set(line) != {"─"}]


@pytest.fixture(scope="module")
def checkout(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """What the examples need of a fresh checkout."""
    folder = tmp_path_factory.mktemp("checkout")
    for name in ("config", "examples"):
        shutil.copytree(ROOT / name, folder / name)
    (folder / "runs").mkdir()
    (folder / "docs" / "pictures").mkdir(parents=True)
    before = Path.cwd()
    os.chdir(folder)
    yield folder
    os.chdir(before)


def test_every_example_runs(checkout: Path) -> None:
    printed, shown, count = "", 0, 0
    for language, block in blocks():
        if language == "python":
            exec(compile(block, "docs/recordings.md", "exec"), {})
        elif is_commands(block):
            printed = ""
            for line in block.splitlines():
                if not line.startswith(NOT_HERE):
                    printed = execute(line)
                    count += 1
        else:
            head, _, last = block.partition("…")
            found = lines_of(printed)
            assert [line for line in lines_of(head + last) if line not in found] == []
            shown += 1
    assert count > 20 and shown == 1
    written = {path.name for path in checkout.iterdir()}
    assert {
        "run.html",
        "part.html",
        "plots.html",
        "difference.html",
        "diff.html",
        "x.csv",
        "x.parquet",
        "x.npz",
    } <= written
    assert {"lathe.json", "lathe.xml", "new.mcap", "whole.mcap"} <= written
    assert {path.name for path in (checkout / "runs").iterdir()} == {
        "long",
        "saved",
        "graph.mcap",
        "graph.mcap.checkpoints",
        "metadata.yaml",
    }
