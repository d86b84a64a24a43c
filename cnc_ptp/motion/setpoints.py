"""Setpoints of many cycles as columns: lists of plain numbers are what passes between units, cycle by cycle."""

from __future__ import annotations

from collections.abc import Iterable

MotionState = tuple[float, float, float, float]
"""Position, velocity, acceleration, jerk."""


class Setpoints:
    """Position, velocity, acceleration and jerk of consecutive cycles; mm, s (deg, s)."""

    __slots__ = ("accelerations", "jerks", "positions", "velocities")

    def __init__(
        self,
        positions: list[float],
        velocities: list[float],
        accelerations: list[float],
        jerks: list[float],
    ) -> None:
        """Lists of equal length."""
        self.positions = positions
        self.velocities = velocities
        self.accelerations = accelerations
        self.jerks = jerks

    @classmethod
    def of(cls, states: Iterable[MotionState]) -> Setpoints:
        """Of (p, v, a, j) cycle by cycle."""
        setpoints = cls([], [], [], [])
        for position, velocity, acceleration, jerk in states:
            setpoints.add(position, velocity, acceleration, jerk)
        return setpoints

    def __len__(self) -> int:
        return len(self.positions)

    def add(self, position: float, velocity: float, acceleration: float, jerk: float) -> None:
        self.positions.append(position)
        self.velocities.append(velocity)
        self.accelerations.append(acceleration)
        self.jerks.append(jerk)

    def at(self, index: int) -> MotionState:
        """(p, v, a, j) of one cycle."""
        return self.positions[index], self.velocities[index], self.accelerations[index], self.jerks[index]

    def states(self) -> list[MotionState]:
        """(p, v, a, j) cycle by cycle."""
        return [self.at(index) for index in range(len(self.positions))]
