"""A recording of a long program does not hold its text again and again."""

from __future__ import annotations

import tracemalloc
from pathlib import Path

from machine_support import ROOT

from cnc_ptp.parameters import machine_text
from cnc_ptp.protocol.blocks import CommandRecord
from cnc_ptp.recording.reader import read_recording
from cnc_ptp.recording.writer import Recording

MACHINE = ROOT / "config" / "mill.yaml"


def test_a_long_program_is_not_copied_again_and_again(tmp_path: Path) -> None:
    text = "X1.000 Y2.000\n" * 500_000
    path = tmp_path / "long.mcap"
    with Recording(path, machine_text(MACHINE)) as recording:
        record = CommandRecord(0, "channel", "load", {"program": "long.nc", "text": text}, True, 0, "")
        tracemalloc.start()
        recording.command(record)
        recording.flush()
        largest = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
    assert largest < 2.6 * len(text)
    (found,) = read_recording(path).commands
    assert len(found.arguments_json) > len(text)
