"""Pictures that commands write: .svg and .png drawn by Matplotlib, .html by Plotly as the reports are."""

from __future__ import annotations

import io
from collections.abc import Sequence
from html import escape

import plotly.graph_objects as go
from matplotlib.figure import Figure

from cnc_ptp.commands.output_file import check_output
from cnc_ptp.commissioning.faults import BAD_OUTPUT
from cnc_ptp.errors import CncError
from cnc_ptp.plots.colours import BLUE, GREEN, RED, YELLOW
from cnc_ptp.plots.page import page_head, plot_div
from cnc_ptp.plots.svg import svg_text

KINDS = ("svg", "png", "html")
COLOURS = (BLUE.set, RED.set, GREEN.set, YELLOW.set)


def picture_kind(output: str) -> str:
    """The ending without its dot, in small letters."""
    return output.rsplit(".", 1)[-1].lower()


def check_picture(output: str, **inputs: str | None) -> None:
    """Raises CncError 27030 for a picture that cannot be made or would overwrite an input: machine_file="…"."""
    if picture_kind(output) not in KINDS:
        *others, last = (f".{kind}" for kind in KINDS)
        wrong = f"{output}: the file name of a picture must end in {', '.join(others)} or {last}"
        raise CncError(BAD_OUTPUT, wrong, "nothing was started")
    check_output(output, **inputs)


def picture_bytes(drawing: Figure, kind: str, *, title: str) -> bytes:
    """An `svg` or `png` file, the same for the same drawing."""
    if kind == "svg":
        return svg_text(drawing, title=title).encode()
    buffer = io.BytesIO()
    drawing.savefig(buffer, format=kind, dpi=150, metadata={"Software": None})
    return buffer.getvalue()


def plot_page(plot: go.Figure, lines: Sequence[str]) -> str:
    """One self-contained HTML page: title (the first of `lines`), plot, and the other lines as a table of text."""
    table = escape("\n".join(lines[1:]))
    return (
        f"{page_head(lines[0])}<main>\n"
        f"<section>{plot_div(plot, 'plot')}</section><section><pre>{table}</pre></section></main></body></html>\n"
    )
