"""A drawing as SVG: the same bytes for the same motion, small, readable on light and on dark pages."""

from __future__ import annotations

import io
import re
from typing import Any

import matplotlib
from matplotlib.figure import Figure

from cnc_ptp.plots.colours import DARK

FONTS = '"Helvetica Neue", Helvetica, Arial, "Liberation Sans", "DejaVu Sans", sans-serif'
SETTINGS: dict[Any, Any] = {
    "svg.hashsalt": "cnc_ptp",
    "svg.fonttype": "none",
    "font.sans-serif": ["DejaVu Sans"],
    "path.simplify_threshold": 0.05,
}
"""Fixed names of elements, text as text, lines without points that nobody sees (a twentieth of a pixel)."""

HEAD = '<style type="text/css">'
LONG_NUMBER = re.compile(r"-?\d+\.\d{3,}")
TAG = re.compile(r"<[^>]*>")


def svg_text(drawing: Figure, *, title: str) -> str:
    """The drawing as SVG with the given title, without date and without versions."""
    buffer = io.StringIO()
    with matplotlib.rc_context(SETTINGS):
        drawing.savefig(buffer, format="svg", metadata={"Date": None, "Creator": None, "Title": title})
    text = TAG.sub(lambda tag: short_numbers(tag[0]), buffer.getvalue())
    text = "\n".join(line.rstrip() for line in text.splitlines()) + "\n"
    return text.replace(HEAD, HEAD + style(), 1)


def short_numbers(tag: str) -> str:
    """Coordinates to a hundredth of a point; the text between tags is words."""
    return LONG_NUMBER.sub(lambda match: f"{float(match[0]):.2f}", tag)


def style() -> str:
    """Fonts, and the colours of dark pages: the file itself has those of light ones, for viewers that know no CSS."""
    rules = [
        f'[style*="{kind}: {light}"]{{{kind}:{dark}!important}}'
        for light, dark in DARK.items()
        for kind in ("fill", "stroke")
    ]
    dark = "\n".join(rules)
    return f"text{{font-family:{FONTS}!important}}\n@media (prefers-color-scheme: dark){{\n{dark}\n}}\n"
