"""Memory of a recorder beside a PLC that writes four values a millisecond, of which each block takes over the newest."""

import gc
import tracemalloc
from dataclasses import replace

from machine_support import MILL, ROOT, MachineBench

from cnc_ptp.machine.wiring import unit_kinds
from cnc_ptp.parameters import machine_text
from cnc_ptp.protocol.blocks import CommandRecord, CycleTick, json_of
from cnc_ptp.recording.on_demand import OnDemand, Snapshots
from cnc_ptp.recording.settings import Settings
from cnc_ptp.recording.writer import Recording
from cnc_ptp.wire.stamps import Stamps

FLOODED = ("x", "y", "z", "channel")
OVERRIDE = bytes(24)
WARM_UP, SECONDS = 3, 5


def test_a_recorder_gains_next_to_nothing(tmp_path):
    """Indexes of chunks and compressed commands, some kB per second. As objects these were 400 kB per second."""
    bench = MachineBench(machine=MILL, end_when_idle=False).run(0.01)
    blocks = {name: of_unit[-1] for name, of_unit in bench.blocks.items()}
    text, stamps = machine_text(ROOT / "config" / "mill.yaml"), Stamps(0, 1_000_000)
    recorder = OnDemand(
        text,
        stamps,
        unit_kinds(MILL),
        current=Recording(tmp_path / "run.mcap", text),
        settings=Settings(),
        snapshots=Snapshots(),
        publish=lambda event: None,
    )

    def run(first, last):
        for cycle in range(1000 * first, 1000 * last, 10):
            recorder.tick(CycleTick(cycle, 10))
            for name, block in blocks.items():
                recorder.block(name, replace(block, first_cycle=cycle))
            for number, unit in enumerate(FLOODED):
                arguments = json_of({"percent": 50.0 + (cycle // 10 + number) % 41})
                recorder.command(CommandRecord(cycle, unit, "set_override", arguments, True, 0, "", cycle))
                for millisecond in range(10):
                    recorder.raw(
                        f"/{unit}/override", "cnc_ptp/msg/Override", OVERRIDE, (cycle + millisecond) * 1_000_000
                    )
            recorder.flush_if_due(cycle / 1000.0)

    tracemalloc.start()
    try:
        run(0, WARM_UP)
        gc.collect()
        before = tracemalloc.get_traced_memory()[0]
        run(WARM_UP, WARM_UP + SECONDS)
        gc.collect()
        gained = tracemalloc.get_traced_memory()[0] - before
    finally:
        tracemalloc.stop()
        recorder.close()
    assert gained / SECONDS < 20_000
