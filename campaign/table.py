"""Rows of a campaign as a table."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from rich.table import Table

from campaign.kills import ENDLESS, HOLD, KILL, TERM, Row


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
    of = Counter(row.outcome for row in rows)
    parts = [f"{of['stopped']} stops", f"{of['survived']} runs that continued"]
    parts += [f"{of[ENDLESS]} runs that did not end"] if of[ENDLESS] else []
    parts += [f"{of['']} runs in which there was no fault"] if of[""] else []
    parts.append(f"{sum(len(row.problems) for row in rows)} problems")
    happened = len(rows) - of["over"] - of[""]
    return f"{happened} faults ({of['over']} came after the end of their run): {', '.join(parts)}"
