"""Speeds that a recording lacks for a friction table, and a scenario that drives them."""

from __future__ import annotations

from collections.abc import Sequence

from cnc_ptp.commissioning.excitation import Motion, Room

WIDEST_STEP = 1.6
"""Ratio of neighbouring speeds up to which a curve with a Stribeck minimum is covered well enough."""


def missing_speeds(wanted: Sequence[float], found: Sequence[float]) -> list[float]:
    """Those of the `wanted` speeds (ascending) that have no `found` one within WIDEST_STEP below or above."""
    return [speed for speed in wanted if not any(_near(speed, other) for other in found)]


def _near(speed: float, other: float) -> bool:
    return speed <= other * WIDEST_STEP and other <= speed * WIDEST_STEP


def scenario_lines(room: Room, motions: Sequence[Motion]) -> list[str]:
    """The motions as lines of a scenario file, from a powered axis at a standstill at `room.position`."""
    return [
        f"- {{at: {motion.at:.3f}, to: {room.axis}, do: move_relative, distance: {motion.distance:.4f}, "
        f"velocity: {motion.velocity:g}}}"
        for motion in motions
    ]
