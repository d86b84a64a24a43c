"""The documents and the texts of the code are written in the words of docs/glossary.md."""

from __future__ import annotations

import ast
import io
import re
import tokenize
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
GENERATED = ("parameters.md",)
PAGES = [
    page
    for page in (ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md")))
    if page.name not in (*GENERATED, "glossary.md")
]
FROM_SCHEMAS = ("msg", "srv", "action")
FOLDERS = ["", *sorted(path.parent.name for path in (ROOT / "cnc_ptp").glob("*/__init__.py"))]
AVOIDED = (
    "in work",
    "at work",
    "(is|are) through",
    "(is|are) over",
    "the begin",
    "of before",
    "hears? of",
    "tells? of",
    "(is|are) told",
    "any ?more",
    "rest of the way",
    "(way|on the way) (back|there)",
    "goes on",
    "went on",
    "by (itself|themselves)",
    "for good",
    "hang together",
    "stays? as (it|they) (is|are|was|were)",
    "does nothing",
    "stands (in|still|twice)",
    "(real|nominal|desired) values?",
    "pre-control",
    "zero mark",
    "stop way",
)
"""Patterns of phrases, most of them from the right-hand columns of the glossary."""
PATTERN = re.compile(rf"\b(?:{'|'.join(AVOIDED)})\b", re.IGNORECASE)
MESSAGE = re.compile(r"\| \d{4,6}\b.*?\| [A-Z]+(?:, [A-Z]+)? \|[^|]*\|")
"""The number and the text of a message in a table of errors, which is quoted as the code prints it."""


def phrases(text: str) -> list[str]:
    """Phrases that the glossary has a better word for."""
    return [found.group().lower() for found in PATTERN.finditer(" ".join(text.split()))]


def avoided(page: str) -> list[str]:
    """Phrases to avoid in a document; messages and examples are not looked at."""
    lines = [MESSAGE.sub("|", line) for line in re.sub(r"```.*?```", "", page, flags=re.DOTALL).splitlines()]
    lines = [re.sub(r"`[^`]*`", "", line) if line.startswith('| <a id="p-err-') else line for line in lines]
    return phrases("\n".join(line for line in lines if not line.startswith("    ")))


def texts(source: str) -> Iterator[tuple[int, str]]:
    """Line and text of all docstrings, messages and comments of a module; a text without a blank is a name."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and " " in node.value.strip():
            yield node.lineno, node.value
    for token in tokenize.generate_tokens(io.StringIO(source).readline):
        if token.type == tokenize.COMMENT:
            yield token.start[0], token.string


def avoided_in_code(source: str) -> list[str]:
    """`line: phrase` for each phrase to avoid."""
    return [f"{line}: {phrase}" for line, text in sorted(texts(source)) for phrase in phrases(text)]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_no_phrase_that_the_glossary_avoids(page: Path) -> None:
    assert avoided(page.read_text(encoding="utf-8")) == []


@pytest.mark.parametrize("folder", [name for name in FOLDERS if name not in FROM_SCHEMAS])
def test_no_phrase_that_the_glossary_avoids_in_code(folder: str) -> None:
    files = (ROOT / "cnc_ptp" / folder).glob("**/*.py" if folder else "*.py")
    sources = {str(file.relative_to(ROOT)): file.read_text(encoding="utf-8") for file in sorted(files)}
    assert sources
    assert [f"{file}:{found}" for file, source in sources.items() for found in avoided_in_code(source)] == []


def test_a_phrase_is_found_in_prose_and_not_in_messages() -> None:
    text = "A positioning is in\nwork.\n\n    in work: code\n| 23014 | R | is through | nothing any more |\n"
    assert avoided(text) == ["in work", "any more"]


def test_a_phrase_is_found_in_docstrings_messages_and_comments() -> None:
    source = '''
def wait(axis):
    """Until nothing is in
    work."""
    raise Error(f"axis {axis} is "
        f"told")  # nothing any more
    return "in_work", at.work
'''
    assert avoided_in_code(source) == ["3: in work", "5: is told", "6: any more"]
