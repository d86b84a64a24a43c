"""Parts of a page: head, sections, cards, tables. It is one file, to be opened without a network."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape

import plotly.graph_objects as go
from plotly.offline import get_plotlyjs

from cnc_ptp.plots.colours import BLUE, EDGE, INK, RED, SOFT

MOST_ROWS = 1000
NUMBER = ' class="number"'
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
.cursor-layer { position: absolute; inset: 0; pointer-events: none; font-size: 12px; overflow: hidden; }
.cursor-layer > div { position: absolute; font-variant-numeric: tabular-nums; white-space: pre; }
.cursor-line { width: 0; border-left: 1px solid var(--ink); opacity: 0.7; }
.cursor-line.mark { border-left: 1px dashed var(--red); opacity: 1; }
.cursor-name { color: white; background: var(--red); border-radius: 4px; padding: 0 5px; }
.cursor-time { background: var(--ink); color: white; border-radius: 4px; padding: 0 6px; }
.cursor-values { background: rgb(255 255 255 / 85%); border-radius: 4px; padding: 0 6px; text-align: right; }
.cursor-values span { display: block; line-height: 1.3; }
.cursor-place { width: 13px; height: 13px; margin: -7px 0 0 -7px; border: 2px solid white; border-radius: 50%;
                background: var(--ink); box-shadow: 0 0 0 1px var(--ink); }
.legend { display: flex; flex-wrap: wrap; gap: 2px 4px; margin: 0 0 4px; }
.legend button { border: 0; background: none; color: inherit; font: inherit; font-size: 12.5px; padding: 1px 6px;
                 cursor: pointer; border-radius: 6px; }
.legend button:hover { background: var(--page); }
.legend button.off { opacity: 0.35; }
.legend i { display: inline-block; width: 13px; height: 9px; border-radius: 2px; margin-right: 5px; }
#measured { margin: 6px 0 10px; }
#time { touch-action: pan-y; }
.paper { display: none; }
@media (max-width: 640px) {
  header { padding: 14px 14px 12px; }
  h1 { font-size: 20px; overflow-wrap: anywhere; }
  main { padding: 10px 8px 32px; }
  section { padding: 10px 8px 12px; border-radius: 8px; }
  .cards { grid-template-columns: repeat(auto-fill, minmax(130px, 1fr)); gap: 8px; }
  .card { padding: 8px 10px; }
  .card b { font-size: 18px; }
  table { font-size: 12.5px; }
  th, td { padding-right: 8px; }
  td.text { min-width: 11em; }
  .js-plotly-plot:not(#time) .modebar-container { display: none; }
}
@page { size: A4; margin: 12mm 10mm; }
@media print {
  * { print-color-adjust: exact; -webkit-print-color-adjust: exact; }
  body { background: white; font-size: 12px; }
  header { padding: 0 0 8px; }
  main { padding: 8px 0 0; max-width: none; }
  section { border: 0; padding: 0; border-radius: 0; }
  .card, .js-plotly-plot, tr, .note { break-inside: avoid; }
  .paper > div:not(:last-child) { break-after: page; }
  section:has(> .paper), section:has(> .paths) ~ section:has(> .paths) { break-before: page; }
  .paths { display: block; }
  h2, .note { break-after: avoid; }
  thead { display: table-header-group; }
  th { position: static; }
  .scroll, pre { max-height: none; overflow: visible; }
  table { font-size: 10.5px; }
  pre { font-size: 9.5px; white-space: pre-wrap; overflow-wrap: anywhere; }
  .modebar-container, .updatemenu-container, #time { display: none !important; }
  .paper { display: block; }
}
"""


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


def card_grid(cards: Iterable[tuple[str, str, bool]]) -> str:
    """Figures of a page: label, value, and whether it is bad."""
    body = "".join(
        f'<div class="card{" bad" if bad else ""}"><b>{escape(value)}</b><span>{escape(label)}</span></div>'
        for label, value, bad in cards
    )
    return f'<div class="cards">{body}</div>'


def value_text(value: float | None, unit: str, digits: int) -> str:
    return "–" if value is None else f"{value:.{digits}f} {unit}"


def plot_div(figure: go.Figure, name: str) -> str:
    text: str = figure.to_html(full_html=False, include_plotlyjs=False, config=CONFIG, div_id=name)
    return text


def section(title: str, body: str, note: str = "") -> str:
    text = f'<p class="note">{escape(note)}</p>' if note else ""
    return f"<section><h2>{escape(title)}</h2>{text}{body}</section>"


def count_note(number: int, what: str) -> str:
    if number == 0:
        return f"No {what}s."
    return f"The first {MOST_ROWS} of {number} {what}s." if number > MOST_ROWS else ""


def table(head: Sequence[str], rows: Iterable[tuple[str, list[str]]]) -> str:
    """Empty without rows; the head of a column with numbers is on their side."""
    known = list(rows)
    if not known:
        return ""
    lines = [
        f'<tr class="{style}">{"".join(cells)}</tr>' if style else f"<tr>{''.join(cells)}</tr>"
        for style, cells in known
    ]
    heads = "".join(
        f"<th{NUMBER}>{escape(title)}</th>"
        if any(cell.startswith(f"<td{NUMBER}>") for cell in column)
        else f"<th>{escape(title)}</th>"
        for title, *column in zip(head, *[cells for _, cells in known], strict=True)
    )
    return f'<div class="scroll"><table><thead><tr>{heads}</tr></thead><tbody>{"".join(lines)}</tbody></table></div>'


def number_cell(value: float, digits: int = 0) -> str:
    return f"<td{NUMBER}>{value:.{digits}f}</td>"


def text_cell(value: str) -> str:
    return f'<td class="text">{escape(value)}</td>'


def name_cell(value: str) -> str:
    return f"<td>{escape(value)}</td>"


def tag_cell(value: str) -> str:
    return f'<td><span class="tag">{escape(value)}</span></td>'
