"""Rows of a campaign as a table."""

from __future__ import annotations

from collections.abc import Sequence

from rich.table import Table

from campaign.kills import HOLD, KILL, TERM, Row


def table(rows: Sequence[Row]) -> Table:
    """By what moved and what happened: how often, and how often all was as it must be."""
    shown = Table(title="faults: good / all")
    for heading in ("what moves", KILL, TERM, HOLD, "drives that braked on their own", "longest until the end, s"):
        shown.add_column(heading)
    for case in dict.fromkeys(row.fault.case for row in rows):
        of_case = [row for row in rows if row.fault.case == case and row.outcome != "over"]
        cells = [ratio([row for row in of_case if row.fault.signal == name]) for name in (KILL, TERM, HOLD)]
        own = sum(cycles > 1 for row in of_case for cycles in row.own_stops.values())
        longest = max((row.seconds for row in of_case if row.outcome == "stopped"), default=0.0)
        shown.add_row(case, *cells, str(own), f"{longest:.1f}")
    return shown


def ratio(rows: Sequence[Row]) -> str:
    return f"{sum(row.good for row in rows)} / {len(rows)}"


def summary(rows: Sequence[Row]) -> str:
    """What a document says of it."""
    happened = [row for row in rows if row.outcome not in ("over", "")]
    over = len(rows) - len(happened)
    survived = sum(row.outcome == "survived" for row in happened)
    bad = [problem for row in rows for problem in row.problems]
    return (
        f"{len(happened)} faults ({over} came after the end of their run): {len(happened) - survived} stops, "
        f"{survived} runs that continued, {len(bad)} problems"
    )
