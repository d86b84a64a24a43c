"""The run of a program along its path, from the states of a recording or of an offline run."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from cnc_ptp.channel.program_check import ProgramCheck
from cnc_ptp.errors import CncError
from cnc_ptp.nc.canonical import CanonicalBlock, CircularMove, LinearMove
from cnc_ptp.nc.parser import parse_program
from cnc_ptp.nc.vocabularies import VOCABULARIES
from cnc_ptp.parameters import ChannelParameters, MachineParameters, load_machine
from cnc_ptp.path.geometry import NEGLIGIBLE_MM, Arc
from cnc_ptp.protocol.blocks import CommandRecord
from cnc_ptp.protocol.channel_states import IN_PROGRAM
from cnc_ptp.recording.command_words import is_load, json_object
from cnc_ptp.recording.reader import AXIS_STATE, CHANNEL_STATE, Recorded
from cnc_ptp.wire.layout import Records

Floats = npt.NDArray[np.float64]
ARC_STEP = 3.0
"""deg between points of a programmed arc."""


@dataclass(frozen=True, slots=True)
class BlockPass:
    """A block as it was run: `length` in mm, `seconds`, largest path velocity `reached` and `feed` in mm/s.

    `number` N word, 0 none; `text` "" if it is not known; `begin`: place of its first cycle in the run.
    """

    begin: int
    line: int
    number: int
    text: str
    length: float
    seconds: float
    feed: float
    reached: float


@dataclass(frozen=True, slots=True)
class ProgramRun:
    """The cycles of a program's run, n of them.

    nodes         its linear axes, X Y Z if there are any; by these the path is measured and drawn
    channel       states of the channel, (n,)
    axes          states of each of `nodes`, (n,)
    length        mm run since the start, (n,)
    programmed    corners of the programmed path, arcs in steps, (axes, m); None if it is not known
    blocks        that took a cycle at least
    total         blocks of the program with a motion, as far as known; None if they are not
    machine       None if the recording holds none
    """

    nodes: tuple[str, ...]
    cycle_time: float
    channel: Records
    axes: tuple[Records, ...]
    length: Floats
    programmed: Floats | None
    blocks: tuple[BlockPass, ...]
    total: int | None
    machine: MachineParameters | None

    @property
    def seconds(self) -> float:
        """Time of the program, waiting included."""
        return len(self.channel) * self.cycle_time

    def column(self, field: str) -> Floats:
        """A field of the axes, (axes, n)."""
        return np.stack([rows[field] for rows in self.axes])


def program_run(recorded: Recorded, nodes: Sequence[str]) -> ProgramRun | None:
    """The run of the first channel that moves along a path, over the axes `nodes`; None if there is none."""
    channels = {name: rows for name, rows in recorded.of_type(CHANNEL_STATE).items() if np.any(rows["path_velocity"])}
    if not channels or len(nodes) < 2:
        return None
    name, states = next(iter(channels.items()))
    axes = [recorded.of_type(AXIS_STATE)[node] for node in nodes]
    channel, *of_axes = in_program(states, axes)
    if len(channel) == 0:
        return None
    positions = np.stack([rows["set_position"] for rows in of_axes])
    steps = np.sqrt((np.diff(positions, axis=1) ** 2).sum(axis=0))
    length = np.concatenate([[0.0], np.cumsum(steps)])
    cycle_time = recorded.cycle_time_ns * 1e-9
    machine = machine_of(recorded)
    known = None if machine is None else known_blocks(recorded, machine, name)
    corners = None
    if known is not None and machine is not None and known.blocks:
        places = [axis.node for axis in machine.channels[name].axes]
        if all(node in places for node in nodes):
            corners = programmed_path(known, [places.index(node) for node in nodes])
    return ProgramRun(
        nodes=tuple(nodes),
        cycle_time=cycle_time,
        channel=channel,
        axes=tuple(of_axes),
        length=length,
        programmed=corners,
        blocks=tuple(passes(channel, length, cycle_time, [] if known is None else known.blocks)),
        total=None if known is None else sum(map(moves, known.blocks)),
        machine=machine,
    )


def in_program(channel: Records, axes: Sequence[Records]) -> list[Records]:
    """The rows of the cycles that all have, from the first to the last one in which a program was being executed."""
    common = channel["cycle"]
    for rows in axes:
        common = np.intersect1d(common, rows["cycle"])
    active = channel["cycle"][np.isin(channel["state"], IN_PROGRAM)]
    if len(active) == 0:
        return [rows[:0] for rows in (channel, *axes)]
    common = common[(common >= active.min()) & (common <= active.max())]
    return [rows[np.isin(rows["cycle"], common)] for rows in (channel, *axes)]


def machine_of(recorded: Recorded) -> MachineParameters | None:
    """The machine of a recording, if it holds one that can be loaded."""
    try:
        return load_machine(recorded.machine_yaml, "machine.yaml")
    except CncError:
        return None


@dataclass(frozen=True, slots=True)
class Known:
    """Blocks of a program from `start` (mm, deg), by the axes of `channel`."""

    channel: ChannelParameters
    start: tuple[float, ...]
    blocks: Sequence[CanonicalBlock]


def known_blocks(recorded: Recorded, machine: MachineParameters, name: str) -> Known | None:
    """The blocks of the program that was loaded and started first in a channel, interpreted again.

    None for manual blocks alone, for a program that was not started at its beginning, and where something is missing.
    """
    load, start = (first_command(recorded, name, command) for command in ("load", "start"))
    if load is None or start is None or json_object(start.arguments_json or "{}") != {}:
        return None
    channel, values = machine.channels[name], json_object(load.arguments_json) or {}
    axes, dialect = recorded.of_type(AXIS_STATE), values.get("dialect")
    if not (is_load(values) and values.get("text")) or not all(axis.node in axes for axis in channel.axes):
        return None
    if dialect and dialect not in VOCABULARIES:
        return None
    begin = tuple([position_at(axes[axis.node], start.cycle) for axis in channel.axes])
    check = ProgramCheck(channel, machine.axes, machine.spindles)
    begin += check.start[len(begin) :]
    vocabulary = VOCABULARIES[dialect] if dialect else check.vocabulary
    try:
        program = parse_program(
            values["text"], values["program"], files=values.get("files") or {}, vocabulary=vocabulary
        )
        return Known(channel, begin, check.known_ahead(program, begin, check.state({}, {}, {})).blocks)
    except CncError:
        return None


def first_command(recorded: Recorded, target: str, command: str) -> CommandRecord | None:
    """The first one that was carried out."""
    found = (record for record in recorded.commands if record.accepted)
    return next((record for record in found if (record.target, record.command) == (target, command)), None)


def position_at(rows: Records, cycle: int) -> float:
    """Set position in a cycle, or in the first one behind it."""
    return float(rows["set_position"][min(int(np.searchsorted(rows["cycle"], cycle)), len(rows) - 1)])


def moves(block: CanonicalBlock) -> bool:
    return isinstance(block.motion, (LinearMove, CircularMove))


def programmed_path(known: Known, axes: Sequence[int]) -> Floats:
    """Corners of the path over the axes with these places in the channel, arcs in steps of 3 deg, (axes, m)."""
    position, corners = known.start, [known.start]
    for block in known.blocks:
        motion = block.motion
        if isinstance(motion, CircularMove):
            corners += arc_points(motion, position)
        if isinstance(motion, (LinearMove, CircularMove)):
            position = motion.target
            corners.append(position)
    return np.array(corners, dtype=np.float64)[:, list(axes)].T


def arc_points(motion: CircularMove, start: tuple[float, ...]) -> list[tuple[float, ...]]:
    """Points of an arc between its start and its end."""
    arc = Arc(start, motion.target, motion.center, motion.plane, motion.radius, motion.sweep, motion.plane)
    count = int(abs(motion.sweep) / ARC_STEP) + 1
    states = [arc.evaluate(arc.length * index / count, 0.0, 0.0, 0.0) for index in range(1, count)]
    return [tuple([state[0] for state in point]) for point in states]


def passes(channel: Records, length: Floats, cycle_time: float, blocks: Sequence[CanonicalBlock]) -> list[BlockPass]:
    """The stretches of one block each: another line or block number, or a distance to go that has grown."""
    line, number, to_go = (channel[name] for name in ("line", "block_number", "distance_to_go"))
    other = (line[1:] != line[:-1]) | (number[1:] != number[:-1]) | (np.diff(to_go) > NEGLIGIBLE_MM)
    begins = np.concatenate([[0], np.flatnonzero(other) + 1])
    ends = np.concatenate([begins[1:], [len(line)]])
    texts = BlockTexts(blocks)
    found = []
    for begin, end in zip(begins.tolist(), ends.tolist(), strict=True):
        if line[begin] == 0:
            continue  # the program has not reached its first block
        found.append(
            BlockPass(
                begin=begin,
                line=int(line[begin]),
                number=int(number[begin]),
                text=texts.next(int(line[begin]), int(number[begin])),
                length=float(length[end - 1] - length[max(0, begin - 1)]),
                seconds=(end - begin) * cycle_time,
                feed=float(channel["programmed_feed"][begin:end].max()),
                reached=float(channel["path_velocity"][begin:end].max()),
            )
        )
    return found


class BlockTexts:
    """Texts of the blocks in the order in which they are run."""

    def __init__(self, blocks: Sequence[CanonicalBlock]) -> None:
        self._blocks = blocks
        self._places: dict[tuple[int, int], list[int]] = {}
        for place, block in enumerate(blocks):
            self._places.setdefault((block.source.line, block.source.block_number), []).append(place)
        self._next = 0

    def next(self, line: int, number: int) -> str:
        """Text of the next block with this line and N word, or of the last one; "" if there is none."""
        places = self._places.get((line, number))
        if not places:
            return ""
        place = places[min(bisect_left(places, self._next), len(places) - 1)]
        self._next = max(self._next, place + 1)
        return self._blocks[place].source.text
