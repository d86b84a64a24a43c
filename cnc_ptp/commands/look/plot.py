"""`cnc_ptp plot`: a picture of a recording, in the style of the figures of the documentation."""

from __future__ import annotations

from collections.abc import Sequence
from math import inf
from pathlib import Path

from cnc_ptp.commands.look.report import program_of
from cnc_ptp.commands.output_file import beside, write_output
from cnc_ptp.commands.picture_file import check_picture, picture_bytes, picture_kind
from cnc_ptp.errors import CncError
from cnc_ptp.plots.recording_picture import Heading, draw_rows
from cnc_ptp.plots.report import plots_page
from cnc_ptp.plots.report_figures import time_range
from cnc_ptp.recording.fields import chosen_rows, usual_rows
from cnc_ptp.recording.long_recording import read_for_report
from cnc_ptp.recording.reader import Recorded
from cnc_ptp.recording.rows import PlotRow
from cnc_ptp.recording.selection import NOT_RECORDED, selected
from cnc_ptp.recording.statistics import axis_units, in_machine_order, torque_units


def plot(
    recording: str,
    topics: Sequence[str],
    begin: float | None,
    end: float | None,
    axes: Sequence[str],
    output: str | None,
) -> int:
    """Draws the fields `topics`, or the usual ones; without `output` RECORDING.svg next to the recording."""
    output = output or beside(recording, ".svg")
    check_picture(output, recording=recording)
    whole = read_for_report(recording, begin, end, most_states=inf)  # every cycle: any field may be asked for
    program = program_of(whole)
    title = Path(program).name if program else whole.path.name
    recorded = in_machine_order(selected(whole, begin=begin, end=end, units=axes))
    rows = rows_of(recorded, topics)
    content = content_of(recorded, rows, title, picture_kind(output))
    write_output(output, content, remains="the recording is unchanged")
    begin, end = time_range(recorded)
    print(f"{output}: {len(rows)} plots, {begin:g} s to {end:g} s")
    if not recorded.complete:
        print(f"note: {recorded.missing}")
    return 0


def rows_of(recorded: Recorded, topics: Sequence[str]) -> list[PlotRow]:
    """The rows to draw. Raises CncError 26011 if there are none."""
    units = axis_units(recorded)
    rows = chosen_rows(recorded, topics, units, torque_units(recorded)) if topics else usual_rows(recorded, units)
    if not rows:
        if not recorded.states:
            raise CncError(NOT_RECORDED, f"recording {recorded.path}: holds no states", "nothing was drawn")
        reason = f"recording {recorded.path}: no axis and no spindle moves there"
        raise CncError(NOT_RECORDED, reason, "nothing was drawn, choose fields with --topics")
    return rows


def content_of(recorded: Recorded, rows: list[PlotRow], title: str, kind: str) -> str | bytes:
    if kind == "html":
        return plots_page(recorded, rows, title=title)
    begin, end = time_range(recorded)
    where = f"Recording {recorded.path.name}, {begin:g} s to {end:g} s."
    drawing = draw_rows(recorded, rows, Heading(title, where), (begin, end))
    return picture_bytes(drawing, kind, title=title)
