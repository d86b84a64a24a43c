"""Pitch and phase error of threads: the path against the actual angle of its spindle, cycle by cycle.

In cycle c the setpoint of cycle c - delay acts. With its spindle angle α (deg), position q (mm) and lead p (mm), the actual
angle θ and the actual position x of that cycle, and s the values of the thread's first cycle:

    phase error of the set value       α - θ                        deg
    phase error of the actual value    α - θ + (x - q)·360/p        deg
    pitch error                        (phase error - phase error in s)·p/360     mm

Spindle and axes report a cycle one block later, so the errors come with the block behind it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import isnan, nan
from typing import Final, NamedTuple

from cnc_ptp.path.thread.thread_check import TURN
from cnc_ptp.path.thread.thread_place import ThreadPlace
from cnc_ptp.protocol.blocks import AxisBlock, ChannelBlock, CycleBlock, SpindleBlock


class ThreadError(NamedTuple):
    """Of a cycle, as ThreadState has it: mm and deg."""

    lead: float
    set_pitch: float
    actual_pitch: float
    set_phase: float
    actual_phase: float


NO_THREAD: Final = ThreadError(nan, nan, nan, nan, nan)


class ThreadErrors:
    """Keeps what the path stands for until spindle and axes have reported the cycle in which it acts."""

    def __init__(self, nodes: Sequence[str], delay: int) -> None:
        """`nodes` of the axes; `delay`: cycles by which they act later than their setpoints come."""
        self._nodes, self._delay = nodes, delay
        self._places: dict[int, ThreadPlace] = {}
        """By cycle of the setpoint."""
        self._start: tuple[float, float] | None = None
        """Phase errors of set and actual value in the first cycle of the thread."""

    def note(self, first_cycle: int, count: int, places: Mapping[int, ThreadPlace]) -> None:
        """Takes the places of a block by row; rows behind its `count` cycles come again with the next one."""
        for row, place in places.items():
            if row < count:
                self._places[first_cycle + row] = place

    def take(self, first_cycle: int, feedback: Mapping[str, CycleBlock]) -> list[ThreadError]:
        """Of each cycle of the block before `first_cycle`; empty if no thread acted in it."""
        if not self._places:
            return []
        spindle = feedback.get(next(iter(self._places.values())).spindle)
        if not isinstance(spindle, SpindleBlock) or spindle.first_cycle + spindle.count != first_cycle:
            self._forget(first_cycle)
            return []
        self._note_set_angles(spindle)
        errors = [self._error(cycle, spindle, feedback) for cycle in range(spindle.first_cycle, first_cycle)]
        self._forget(first_cycle)
        return errors if any(error is not NO_THREAD for error in errors) else []

    def _note_set_angles(self, spindle: SpindleBlock) -> None:
        """Tapping: the angle that belongs to a setpoint is the set angle of its cycle."""
        for index, angle in enumerate(spindle.set_position_deg):
            place = self._places.get(spindle.first_cycle + index)
            if place is not None and isnan(place.angle):
                self._places[spindle.first_cycle + index] = place._replace(angle=angle)

    def _forget(self, first_cycle: int) -> None:
        """Places that have acted before."""
        self._places = {cycle: place for cycle, place in self._places.items() if cycle + self._delay >= first_cycle}

    def _error(self, cycle: int, spindle: SpindleBlock, feedback: Mapping[str, CycleBlock]) -> ThreadError:
        place = self._places.get(cycle - self._delay)
        index = cycle - spindle.first_cycle
        if place is None or place.lead == 0.0:
            self._start = None
            return NO_THREAD
        set_phase = place.angle - spindle.actual_position_deg[index]
        lag = self._actual_position(place.axis, cycle, feedback) - place.position
        actual_phase = set_phase + TURN * lag / place.lead
        if self._start is None:
            self._start = set_phase, actual_phase
        per_degree = place.lead / TURN
        set_pitch, actual_pitch = (set_phase - self._start[0]), (actual_phase - self._start[1])
        return ThreadError(place.lead, set_pitch * per_degree, actual_pitch * per_degree, set_phase, actual_phase)

    def _actual_position(self, axis: int, cycle: int, feedback: Mapping[str, CycleBlock]) -> float:
        """mm; NaN of an axis that has not reported."""
        block = feedback.get(self._nodes[axis])
        if not isinstance(block, AxisBlock) or not 0 <= cycle - block.first_cycle < block.count:
            return nan
        return block.actual_position[cycle - block.first_cycle]


def add_thread(block: ChannelBlock, errors: Sequence[ThreadError]) -> None:
    """The errors of the cycles before a block."""
    if not errors:
        return
    block.thread_lead = [error.lead for error in errors]
    block.thread_set_pitch_error = [error.set_pitch for error in errors]
    block.thread_actual_pitch_error = [error.actual_pitch for error in errors]
    block.thread_set_phase_error_deg = [error.set_phase for error in errors]
    block.thread_actual_phase_error_deg = [error.actual_phase for error in errors]
