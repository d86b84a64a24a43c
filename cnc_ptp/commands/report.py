"""`cnc_ptp report`: one HTML page of a recording."""

from __future__ import annotations

import json
from datetime import UTC, datetime
from pathlib import Path

from cnc_ptp.commands.output_file import check_page
from cnc_ptp.recording.reader import Recorded, read_recording
from cnc_ptp.recording.report import write_report


def report(recording: str, output: str) -> int:
    """Writes the page; tells when the recording was cut off."""
    check_page(output, recording=recording)
    recorded = read_recording(recording)
    made = datetime.now(tz=UTC).strftime("%Y-%m-%d %H:%M UTC")
    write_report(recorded, output, program=program_of(recorded), date=made)
    size = Path(output).stat().st_size / 1e6
    print(f"{output}: {size:.1f} MB, cycles 0 to {recorded.last_cycle}")
    if not recorded.complete:
        print(f"note: {recorded.missing}")
    return 0


def program_of(recorded: Recorded) -> str:
    """File name of the first NC program that was loaded, empty if none was."""
    loads = (record for record in recorded.commands if record.command == "load" and record.accepted)
    return next((str(json.loads(record.arguments_json)["program"]) for record in loads), "")
