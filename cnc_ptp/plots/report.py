"""The report of a run: one HTML page with everything in it, to be opened without a network."""

from __future__ import annotations

from collections.abc import Iterable
from html import escape
from typing import Any

import plotly.graph_objects as go

from cnc_ptp.plots.page import (
    MOST_ROWS,
    card_grid,
    count_note,
    name_cell,
    number_cell,
    page_head,
    plot_div,
    section,
    table,
    tag_cell,
    text_cell,
    value_text,
)
from cnc_ptp.plots.path_figures import actual_path_figures
from cnc_ptp.plots.program_page import recorded_program
from cnc_ptp.plots.surface_sections import surface_sections
from cnc_ptp.plots.thread_sections import thread_sections
from cnc_ptp.plots.time_plots import HINT, time_plots
from cnc_ptp.protocol.blocks import CommandRecord, Event, Severity
from cnc_ptp.recording.command_words import argument_words, json_object
from cnc_ptp.recording.reader import SPINDLE_STATE, Recorded
from cnc_ptp.recording.rows import PlotRow, standing, time_rows
from cnc_ptp.recording.statistics import in_machine_order, last_diagnostics, summary, torque_units

OF_EVERY_CYCLE = (recorded_program, surface_sections, thread_sections)
"""Sections that a long recording does not get."""


def report_page(recorded: Recorded, *, program: str = "", date: str = "") -> str:
    """The page as text. `program` and `date` are in its head; any text in it is escaped."""
    recorded = in_machine_order(recorded)
    figures = summary(recorded)
    title = program or recorded.path.name
    parts = [
        page_head(title, [part for part in (date, recorded.path.name) if part]),
        "<main>",
        _incomplete(recorded),
        _cards(figures),
        reduced_note(recorded),
        _paths(actual_path_figures(recorded, figures["units"])),
        *([] if recorded.reduced else [section_of(recorded) for section_of in OF_EVERY_CYCLE]),
        _times(recorded, figures["units"]),
        _events(recorded.events, recorded.cycle_time_ns * 1e-9),
        _commands(recorded, {**dict.fromkeys(recorded.of_type(SPINDLE_STATE), "deg"), **figures["units"]}),
        _nodes(last_diagnostics(recorded)),
        _topics(recorded),
        _files(recorded),
        "</main></body></html>\n",
    ]
    return "\n".join(part for part in parts if part)


def plots_page(recorded: Recorded, rows: list[PlotRow], *, title: str) -> str:
    """A page of some plots alone."""
    plots = section("Over time", time_plots(recorded, rows), HINT)
    body = [page_head(title, [recorded.path.name]), "<main>", _incomplete(recorded), plots, "</main></body></html>\n"]
    return "\n".join(body)


def _incomplete(recorded: Recorded) -> str:
    return "" if recorded.complete else f'<p class="warn">Incomplete recording: {escape(recorded.missing)}.</p>'


def reduced_note(recorded: Recorded) -> str:
    """What a page of a long recording leaves out."""
    reduced = recorded.reduced
    if reduced is None:
        return ""
    step = recorded.cycle_time_ns * 1e-9
    return (
        '<p class="warn">A long recording: the plots over time show the smallest and largest values of each '
        f"{2 * reduced.stride * step:g} s, the path a place each {reduced.path_stride * step:g} s. The figures above "
        "are those of all cycles. A part of it (--from, --to) has every cycle, and sections on programs, threads and "
        "faces.</p>"
    )


def _cards(figures: dict[str, Any]) -> str:
    cards: list[tuple[str, str, bool]] = [
        ("program time", value_text(figures["program_time_s"], "s", 3), False),
        ("recorded time", value_text(figures["duration_s"], "s", 3), False),
        ("cycles", f"{figures['cycles']:,}".replace(",", "\u202f"), False),
        ("lost blocks", str(figures["lost_blocks"]), figures["lost_blocks"] > 0),
    ]
    for name, extreme in figures["following_error"].items():
        label = f"largest following error of {name}, at {extreme.time_s:.3f} s"
        cards.append((label, f"{abs(extreme.value):.4f} {figures['units'].get(name, 'mm')}", False))
    if figures["lateness_p50_ms"] is not None and figures["lateness_p99_ms"] is not None:
        cards.append(
            ("lateness p50 / p99", f"{figures['lateness_p50_ms']:.1f} / {figures['lateness_p99_ms']:.1f} ms", False)
        )
    cards += [
        ("errors / warnings", f"{figures['errors']} / {figures['warnings']}", figures["errors"] > 0),
        ("commands / refused", f"{figures['commands']} / {figures['refused']}", figures["refused"] > 0),
    ]
    return card_grid(cards)


def _paths(figures: list[go.Figure]) -> str:
    if not figures:
        return ""
    plots = "".join(f"<div>{plot_div(figure, f'path{number}')}</div>" for number, figure in enumerate(figures))
    style = "paths two" if len(figures) > 1 else "paths"
    return section(
        "Path",
        f'<div class="{style}">{plots}</div>',
        "Actual position, coloured by the actual feed or by the following error of its axes together.",
    )


def _times(recorded: Recorded, units: dict[str, str]) -> str:
    if not recorded.states:
        return section("Over time", "", "The recording holds no states.")
    still = standing(recorded)
    notes = [HINT, f"Without plots, as they do not move: {', '.join(still)}."] if still else [HINT]
    plots = time_plots(recorded, list(time_rows(recorded, units, torque_units(recorded))))
    return section("Over time", plots, " ".join(notes))


def _events(events: list[Event], cycle_time: float) -> str:
    rows = [
        (
            Severity(event.severity).name.lower() if event.severity in list(Severity) else "",
            [
                number_cell(event.cycle * cycle_time, 3),
                number_cell(event.cycle),
                tag_cell(
                    Severity(event.severity).name.lower() if event.severity in list(Severity) else str(event.severity)
                ),
                name_cell(event.source),
                name_cell(f"P-ERR-{event.error_id}" if event.error_id else ""),
                text_cell(event.text),
                number_cell(event.line) if event.line else text_cell(""),
            ],
        )
        for event in events[:MOST_ROWS]
    ]
    head = ["time in s", "cycle", "", "source", "number", "text", "line"]
    return section("Events", table(head, rows), count_note(len(events), "event"))


def _commands(recorded: Recorded, units: dict[str, str]) -> str:
    """`units`: mm or deg by axis and spindle."""
    commands, cycle_time = recorded.commands, recorded.cycle_time_ns * 1e-9
    rows = [
        (
            "" if command.accepted else "refused",
            [
                number_cell(command.cycle * cycle_time, 3),
                number_cell(command.cycle),
                name_cell(command.target),
                name_cell(command.command.replace("_", " ")),
                text_cell(argument_words(command.arguments_json, units.get(command.target, ""))),
                tag_cell("accepted" if command.accepted else "refused"),
                text_cell(f"P-ERR-{command.error_id} {command.message}" if command.error_id else command.message),
            ],
        )
        for command in commands[:MOST_ROWS]
    ]
    head = ["time in s", "cycle", "to", "command", "arguments", "", "answer"]
    return section("Commands", table(head, rows), count_note(len(commands), "command"))


def _nodes(nodes: dict[str, dict[str, str]]) -> str:
    if not nodes:
        return ""
    keys = list(dict.fromkeys(key for values in nodes.values() for key in values))
    rows = [
        ("", [text_cell(name), *(text_cell(values.get(key, "")) for key in keys)]) for name, values in nodes.items()
    ]
    return section("Nodes", table(["node", *keys], rows), "Last values that each node reported on /diagnostics.")


def _topics(recorded: Recorded) -> str:
    rows = [
        (
            "",
            [
                text_cell(info.topic),
                text_cell(info.type_name),
                number_cell(info.count),
                number_cell((info.first_ns - recorded.start_ns) * 1e-9, 3),
                number_cell((info.last_ns - recorded.start_ns) * 1e-9, 3),
            ],
        )
        for info in sorted(recorded.topics.values(), key=lambda info: info.topic)
    ]
    topics = table(["topic", "type", "messages", "from s", "to s"], rows)
    return f"<section><details><summary>Topics</summary>{topics}</details></section>"


def _programs(commands: Iterable[CommandRecord]) -> dict[str, str]:
    """The texts of the loaded NC programs by file name, their lines numbered."""
    programs: dict[str, str] = {}
    for command in commands:
        values = json_object(command.arguments_json) or {}
        if command.accepted and command.command == "load" and isinstance(values.get("text"), str):
            lines = values["text"].splitlines()
            numbered = (f"{number:>5}  {line}" for number, line in enumerate(lines, start=1))
            programs[f"NC program {values.get('program', '')}"] = "\n".join(numbered)
    return programs


def _files(recorded: Recorded) -> str:
    files = {**_programs(recorded.commands), "machine.yaml": recorded.machine_yaml, **recorded.attachments}
    return "".join(
        f"<section><details><summary>{escape(name)}</summary><pre>{escape(text)}</pre></details></section>"
        for name, text in files.items()
        if text
    )
