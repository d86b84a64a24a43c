"""A part of a recording: from one time to another, some units only."""

from __future__ import annotations

import difflib
from collections.abc import Collection, Sequence
from dataclasses import replace

import numpy as np

from cnc_ptp.errors import CncError
from cnc_ptp.recording.reader import AXIS_STATE, SPINDLE_STATE, STATE_TYPES, Recorded
from cnc_ptp.wire.layout import Records

NOT_RECORDED = 26011
NEAR_CYCLES = 1e-6
"""A time in s may be off by rounding."""


def selected(
    recorded: Recorded, *, begin: float | None = None, end: float | None = None, units: Sequence[str] = ()
) -> Recorded:
    """The states, events and commands from `begin` up to `end` in s of axes and spindles `units`.

    Topics of other units are kept. Raises CncError 26011 for a unit that is not recorded and for a time in
    which there is nothing.
    """
    if units:
        recorded = _of_units(recorded, units)
    if begin is None and end is None:
        return recorded
    cycle_time = recorded.cycle_time_ns * 1e-9
    low = -np.inf if begin is None else begin / cycle_time - NEAR_CYCLES
    high = np.inf if end is None else end / cycle_time - NEAR_CYCLES
    states = {topic: _between(rows, low, high) for topic, rows in recorded.states.items()}
    if not any(len(rows) for rows in states.values()):
        raise CncError(
            NOT_RECORDED, f"recording {recorded.path}: {_nothing(recorded, begin, end)}", "nothing was drawn"
        )
    return replace(
        recorded,
        states={topic: rows for topic, rows in states.items() if len(rows)},
        threads={name: part for name, rows in recorded.threads.items() if len(part := _between(rows, low, high))},
        events=[event for event in recorded.events if low <= event.cycle <= high],
        commands=[command for command in recorded.commands if low <= command.cycle <= high],
    )


def nearest(word: str, known: Collection[str]) -> str:
    """`; did you mean 'x' or 'y'?` with the names that are most like a word, otherwise all of them: `; known are …`."""
    close = difflib.get_close_matches(word, known, n=3, cutoff=0.5)
    if close:
        return f"; did you mean {' or '.join(repr(name) for name in close)}?"
    return f"; known are {', '.join(known)}" if known else "; there are none"


def _of_units(recorded: Recorded, units: Sequence[str]) -> Recorded:
    known = [*recorded.of_type(AXIS_STATE), *recorded.of_type(SPINDLE_STATE)]
    for unit in units:
        if unit not in known:
            hint = nearest(unit, known)
            raise CncError(
                NOT_RECORDED, f"recording {recorded.path}: holds no axis or spindle '{unit}'{hint}", "nothing was drawn"
            )
    left_out = {*known} - {*units}
    states = {
        topic: rows for topic, rows in recorded.states.items() if topic[1:].removesuffix("/state") not in left_out
    }
    return replace(
        recorded,
        states=states,
        events=[event for event in recorded.events if event.source not in left_out],
        commands=[command for command in recorded.commands if command.target not in left_out],
    )


def _between(rows: Records, low: float, high: float) -> Records:
    return rows[(rows["cycle"] >= low) & (rows["cycle"] <= high)]


def asked_time(begin: float | None, end: float | None) -> str:
    return f"{'the start' if begin is None else f'{begin:g} s'} to {'the end' if end is None else f'{end:g} s'}"


def _nothing(recorded: Recorded, begin: float | None, end: float | None) -> str:
    cycle_time = recorded.cycle_time_ns * 1e-9
    asked = asked_time(begin, end)
    if recorded.states:
        first = min(int(rows["cycle"].min()) for rows in recorded.states.values()) * cycle_time
        last = recorded.last_cycle * cycle_time
    else:  # only this time was read
        topics = [info for info in recorded.topics.values() if info.type_name in STATE_TYPES]
        if not topics:
            return "holds no states"
        first, last = (
            (time - recorded.start_ns) * 1e-9
            for time in (min(info.first_ns for info in topics), max(info.last_ns for info in topics))
        )
    return f"nothing from {asked}, it covers {first:g} s to {last:g} s"
