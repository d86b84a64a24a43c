"""The newest block of each unit, for clients that show a machine."""

from __future__ import annotations

import time
from collections.abc import Collection, Mapping
from typing import Any

from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile

from cnc_ptp.errors import CncError
from cnc_ptp.nodes.convert import message_of
from cnc_ptp.nodes.handover import Handover
from cnc_ptp.nodes.topics import BLOCK_TYPES, block_topic
from cnc_ptp.protocol.blocks import CycleBlock
from cnc_ptp.protocol.unit_view import VIEWS, UnitView, view_of

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
        node: Node,
        kinds: Mapping[str, str],
        *,
        rotary: Collection[str],
        from_the_start: bool = False,
        handover: Handover | None = None,
    ) -> None:
        """`kinds`: unit -> kind; the plc is left out. `rotary`: axes in degrees.

        `handover`: from units of this process.
        """
        self._kinds = {unit: kind for shown in VIEWS for unit, kind in kinds.items() if kind == shown}
        self._rotary = rotary
        self._newest: dict[str, bytes | CycleBlock] = {}
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
        """None before the first block, and while the newest one cannot be read."""
        newest = self._newest.get(unit)
        if newest is None:
            return None
        kind = self._kinds[unit]
        try:
            block = message_of(newest, BLOCK_TYPES[kind]) if isinstance(newest, bytes) else newest
        except CncError:
            return None
        return view_of(unit, kind, block, rotary=unit in self._rotary)

    def views(self) -> list[UnitView]:
        """The blocks of the units that have published: channels, axes, spindles."""
        return [view for view in map(self.view, self._kinds) if view is not None]
