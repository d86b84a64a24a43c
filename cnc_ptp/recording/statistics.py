"""Figures of a run: program time, cycles, lost blocks, largest following errors, lateness, errors."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np

from cnc_ptp.errors import CncError
from cnc_ptp.parameters import MachineParameters, load_machine
from cnc_ptp.parameters.view.encoder import uses_feed_constant
from cnc_ptp.protocol.blocks import Severity
from cnc_ptp.protocol.channel_states import IN_PROGRAM
from cnc_ptp.recording.node_figures import LATENESS_P50, LATENESS_P99, LOST_BLOCKS
from cnc_ptp.recording.reader import AXIS_STATE, CHANNEL_STATE, Recorded
from cnc_ptp.recording.writer import MACHINE_FILE
from cnc_ptp.wire.layout import Records


@dataclass(frozen=True, slots=True)
class Extreme:
    """The largest magnitude of a quantity and its time."""

    value: float
    cycle: int
    time_s: float


def summary(recorded: Recorded) -> dict[str, Any]:
    """The figures that close a run.

    `program_time_s` (None without a channel): time in which a program was being executed, waiting included;
    `duration_s`: recorded time; `cycles`, `blocks`; `lost_blocks`: blocks that the nodes reported as lost, or that are
    missing in the recording, whichever is more; `following_error`: Extreme by axis; `units`: mm or deg by axis, as far
    as known; `lateness_p50_ms`, `lateness_p99_ms`: of the node that was latest, None if no node reported; `errors`,
    `warnings`: events; `commands`, `refused`; `complete`, `missing`: of the file.
    """
    nodes = last_diagnostics(recorded)
    reported = sum(_number(values, LOST_BLOCKS) or 0 for values in nodes.values())
    return {
        "program_time_s": program_time(recorded),
        "duration_s": cycles(recorded) * recorded.cycle_time_ns * 1e-9,
        "cycles": cycles(recorded),
        "blocks": math.ceil(cycles(recorded) / recorded.block_cycles),
        "lost_blocks": max(int(reported), missing_blocks(recorded)),
        "following_error": largest_following_errors(recorded),
        "units": axis_units(recorded),
        "lateness_p50_ms": _largest(nodes, LATENESS_P50),
        "lateness_p99_ms": _largest(nodes, LATENESS_P99),
        "errors": sum(event.severity == Severity.ERROR for event in recorded.events),
        "warnings": sum(event.severity == Severity.WARNING for event in recorded.events),
        "commands": len(recorded.commands),
        "refused": sum(not command.accepted for command in recorded.commands),
        "complete": recorded.complete,
        "missing": recorded.missing,
    }


def cycles(recorded: Recorded) -> int:
    """Cycles from the first to the last recorded one."""
    first = min((int(rows["cycle"].min()) for rows in recorded.states.values()), default=0)
    return recorded.last_cycle + 1 - first


def program_time(recorded: Recorded) -> float | None:
    """Time in s that a channel spent executing a program; the longest of several, None without a channel."""
    channels = recorded.of_type(CHANNEL_STATE)
    if recorded.reduced is not None:
        active = [recorded.reduced.in_program[name] for name in channels]
    else:
        active = [int(np.isin(rows["state"], IN_PROGRAM).sum()) for rows in channels.values()]
    return max(active) * recorded.cycle_time_ns * 1e-9 if active else None


def missing_blocks(recorded: Recorded) -> int:
    """Blocks missing between the first and the last cycle of each unit, all units together."""
    if recorded.reduced is not None:
        return recorded.reduced.missing
    return sum(_missing_blocks(rows, recorded.block_cycles) for rows in recorded.states.values())


def _missing_blocks(rows: Records, block_cycles: int) -> int:
    numbers = np.unique(rows["cycle"]).astype(np.int64)
    gaps = np.diff(numbers) - 1
    return int(np.ceil(gaps / block_cycles).sum())


def largest_following_errors(recorded: Recorded) -> dict[str, Extreme]:
    """The largest following error by axis; mm or deg."""
    result: dict[str, Extreme] = {}
    for name, rows in recorded.of_type(AXIS_STATE).items():
        known = largest_error(rows) if recorded.reduced is None else recorded.reduced.largest[name]
        result[name] = Extreme(*known, known[1] * recorded.cycle_time_ns * 1e-9)
    return result


def largest_error(rows: Records) -> tuple[float, int]:
    """The largest following error and its cycle; NaN is the largest."""
    magnitudes = np.nan_to_num(np.abs(rows["following_error"]), nan=np.inf)
    place = int(magnitudes.argmax())
    return float(rows["following_error"][place]), int(rows["cycle"][place])


def axis_units(recorded: Recorded) -> dict[str, str]:
    """`mm` or `deg` by axis as the machine file says; empty when the recording holds none that can be loaded."""
    machine = _machine(recorded.machine_yaml)
    return {name: "deg" if axis.rotary else "mm" for name, axis in machine.axes.items()} if machine else {}


def in_machine_order(recorded: Recorded) -> Recorded:
    """The recording with states and diagnostics in the order of the machine file, not that of their arrival.

    Units of each kind as /machine lists them, unlisted ones after them; unchanged without a machine file.
    """
    machine = _machine(recorded.machine_yaml)
    if machine is None:
        return recorded
    units = [*machine.channels, *machine.spindles, *machine.axes]

    def place(name: str) -> int:
        unit = name.removeprefix("/").removesuffix("/state")
        return units.index(unit) if unit in units else len(units)

    states = {topic: recorded.states[topic] for topic in sorted(recorded.states, key=place)}
    diagnostics = sorted(recorded.diagnostics, key=lambda diagnostic: place(diagnostic.name))
    return replace(recorded, states=states, diagnostics=diagnostics)


def torque_units(recorded: Recorded) -> dict[str, str]:
    """Nm by axis where torques are those of a motor shaft (rotary axes, axes with a feed constant), else N.

    Empty when the recording holds no machine file that can be loaded.
    """
    machine = _machine(recorded.machine_yaml)
    if machine is None:
        return {}
    shaft = {name: axis.rotary or uses_feed_constant(machine.raw(name)) for name, axis in machine.axes.items()}
    return {name: "Nm" if on_shaft else "N" for name, on_shaft in shaft.items()}


@lru_cache(maxsize=1)
def _machine(text: str) -> MachineParameters | None:
    """A recording and its parts have one text, which is read once."""
    try:
        return load_machine(text, MACHINE_FILE)
    except CncError:
        return None


def last_diagnostics(recorded: Recorded) -> dict[str, dict[str, str]]:
    """The last reported values of each node, by its name."""
    return {diagnostic.name: diagnostic.values for diagnostic in recorded.diagnostics}


def _largest(nodes: dict[str, dict[str, str]], key: str) -> float | None:
    numbers = [number for values in nodes.values() if (number := _number(values, key)) is not None]
    return max(numbers, default=None)


def _number(values: dict[str, str], key: str) -> float | None:
    try:
        return float(values[key])
    except (KeyError, ValueError):
        return None
