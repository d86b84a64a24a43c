"""Links, anchors and pictures of README.md and docs/*.md lead somewhere."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest
from markdown_it import MarkdownIt
from markdown_it.token import Token

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
MARKDOWN = MarkdownIt("commonmark").enable("table")


@cache
def tokens(page: Path) -> list[Token]:
    return MARKDOWN.parse(page.read_text(encoding="utf-8"))


def targets(page: Path) -> Iterator[str]:
    """What links and pictures of a page name."""
    for token in tokens(page):
        for child in token.children or ():
            if target := child.attrGet("href") or child.attrGet("src"):
                yield str(target)


def anchors(page: Path) -> set[str]:
    """The anchors that GitHub and the site make of the headings; the n-th of the same name ends with -n."""
    found: Counter[str] = Counter()
    names = set()
    for token, content in zip(parts := tokens(page), parts[1:], strict=False):
        if token.type == "heading_open":
            text = "".join(child.content for child in content.children or ())
            slug = re.sub(r"[^\w\- ]", "", text.strip().lower()).replace(" ", "-")
            names.add(f"{slug}-{found[slug]}" if found[slug] else slug)
            found[slug] += 1
    return names


def broken(page: Path) -> list[str]:
    """Targets of a page that do not exist, in the order of the page; addresses of the web are not looked at."""
    wrong = []
    for target in targets(page):
        if re.match(r"[a-z]+:", target):
            continue
        name, _, anchor = target.partition("#")
        file = (page.parent / name).resolve() if name else page
        if not file.exists() or (anchor and anchor not in anchors(file)):
            wrong.append(target)
    return wrong


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_links_lead_somewhere(page: Path) -> None:
    assert broken(page) == []


def test_a_broken_link_is_found(tmp_path: Path) -> None:
    (tmp_path / "other.md").write_text("# One (2.1, 2.6)\n# One (2.1, 2.6)\n")
    page = tmp_path / "page.md"
    page.write_text(
        "# Here\n[a](#here) [b](#there) [c](other.md#one-21-26-1) [d](other.md#one-21-26-2) [e](none.md)\n\n"
        "| ![f](none.svg) |\n|---|\n| [g](https://nowhere.example) |\n\n    [code](none.md)\n"
    )
    assert broken(page) == ["#there", "other.md#one-21-26-2", "none.md", "none.svg"]


def test_the_index_names_every_page() -> None:
    text = (ROOT / "docs" / "index.md").read_text(encoding="utf-8")
    names = {page.stem for page in PAGES[1:]} - {"index"}
    assert set(text.split(":hidden:\n\n")[1].split("\n```")[0].split("\n")) == names
    assert {target.removesuffix(".md") for target in targets(ROOT / "docs" / "index.md") if "#" not in target} == names
