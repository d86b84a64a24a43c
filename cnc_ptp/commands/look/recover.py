"""`cnc_ptp recover`: what is whole of a damaged or cut recording."""

from __future__ import annotations

from cnc_ptp.commands.output_file import check_output
from cnc_ptp.recording.recovery import recover


def recover_file(recording: str, output: str) -> int:
    """Writes `output`; prints what is in it and what is lost."""
    check_output(output, recording=recording)
    recovered = recover(recording, output)
    print(f"{output}: {recovered.messages} messages")
    for text in recovered.lost:
        print(f"lost: {text}")
    return 0
