"""What the path stands for in a cycle of a thread: the angle of the spindle that belongs to its set position."""

from __future__ import annotations

from math import nan
from typing import NamedTuple


class ThreadPlace(NamedTuple):
    """The set position of a cycle within a thread.

    spindle   its node
    axis      place of the axis along which the pitch counts: the one with the longest distance
    position  set position of this axis, mm
    lead      mm along this axis while the angle of the spindle grows by 360 deg; signed, of this cycle
    angle     of the spindle at which the axis should be there, deg; when tapping NaN: what the spindle reports as set
    """

    spindle: str
    axis: int
    position: float
    lead: float
    angle: float = nan
