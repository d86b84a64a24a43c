"""The passes of threads in a recording: cycles without a gap in which the path follows its spindle."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from cnc_ptp.parameters import MachineParameters
from cnc_ptp.recording.reader import AXIS_STATE, CHANNEL_STATE, SPINDLE_STATE, Recorded
from cnc_ptp.wire.layout import Records

Floats = npt.NDArray[np.float64]
TURN = 360.0
SAME_LEAD = 1e-3
"""Relative; threads with other leads have no phase against each other."""


@dataclass(frozen=True, slots=True)
class ThreadPass:
    """A pass with its n cycles.

    channel, axis, spindle   names; along `axis` the pitch counts
    line                     first line of its program
    errors                   states of the thread (n,)
    position, angle          of the axis (mm) and of the spindle (deg, + = M03), actual values (n,)
    seconds                  since the start of the recording, at its first cycle
    """

    channel: str
    axis: str
    spindle: str
    line: int
    errors: Records
    position: Floats
    angle: Floats
    seconds: float
    cycle_time: float

    @property
    def lead(self) -> float:
        """mm in one turn, where most of the pass has it."""
        return float(abs(np.median(self.errors["lead"])))

    @property
    def rpm(self) -> float:
        """Speed of the spindle in most of its cycles, in any direction."""
        return float(np.median(abs(np.diff(self.angle))) / TURN / self.cycle_time * 60.0)

    @property
    def phase(self) -> float:
        """Angle of the spindle at which the groove is at the position 0 of the axis, 0 … 360 deg; of its middle."""
        angles = self.angle - TURN * self.position / float(np.median(self.errors["lead"]))
        return float(np.median(angles) % TURN)

    def largest(self, field: str) -> float:
        """Largest absolute value of a field; NaN for a pass shorter than a turn."""
        values = abs(self.errors[field])
        return float("nan") if np.isnan(values).all() else float(np.nanmax(values))


def phase_against(one: ThreadPass, other: ThreadPass) -> float:
    """deg from the groove of `one` to that of `other`, -180 … 180; NaN where axis or lead differ."""
    if one.axis != other.axis or abs(one.lead - other.lead) > SAME_LEAD * one.lead:
        return float("nan")
    return (other.phase - one.phase + 0.5 * TURN) % TURN - 0.5 * TURN


def thread_passes(recorded: Recorded, machine: MachineParameters | None) -> list[ThreadPass]:
    """All passes of two cycles and more in the order of the channels and of time.

    None without a machine file, which says whose the numbers of axes and spindles are; nor of an older recording
    without these numbers.
    """
    if machine is None:
        return []
    threads = recorded.threads.items()
    return [found for channel, rows in threads for found in _of_channel(recorded, machine, channel, rows)]


def _of_channel(recorded: Recorded, machine: MachineParameters, channel: str, rows: Records) -> Iterator[ThreadPass]:
    """A pass ends where cycles are missing, and where another axis or spindle counts."""
    if not {"axis", "spindle"} <= set(rows.dtype.names or ()):
        return
    known = rows[rows["spindle"] > 0]
    parting = np.diff(known["cycle"].astype(np.int64)) != 1
    for name in ("axis", "spindle"):
        parting |= known[name][1:] != known[name][:-1]
    for part in np.split(np.arange(len(known)), np.flatnonzero(parting) + 1):
        found = _pass(recorded, machine, channel, known[part]) if len(part) > 1 else None
        if found is not None:
            yield found


def _pass(recorded: Recorded, machine: MachineParameters, channel: str, errors: Records) -> ThreadPass | None:
    """None where the states of its cycles are not complete."""
    axis = next((name for name, unit in machine.axes.items() if unit.number == errors["axis"][0]), "")
    spindle = next((name for name, unit in machine.spindles.items() if unit.number == errors["spindle"][0]), "")
    cycles = errors["cycle"]
    position = _column(recorded.of_type(AXIS_STATE).get(axis), "actual_position", cycles)
    angle = _column(recorded.of_type(SPINDLE_STATE).get(spindle), "actual_position_deg", cycles)
    lines = _column(recorded.of_type(CHANNEL_STATE).get(channel), "line", cycles)
    if position is None or angle is None:
        return None
    line = int(lines[0]) if lines is not None else 0
    seconds = float(recorded.seconds(cycles[:1])[0])
    return ThreadPass(channel, axis, spindle, line, errors, position, angle, seconds, recorded.cycle_time_ns * 1e-9)


def _column(rows: Records | None, field: str, cycles: npt.NDArray[np.uint64]) -> Floats | None:
    """A field in these cycles; None if one of them is missing."""
    if rows is None:
        return None
    part = rows[(rows["cycle"] >= cycles[0]) & (rows["cycle"] <= cycles[-1])]
    return part[field].astype(np.float64) if len(part) == len(cycles) else None
