"""The measuring run of a channel (G100, G31): the signal of the probe, positions of all axes at that instant.

The signal comes from the axes, which say in which cycle, or as a command of the PLC, which counts for the last cycle
that the axes have reported. The path has gone on meanwhile: it stops on its ramp from the next cycle that is made.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from cnc_ptp.errors import CncError
from cnc_ptp.nc.canonical import LinearMove, number
from cnc_ptp.nc.measuring import Touch
from cnc_ptp.parameters import AxisParameters
from cnc_ptp.protocol.blocks import AxisBlock, CycleBlock, EventValue

PROBE_ON = 50052
NO_SIGNAL = 22051
STROKE_EXCEEDED = 22052
STROKE_SHORT = 22053
SETTLED = 1e-5
"""mm (deg) within which an axis has come to rest behind the end of the path …"""
SETTLING_WINDOW = 0.02
"""… for so many s …"""
LONGEST_SETTLING = 1.0
"""… or after so many, whatever it does."""
NO_TOUCH = Touch(None)


class ChannelAxisProbe(NamedTuple):
    """An axis of the channel: its name in programs, its node, P-AXIS-00086 (mm, deg), and its unit of length."""

    name: str
    node: str
    stroke: float
    unit: str


class Measuring:
    """One measuring run after the other.

    touch      how the last one has ended
    awaits     a run is on, and the signal has not come
    commanded  the PLC has given the signal; it counts when the newest blocks of the axes are read
    reached    the signal has come, and the path brakes
    """

    def __init__(
        self, names: Sequence[str], axes: Sequence[AxisParameters], cycle_time: float, *, required: bool
    ) -> None:
        """`names` and parameters of the channel's axes; `cycle_time` in s; `required`: P-CHAN-00176."""
        units = ("deg" if axis.rotary else "mm" for axis in axes)
        self._axes = [
            ChannelAxisProbe(name, axis.name, axis.probe.stroke, unit)
            for name, axis, unit in zip(names, axes, units, strict=True)
        ]
        self._cycle_time, self._required = cycle_time, required
        self._measures: tuple[int, ...] = ()
        self._last: tuple[float, ...] = ()
        """Actual positions in the last cycle of the block before."""
        self._settling = self._window = 0
        """Cycles since the end of the path, and since the axes were at …"""
        self._stood_at: tuple[float, ...] = ()
        """… these positions."""
        self.touch = NO_TOUCH
        self.awaits = self.commanded = self.reached = False

    def ready(self, motion: LinearMove, feedback: Mapping[str, CycleBlock]) -> bool:
        """The axes that take part have reported whether their probes are on."""
        return all(isinstance(feedback.get(self._axes[place].node), AxisBlock) for place in motion.measures)

    def begin(self, motion: LinearMove, feedback: Mapping[str, CycleBlock]) -> None:
        """A run begins. Raises CncError 50052 if the probe of an axis that takes part is on already."""
        for place in motion.measures:
            axis = self._axes[place]
            block = feedback.get(axis.node)
            if isinstance(block, AxisBlock) and block.probe_on:
                position = block.actual_position[-1]
                at = f"at {number(position)} {axis.unit}"
                reason = f"the probe of axis {axis.name} is on already, {at}, before the measuring run"
                raise CncError(PROBE_ON, reason, axis=axis.node, actual_position=position)
        self._measures = motion.measures
        self._last = self._stood_at = self._ends(feedback)
        self._settling = self._window = 0
        self.touch, self.awaits = NO_TOUCH, True
        self.commanded = self.reached = False

    def end(self) -> None:
        """The run has ended, or the program was aborted."""
        self.awaits = self.commanded = self.reached = False

    def short_strokes(self, braking: Sequence[float]) -> str:
        """Warning of axes whose `braking` distances (mm, deg) from the feed are longer than their strokes, or empty."""
        short = [
            f"axis {axis.name} brakes within {braking[place]:.4f} {axis.unit}, "
            f"the stroke of its probe is {number(axis.stroke)} {axis.unit} (P-AXIS-00086)"
            for place in self._measures
            if 0.0 < (axis := self._axes[place]).stroke < braking[place]
        ]
        return f"{' and '.join(short)}; the feed is too high for the probe" if short else ""

    # the signal

    def read(self, feedback: Mapping[str, CycleBlock]) -> bool:
        """Reads the blocks of the axes; True when a probe has switched in them, or the PLC has given the signal."""
        blocks = [self._block(axis, feedback) for axis in self._axes]
        instants = [(block.probe_cycle, place) for place in self._measures if (block := blocks[place]).probe_switched]
        if instants:
            instant, by = min(instants)
            self._take(tuple([self._at(place, by, instant, block) for place, block in enumerate(blocks)]))
        elif self.commanded:
            self._take(self._ends(feedback))
        return self.reached

    def _at(self, place: int, by: int, instant: float, block: AxisBlock) -> float:
        """Actual position of an axis at an instant between two cycles of its block; its own probe knows it exactly."""
        if place == by:
            return block.probe_position
        cycle = int(instant + 1.0)
        share = instant + 1.0 - cycle
        positions = (self._last[place], *block.actual_position)
        before, after = positions[cycle], positions[min(cycle + 1, len(positions) - 1)]
        return before + share * (after - before)

    def _take(self, position: tuple[float, ...]) -> None:
        self.touch = Touch(position)
        self.awaits, self.reached = False, True

    def overrun(self, rest: Sequence[float]) -> None:
        """Raises CncError 22052 for an axis that comes to rest (mm, deg) farther behind the point than its stroke."""
        assert self.touch.position is not None
        for place in self._measures:
            axis, way = self._axes[place], abs(rest[place] - self.touch.position[place])
            if 0.0 < axis.stroke < way:
                limit = f"{number(axis.stroke)} {axis.unit} (P-AXIS-00086)"
                reason = (
                    f"axis {axis.name} comes to rest {way:.4f} {axis.unit} behind the measured point, "
                    f"the stroke of its probe is {limit}"
                )
                raise CncError(STROKE_EXCEEDED, reason, axis=axis.node, distance=way, limit=axis.stroke)

    # without a signal

    def settled(self, feedback: Mapping[str, CycleBlock], cycles: int) -> bool:
        """The axes have come to rest behind the end of the path, `cycles` more have passed; without a signal.

        Raises CncError 22051 if there must be one.
        """
        ends = self._last = self._ends(feedback)
        self._settling += cycles
        self._window += cycles
        if self._window * self._cycle_time < SETTLING_WINDOW:
            return False
        still = all(abs(ends[place] - self._stood_at[place]) <= SETTLED for place in self._measures)
        self._stood_at, self._window = ends, 0
        if not still and self._settling * self._cycle_time < LONGEST_SETTLING:
            return False
        self.awaits = False
        if self._required:
            where = ", ".join(f"{self._axes[place].name} {number(ends[place])}" for place in self._measures)
            reason = f"the measuring run has ended at {where} without a signal of the probe (P-CHAN-00176)"
            raise CncError(NO_SIGNAL, reason)
        return True

    def follow(self, feedback: Mapping[str, CycleBlock]) -> None:
        """A block without a signal has passed."""
        self._last = self._ends(feedback)

    # what has been measured

    def text(self) -> str:
        """For the event."""
        return "measured: " + ", ".join(f"{value.name} {number(value.value)} {value.unit}" for value in self.values())

    def values(self) -> list[EventValue]:
        """Measured positions of the axes that take part, in machine coordinates."""
        position = self.touch.position or ()
        return [
            EventValue(self._axes[place].name, position[place], self._axes[place].unit)
            for place in self._measures
            if position
        ]

    def _block(self, axis: ChannelAxisProbe, feedback: Mapping[str, CycleBlock]) -> AxisBlock:
        block = feedback.get(axis.node)
        return block if isinstance(block, AxisBlock) else AxisBlock(0, 0)

    def _ends(self, feedback: Mapping[str, CycleBlock]) -> tuple[float, ...]:
        blocks = [self._block(axis, feedback) for axis in self._axes]
        return tuple([block.actual_position[-1] if block.actual_position else 0.0 for block in blocks])
