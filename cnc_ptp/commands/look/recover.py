"""`cnc_ptp recover`: what is whole of a damaged or cut recording."""

from __future__ import annotations

from contextlib import suppress
from math import isnan
from pathlib import Path

import cnc_ptp.recording
from cnc_ptp.commands.output_file import check_output
from cnc_ptp.errors import CncError
from cnc_ptp.recording.bag import FILE
from cnc_ptp.recording.recovery import recover


def recover_file(recording: str, output: str) -> int:
    """Writes `output`; prints what is in it, what was wrong and what is lost."""
    path = Path(recording)
    check_output(output, recording=str(path.parent if path.name == FILE else path))
    recovered = recover(recording, output)
    print(f"{output}: {recovered.messages} messages{span_of(output)}")
    for text in recovered.mended:
        print(f"note: {text}")
    for text in recovered.lost:
        print(f"lost: {text}")
    return 0


def span_of(recording: str) -> str:
    """From when to when it reaches; empty where its times cannot be read."""
    with suppress(CncError), cnc_ptp.recording.open(recording) as saved:
        first, last = saved.recorded_span()
        return "" if isnan(first) else f", {first:.10g} s to {last:.10g} s"
    return ""
