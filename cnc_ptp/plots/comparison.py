"""Two recordings on top of each other, as a page: paths, plots over time, and tables of what differs.

`comparison_page` is all that others need: two recordings as read, a page as text.
"""

from __future__ import annotations

import difflib
from collections.abc import Iterator, Sequence
from dataclasses import replace
from html import escape
from typing import Any

import numpy as np
import plotly.graph_objects as go

from cnc_ptp.plots.colours import BLUE, RED
from cnc_ptp.plots.page import (
    MOST_ROWS,
    card_grid,
    name_cell,
    number_cell,
    page_head,
    plot_div,
    section,
    table,
    text_cell,
    value_text,
)
from cnc_ptp.plots.path_figures import figures_of_runs, path_axes
from cnc_ptp.plots.report_figures import COLOURS
from cnc_ptp.plots.time_plots import HINT, time_plots
from cnc_ptp.recording.command_words import json_object
from cnc_ptp.recording.difference import (
    LETTERS,
    PROGRAM,
    Compared,
    FieldDifference,
    common_cycles,
    compared,
    measure_of,
    parameter_differences,
)
from cnc_ptp.recording.reader import CHANNEL_STATE, Recorded
from cnc_ptp.recording.rows import OTHER, SET, Line, PlotRow, time_rows
from cnc_ptp.recording.statistics import axis_units, summary, torque_units

PAIRS = (BLUE, RED)
WITH_DIFFERENCE = ("position", "feed", "speed", "angle")
"""Plots below which B − A is drawn."""


def comparison_page(
    first: Recorded,
    second: Recorded,
    *,
    align: str = PROGRAM,
    names: tuple[str, str] | None = None,
    title: str = "",
    date: str = "",
) -> str:
    """The page as text; `align`: see `aligned`, whose errors it raises. `names`: of A and B, or those of the files."""
    return page_of(compared(first, second, align), names=names, title=title, date=date)


def page_of(both: Compared, *, names: tuple[str, str] | None = None, title: str = "", date: str = "") -> str:
    """The page of two recordings that are on one time scale."""
    pair = both.pair
    names = names or (pair[0].path.name, pair[1].path.name)
    details = [*(f"{letter}: {name}" for letter, name in zip(LETTERS, names, strict=True)), date]
    units = units_of(pair)
    parts = [
        page_head(title or "Comparison of two recordings", [detail for detail in details if detail]),
        "<main>",
        *(incomplete(recorded, letter) for recorded, letter in zip(pair, LETTERS, strict=True)),
        f'<p class="warn">{escape(" ".join(both.alone))}</p>' if both.alone else "",
        card_grid(_cards(both)),
        section("Differences", table(HEAD, _rows(both.found, units, pair[0])), NOTE),
        _paths(pair, units),
        section("Over time", time_plots(merged(pair), list(compared_rows(pair, units))), HINT),
        _parameters(pair),
        _programs(pair),
        "</main></body></html>\n",
    ]
    return "\n".join(part for part in parts if part)


def units_of(pair: Sequence[Recorded]) -> dict[str, str]:
    """mm or deg by axis, of both."""
    return {**axis_units(pair[1]), **axis_units(pair[0])}


HEAD = ("unit", "field", "", "largest of A", "largest of B", "largest |B − A|", "at s", "part at s")
NOTE = "Of the cycles that both have; times are those of the plots."


def incomplete(recorded: Recorded, letter: str) -> str:
    return "" if recorded.complete else f'<p class="warn">{letter} is incomplete: {escape(recorded.missing)}.</p>'


def _cards(both: Compared) -> Iterator[tuple[str, str, bool]]:
    figures = [summary(recorded) for recorded in both.pair]
    times = [each["program_time_s"] for each in figures]
    for letter, time in zip(LETTERS, times, strict=True):
        yield f"program time of {letter}", value_text(time, "s", 3), False
    if None not in times:
        yield "program time, B − A", f"{times[1] - times[0]:+.3f} s", False
    apart = "never" if both.parted is None else f"{both.parted:.3f} s"
    yield "set values part at", apart, False
    for label, key in (
        ("errors of A / B", "errors"),
        ("warnings of A / B", "warnings"),
        ("commands of A / B", "commands"),
    ):
        yield label, f"{figures[0][key]} / {figures[1][key]}", False


def _rows(found: Sequence[FieldDifference], units: dict[str, str], of: Recorded) -> Iterator[tuple[str, list[str]]]:
    second = of.cycle_time_ns * 1e-9
    for each in found:
        yield (
            "",
            [
                name_cell(each.unit),
                name_cell(each.field.replace("_", " ")),
                name_cell(measure_of(each, units)),
                number_cell(each.first, 4),
                number_cell(each.second, 4),
                number_cell(each.largest, 4),
                number_cell(each.cycle * second, 3) if each.largest else text_cell(""),
                number_cell(each.parted * second, 3) if each.parted >= 0 else name_cell("never"),
            ],
        )


def _paths(pair: Sequence[Recorded], units: dict[str, str]) -> str:
    axes = [path_axes(recorded, units) for recorded in pair]
    common = [axis for axis in axes[0] if axis in axes[1]]
    on_path = any(
        np.any(rows["path_velocity"]) for recorded in pair for rows in recorded.of_type(CHANNEL_STATE).values()
    )
    if len(common) < 2 or not on_path:
        return ""
    runs = [
        (f"{letter} {which}", recorded, getattr(colour, which), f"{which}_position")
        for letter, recorded, colour in zip(LETTERS, pair, PAIRS, strict=True)
        for which in ("set", "actual")
    ]
    figures: list[go.Figure] = figures_of_runs(runs, common)
    plots = "".join(f"<div>{plot_div(figure, f'path{number}')}</div>" for number, figure in enumerate(figures))
    style = "paths two" if len(figures) > 1 else "paths"
    return section("Path", f'<div class="{style}">{plots}</div>', "Set and actual positions of A and B.")


def merged(pair: Sequence[Recorded]) -> Recorded:
    """One recording with the units of both, `x A` and `x B`: for states, events and commands."""
    result = replace(pair[0], states={}, topics={}, events=[], commands=[])
    for letter, recorded in zip(LETTERS, pair, strict=True):
        result.events += [replace(event, source=f"{letter} {event.source}") for event in recorded.events]
        result.commands += [replace(command, target=f"{letter} {command.target}") for command in recorded.commands]
    for topic in dict.fromkeys(topic for recorded in pair for topic in recorded.states):
        for letter, recorded in zip(LETTERS, pair, strict=True):
            if topic in recorded.states:
                name = f"{topic.removesuffix('/state')} {letter}/state"
                result.states[name], result.topics[name] = recorded.states[topic], recorded.topics[topic]
    result.events.sort(key=lambda event: event.cycle)
    result.commands.sort(key=lambda command: command.cycle)
    return result


def compared_rows(pair: Sequence[Recorded], units: dict[str, str]) -> Iterator[PlotRow]:
    """The rows of a report with the lines of both, and B − A below some of them."""
    first, second = (
        {(row.unit, row.title): row for row in time_rows(recorded, units, torque_units(recorded))} for recorded in pair
    )
    for key in dict.fromkeys([*first, *second]):
        one, other = first.get(key), second.get(key)
        known = one or other
        assert known is not None
        lines = [
            replace(line, name=f"{letter} {line.name}", role=OTHER, colour=_colour(row, index, which))
            for which, (letter, row) in enumerate(zip(LETTERS, (one, other), strict=True))
            if row is not None
            for index, line in enumerate(row.lines)
        ]
        yield replace(known, lines=lines, legend=True)
        if known.title in WITH_DIFFERENCE and one is not None and other is not None:
            yield from _difference_row(one, other)


def _colour(row: PlotRow, index: int, which: int) -> str:
    """A is blue and B red, set values dark; of other lines each its own, light those of B."""
    line = row.lines[index]
    if line.role != OTHER or len(row.lines) == 1:
        return PAIRS[which].set if line.role in (SET, OTHER) else PAIRS[which].actual
    half = len(COLOURS) // 2
    return COLOURS[index % half + which * half]


def _difference_row(first: PlotRow, second: PlotRow) -> Iterator[PlotRow]:
    others = {line.field: line for line in second.lines}
    lines = []
    for line in first.lines:
        if line.field in others:
            a, b = common_cycles(line.rows, others[line.field].rows)
            rows: Any = np.zeros(len(a), dtype=[("cycle", "<u8"), ("difference", "<f8")])
            rows["cycle"], rows["difference"] = a["cycle"], b[line.field] - a[line.field]
            if len(rows):
                lines.append(Line(f"{line.name}, B − A", rows, "difference", OTHER, line.factor))
    if lines:
        yield PlotRow(first.unit, f"{first.title}, B − A", first.measure, lines, legend=True)


def _parameters(pair: Sequence[Recorded]) -> str:
    found = parameter_differences(*pair)
    rows = (("", [text_cell(text) for text in each]) for each in found[:MOST_ROWS])
    return section("Parameters", table(("parameter", "A", "B"), rows), "" if found else "The machine files are equal.")


def _programs(pair: Sequence[Recorded]) -> str:
    """Lines of the programs that differ; nothing where they are equal."""
    one, other = (_program(recorded).splitlines() for recorded in pair)
    lines = list(difflib.unified_diff(one, other, *LETTERS, lineterm="", n=2))
    return section("Program", f"<pre>{escape(chr(10).join(lines))}</pre>") if lines else ""


def _program(recorded: Recorded) -> str:
    loads = (command for command in recorded.commands if command.command == "load" and command.accepted)
    values = next((json_object(command.arguments_json) or {} for command in loads), {})
    return str(values.get("text", ""))
