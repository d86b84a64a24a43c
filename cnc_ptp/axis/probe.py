"""The measuring probe of a simulated axis: an input that is on behind a surface, latched to the exact crossing."""

from __future__ import annotations

from cnc_ptp.parameters.view.probe_view import ProbeParameters
from cnc_ptp.protocol.blocks import AxisBlock


class Probe:
    """The input of one axis, block by block."""

    def __init__(self, parameters: ProbeParameters) -> None:
        self._parameters = parameters
        self._last: float | None = None
        """Actual position in the last cycle."""
        self._on = False

    def watch(self, block: AxisBlock, offset: float) -> None:
        """Tells the block whether the input is on, and where it has switched on first.

        Between two cycles the actual position is taken to go straight. `offset` of the coordinates from the encoder.
        """
        parameters = self._parameters
        if not parameters.measures:
            return
        low, high = parameters.below + offset, parameters.above + offset
        before = block.actual_position[0] if self._last is None else self._last
        for cycle, position in enumerate(block.actual_position):
            on = not low < position < high
            if on and not self._on and self._last is not None and not block.probe_switched:
                surface = high if position >= high else low
                way = position - before
                share = (surface - before) / way if way else 1.0
                block.probe_switched, block.probe_position = True, surface
                block.probe_cycle = cycle - 1.0 + min(1.0, max(0.0, share))
            self._on, self._last, before = on, position, position
        block.probe_on = self._on
