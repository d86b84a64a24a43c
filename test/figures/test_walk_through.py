"""The commissioning walk-through of docs/control.md: its short commands, one after the other, print what the document shows."""

import os
import subprocess
import sys
from itertools import groupby
from pathlib import Path

from figures.scenario_head import ROOT

SECTION = "## Commissioning, step by step\n"
PROGRAMS = (".", "cnc_ptp", "for", "printf", "sed")
SLOW = ("cnc_ptp identify", "cnc_ptp circle", "cnc_ptp report", ". .venv")
"""What takes longer is tested with its command; the machine files below `identify friction` need its result."""
RESULT = "largest following error"


def steps():
    """Blocks of commands up to the identification of friction, each with the lines that are to be printed."""
    text = (ROOT / "docs" / "control.md").read_text(encoding="utf-8").split(SECTION)[1].split("\n## ")[0]
    blocks = [
        [line.removeprefix("    ") for line in lines]
        for indented, lines in groupby(text.split("\n"), key=lambda line: line.startswith("    "))
        if indented
    ]
    found = []
    for block in blocks:
        if block[0].split()[0] in PROGRAMS:
            if block[0].startswith("for axis"):
                break
            found.append((block, []))
        else:
            found[-1][1].extend(block)
    return found


def printed(line: str, folder: Path) -> str:
    paths = f"{Path(sys.executable).parent}:{os.environ['PATH']}"
    shell = subprocess.run(
        ["bash", "-c", line], cwd=folder, env={**os.environ, "PATH": paths}, capture_output=True, text=True, timeout=120
    )
    assert shell.returncode == 0, shell.stderr
    return shell.stdout


def test_commands_print_what_the_text_says(tmp_path):
    (tmp_path / "config").symlink_to(ROOT / "config")
    (tmp_path / "runs").mkdir()
    compared = 0
    for commands, expected in steps():
        output = [printed(line, tmp_path) for line in commands if not line.startswith(SLOW)]
        lags = [line for text in output for line in text.splitlines() if line.startswith(RESULT)]
        assert lags == [line for line in expected if line.startswith(RESULT)]
        compared += len(lags)
    assert compared == 4 * 3
    assert {file.name for file in (tmp_path / "runs").glob("*.yaml")} == {
        "new.yaml",
        "vel.yaml",
        "acc.yaml",
        "metadata.yaml",
    }
