"""`cnc_ptp recover`: what is whole of a damaged or cut recording."""

from __future__ import annotations

from pathlib import Path

from cnc_ptp.commands.output_file import check_output
from cnc_ptp.recording.bag import FILE
from cnc_ptp.recording.recovery import recover


def recover_file(recording: str, output: str) -> int:
    """Writes `output`; prints what is in it and what is lost."""
    path = Path(recording)
    check_output(output, recording=str(path.parent if path.name == FILE else path))
    recovered = recover(recording, output)
    print(f"{output}: {recovered.messages} messages")
    for text in recovered.lost:
        print(f"lost: {text}")
    return 0
