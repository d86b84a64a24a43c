"""The commands of docs/spindles.md run and print the lines that stand below them."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from itertools import groupby
from pathlib import Path

import pytest

from cnc_ptp.parameters.declare.declarations import catalogue

ROOT = Path(__file__).parents[2]
DOCUMENT = ROOT / "docs" / "spindles.md"
PROGRAMS = ("cnc_ptp ", "$ cnc_ptp ")
LINKS = ("config", "examples", "docs")


def commands() -> list[tuple[str, list[str]]]:
    """Each command of an indented block with the lines below it that it is to print."""
    text = DOCUMENT.read_text(encoding="utf-8")
    found: list[tuple[str, list[str]]] = []
    for indented, group in groupby(text.split("\n"), key=lambda line: line.startswith("    ")):
        lines = [line.removeprefix("    ").rstrip() for line in group] if indented else []
        if not any(line.startswith(PROGRAMS) for line in lines):
            continue
        for line in lines:
            if line.startswith(PROGRAMS):
                found.append((line.removeprefix("$ "), []))
            elif not line.startswith(". ") and line != "…":
                found[-1][1].append(line)
    return found


def ranges_of(text: str) -> list[tuple[int, int]]:
    """Numbers of five digits as (first, last): `00026 – 00028` are three, `24003` is one."""
    return [(int(first), int(last or first)) for first, last in re.findall(r"\b(\d{5})\b(?: – (\d{5}))?", text)]


@pytest.mark.long
def test_commands_print_what_the_text_says(tmp_path: Path) -> None:
    (tmp_path / "runs").mkdir()
    for name in LINKS:
        (tmp_path / name).symlink_to(ROOT / name)
    paths = f"{Path(sys.executable).parent}:{os.environ['PATH']}"
    compared = 0
    for command, expected in commands():
        words, _, comment = command.partition("#")
        run = subprocess.run(
            ["bash", "-c", words],
            cwd=tmp_path,
            env={**os.environ, "PATH": paths, "COLUMNS": "200"},
            capture_output=True,
            text=True,
            timeout=120,
        )
        refused = any(line.startswith("P-ERR-") for line in expected)
        assert (run.returncode != 0) == refused, (command, run.stderr)
        if "status" in comment:
            assert run.returncode == int(comment.split("status")[1])
        output = [line.rstrip() for line in (run.stdout + run.stderr).splitlines()]
        assert [line for line in expected if line not in output] == [], command
        compared += len(expected)
    assert compared > 20


def test_every_example_of_the_folder_is_named() -> None:
    text = DOCUMENT.read_text(encoding="utf-8")
    files = [file.name for file in (ROOT / "examples" / "spindles").iterdir()]
    assert [name for name in files if f"{name}`" not in text and not name.startswith("channel2")] == []


def test_every_parameter_of_chapter_3_is_named() -> None:
    """Those that the declarations have from chapter 3 of the manual; `00026 – 00028` names three."""
    part = DOCUMENT.read_text(encoding="utf-8").split("## Parameters of chapter 3\n")[1].split("\n## ")[0]
    named = {f"{number:05d}" for first, last in ranges_of(part) for number in range(first, last + 1)}
    of_manual = [
        declaration.id
        for declaration in catalogue().by_id.values()
        if any(63 <= int(page) <= 84 for page in re.findall(r"spindle p\.(\d+)", declaration.source))
    ]
    assert len(of_manual) > 60
    assert [number for number in of_manual if number[-5:] not in named] == []


@pytest.mark.parametrize("module", ["spindle/faults.py", "nc/spindle_faults.py"])
def test_every_number_of_the_spindle_is_in_the_table(module: str) -> None:
    part = DOCUMENT.read_text(encoding="utf-8").split("## Errors\n")[1].split("\n## ")[0]
    named = {number for first, last in ranges_of(part) for number in range(first, last + 1)}
    source = (ROOT / "cnc_ptp" / module).read_text(encoding="utf-8")
    numbers = {int(number) for number in re.findall(r"(?:= |Fault\(\s*)(\d{5})\b", source)}
    assert len(numbers) > 20 and numbers - named == set()


def test_no_number_of_the_spindle_is_in_the_table_that_does_not_exist() -> None:
    part = DOCUMENT.read_text(encoding="utf-8").split("## Errors\n")[1].split("\n## ")[0]
    listed = {number for first, last in ranges_of(part) if 24000 < first < 25000 for number in range(first, last + 1)}
    source = (ROOT / "cnc_ptp" / "spindle" / "faults.py").read_text(encoding="utf-8")
    assert listed <= {int(number) for number in re.findall(r"= (\d{5})\b", source)}


def test_numbers_of_a_channel_that_waits_for_spindles_are_in_the_table() -> None:
    part = DOCUMENT.read_text(encoding="utf-8").split("## Errors\n")[1].split("\n## ")[0]
    named = {number for first, last in ranges_of(part) for number in range(first, last + 1)}
    modules = ("waits.py", "program_sequence.py", "function_output.py", "spindle_functions.py")
    sources = [(ROOT / "cnc_ptp" / "channel" / module).read_text(encoding="utf-8") for module in modules]
    numbers = {int(number) for text in sources for number in re.findall(r"^[A-Z_]+ = (\d{5})$", text, re.MULTILINE)}
    assert len(numbers) >= 4 and numbers - named == set()
