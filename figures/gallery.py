"""The gallery of all figures, docs/gallery.md: `python -m figures.gallery > docs/gallery.md`."""

from __future__ import annotations

import sys
from collections.abc import Iterator

from figures.scenario_head import ROOT, FigureScenario, read_head

INTRODUCTION = """\
# Gallery

Made by `python -m figures.gallery` from the heads of `examples/figures/*.yaml`; do not edit. `make figures` draws the
pictures again. In curves over time, thin dark lines are set values and broad light ones below them actual values.
"""
SUBJECTS = {
    "ptp": "[PTP axis functions](ptp.md)",
    "path": "[The path](path.md)",
    "slave": "[Slave axes](slaves.md)",
    "control": "[Position control](control.md)",
    "spindle": "[Spindles](spindles.md)",
    "thread": "[Threads](threads.md)",
    "caxis": "[C axis](caxis.md)",
    "turning": "[Turning](turning.md)",
    "plc": "[PLC](plc.md)",
}
"""First word of the file name, and the page that explains the figure."""


def gallery_markdown() -> str:
    """docs/gallery.md."""
    heads = [read_head(path) for path in sorted((ROOT / "examples" / "figures").glob("*.yaml"))]
    return "\n".join([INTRODUCTION, *(line for subject in SUBJECTS for line in subject_lines(subject, heads))])


def subject_lines(subject: str, heads: list[FigureScenario]) -> Iterator[str]:
    """The figures that one page explains."""
    yield f"## {SUBJECTS[subject]}\n"
    for head in heads:
        if head.name.startswith(f"{subject}_"):
            yield f"### {head.title}\n"
            yield f"{head.caption} Scenario: [{head.path.name}](../examples/figures/{head.path.name}).\n"
            yield f"![{head.title}](figures/{head.name}.svg)\n"


if __name__ == "__main__":
    sys.stdout.write(gallery_markdown())
