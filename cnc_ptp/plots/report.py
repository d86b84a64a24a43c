"""The report of a run: one HTML page with everything in it, to be opened without a network."""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from html import escape
from pathlib import Path
from typing import Any

import plotly.graph_objects as go
from plotly.offline import get_plotlyjs

from cnc_ptp.plots.colours import BLUE, EDGE, INK, RED, SOFT
from cnc_ptp.plots.report_figures import path_figures, rows_figure, time_columns
from cnc_ptp.protocol.blocks import CommandRecord, Event, Severity
from cnc_ptp.recording.command_words import argument_words, json_object
from cnc_ptp.recording.reader import SPINDLE_STATE, Recorded
from cnc_ptp.recording.rows import PlotRow, standing, time_rows
from cnc_ptp.recording.statistics import in_machine_order, last_diagnostics, summary, torque_units

MOST_ROWS = 1000
NUMBERS = ("time in s", "cycle", "line", "messages", "from s", "to s")  # columns of numbers
CONFIG = {
    "displaylogo": False,
    "responsive": True,
    "displayModeBar": True,
    "showSendToCloud": False,
    "plotlyServerURL": "",
    "modeBarButtonsToRemove": ["sendChartToCloud", "sendDataToCloud", "select2d", "lasso2d"],
}
SECURITY = (
    "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:"  # no network
)
SCRIPT = Path(__file__).with_name("report.js").read_text(encoding="utf-8")
HINT = (
    "Drag sideways to zoom all plots, double click for the whole run; the scales follow. The cursor shows the values "
    "of a cycle: click for a reference, Δt and Δy count from there, Esc takes it away. Click a legend entry to hide it."
)
COLOURS = (
    f":root {{ --ink: {INK}; --soft: {SOFT}; --line: {EDGE}; --page: #f4f6f9; --blue: {BLUE.set}; --red: {RED.set}; "
    "--amber: #8a5b00; }"
)
STYLE = """
* { box-sizing: border-box; }
body { margin: 0; background: var(--page); color: var(--ink);
       font: 15px/1.5 system-ui, 'Segoe UI', Roboto, 'DejaVu Sans', sans-serif; }
header { background: white; border-bottom: 1px solid var(--line); padding: 22px 32px 18px; }
h1 { margin: 0; font-size: 26px; font-weight: 650; letter-spacing: -0.01em; }
header p { margin: 2px 0 0; color: var(--soft); }
main { max-width: 1500px; margin: 0 auto; padding: 20px 24px 48px; }
section { background: white; border: 1px solid var(--line); border-radius: 10px; padding: 14px 18px 16px;
          margin: 0 0 18px; }
h2 { margin: 0 0 8px; font-size: 17px; font-weight: 620; }
.note { color: var(--soft); margin: 0 0 8px; font-size: 13.5px; }
.cards { display: grid; grid-template-columns: repeat(auto-fill, minmax(170px, 1fr)); gap: 12px; margin: 0 0 18px; }
.card { background: white; border: 1px solid var(--line); border-radius: 10px; padding: 10px 14px; }
.card b { display: block; font-size: 21px; font-weight: 620; font-variant-numeric: tabular-nums; }
.card span { color: var(--soft); font-size: 13px; }
.card.bad b { color: var(--red); }
.warn { background: #fff6e0; border: 1px solid #f0d38c; color: var(--amber); border-radius: 10px; padding: 10px 16px;
        margin: 0 0 18px; }
.paths { display: flex; flex-wrap: wrap; gap: 18px; }
.paths > div { flex: 0 0 100%; min-width: 0; overflow: hidden; }
@media (min-width: 1000px) { .paths.two > div { flex-basis: calc(50% - 9px); } }
.scroll { overflow: auto; max-height: 460px; }
table { border-collapse: collapse; width: 100%; font-size: 13.5px; }
th { position: sticky; top: 0; background: white; text-align: left; color: var(--soft); font-weight: 560; }
th, td { padding: 5px 12px 5px 0; border-bottom: 1px solid var(--line); vertical-align: top; }
td.number, th.number { text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap; }
td.text { overflow-wrap: anywhere; }
tr.error td, tr.refused td { background: #fdecea; }
tr.warning td { background: #fff8e6; }
.tag { font-size: 12px; padding: 1px 8px; border-radius: 9px; background: #e8eef6; color: var(--blue);
       white-space: nowrap; }
tr.error .tag, tr.refused .tag { background: #f6cfcb; color: var(--red); }
tr.warning .tag { background: #fbe6ae; color: var(--amber); }
pre { background: var(--page); border-radius: 8px; padding: 12px; overflow: auto; font-size: 12.5px;
      max-height: 420px; }
summary { cursor: pointer; font-weight: 600; }
.cursor-layer { position: absolute; inset: 0; pointer-events: none; font-size: 12px; }
.cursor-layer > div { position: absolute; font-variant-numeric: tabular-nums; white-space: pre; }
.cursor-line { width: 0; border-left: 1px solid var(--ink); opacity: 0.7; }
.cursor-line.reference { border-left: 1px dashed var(--red); }
.cursor-time { background: var(--ink); color: white; border-radius: 4px; padding: 0 6px; }
.cursor-values { background: rgb(255 255 255 / 85%); border-radius: 4px; padding: 0 6px; text-align: right; }
.cursor-values span { display: block; line-height: 1.3; }
@media print { section, .card { break-inside: avoid; } }
"""


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
        _paths(path_figures(recorded, figures["units"])),
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
    plots = _section("Over time", time_plots(recorded, rows), HINT)
    body = [page_head(title, [recorded.path.name]), "<main>", _incomplete(recorded), plots, "</main></body></html>\n"]
    return "\n".join(body)


def page_head(title: str, details: Sequence[str] = ()) -> str:
    """The page before its main part."""
    below = f"<p>{' · '.join(map(escape, details))}</p>" if details else ""
    return (
        '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f'<meta http-equiv="Content-Security-Policy" content="{SECURITY}">'
        f"<title>{escape(title)}</title><style>{COLOURS}{STYLE}</style><script>{get_plotlyjs()}</script></head><body>\n"
        f"<header><h1>{escape(title)}</h1>{below}</header>"
    )


def _incomplete(recorded: Recorded) -> str:
    return "" if recorded.complete else f'<p class="warn">Incomplete recording: {escape(recorded.missing)}.</p>'


def _cards(figures: dict[str, Any]) -> str:
    cards: list[tuple[str, str, bool]] = [
        ("program time", _value(figures["program_time_s"], "s", 3), False),
        ("recorded time", _value(figures["duration_s"], "s", 3), False),
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
    body = "".join(
        f'<div class="card{" bad" if bad else ""}"><b>{escape(value)}</b><span>{escape(label)}</span></div>'
        for label, value, bad in cards
    )
    return f'<div class="cards">{body}</div>'


def _value(value: float | None, unit: str, digits: int) -> str:
    return "–" if value is None else f"{value:.{digits}f} {unit}"


def _paths(figures: list[go.Figure]) -> str:
    if not figures:
        return ""
    plots = "".join(f"<div>{_plot(figure, f'path{number}')}</div>" for number, figure in enumerate(figures))
    style = "paths two" if len(figures) > 1 else "paths"
    return _section("Path", f'<div class="{style}">{plots}</div>', "Actual position, coloured by the actual feed.")


def _times(recorded: Recorded, units: dict[str, str]) -> str:
    if not recorded.states:
        return _section("Over time", "", "The recording holds no states.")
    still = standing(recorded)
    notes = [HINT, f"Without plots, as they do not move: {', '.join(still)}."] if still else [HINT]
    plots = time_plots(recorded, list(time_rows(recorded, units, torque_units(recorded))))
    return _section("Over time", plots, " ".join(notes))


def time_plots(recorded: Recorded, rows: list[PlotRow]) -> str:
    """The plots with every cycle of their lines, and the script that zooms them."""
    columns = json.dumps(time_columns(recorded, rows), separators=(",", ":"))
    return (
        f"{_plot(rows_figure(recorded, rows), 'time')}"
        f'<script type="application/json" id="columns">{columns}</script><script>{SCRIPT}</script>'
    )


def _plot(figure: go.Figure, name: str) -> str:
    text: str = figure.to_html(full_html=False, include_plotlyjs=False, config=CONFIG, div_id=name)
    return text


def _events(events: list[Event], cycle_time: float) -> str:
    rows = [
        (
            Severity(event.severity).name.lower() if event.severity in list(Severity) else "",
            [
                _number(event.cycle * cycle_time, 3),
                _number(event.cycle),
                _tag(
                    Severity(event.severity).name.lower() if event.severity in list(Severity) else str(event.severity)
                ),
                _name(event.source),
                _name(f"P-ERR-{event.error_id}" if event.error_id else ""),
                _text(event.text),
                _number(event.line) if event.line else _text(""),
            ],
        )
        for event in events[:MOST_ROWS]
    ]
    head = ["time in s", "cycle", "", "source", "number", "text", "line"]
    return _section("Events", _table(head, rows), _count(len(events), "event"))


def _commands(recorded: Recorded, units: dict[str, str]) -> str:
    """`units`: mm or deg by axis and spindle."""
    commands, cycle_time = recorded.commands, recorded.cycle_time_ns * 1e-9
    rows = [
        (
            "" if command.accepted else "refused",
            [
                _number(command.cycle * cycle_time, 3),
                _number(command.cycle),
                _name(command.target),
                _name(command.command.replace("_", " ")),
                _text(argument_words(command.arguments_json, units.get(command.target, ""))),
                _tag("accepted" if command.accepted else "refused"),
                _text(f"P-ERR-{command.error_id} {command.message}" if command.error_id else command.message),
            ],
        )
        for command in commands[:MOST_ROWS]
    ]
    head = ["time in s", "cycle", "to", "command", "arguments", "", "answer"]
    return _section("Commands", _table(head, rows), _count(len(commands), "command"))


def _nodes(nodes: dict[str, dict[str, str]]) -> str:
    if not nodes:
        return ""
    keys = list(dict.fromkeys(key for values in nodes.values() for key in values))
    rows = [("", [_text(name), *(_text(values.get(key, "")) for key in keys)]) for name, values in nodes.items()]
    return _section("Nodes", _table(["node", *keys], rows), "Last values that each node reported on /diagnostics.")


def _topics(recorded: Recorded) -> str:
    rows = [
        (
            "",
            [
                _text(info.topic),
                _text(info.type_name),
                _number(info.count),
                _number((info.first_ns - recorded.start_ns) * 1e-9, 3),
                _number((info.last_ns - recorded.start_ns) * 1e-9, 3),
            ],
        )
        for info in sorted(recorded.topics.values(), key=lambda info: info.topic)
    ]
    table = _table(["topic", "type", "messages", "from s", "to s"], rows)
    return f"<section><details><summary>Topics</summary>{table}</details></section>"


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


def _section(title: str, body: str, note: str = "") -> str:
    text = f'<p class="note">{escape(note)}</p>' if note else ""
    return f"<section><h2>{escape(title)}</h2>{text}{body}</section>"


def _count(number: int, what: str) -> str:
    if number == 0:
        return f"No {what}s."
    return f"The first {MOST_ROWS} of {number} {what}s." if number > MOST_ROWS else ""


def _table(head: Sequence[str], rows: Iterable[tuple[str, list[str]]]) -> str:
    lines = [
        f'<tr class="{style}">{"".join(cells)}</tr>' if style else f"<tr>{''.join(cells)}</tr>" for style, cells in rows
    ]
    if not lines:
        return ""
    heads = "".join(
        f'<th class="number">{escape(title)}</th>' if title in NUMBERS else f"<th>{escape(title)}</th>"
        for title in head
    )
    return f'<div class="scroll"><table><thead><tr>{heads}</tr></thead><tbody>{"".join(lines)}</tbody></table></div>'


def _number(value: float, digits: int = 0) -> str:
    return f'<td class="number">{value:.{digits}f}</td>'


def _text(value: str) -> str:
    return f'<td class="text">{escape(value)}</td>'


def _name(value: str) -> str:
    return f"<td>{escape(value)}</td>"


def _tag(value: str) -> str:
    return f'<td><span class="tag">{escape(value)}</span></td>'
