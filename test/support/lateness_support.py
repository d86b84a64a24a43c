"""Recordings of what nodes tell of their lateness."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from mcap.writer import Writer
from rclpy.serialization import serialize_message

from cnc_ptp.nodes.unit.lateness import Lateness


def write_lateness(path: Path, seconds: Sequence[Mapping[str, float]]) -> None:
    """A recording of what nodes tell each second on /lateness: a hundred blocks more, all so many µs late, by node."""
    late: dict[str, Lateness] = {}
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start()
        schema = writer.register_schema("cnc_ptp/msg/LatenessHistogram", "ros2msg", b"")
        channel = writer.register_channel("/lateness", "cdr", schema)
        for number, of_second in enumerate(seconds, 1):
            for source, lateness_us in of_second.items():
                of_source = late.setdefault(source, Lateness())
                for _ in range(100):
                    of_source.add(int(lateness_us))
                at = 1_000_000_000 * number
                writer.add_message(channel, at, serialize_message(of_source.message(source)), at)
        writer.finish()
