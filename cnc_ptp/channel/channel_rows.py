"""What a channel has at hand while it makes a block: its cycles as rows, and a program that waits interpreted."""

from __future__ import annotations

from typing import NamedTuple

from cnc_ptp.nc.canonical import CanonicalBlock
from cnc_ptp.nc.program import ModalState, Program
from cnc_ptp.path.path_motion import AxisStates


class Rows:
    """The cycles of a block as they are made: the state of each axis, and the columns of ChannelState."""

    def __init__(self) -> None:
        self.axes: list[AxisStates] = []
        self.line: list[int] = []
        self.block_number: list[int] = []
        self.path_velocity: list[float] = []
        self.programmed_feed: list[float] = []
        self.override_percent: list[float] = []
        self.distance_to_go: list[float] = []
        self.state: list[int] = []
        self.error_id: list[int] = []

    def __len__(self) -> int:
        return len(self.axes)


class Prepared(NamedTuple):
    """A program that was interpreted before its load, from the position `start` and the modal state `modal`."""

    text: str
    program: Program
    start: tuple[float, ...]
    modal: ModalState
    modal_at_end: ModalState
    blocks: list[CanonicalBlock]
