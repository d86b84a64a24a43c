"""Units of a running machine as a table, or as lines."""

from __future__ import annotations

import time
from collections.abc import Iterable, Sequence

from rich.console import Console
from rich.table import Table

from cnc_ptp.protocol.unit_view import UnitView

OLD = 1.0
"""Seconds after which data are marked: a machine in real time has new ones every few milliseconds."""
COLUMNS = ("unit", "state", "position", "speed", "following error", "override", "error", "age")
PLAIN_WIDTH = 160
"""Columns of a table that goes to a file or a pipe."""


def wide_console() -> Console:
    console = Console(highlight=False)
    return console if console.is_terminal else Console(highlight=False, width=PLAIN_WIDTH)


def unit_table(views: Iterable[UnitView], silent: Sequence[str] = ()) -> Table:
    """One row per unit; `silent`: units that have published nothing."""
    table = Table(box=None, padding=(0, 2, 0, 0), pad_edge=False)
    for number, column in enumerate(COLUMNS):
        table.add_column(column, justify="left" if number < 2 else "right", no_wrap=number != 4)
    for view in views:
        old = time.time() - view.stamp > OLD
        table.add_row(*cells(view), style="red" if view.error_id else "yellow" if old else "")
    for unit in silent:
        table.add_row(unit, "no data", style="yellow")
    return table


def cells(view: UnitView) -> list[str]:
    """One for each column."""
    place = value_text(view.position, 3, view.unit)
    if view.kind == "channel":
        place = f"line {view.line}, block {view.blocks_done}/{view.blocks_total}"
        place += f", {100.0 * view.progress:.0f} %" if view.busy else ""
        place += f", {view.time_left:.0f} s left" if view.busy and view.time_left >= 0.0 else ""
    return [
        view.name,
        view.state,
        place,
        value_text(view.speed, 1 if view.speed_unit == "rpm" else 3, view.speed_unit),
        value_text(view.following_error, 4, view.unit),
        f"{view.override:g} %",
        f"P-ERR-{view.error_id}" if view.error_id else "-",
        age_text(time.time() - view.stamp),
    ]


def line(view: UnitView) -> str:
    """The same for a file."""
    unit, state, place, speed, error, override, number, age = cells(view)
    words = [unit, state, place, speed, error and f"following error {error}", f"override {override}", f"age {age}"]
    return "  ".join(text for text in [*words, "" if number == "-" else number] if text)


def value_text(value: float | None, decimals: int, unit: str) -> str:
    return "" if value is None else f"{value:.{decimals}f} {unit}"


def age_text(seconds: float) -> str:
    """A machine in free run is ahead of its time stamps or behind them: not older than new."""
    return f"{max(0.0, seconds) * 1000.0:.0f} ms" if seconds < OLD else f"{seconds:.1f} s"
