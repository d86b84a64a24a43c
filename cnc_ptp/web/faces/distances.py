"""Distances to go that no block says: of axes whose path is held, and of those that are positioned."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from cnc_ptp.protocol.blocks import ChannelBlock
from cnc_ptp.web.faces.face import State
from cnc_ptp.web.faces.unit_fields import shown

NOTHING: Mapping[str, Any] = {}


class DistancesToGo:
    """`distance_to_go` (mm, deg) for the states of axes."""

    def __init__(self) -> None:
        self._axes: dict[str, tuple[str, ...]] = {}
        """Channel -> its axes."""

    def take_block(self, channel: str, block: ChannelBlock) -> None:
        self._axes[channel] = tuple(block.axes)

    def fields(self, now: State, before: State, targets: Mapping[str, float | None]) -> dict[str, dict[str, float]]:
        """Axis -> `distance_to_go` in place of what its state has now; `targets` of positionings by axis.

        An axis keeps its part of the path's distance while the path stands within a block.
        """
        found: dict[str, dict[str, float]] = {}
        for channel, axes in self._axes.items():
            share = share_left(now.get(channel, NOTHING), before.get(channel, NOTHING))
            for axis in axes:
                last = before.get(axis, NOTHING).get("distance_to_go")
                is_open = now.get(axis, NOTHING).get("distance_to_go", 0.0) is None
                if is_open and share is not None and last is not None:
                    found[axis] = {"distance_to_go": shown(share * last)}
        for axis, target in targets.items():
            fields = now.get(axis, NOTHING)
            if target is not None and fields.get("job") and fields.get("state") == "DiscreteMotion":
                found[axis] = {"distance_to_go": shown(target - fields["set_position"])}
        return found


def share_left(now: Mapping[str, Any], before: Mapping[str, Any]) -> float | None:
    """Of the distance in a block that was left before; None in another block."""
    same = all(now.get(name) == before.get(name) for name in ("line", "blocks_done"))
    left = before.get("distance_to_go")
    return now["distance_to_go"] / left if same and left and "distance_to_go" in now else None
