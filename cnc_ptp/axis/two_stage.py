"""New velocity and new end position: the six cases, by the order of the three positions (TX1250 2.4)."""

from __future__ import annotations

from enum import Enum, auto
from typing import NamedTuple


class Stage(Enum):
    """When the new velocity comes."""

    NEVER = auto()
    NOW = auto()
    LATER = auto()


class Request(NamedTuple):
    """A new target (mm, deg), with a new velocity (mm/s, deg/s) that counts from `activation_position` on, if any."""

    target: float
    velocity: float | None = None
    activation_position: float = 0.0


def velocity_stage(direction: float, position: float, request: Request) -> Stage:
    """When the new velocity of `request` comes for an axis at `position` that goes in `direction` (+1, -1).

    Seen in that direction, with Pos the axis, APos the activation position and EPos the new target:
    EPos <= Pos (cases 3, 5, 6) stop and return with the old velocity, and this first where positions are equal;
    Pos <= APos <= EPos (1) later; APos <= Pos <= EPos (2) now; Pos <= EPos <= APos (4) never.
    """
    if request.velocity is None:
        return Stage.NEVER
    target = direction * (request.target - position)
    activation = direction * (request.activation_position - position)
    if target <= 0.0 or activation > target:
        return Stage.NEVER
    return Stage.LATER if activation >= 0.0 else Stage.NOW
