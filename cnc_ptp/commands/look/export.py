"""`cnc_ptp export`: a topic of a recording as CSV, Parquet or NumPy's .npz."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import cnc_ptp.recording
from cnc_ptp.commands.output_file import check_output
from cnc_ptp.commissioning.faults import BAD_OUTPUT
from cnc_ptp.errors import CncError
from cnc_ptp.recording.export import WRITERS, export_topic
from cnc_ptp.recording.overwriting import replacing, why_not_written


def export(
    recording: str, topic: str, fields: Sequence[str], begin: float | None, end: float | None, output: str
) -> int:
    """Writes `fields` of a topic, all without any, from `begin` to `end` in s. A file that fails is not left."""
    file = Path(output)
    if file.suffix.lower() not in WRITERS:
        *others, last = WRITERS
        wrong = f"{output}: the file name of an export must end in {', '.join(others)} or {last}"
        raise CncError(BAD_OUTPUT, wrong, "nothing was started")
    check_output(output, recording=recording)
    name = topic if topic.startswith("/") else f"/{topic}"
    with cnc_ptp.recording.open(recording) as opened:
        try:
            with replacing(file) as part:
                count = export_topic(opened, name, part, *fields, start=begin, end=end)
        except OSError as error:
            raise CncError(
                BAD_OUTPUT, f"{output} cannot be written: {why_not_written(error)}", "the recording is unchanged"
            ) from None
    print(f"{output}: {count} rows of {name}")
    if opened.missing:
        print(f"note: {opened.missing}")
    return 0
