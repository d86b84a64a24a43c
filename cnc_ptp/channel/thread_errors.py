"""Pitch and phase error of threads: the path against the actual angle of its spindle, cycle by cycle.

In cycle c the setpoint of cycle c - delay acts. With its spindle angle α (deg), position q (mm) and lead p (mm), and
with the actual angle θ and the actual position x of cycle c:

    phase error of the set value       α - θ                    deg
    phase error of the actual value    α - θ + (x - q)·360/p    deg
    deviation e                        phase error · p/360      mm: beside its place by the angle
    pitch error                        e(θ) - e(one turn before θ)    mm: way in the last turn - lead

Spindle and axes report a cycle one block later, so the errors come with the block behind it.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping, Sequence
from math import isnan, nan
from typing import Final, NamedTuple

from cnc_ptp.path.thread.thread_check import TURN
from cnc_ptp.path.thread_place import ThreadPlace
from cnc_ptp.protocol.blocks import AxisBlock, ChannelBlock, CycleBlock, SpindleBlock


class ThreadError(NamedTuple):
    """Of a cycle, as ThreadState has it: logical numbers of axis and spindle, mm and deg."""

    axis: int
    spindle: int
    lead: float
    set_pitch: float
    actual_pitch: float
    set_phase: float
    actual_phase: float


NO_THREAD: Final = ThreadError(0, 0, nan, nan, nan, nan, nan)


class LastTurn:
    """Deviations (mm) of set and actual value over the last turn of the spindle, in one direction."""

    def __init__(self) -> None:
        self._known: deque[tuple[float, float, float]] = deque()
        """Angle in the direction of the turning, deviations; the first one is a turn behind or less."""
        self._sense = 0.0
        self._last = nan

    def clear(self) -> None:
        self._known.clear()
        self._sense, self._last = 0.0, nan

    def growth(self, angle: float, set_value: float, actual: float) -> tuple[float, float]:
        """By how much they are greater than a turn before `angle` (deg); NaN within the first turn."""
        way = angle - self._last
        self._last = angle
        if way * self._sense < 0.0:
            self._known.clear()
        if way > 0.0 or way < 0.0:
            self._sense = way
        turned = -angle if self._sense < 0.0 else angle
        known = self._known
        known.append((turned, set_value, actual))
        while len(known) > 1 and known[1][0] <= turned - TURN:
            known.popleft()
        if known[0][0] > turned - TURN:
            return nan, nan
        begin, end = known[0], known[1]
        part = (turned - TURN - begin[0]) / (end[0] - begin[0])
        return (
            set_value - begin[1] - part * (end[1] - begin[1]),
            actual - begin[2] - part * (end[2] - begin[2]),
        )


class ThreadErrors:
    """Keeps what the path stands for until spindle and axes have reported the cycle in which it acts."""

    def __init__(self, nodes: Sequence[str], numbers: Mapping[str, int], delay: int) -> None:
        """`nodes` of the axes; `numbers`: logical ones of axes and spindles, by node.

        `delay`: cycles by which the axes act later than their setpoints come.
        """
        self._nodes, self._numbers, self._delay = nodes, numbers, delay
        self._places: dict[int, ThreadPlace] = {}
        """By cycle of the setpoint."""
        self._last_turn = LastTurn()

    def note(self, first_cycle: int, count: int, places: Mapping[int, ThreadPlace]) -> None:
        """Takes the places of a block by row; rows behind its `count` cycles come again with the next one."""
        for row, place in places.items():
            if row < count:
                self._places[first_cycle + row] = place

    def take(self, first_cycle: int, feedback: Mapping[str, CycleBlock]) -> list[ThreadError]:
        """Of each cycle of the block before `first_cycle`; empty if no thread acted in it."""
        if not self._places:
            self._last_turn.clear()
            return []
        spindles: dict[str, SpindleBlock] = {}
        for place in self._places.values():
            block = ended_at(first_cycle, feedback.get(place.spindle))
            if block is not None:
                spindles[place.spindle] = block
        if not spindles:
            self._forget(first_cycle)
            self._last_turn.clear()
            return []
        for node, report in spindles.items():
            self._note_set_angles(node, report)
        begin = min([report.first_cycle for report in spindles.values()])
        errors = [self._error(cycle, spindles, feedback) for cycle in range(begin, first_cycle)]
        self._forget(first_cycle)
        return errors if any(error is not NO_THREAD for error in errors) else []

    def _note_set_angles(self, node: str, spindle: SpindleBlock) -> None:
        """Tapping: the angle that belongs to a setpoint is the set angle of its cycle."""
        for index, angle in enumerate(spindle.set_position_deg):
            place = self._places.get(spindle.first_cycle + index)
            if place is not None and place.spindle == node and isnan(place.angle):
                self._places[spindle.first_cycle + index] = place._replace(angle=angle)

    def _forget(self, first_cycle: int) -> None:
        """Places that have acted before."""
        self._places = {cycle: place for cycle, place in self._places.items() if cycle + self._delay >= first_cycle}

    def _error(
        self, cycle: int, spindles: Mapping[str, SpindleBlock], feedback: Mapping[str, CycleBlock]
    ) -> ThreadError:
        place = self._places.get(cycle - self._delay)
        spindle = None if place is None else spindles.get(place.spindle)
        if place is None or spindle is None or place.lead == 0.0 or cycle < spindle.first_cycle:
            self._last_turn.clear()
            return NO_THREAD
        angle = spindle.actual_position_deg[cycle - spindle.first_cycle]
        set_phase = place.angle - angle
        lag = self._actual_position(place.axis, cycle, feedback) - place.position
        actual_phase = set_phase + TURN * lag / place.lead
        per_degree = place.lead / TURN
        set_pitch, actual_pitch = self._last_turn.growth(angle, set_phase * per_degree, actual_phase * per_degree)
        axis_number, spindle_number = self._numbers[self._nodes[place.axis]], self._numbers[place.spindle]
        return ThreadError(axis_number, spindle_number, place.lead, set_pitch, actual_pitch, set_phase, actual_phase)

    def _actual_position(self, axis: int, cycle: int, feedback: Mapping[str, CycleBlock]) -> float:
        """mm; NaN of an axis that has not reported."""
        block = feedback.get(self._nodes[axis])
        if not isinstance(block, AxisBlock) or not 0 <= cycle - block.first_cycle < block.count:
            return nan
        return block.actual_position[cycle - block.first_cycle]


def ended_at(first_cycle: int, block: CycleBlock | None) -> SpindleBlock | None:
    """The report of a spindle for the cycles right before `first_cycle`."""
    if not isinstance(block, SpindleBlock) or block.first_cycle + block.count != first_cycle:
        return None
    return block


def add_thread(block: ChannelBlock, errors: Sequence[ThreadError]) -> None:
    """The errors of the cycles before a block."""
    if not errors:
        return
    block.thread_axis = [error.axis for error in errors]
    block.thread_spindle = [error.spindle for error in errors]
    block.thread_lead = [error.lead for error in errors]
    block.thread_set_pitch_error = [error.set_pitch for error in errors]
    block.thread_actual_pitch_error = [error.actual_pitch for error in errors]
    block.thread_set_phase_error_deg = [error.set_phase for error in errors]
    block.thread_actual_phase_error_deg = [error.actual_phase for error in errors]
