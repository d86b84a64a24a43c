"""The newest block of each unit, for clients that show a machine."""

from __future__ import annotations

import time
from collections.abc import Collection, Mapping
from typing import Any

from rclpy.qos import DurabilityPolicy, QoSProfile

from cnc_ptp.errors import CncError
from cnc_ptp.nodes.handover import Handover
from cnc_ptp.nodes.polling_node import PollingNode
from cnc_ptp.nodes.topics import BLOCK_CLASSES, BLOCK_TYPES, block_topic
from cnc_ptp.protocol.blocks import CycleBlock
from cnc_ptp.protocol.unit_view import VIEWS, UnitView, view_of
from cnc_ptp.wire.block_codec import codec_of, head_of

GONE = 5.0
"""Seconds without a block of any unit after which a machine counts as gone."""
GONE_TEXT = f"nothing new for {GONE:g} s: the machine no longer runs"
NEWEST = QoSProfile(depth=1)
"""Volatile: axes and spindles remember ten seconds of blocks, and a late reader would see the oldest first."""
REMEMBERED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
"""For a reader that is there from the start, of units that remember."""


class LatestBlocks:
    """Keeps the newest block of units; only those that are shown are deserialised: some hundred come per second."""

    def __init__(
        self,
        node: PollingNode,
        kinds: Mapping[str, str],
        *,
        rotary: Collection[str],
        from_the_start: bool = False,
        handover: Handover | None = None,
    ) -> None:
        """`kinds`: unit -> kind; the plc is left out. `rotary`: axes in degrees.

        `handover`: from units of this process.
        """
        self._node = node
        self._kinds = {unit: kind for shown in VIEWS for unit, kind in kinds.items() if kind == shown}
        self._rotary = rotary
        self._newest: dict[str, bytes | CycleBlock] = {}
        self._views: dict[str, UnitView] = {}
        """The last ones that were asked for."""
        self._heard = time.monotonic()
        for unit, kind in self._kinds.items():
            if handover is not None:
                handover.on_block(unit, self._keeper(unit))
                continue
            quality = REMEMBERED if from_the_start and kind in ("axis", "spindle") else NEWEST
            node.create_subscription(BLOCK_TYPES[kind], block_topic(unit), self._keeper(unit), quality, raw=True)

    def _keeper(self, unit: str) -> Any:
        def received(newest: bytes | CycleBlock) -> None:
            self._newest[unit] = newest
            self._heard = time.monotonic()

        return received

    @property
    def gone(self) -> bool:
        """No unit has published anything for GONE seconds."""
        return time.monotonic() - self._heard > GONE

    def view(self, unit: str) -> UnitView | None:
        """None before the first block that can be read; of one that cannot, the node says so."""
        newest = self._newest.get(unit)
        try:
            if newest is not None:
                self._views[unit] = self._view_of(unit, newest)
        except CncError as error:
            self._node.leave_out(block_topic(unit), error)
        return self._views.get(unit)

    def _view_of(self, unit: str, newest: bytes | CycleBlock) -> UnitView:
        """Raises CncError 26184."""
        kind, rotary = self._kinds[unit], unit in self._rotary
        if not isinstance(newest, bytes):
            return view_of(unit, kind, newest, rotary=rotary)
        block = codec_of(BLOCK_CLASSES[kind]).decode(newest)
        return view_of(unit, kind, block, rotary=rotary, stamp=head_of(newest)[0] * 1e-9)

    def views(self) -> list[UnitView]:
        """The blocks of the units that have published: channels, axes, spindles."""
        return [view for view in map(self.view, self._kinds) if view is not None]
