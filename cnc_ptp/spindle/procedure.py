"""Procedures of a spindle: their steps, and the active one."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field
from enum import Enum, auto

DIRECTIONS = {"cw": 1.0, "ccw": -1.0}


class Step(Enum):
    """Part of a job."""

    APPROACH = auto()
    """Down to a speed at which the position loop can be closed."""
    SEARCH = auto()
    """Turn at homing speed until the zero pulse comes."""
    POSITION = auto()
    HALT = auto()
    """Exact stop."""
    SHIFT = auto()
    """The PLC changes the gear."""


@dataclass(slots=True)
class Procedure:
    """A job of several steps: `name` of the command; the rest as the steps need it."""

    name: str
    steps: deque[Step] = field(default_factory=deque)
    goal: float = 0.0
    speed: float = 0.0
    direction: str = ""
    stage: int = 0
    resume: float = 0.0
    """Speed of endless rotation that the gear change has interrupted, °/s."""
    number: int = 0
    """Number of the command that it carries out."""

    @property
    def homes(self) -> bool:
        """The zero pulse is still to come."""
        return Step.SEARCH in self.steps


@dataclass(slots=True)
class Work:
    """The active job of one spindle, and the outcome of the last one."""

    procedure: Procedure | None = None
    done: bool = True
    """The last job came to its end."""
    last_done: int = 0
    """Number of the last command whose job came to its end."""

    @property
    def gear_request(self) -> int:
        """The stage that the PLC is to change to, 0 if none."""
        return self.procedure.stage if self.procedure is not None and self.procedure.steps[0] is Step.SHIFT else 0

    @property
    def changes_gear(self) -> bool:
        return self.procedure is not None and self.procedure.stage != 0

    def finish(self) -> None:
        """The active job has finished."""
        if self.procedure is not None:
            self.last_done = self.procedure.number
        self.procedure, self.done = None, True

    def cancel(self) -> None:
        self.procedure, self.done = None, False

    def forget_rotation(self) -> None:
        """The endless rotation that a gear change has interrupted does not resume after it."""
        if self.procedure is not None:
            self.procedure.resume = 0.0
