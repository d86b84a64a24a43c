"""The catalogue: entries/*.yaml, reactions.yaml and texts.yaml as one table. Read when something asks for it."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path
from typing import Any

from cnc_ptp import yaml_text
from cnc_ptp.catalogue.entry import Entry, Reaction, Text, Value

FOLDER = Path(__file__).parent
RANGES = (
    (17_000, 17_999, "following error (0x4550 of the NC)"),
    (20_000, 21_999, "NC programs; 20xxx as the vendor has them"),
    (22_000, 22_999, "channels, paths and PLC"),
    (23_000, 23_999, "axes"),
    (24_000, 24_999, "spindles"),
    (25_000, 25_999, "machine files, scenarios and other files"),
    (26_000, 26_999, "graph, recordings, command line and clients"),
    (27_000, 27_999, "commissioning"),
    (50_000, 59_999, "paths and measuring, as the vendor has them"),
    (60_000, 69_999, "spindles and homing, as the vendor has them"),
    (70_000, 79_999, "position control, as the vendor has them"),
    (90_000, 99_999, "compensation of the tool radius, as the vendor has them"),
    (110_000, 119_999, "parameters, as the vendor has them"),
    (120_000, 129_999, "soft limits and program values, as the vendor has them"),
)
"""First and last number, and what they are about."""
PASTED = re.compile(r"P-(?:ERR|WARN)-\s*(\d+)|0x([0-9A-Fa-f]{4})\b")


@cache
def catalogue() -> Mapping[int, Entry]:
    """Every number in ascending order."""
    reactions, texts = _reactions(), _texts()
    found = {}
    for path in sorted(FOLDER.glob("entries/*.yaml")):
        for group in _load(path):
            for number, row in group["numbers"].items():
                if number in found:
                    raise ValueError(f"number {number} is declared twice, also in {path.name}")
                found[number] = _entry(number, group | row, reactions, texts.get(number, ()))
    return dict(sorted(found.items()))


def entry(number: int) -> Entry | None:
    """What there is about a number."""
    return catalogue().get(number)


def numbers_in(words: str) -> list[int]:
    """The numbers in what somebody types or pastes: 70349, P-ERR-70349, 0x4550, a whole line of a run."""
    if words.strip().isdigit():
        return [int(words)]
    return list(dict.fromkeys(int(found[1]) if found[1] else int(found[2], 16) for found in PASTED.finditer(words)))


def range_of(number: int) -> str:
    """What the range of a number is about; empty for one that is in none."""
    return next((text for first, last, text in RANGES if first <= number <= last), "")


def neighbours(number: int, count: int = 3) -> list[Entry]:
    """The numbers nearest to one that is not there: first those that differ in one digit, then by distance."""

    def distance(known: int) -> tuple[int, int]:
        same_length = len(str(known)) == len(str(number))
        differing = sum(a != b for a, b in zip(str(known), str(number), strict=False))
        return (differing if same_length and differing <= 1 else 2, abs(known - number))

    return [catalogue()[known] for known in sorted(catalogue(), key=distance)[:count]]


def _entry(number: int, row: Mapping[str, Any], reactions: Mapping[str, Reaction], texts: tuple[Text, ...]) -> Entry:
    return Entry(
        number=number,
        name=row["name"],
        title=row["title"],
        error_class=row["class"],
        severity=row["severity"],
        reactions=tuple(reactions[key] for key in row["reactions"]),
        texts=texts,
        cause=row["cause"],
        remedy=row["remedy"],
        page=row["page"],
        manual=row.get("manual", ""),
    )


def _reactions() -> Mapping[str, Reaction]:
    return {key: Reaction(key, **row) for key, row in _load(FOLDER / "reactions.yaml").items()}


def _texts() -> Mapping[int, tuple[Text, ...]]:
    loaded = _load(FOLDER / "texts.yaml") or {}
    return {number: tuple(_text(row) for row in rows) for number, rows in loaded.items()}


def _text(row: Mapping[str, Any]) -> Text:
    return Text(row["text"], tuple(_values(row.get("values", {}))))


def _values(row: Mapping[str, str]) -> Iterator[Value]:
    for name, kind in row.items():
        word, _, unit = kind.partition(" ")
        yield Value(name, word == "number", unit)


def _load(path: Path) -> Any:
    return yaml_text.load(path.read_text(encoding="utf-8"))
