"""The rows of a cycle block of the channel while they are made."""

from __future__ import annotations

from collections.abc import Sequence

from cnc_ptp.path.shape import AxisState, AxisStates
from cnc_ptp.path.thread_place import ThreadPlace


class CycleRows:
    """The cycles of a block as they are made: the state of each axis, and the columns of ChannelState."""

    def __init__(self, *, with_spindle: bool) -> None:
        """`with_spindle`: a spindle is an axis of the path."""
        self.with_spindle = with_spindle
        self.axes: list[AxisStates] = []
        self.spindle: list[AxisState] = []
        """Of the spindle on the path."""
        self.thread_places: dict[int, ThreadPlace] = {}
        """By row, of those within a thread."""
        self.line: list[int] = []
        self.block_number: list[int] = []
        self.path_velocity: list[float] = []
        self.programmed_feed: list[float] = []
        self.override_percent: list[float] = []
        self.distance_to_go: list[float] = []
        self.state: list[int] = []
        self.error_id: list[int] = []
        self.cut_end = -1
        """The last row in which the path moves at a feed, -1 none."""

    def __len__(self) -> int:
        return len(self.axes)

    def note_thread(self, places: Sequence[ThreadPlace | None]) -> None:
        """Of the rows that come next."""
        begin = len(self)
        for number, place in enumerate(places):
            if place is not None:
                self.thread_places[begin + number] = place
