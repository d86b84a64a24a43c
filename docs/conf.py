"""The documentation site: `make docs` builds it into build/site."""

from typing import Any

from pygments.lexers.special import TextLexer

project = "cnc_ptp"
html_title = "cnc_ptp"
extensions = ["myst_parser"]
source_suffix = {".md": "markdown"}
myst_heading_anchors = 3  # as deep as links in the documents go; slugs are those of GitHub
highlight_language = "none"
html_theme = "furo"
html_show_copyright = False
html_show_sourcelink = False


def setup(app: Any) -> None:
    """State graphs are shown as text here; GitHub draws them."""
    app.add_lexer("mermaid", TextLexer)
