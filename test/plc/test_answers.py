"""docs/answers.md, cell by cell: every command in every state of axis, spindle and channel."""

from __future__ import annotations

import re

import pytest
from answer_support import HEADLINES, PAGE, ROWS, SITUATIONS, Situation, answers, read_tables

from cnc_ptp.protocol.axis_states import AxisStateCode
from cnc_ptp.protocol.channel_states import ChannelStateCode
from cnc_ptp.protocol.commands import BUFFER_MODES, COMMANDS

TABLES = read_tables()
COLUMNS = [(kind, situation) for kind in HEADLINES for situation in SITUATIONS[kind]]


@pytest.mark.parametrize(("kind", "situation"), COLUMNS, ids=lambda value: getattr(value, "column", value))
def test_every_command_is_answered_as_the_page_says(kind: str, situation: Situation) -> None:
    """The page as the units answer now: python test/support/answer_support.py"""
    assert dict(answers(kind, situation)) == TABLES[kind][situation.column]


@pytest.mark.parametrize("kind", HEADLINES)
def test_the_page_has_all_commands_and_all_states(kind: str) -> None:
    assert {command for command, _ in ROWS[kind].values()} == set(COMMANDS[kind])
    codes = ChannelStateCode if kind == "channel" else AxisStateCode
    assert {situation.state for situation in SITUATIONS[kind]} == set(codes)
    assert list(TABLES[kind]) == [situation.column for situation in SITUATIONS[kind]]
    for column in TABLES[kind].values():
        assert list(column) == list(ROWS[kind])


@pytest.mark.parametrize("kind", HEADLINES)
def test_each_command_is_accepted_in_a_state_of_the_page(kind: str) -> None:
    for row in ROWS[kind]:
        assert "ok" in {column[row] for column in TABLES[kind].values()}, row


def test_every_number_of_the_page_is_explained() -> None:
    text = PAGE.read_text(encoding="utf-8")
    for kind, headline in HEADLINES.items():
        section = text.split(f"\n## {headline}\n")[1].split("\n## ")[0]
        explained = {
            number for row in re.findall(r"^\| ([\d, ]+) \|", section, re.MULTILINE) for number in row.split(", ")
        }
        used = {cell for column in TABLES[kind].values() for cell in column.values()}
        assert used - {"ok"} == explained, kind


@pytest.mark.parametrize("situation", SITUATIONS["axis"], ids=lambda situation: situation.column)
def test_all_modes_of_blending_are_answered_alike(situation: Situation) -> None:
    for mode in BUFFER_MODES[2:]:
        give, _ = situation.prepare()
        record = give("move_absolute", target=50.0, buffer_mode=mode)
        answer = "ok" if record.accepted else str(record.error_id)
        assert answer == TABLES["axis"][situation.column]["move_absolute blending_next"]
