"""The documents are written in the words of docs/glossary.md."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
GENERATED = ("parameters.md",)
PAGES = [
    page
    for page in (ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md")))
    if page.name not in (*GENERATED, "glossary.md")
]
AVOIDED = (
    "in work",
    "is through",
    "at the begin",
    "of before",
    "hears of",
    "hear of it",
    "any more",
    "rest of the way",
    "goes on again",
    "on the way there",
)
MESSAGE = re.compile(r"\| \d{4,6}\b.*?\| [A-Z]+(?:, [A-Z]+)? \|[^|]*\|")
"""The number and the text of a message in a table of errors, which is quoted as the code prints it."""


def avoided(text: str) -> list[str]:
    """Phrases of a document that the glossary has a better word for; messages and examples are not looked at."""
    lines = [MESSAGE.sub("|", line) for line in re.sub(r"```.*?```", "", text, flags=re.DOTALL).splitlines()]
    prose = " ".join(line for line in lines if not line.startswith("    "))
    return [phrase for phrase in AVOIDED if re.search(rf"\b{phrase}\b", prose, re.IGNORECASE)]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_no_phrase_that_the_glossary_avoids(page: Path) -> None:
    assert avoided(page.read_text(encoding="utf-8")) == []


def test_a_phrase_is_found_in_prose_and_not_in_messages() -> None:
    text = "A positioning is in\nwork.\n\n    in work: code\n| 23014 | R | is through | nothing any more |\n"
    assert avoided(text) == ["in work", "any more"]
