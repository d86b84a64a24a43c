"""`cnc_ptp report`: one HTML page of a recording."""

from __future__ import annotations

import json
from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path

from cnc_ptp.commands.output_file import check_page, write_output
from cnc_ptp.plots.report import report_page
from cnc_ptp.recording.long_recording import read_for_report
from cnc_ptp.recording.reader import Recorded
from cnc_ptp.recording.selection import selected


def report(recording: str, output: str, begin: float | None, end: float | None, axes: Sequence[str]) -> int:
    """Writes the page, of a part if asked for; warns when the recording was cut off."""
    check_page(output, recording=recording)
    whole = read_for_report(recording, begin, end)
    recorded = selected(whole, begin=begin, end=end, units=axes)
    made = datetime.now(tz=UTC).strftime("%Y-%m-%d %H:%M UTC")
    page = report_page(recorded, program=program_of(whole), date=made)
    write_output(output, page, remains="the recording is unchanged")
    size = Path(output).stat().st_size / 1e6
    first = min((int(rows["cycle"].min()) for rows in recorded.states.values()), default=0)
    print(f"{output}: {size:.1f} MB, cycles {first} to {recorded.last_cycle}")
    if not recorded.complete:
        print(f"note: {recorded.missing}")
    return 0


def program_of(recorded: Recorded) -> str:
    """File name of the first NC program that was loaded, empty if none was."""
    loads = (record for record in recorded.commands if record.command == "load" and record.accepted)
    return next((str(json.loads(record.arguments_json)["program"]) for record in loads), "")
