"""What `bench web` takes from the recording of its run."""

from __future__ import annotations

from pathlib import Path

import pytest
from mcap.writer import Writer
from rclpy.serialization import serialize_message

from bench.web import lateness_p99
from cnc_ptp.nodes.unit.lateness import Lateness

SECOND = 1_000_000_000


@pytest.mark.motion_unchecked("messages of one topic, of no machine")
def test_the_lateness_is_that_of_the_latest_node_while_the_scopes_were_looked_at(tmp_path: Path) -> None:
    """A hundred blocks a second: late by 90 ms in the first second, by 2 ms (y: 7.25 ms) in those that count, then by 50."""
    path = tmp_path / "run.mcap"
    late = {"x": Lateness(), "y": Lateness()}
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start()
        schema = writer.register_schema("cnc_ptp/msg/LatenessHistogram", "ros2msg", b"")
        channel = writer.register_channel("/lateness", "cdr", schema)
        for second in range(6):
            for source, of_source in late.items():
                now = 90_000 if second == 0 else 50_000 if second == 5 else 2_000 if source == "x" else 7_250
                for _ in range(100):
                    of_source.add(now)
                at = (second + 1) * SECOND
                writer.add_message(channel, at, serialize_message(of_source.message(source)), at)
        writer.finish()
    assert lateness_p99(str(path), SECOND + 1, 5 * SECOND + 1) == 7.3  # the upper end of its step
    assert lateness_p99(str(path), 5 * SECOND + 1, 7 * SECOND) == 50.1
