"""docs/gallery.md shows every figure."""

from __future__ import annotations

from pathlib import Path

from figures.gallery import gallery_markdown

DOCS = Path(__file__).parents[2] / "docs"


def test_document_is_up_to_date() -> None:
    """Otherwise: python -m figures.gallery > docs/gallery.md"""
    assert (DOCS / "gallery.md").read_text(encoding="utf-8") == gallery_markdown()


def test_every_picture_is_in_it_once() -> None:
    text = gallery_markdown()
    pictures = list((DOCS / "figures").glob("*.svg"))
    assert len(pictures) > 50
    assert [picture.name for picture in pictures if text.count(f"(figures/{picture.name})") != 1] == []
