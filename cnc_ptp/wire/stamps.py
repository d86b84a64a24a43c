"""When a cycle counts."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from cnc_ptp.wire.layout import Header, header_at

Times = npt.NDArray[np.uint64]


class Stamps:
    """Cycle number -> ns since the epoch."""

    def __init__(self, start_ns: int, cycle_time_ns: int) -> None:
        self.start_ns = start_ns
        self.cycle_time_ns = cycle_time_ns

    def at(self, cycle: int) -> int:
        return self.start_ns + cycle * self.cycle_time_ns

    def at_all(self, cycles: Times) -> Times:
        return np.uint64(self.start_ns) + cycles * np.uint64(self.cycle_time_ns)

    def header_of(self, value: Any) -> Header:
        """The header of an event, command or handshake (cycle) or of a block (first_cycle)."""
        return header_at(self.at(value.cycle if hasattr(value, "cycle") else value.first_cycle))
