"""Blocks that wait in the compensation of the tool radius."""

from __future__ import annotations

from dataclasses import dataclass

from cnc_ptp.nc.canonical import CanonicalBlock
from cnc_ptp.nc.coordinates.limits import Limits


@dataclass(slots=True, eq=False)
class Entry:
    """A block that waits; `element`: it is an element of the contour, `limits` of G98 and G99 that held for it."""

    block: CanonicalBlock
    limits: Limits | None
    element: bool = False
    contour_feed: bool = False
