"""Colours of all figures: on light pages, and next to each its colour on dark ones."""

from __future__ import annotations

from typing import NamedTuple

PAPER, EDGE, GRID, BAND = "#ffffff", "#d5dbe3", "#e9edf2", "#eff5fc"
INK, SOFT, FAINT = "#1c2430", "#566273", "#a3adba"


class Pair(NamedTuple):
    """Colours of a set value and of its actual value, which lies below it."""

    set: str
    actual: str


BLUE = Pair("#1d4f9e", "#74b0ee")
GREEN = Pair("#17713a", "#66c78a")
RED = Pair("#b0271d", "#f2948a")
YELLOW = Pair("#c08a00", "#e5b93d")
PURPLE = Pair("#6a3fa0", "#b48fe3")
TEAL = Pair("#0f7276", "#5cc2c6")
BY_AXIS = (BLUE, RED, GREEN, PURPLE, YELLOW, TEAL)
"""Several axes in one figure: one colour per axis instead of one per quantity."""

DARK = {
    PAPER: "#14191f",
    EDGE: "#2f3742",
    GRID: "#252c35",
    BAND: "#1a2430",
    INK: "#e8edf3",
    SOFT: "#a9b4c2",
    FAINT: "#5d6876",
    **dict(zip(BLUE, ("#7db8ff", "#3a70b5"), strict=True)),
    **dict(zip(GREEN, ("#67d48c", "#2b8550"), strict=True)),
    **dict(zip(RED, ("#ff8f85", "#ab4840"), strict=True)),
    **dict(zip(YELLOW, ("#f0c34a", "#94751f"), strict=True)),
    **dict(zip(PURPLE, ("#c3a1f5", "#7554ae"), strict=True)),
    **dict(zip(TEAL, ("#5ecfd3", "#2a8286"), strict=True)),
}
