"""`cnc_ptp report`: one HTML page of a recording, or of two on top of each other."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path

from cnc_ptp.commands.output_file import check_page, write_output
from cnc_ptp.errors import CncError
from cnc_ptp.plots.comparison import page_of, units_of
from cnc_ptp.plots.report import report_page
from cnc_ptp.recording.command_words import json_object
from cnc_ptp.recording.difference import PROGRAM, compared
from cnc_ptp.recording.long_recording import read_own
from cnc_ptp.recording.reader import Recorded
from cnc_ptp.recording.selection import NOT_RECORDED, selected


def report(
    recording: str,
    output: str,
    begin: float | None,
    end: float | None,
    axes: Sequence[str],
    compare: str | None = None,
    align: str = PROGRAM,
) -> int:
    """Writes the page, of a part if asked for, alone or against another recording; warns of one that was cut off."""
    check_page(output, recording=recording, other_recording=compare)
    lines: list[str] = []
    whole = read_own(recording, begin, end)
    recorded = part_of(whole, begin, end, axes)
    made = datetime.now(tz=UTC).strftime("%Y-%m-%d %H:%M UTC")
    if compare is None:
        page = report_page(recorded, program=program_of(whole), date=made)
    else:
        other = part_of(read_own(compare, begin, end), begin, end, axes)
        both = compared(recorded, other, align)
        page, lines = page_of(both, date=made), both.lines(units_of(both.pair))
    write_output(output, page, remains="the recording is unchanged")
    size = Path(output).stat().st_size / 1e6
    first = min((int(rows["cycle"].min()) for rows in recorded.states.values()), default=0)
    print(f"{output}: {size:.1f} MB, cycles {first} to {recorded.last_cycle}")
    for line in lines:
        print(line)
    if not recorded.complete:
        print(f"note: {recorded.missing}")
    return 0


def part_of(whole: Recorded, begin: float | None, end: float | None, axes: Sequence[str]) -> Recorded:
    """Raises CncError 26011 for one in which there are no states."""
    part = selected(whole, begin=begin, end=end, units=axes)
    if not part.states:
        raise CncError(NOT_RECORDED, f"recording {whole.path}: holds no states", "nothing was drawn")
    return part


def program_of(recorded: Recorded) -> str:
    """File name of the first NC program that was loaded, empty if none was."""
    loads = (record for record in recorded.commands if record.command == "load" and record.accepted)
    given = (json_object(record.arguments_json) or {} for record in loads)
    return next((str(values["program"]) for values in given if "program" in values), "")
