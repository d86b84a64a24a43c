"""Reading of ROS parameters files: forms of names and values."""

import math

import pytest

from cnc_ptp.parameters.read.source import read_sections


def values(text: str) -> dict[str, object]:
    sections, problems = read_sections(f"/x:\n  ros__parameters:\n    {text}\n", "m.yaml")
    assert not problems
    return {entry.name: entry.value for entry in sections[0].entries}


@pytest.mark.parametrize(
    "text",
    [
        'getriebe: {"0": {kv: 5}}',
        "getriebe: {0: {kv: 5}}",
        "getriebe.0.kv: 5",
        "getriebe[0].kv: 5",
        "getriebe.0: {kv: 5}",
        "getriebe: {0.kv: 5}",
    ],
)
def test_names_nested_and_flat(text: str) -> None:
    assert values(text) == {"getriebe.0.kv": 5}


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("5", 5),
        ("-5", -5),
        ("+5", 5),
        ("0", 0),
        ("0x1F", 31),
        ("007", "007"),
        ("0b1", "0b1"),
        ("1_000", "1_000"),
        ("1:30", "1:30"),
        ("2026-11-21", "2026-11-21"),
        ("5.", 5.0),
        (".5", 0.5),
        ("1e3", 1000.0),
        ("1.5E-3", 0.0015),
        ("-.inf", -math.inf),
        (".Inf", math.inf),
        ("true", True),
        ("No", False),
        ("ON", True),
        ("~", None),
        ("", None),
        ("null", None),
        ("'5'", "5"),
        ('"true"', "true"),
        ("MVS_SVS | PLC_INFO", "MVS_SVS | PLC_INFO"),
        ("[x, 'y', 3]", ("x", "y", 3)),
        ("[]", ()),
    ],
)
def test_values(text: str, value: object) -> None:
    result = values(f"a: {text}")["a"]
    assert result == value
    assert type(result) is type(value)


def test_not_a_number() -> None:
    result = values("a: .NaN")["a"]
    assert isinstance(result, float)
    assert math.isnan(result)


def test_places_count_from_one() -> None:
    sections, _ = read_sections("# comment\n/x:\n  ros__parameters:\n    a: {b: 1}\n", "m.yaml")
    assert [str(section.place) for section in sections] == ["m.yaml:2:1"]
    assert [str(entry.place) for entry in sections[0].entries] == ["m.yaml:4:12"]


@pytest.mark.parametrize("text", ["/x:", "/x: {}", "/x: {ros__parameters: }", "/x: {ros__parameters: {}}"])
def test_empty_sections(text: str) -> None:
    sections, problems = read_sections(text, "m.yaml")
    assert [(section.node, section.entries) for section in sections] == [("x", [])]
    assert not problems
