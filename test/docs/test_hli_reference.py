"""docs/hli_objects.md is made from the tables of the HLI, which fit its messages; its page names every number."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from cnc_ptp.commands.hli_origins import ORIGINS, UNIT_TEXTS
from cnc_ptp.commands.hli_reference import HEADLINES, fields_of, hli_markdown
from cnc_ptp.plc.hli import object_control
from cnc_ptp.protocol import overlay, unit
from cnc_ptp.protocol.control_units import CONTROL_UNITS, SWITCH

DOCS = Path(__file__).parents[2] / "docs"
PAGE = (DOCS / "plc_hli.md").read_text(encoding="utf-8")


def test_document_is_up_to_date() -> None:
    """Otherwise: python -m cnc_ptp.commands.hli_reference > docs/hli_objects.md"""
    assert (DOCS / "hli_objects.md").read_text(encoding="utf-8") == hli_markdown()


@pytest.mark.parametrize("kind", HEADLINES)
def test_every_control_unit_has_a_text_a_command_and_a_state(kind: str) -> None:
    names = [unit.name for unit in CONTROL_UNITS[kind]]
    assert list(UNIT_TEXTS[kind]) == names
    control, status = (
        {field.name: field.type for field in fields_of(f"{HEADLINES[kind]}Hli{what}")} for what in ("Control", "Status")
    )
    assert [name for name in control if name in names] == [name for name in status if name in names] == names
    for each in CONTROL_UNITS[kind]:
        assert control[each.name] == f"cnc_ptp/Hli{'Switch' if each.value == SWITCH else 'Number'}"
        state = "EdgeState" if each.edge else "SwitchState" if each.value == SWITCH else "NumberState"
        assert status[each.name] == f"cnc_ptp/Hli{state}"


@pytest.mark.parametrize("kind", HEADLINES)
def test_every_field_that_has_an_origin_is_there(kind: str) -> None:
    names = {field.name for what in ("Control", "Status") for field in fields_of(f"{HEADLINES[kind]}Hli{what}")}
    stems = names | {re.sub("_(hli|rpm|deg)$", "", name) for name in names}
    assert set(ORIGINS[kind]) <= stems


@pytest.mark.parametrize("kind", HEADLINES)
def test_every_other_field_says_what_it_is(kind: str) -> None:
    units = {each.name for each in CONTROL_UNITS[kind]}
    fields = [field for what in ("Control", "Status") for field in fields_of(f"{HEADLINES[kind]}Hli{what}")]
    shown = [field for field in fields if field.name not in units]
    inner = [part for field in shown if field.type.startswith("cnc_ptp/Hli") for part in fields_of(field.type[8:])]
    whole = [field for field in shown if not field.type.startswith("cnc_ptp/Hli")]
    assert [field.name for field in (*whole, *inner) if not field.comment] == []


def test_the_page_names_every_number() -> None:
    modules = (object_control, overlay, unit)
    numbers = {
        value
        for of in modules
        for name, value in vars(of).items()
        if name.isupper() and 26160 <= (value if isinstance(value, int) else 0) < 26170
    }
    assert numbers == set(range(26160, 26170))
    assert [number for number in sorted(numbers) if str(number) not in PAGE] == []
