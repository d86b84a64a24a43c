"""A figure's run as a recording shows it, for pictures of what reports draw, too."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory

from cnc_ptp.parameters import machine_text
from cnc_ptp.recording.reader import Recorded, read_recording
from cnc_ptp.recording.writer import Recording
from figures.run import FigureRun
from figures.scenario_head import FigureScenario


def recorded(figure: FigureScenario, run: FigureRun) -> Recorded:
    """Its blocks, written and read back."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / "run.mcap"
        text = machine_text(figure.machine_path)
        with Recording(path, text, cycle_time_ns=run.machine.cycle_time_us * 1000) as recording:
            for tick in run.ticks:
                for name, output in tick.items():
                    recording.block(name, output.block)
        return read_recording(path)
