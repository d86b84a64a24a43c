"""What moves the axes of a channel now: an element, a dwell, linked motions or a thread."""

from __future__ import annotations

from collections.abc import Mapping

from cnc_ptp.errors import Value
from cnc_ptp.path.interpolator import PathInterpolator
from cnc_ptp.path.shape import AxisState, AxisStates
from cnc_ptp.path.thread_place import ThreadPlace
from cnc_ptp.protocol.blocks import CycleBlock

PathPoint = tuple[AxisStates, float, float]
"""One cycle on the path: the state of each axis, path velocity (mm/s), distance to the end of the block (mm)."""
Note = tuple[int, int, str, Mapping[str, Value]]
"""Severity, number and text of an event."""


class ActiveMotion:
    """A motion from its start to its end; methods that a kind of motion has no use for are empty.

    spindle_states   of the spindle that is an axis of the path, in the cycles that `follow` has given out last; empty
                     if the motion has none
    places           in a thread and when tapping: of those cycles; None where the path does not follow the spindle
    notes            what is to be told of the motion
    """

    def __init__(self) -> None:
        self.spindle_states: list[AxisState] = []
        self.places: list[ThreadPlace | None] = []
        self.notes: list[Note] = []

    # cycles

    def follow(self, count: int) -> list[PathPoint]:
        """The next `count` cycles of the active block; fewer when it ends before."""
        raise NotImplementedError

    def read(self, first_cycle: int, feedback: Mapping[str, CycleBlock]) -> None:
        """Before each block of cycles: what the spindles have reported of the one before."""

    # commands

    def set_override(self, override: float) -> None:
        """The override that acts, 1 is 100 %; the interpolator of elements has it already."""

    def release(self, override: float, *, held: bool) -> None:
        """The override of the channel, and whether it is 0 because of a feed hold."""

    def stop(self) -> None:
        """Ramps down; `follow` continues until `stopped` or the end."""

    def pass_block(self) -> None:
        """The next block is the active one."""

    def halt(self) -> None:
        """Stops at the end of the active block, or of the first one at which the axes permit it."""

    def resume(self) -> None:
        """Continues behind the block at whose end the motion has halted."""

    def axis_failed(self, axis: int) -> None:
        """Nothing new can be asked of it."""

    # state

    @property
    def on_path(self) -> bool:
        """It leads along a path; a dwell does not."""
        return True

    @property
    def runs_through(self) -> bool:
        """It goes through several blocks without a stop, so its time is that of the whole path."""
        return False

    @property
    def feed(self) -> float:
        """Programmed feed of the active block, mm/s; in rapid traverse the velocity that the axes allow."""
        return 0.0

    @property
    def stopped(self) -> bool:
        """True when `stop` was called and the axes are at a standstill."""
        raise NotImplementedError

    @property
    def passes(self) -> bool:
        """The active block is finished; the motion continues in the next one without a stop."""
        return False

    @property
    def halted(self) -> bool:
        """The axes rest at the end of a block that they would have passed, until `resume`."""
        return False

    def held_by(self, override: float) -> bool:
        """The override that acts has stopped it, or does so on the ramp."""
        return override == 0.0

    @property
    def can_be_held(self) -> bool:
        """A feed hold would stop it before its end."""
        return False

    def time_to_go(self, velocity: float, distance: float) -> float:
        """Seconds to the end of the active block, from the last cycle; -1.0 while it is held."""
        raise NotImplementedError

    def part_to_go(self, distance: float) -> float:
        """Part of the active block's length, or of the dwell's time, that is still to come."""
        raise NotImplementedError

    def length_known(self, distance: float) -> float:
        """Length of the path, mm, that is known ahead."""
        return distance

    @property
    def runs_out(self) -> float:
        """Length of the path, mm, that is known while it brakes because no more is; -1.0 while it does not."""
        return -1.0

    def rest(self, position: tuple[float, ...]) -> tuple[float, ...]:
        """Where the axes, now at `position`, come to rest in the active block as it is planned now."""
        return position

    @property
    def cuts_thread(self) -> bool:
        """The axes are in a thread, and not on the ramp at its end."""
        return False

    @property
    def stop_text(self) -> str:
        """How the motion is broken off now, for events; empty for the ramp of the path."""
        return ""

    @property
    def waits_for(self) -> str:
        """What it waits for and does not come with time alone."""
        return ""

    # end

    def end(self, position: tuple[float, ...]) -> tuple[float, ...]:
        """Where the axes rest now that it has ended: exactly at its target, or at `position` behind a stop."""
        return position

    def hand_over(self, interpolator: PathInterpolator) -> None:
        """What is started next begins at the exact instant at which this has ended, inside a cycle."""
