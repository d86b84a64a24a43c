"""`cnc_ptp diff`, `cnc_ptp replay --diff`: two recorded runs beside each other, as a table and as a page."""

from __future__ import annotations

from pathlib import Path

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from cnc_ptp.commands.output_file import check_page, write_output
from cnc_ptp.recording.run_difference import Both, RunDifference


def diff(first: str, second: str, output: str | None) -> int:
    """Prints where the runs part; `output`: a page of both."""
    check_diff_page(output, recording=first, second_recording=second)
    show_difference(first, second, output, (Path(first).name, Path(second).name))
    return 0


def check_diff_page(page: str | None, **inputs: str | None) -> None:
    """Raises CncError 27030 before anything is computed."""
    if page is not None:
        check_page(page, **inputs)


def show_difference(first: str | Path, second: str | Path, page: str | None, names: tuple[str, str]) -> None:
    """`names` of the runs on the page. Raises CncError as difference."""
    with Both(first, second) as both:
        found = both.difference()
        print_difference(found)
        if page is not None:
            from cnc_ptp.plots.difference_page import difference_page

            write_output(page, difference_page(both, found, names))
            print(f"{page}: {Path(page).stat().st_size / 1e6:.1f} MB")


def print_difference(found: RunDifference) -> None:
    """A table of all columns that differ."""
    console = Console(highlight=False, soft_wrap=True)
    parted = [row for row in found.rows if row.parts_at is not None]
    console.print(f"compared from {found.begin:g} s to {found.end:g} s", markup=False)
    for channel, (one, two) in found.program_times.items():
        console.print(f"program time {channel}: {one:.3f} s -> {two:.3f} s ({two - one:+.3f} s)", markup=False)
    if not parted:
        console.print("both runs are equal to the bit")
        return
    console.print(f"the runs part at {found.parts_at:g} s")
    table = Table("unit", "column", "largest", "now", "differ by", "at s", "part at s", box=SIMPLE_HEAD, pad_edge=False)
    for column in table.columns:
        column.no_wrap = True
    for row in parted:
        numbers = [f"{value:.6g}" for value in (row.first, row.second, row.difference)]
        table.add_row(row.unit, row.column.replace("_", " "), *numbers, f"{row.at:.3f}", f"{row.parts_at:.3f}")
    console.print(table)
