"""`python -m figures`: draws the figures, one line each."""

from __future__ import annotations

import sys
from pathlib import Path

import click
from rich.console import Console

from cnc_ptp.plots.svg import svg_text
from figures.kinds import draw
from figures.run import run_figure
from figures.scenario_head import ROOT, FigureError, read_head

SCENARIOS, PICTURES = ROOT / "examples" / "figures", ROOT / "docs" / "figures"
FOLDER = click.Path(file_okay=False, path_type=Path)


def draw_figure(scenario: Path, pictures: Path) -> str:
    """Runs a scenario and writes its picture; a line about it. Raises FigureError."""
    figure = read_head(scenario)
    run = run_figure(figure)
    text = svg_text(draw(figure, run), title=figure.title)
    picture = pictures / f"{figure.name}.svg"
    change = "written" if write_if_changed(picture, text) else "unchanged"
    size = len(text.encode()) / 1000
    return f"{figure.name}: {run.cycles * run.cycle_time:.2f} s of machine time, {size:.0f} kB, {change}"


def write_if_changed(path: Path, text: str) -> bool:
    """Writes a file unless it has that text already; True when written."""
    if path.exists() and path.read_text(encoding="utf-8") == text:
        return False
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")
    return True


@click.command(context_settings={"help_option_names": ["-h", "--help"]})
@click.argument("names", nargs=-1)
@click.option("--scenarios", type=FOLDER, default=SCENARIOS, help="Folder of the scenarios.")
@click.option("--pictures", type=FOLDER, default=PICTURES, help="Folder of the pictures.")
def main(names: tuple[str, ...], scenarios: Path, pictures: Path) -> None:
    """Run the scenarios NAMES (all of the folder if none is given) and draw a picture of each.

    Status 1 when a figure cannot be drawn; the others are drawn all the same.
    """
    known = {path.stem: path for path in sorted(scenarios.glob("*.yaml"))}
    for name in names:
        if name not in known:
            raise click.BadParameter(f"there is no scenario {scenarios / name}.yaml; nothing was drawn")
    failed = False
    console = Console(highlight=False, soft_wrap=True)
    for name in names or known:
        try:
            console.print(draw_figure(known[name], pictures), markup=False)
        except FigureError as error:
            failed = True
            console.print(str(error), style="red", markup=False)
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
