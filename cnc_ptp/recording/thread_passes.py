"""The passes of threads in a recording: cycles without a gap in which the path follows its spindle."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from cnc_ptp.recording.reader import AXIS_STATE, CHANNEL_STATE, SPINDLE_STATE, Recorded
from cnc_ptp.wire.layout import Records

Floats = npt.NDArray[np.float64]
TURN = 360.0
SAME_LEAD = 1e-3
"""Relative; threads with other leads have no phase against each other."""


@dataclass(frozen=True, slots=True)
class ThreadPass:
    """A pass with its n cycles.

    channel, axis, spindle   names; `axis` is the one with the longest way, along which the pitch counts
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


def thread_passes(recorded: Recorded) -> list[ThreadPass]:
    """All passes of two cycles and more in the order of the channels and of time."""
    return [found for channel, rows in recorded.threads.items() for found in _of_channel(recorded, channel, rows)]


def _of_channel(recorded: Recorded, channel: str, rows: Records) -> Iterator[ThreadPass]:
    known = rows[~np.isnan(rows["lead"])]
    gaps = np.flatnonzero(np.diff(known["cycle"].astype(np.int64)) != 1) + 1
    for part in np.split(np.arange(len(known)), gaps):
        found = _pass(recorded, channel, known[part]) if len(part) > 1 else None
        if found is not None:
            yield found


def _pass(recorded: Recorded, channel: str, errors: Records) -> ThreadPass | None:
    """None where the states of its cycles are not complete, or nothing moves."""
    cycles = errors["cycle"]
    axes = _columns(recorded.of_type(AXIS_STATE), "actual_position", cycles)
    spindles = _columns(recorded.of_type(SPINDLE_STATE), "actual_position_deg", cycles)
    lines = _columns(recorded.of_type(CHANNEL_STATE), "line", cycles).get(channel)
    if not axes or not spindles:
        return None
    axis = max(axes, key=lambda name: float(np.ptp(axes[name])))
    position = axes[axis]
    lead = float(np.median(errors["lead"]))
    spindle = min(spindles, key=lambda name: _misfit(spindles[name], position, lead))
    line = int(lines[0]) if lines is not None else 0
    seconds = float(recorded.seconds(cycles[:1])[0])
    cycle_time = recorded.cycle_time_ns * 1e-9
    return ThreadPass(channel, axis, spindle, line, errors, position, spindles[spindle], seconds, cycle_time)


def _columns(states: Mapping[str, Records], field: str, cycles: npt.NDArray[np.uint64]) -> dict[str, Floats]:
    """A field in these cycles, by unit; without units that lack one of them."""
    found: dict[str, Floats] = {}
    for name, rows in states.items():
        part = rows[(rows["cycle"] >= cycles[0]) & (rows["cycle"] <= cycles[-1])]
        if len(part) == len(cycles):
            found[name] = part[field].astype(np.float64)
    return found


def _misfit(angle: Floats, position: Floats, lead: float) -> float:
    """deg by which a spindle is off the thread, for the choice of several."""
    return float(np.ptp(angle - TURN * position / lead))
