"""docs/commands.md is made from the command table, and the table of texts fits it."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from cnc_ptp.commands.reference import HIDDEN, arguments, reference_markdown
from cnc_ptp.protocol.command_help import ARGUMENT_TEXTS, COMMAND_TEXTS, SPECIAL_TEXTS, argument_text
from cnc_ptp.protocol.commands import COMMANDS, INTERNAL

ROOT = Path(__file__).parents[2]
USED = [
    (kind, command, name)
    for kind, commands in COMMANDS.items()
    for command in commands
    if command not in INTERNAL
    for name in arguments(kind, command)
]


def test_document_is_up_to_date() -> None:
    """Otherwise: python -m cnc_ptp.commands.reference > docs/commands.md"""
    assert (ROOT / "docs" / "commands.md").read_text(encoding="utf-8") == reference_markdown()


def test_module_prints_the_document() -> None:
    command = [sys.executable, "-m", "cnc_ptp.commands.reference"]
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "PYTHONIOENCODING": "utf-8"}
    output = subprocess.run(command, check=True, capture_output=True, env=environment).stdout
    assert output.decode("utf-8") == reference_markdown()


@pytest.mark.parametrize("kind", COMMANDS)
def test_every_command_has_one_text(kind: str) -> None:
    assert list(COMMAND_TEXTS[kind]) == [name for name in COMMANDS[kind] if name not in INTERNAL]


@pytest.mark.parametrize(("kind", "command", "name"), USED)
def test_every_argument_has_a_text(kind: str, command: str, name: str) -> None:
    """Optional ones say what happens without them."""
    text = argument_text(kind, command, name)
    assert text.meaning
    assert COMMANDS[kind][command][name].required or text.left_out


def test_no_text_is_left_over() -> None:
    assert set(ARGUMENT_TEXTS) == {name for _, _, name in USED}
    assert set(SPECIAL_TEXTS) <= set(USED)


def test_arguments_that_scenarios_may_not_give_are_not_in_the_document() -> None:
    document = reference_markdown()
    assert not [name for name in HIDDEN | INTERNAL if f"`{name}`" in document]
