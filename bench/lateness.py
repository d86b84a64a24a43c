"""How late blocks were in a part of a recorded run, from what its nodes have told on /lateness."""

from __future__ import annotations

from collections.abc import Iterable
from math import nan
from pathlib import Path

from mcap.reader import make_reader
from rclpy.serialization import deserialize_message

from cnc_ptp.msg import LatenessHistogram
from cnc_ptp.nodes.topics import LATENESS
from cnc_ptp.nodes.unit.lateness import Lateness

Told = tuple[int, LatenessHistogram]
"""The time of a message in ns of the wall clock, and the message."""


def told(recording: str | Path) -> list[Told]:
    """What all nodes have told, in the order of time."""
    with Path(recording).open("rb") as file:
        messages = make_reader(file).iter_messages(topics=[f"/{LATENESS}"])
        return [(each.log_time, deserialize_message(each.data, LatenessHistogram)) for _, _, each in messages]


def lateness_p99(messages: Iterable[Told], begin: int, end: int) -> float:
    """Of the latest node from `begin` to `end` in ms; NaN if none has told anything.

    Nodes tell what was since their start.
    """
    first: dict[str, LatenessHistogram] = {}
    last: dict[str, LatenessHistogram] = {}
    for time, message in messages:
        if time <= end:
            (first if time <= begin else last)[message.source] = message
    late = (Lateness.between(first.get(source), message) for source, message in last.items())
    return max((each.percentile_us(99.0) / 1000.0 for each in late), default=nan)
