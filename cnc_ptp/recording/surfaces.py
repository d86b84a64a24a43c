"""Motions of a recording on the face (#FACE) and on the lateral surface (#CYL) of a workpiece, in its coordinates."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from cnc_ptp.parameters import ChannelParameters, MachineParameters
from cnc_ptp.protocol.spindle_states import SpindleBit
from cnc_ptp.recording.reader import AXIS_STATE, CHANNEL_STATE, SPINDLE_STATE, Coordinates, Recorded
from cnc_ptp.recording.rows import ACTUAL
from cnc_ptp.wire.layout import Records

Floats = npt.NDArray[np.float64]
FACE, CYLINDER = "#FACE", "#CYL"
COMMAND = re.compile(r"(#FACE|#CYL) \[(\w+), (\w+)(?:, ([^\]]+))?\]")
"""The systems of ChannelOffsets name them so."""


@dataclass(frozen=True, slots=True)
class Surface:
    """The n cycles for which one of the commands is on.

    command   as programmed, and its `kind`
    axes      what the coordinates are
    points    positions (2, n), mm: x and y of the face; the longitudinal axis and the circumference
    cycles    (n,)
    velocity  of the path, mm/s (n,)
    """

    kind: str
    command: str
    axes: tuple[str, str]
    points: Floats
    cycles: npt.NDArray[np.uint64]
    velocity: Floats


def surfaces(recorded: Recorded, machine: MachineParameters | None, values: str = ACTUAL) -> list[Surface]:
    """All of them in the order of time; none without a machine file, which says which spindle is the C axis.

    `values`: SET or ACTUAL.
    """
    if machine is None:
        return []
    return [found for channel in machine.channels.values() for found in _of_channel(recorded, channel, values)]


def _of_channel(recorded: Recorded, channel: ChannelParameters, values: str) -> Iterator[Surface]:
    changes = [change for change in recorded.coordinates if change.channel == channel.name]
    end = Coordinates(recorded.last_cycle + 1, channel.name, (), (), ())
    for change, following in pairwise([*changes, end]):
        command = next((system for system in change.systems if COMMAND.fullmatch(system)), "")
        origin = dict(zip(change.axes, change.origin, strict=False))
        cycles = (change.cycle, following.cycle)
        found = _surface(recorded, channel, command, origin, cycles, values) if command else None
        if found is not None:
            yield found


def _surface(
    recorded: Recorded,
    channel: ChannelParameters,
    command: str,
    origin: Mapping[str, float],
    cycles: tuple[int, int],
    values: str,
) -> Surface | None:
    """`origin`: machine position of the zero point by axis; None where states are missing."""
    kind, first, second, radial = COMMAND.fullmatch(command).groups()  # type: ignore[union-attr]
    path = part_of(recorded.of_type(CHANNEL_STATE).get(channel.name), cycles)
    along, turned = (_positions(recorded, channel, name, cycles, values) for name in (first, second))
    if path is None or along is None or turned is None or not len(path) == len(along) == len(turned) > 1:
        return None
    distance, angle = along - origin.get(first, 0.0), np.radians(turned - origin.get(second, 0.0))
    if kind == FACE:
        points, axes = np.stack([distance * np.cos(angle), distance * np.sin(angle)]), ("x", "y")
    else:
        names = [name for name in channel.path_axes if radial.startswith(name)]
        radius = float(radial.removeprefix(max(names, key=len, default="")))
        angle -= 2.0 * np.pi * np.rint(angle[0] / (2.0 * np.pi))
        points, axes = np.stack([distance, radius * angle]), (first, "circumference")
    return Surface(kind, command, axes, points, path["cycle"], path["path_velocity"])


def _positions(
    recorded: Recorded, channel: ChannelParameters, name: str, cycles: tuple[int, int], values: str
) -> Floats | None:
    """Positions of an axis by its name in programs; of the C axis those of the spindle that is on the path."""
    node = next((axis.node for axis in channel.axes if axis.name == name), "")
    if node:
        rows = part_of(recorded.of_type(AXIS_STATE).get(node), cycles)
        return None if rows is None else rows[f"{values}_position"]
    states = recorded.of_type(SPINDLE_STATE)
    spindles = [part_of(states.get(entry.node), cycles) for entry in channel.spindles]
    rows = max([each for each in spindles if each is not None], key=_cycles_on_path, default=None)
    return None if rows is None or not _cycles_on_path(rows) else rows[f"{values}_position_deg"]


def _cycles_on_path(spindle: Records) -> int:
    """In how many of these states the path moves a spindle (#MAIN SPINDLE may have made another one the C axis)."""
    return int(np.count_nonzero(spindle["status_bits"] & np.uint32(SpindleBit.ON_PATH)))


def part_of(rows: Records | None, cycles: tuple[int, int]) -> Records | None:
    """The states from the first of two cycles up to the second."""
    return None if rows is None else rows[(rows["cycle"] >= cycles[0]) & (rows["cycle"] < cycles[1])]
