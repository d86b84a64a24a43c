"""Synchronous operation: a master's command as its slave carries it out, by their ratio (TF5200 spindle 2.8.3)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

SMALLEST_RATIO, LARGEST_RATIO = 1e-6, 1e6
OPPOSITE = {"cw": "ccw", "ccw": "cw"}


def is_permitted(ratio: float) -> bool:
    """True if a slave can follow by this ratio."""
    return SMALLEST_RATIO <= abs(ratio) <= LARGEST_RATIO


def scaled(arguments: Mapping[str, Any], ratio: float) -> dict[str, Any]:
    """Arguments of a master's command as its slave has them: speed and position times the ratio.

    A negative ratio reverses the direction of rotation.
    """
    of_slave = dict(arguments)
    for name, factor in (("speed_rpm", abs(ratio)), ("position_deg", ratio)):
        if of_slave.get(name) is not None:
            of_slave[name] *= factor
    if ratio < 0.0 and of_slave.get("direction") in OPPOSITE:
        of_slave["direction"] = OPPOSITE[of_slave["direction"]]
    return of_slave
