"""Synthetic blocks for the tests of the recording: seeded random numbers, or a small machine that moves smoothly."""

from __future__ import annotations

import math
import random
from collections.abc import Iterator
from pathlib import Path

import plotly.graph_objects as go
from mcap_ros2.writer import Writer

from cnc_ptp.plots.report_figures import rows_figure
from cnc_ptp.protocol.blocks import (
    AxisBlock,
    ChannelBlock,
    ChannelOffsets,
    Command,
    CommandRecord,
    CycleBlock,
    CycleTick,
    Event,
    HandshakeRequest,
    PlcBlock,
    SpindleBlock,
)
from cnc_ptp.recording.reader import Recorded
from cnc_ptp.recording.rows import time_rows
from cnc_ptp.recording.settings import Settings
from cnc_ptp.recording.writer import AS_USUAL, Recording

MACHINE = "/machine:\n  ros__parameters: {axes: [x, y, z], note: 'Fräse'}\n"
EXTREMES = [0.0, -0.0, math.nan, math.inf, -math.inf, 5e-324, 1.7976931348623157e308]
STATE_BITS = 3
"""Of the states of units: 0 ... 7."""


class Blocks:
    """Random blocks; floats include NaN, infinities, signed zeros and the smallest and largest numbers."""

    def __init__(self, seed: int) -> None:
        self.random = random.Random(seed)

    def floats(self, count: int) -> list[float]:
        return [self.random.choice([*EXTREMES, self.random.uniform(-1e4, 1e4)]) for _ in range(count)]

    def integers(self, count: int, bits: int) -> list[int]:
        return [self.random.getrandbits(bits) for _ in range(count)]

    def booleans(self, count: int) -> list[bool]:
        return [self.random.random() < 0.5 for _ in range(count)]

    def axis(self, first: int, count: int = 10) -> AxisBlock:
        columns = [self.floats(count) for _ in range(15)]
        return AxisBlock(first, count, *columns, *(self.integers(count, bits) for bits in (STATE_BITS, 32, 32)))

    def spindle(self, first: int, count: int = 10) -> SpindleBlock:
        columns = [self.floats(count) for _ in range(11)]
        output = [value - 2**31 for value in self.integers(count, 32)]
        modes = [self.integers(count, 8) for _ in range(2)]
        flags = [self.booleans(count) for _ in range(5)]
        last = [self.integers(count, bits) for bits in (32, STATE_BITS, 32)]
        return SpindleBlock(first, count, *columns, output, *modes, *flags, *last)

    def channel(self, first: int, count: int = 10, axes: tuple[str, ...] = ("x", "y", "z")) -> ChannelBlock:
        return ChannelBlock(
            first,
            count,
            path_active=bool(axes),
            axes=list(axes),
            set_position=self.floats(count * len(axes)),
            set_velocity=self.floats(count * len(axes)),
            set_acceleration=self.floats(count * len(axes)),
            set_jerk=self.floats(count * len(axes)),
            line=self.integers(count, 32),
            block_number=self.integers(count, 32),
            path_velocity=self.floats(count),
            programmed_feed=self.floats(count),
            override_percent=self.floats(count),
            distance_to_go=self.floats(count),
            state=self.integers(count, STATE_BITS),
            error_id=self.integers(count, 32),
            done=False,
            programmed_position=[1.5, -0.0, 7.25][: len(axes)],
        )

    def channel_with_commands(self, first: int, count: int = 10) -> ChannelBlock:
        block = self.channel(first, count)
        block.commands = [Command("s", "start", {"speed_rpm": 1000.0}, 7), Command("s", "stop", {}, 8)]
        block.offsets = [offsets(first + 4)]
        block.requests = [HandshakeRequest(first + 3, 5, "channel", "M", "s", 3, 0.0, 12, True)]
        return block

    def machine(self, count: int, axes: tuple[str, ...] = ("x", "y")) -> Iterator[tuple[str, CycleBlock]]:
        """`count` blocks of a PLC, a channel, axes and a spindle."""
        for first in range(0, 10 * count, 10):
            yield "plc", PlcBlock(first, 10, first)
            yield "channel", self.channel(first)
            for axis in axes:
                yield axis, self.axis(first)
            yield "s", self.spindle(first)


def offsets(cycle: int) -> ChannelOffsets:
    """Of the axes X, Y, Z."""
    names, own = ["X", "Y", "Z"], ([1.5, 0.0, -3.0], [0.0, 5e-324, 0.0], [0.1, 0.2, 0.3])
    other, scale, mirrored = [7.0, 8.0, 9.0], [1.0, 2.0, 1.0], [False, True, False]
    matrix = [float(place) for place in range(9)]
    values = (
        cycle,
        7,
        names,
        1,
        "Öl",
        *own,
        4,
        other,
        other,
        scale,
        mirrored,
        True,
        30.0,
        ["#ACS"],
        False,
        matrix,
        other,
    )
    tables = {"changed_indices": [1, 96], "changed_offsets": other + own[0], "changed_inactive": 2 * mirrored}
    return ChannelOffsets(*values, default_index=96, **tables)


def record(path: Path, blocks: list[tuple[str, CycleBlock]], **options: float) -> None:
    """A recording of the blocks with one event and one command."""
    with Recording(path, MACHINE, **options) as recording:
        recording.event(Event(3, "x", 1, 23001, 'x: Öl <niedrig> & "fällt"', 4))
        recording.command(CommandRecord(0, "channel", "start", "{}", True, 0, ""))
        for name, block in blocks:
            if name == "plc":
                recording.tick(CycleTick(block.first_cycle, block.count))
            recording.block(name, block)


def foreign_file(path: Path) -> Path:
    """An MCAP file of another program: 20 points in 2 s."""
    with path.open("wb") as stream:
        writer = Writer(stream)
        schema = writer.register_msgdef("geometry_msgs/msg/Point", "float64 x\nfloat64 y\nfloat64 z")
        for number in range(20):
            time = number * 100_000_000
            writer.write_message("/point", schema, {"x": number / 2, "y": 1.0, "z": 0.0}, time, time, number)
        writer.finish()
    return path


SPEED = 2 * math.pi  # rad/s


def smooth_blocks(seconds: float, *, axes: tuple[str, ...] = ("x", "y", "z")) -> list[tuple[str, CycleBlock]]:
    """The blocks of `smooth_run`, one of each unit after the other: PLC, channel, axes, spindle."""
    blocks: list[tuple[str, CycleBlock]] = []
    count = round(seconds * 100)
    for index in range(count):
        first = 10 * index
        blocks += [("plc", PlcBlock(first, 10, index)), ("channel", _channel(first, count * 10))]
        blocks += [(axis, _axis(first, number)) for number, axis in enumerate(axes)]
        blocks.append(("s", _spindle(first)))
    return blocks


def smooth_run(
    path: Path,
    seconds: float = 2.0,
    *,
    axes: tuple[str, ...] = ("x", "y", "z"),
    text: str = "",
    settings: Settings = AS_USUAL,
) -> None:
    """A run as a machine would give it: a helix of radius 40 mm, the spindle runs up, some events and commands."""
    with Recording(path, MACHINE, settings=settings) as recording:
        for name, block in smooth_blocks(seconds, axes=axes):
            if name == "plc":
                recording.tick(CycleTick(block.first_cycle, 10))
            recording.block(name, block)
        for event in _events(text):
            recording.event(event)
        recording.command(CommandRecord(0, "channel", "load", '{"program": "bracket.nc"}', True, 0, ""))
        recording.command(CommandRecord(10, "channel", "start", "{}", True, 0, text))
        recording.command(
            CommandRecord(900, "x", "move_absolute", '{"target": 9999.0}', False, 23010, "x: target 9999.0 mm; refused")
        )


def _events(text: str) -> list[Event]:
    return [
        Event(10, "channel", 0, 0, "program started"),
        Event(500, "s", 1, 24010, f"spindle s: speed 980 rpm, limit 1000 rpm {text}", 12),
        Event(1200, "y", 2, 23020, "axis y: following error 0.8 mm, limit 0.5 mm; the axis stops", 31),
    ]


def _axis(first: int, number: int) -> AxisBlock:
    times = [(first + i) * 1e-3 for i in range(10)]
    phases = [SPEED * t + number * math.pi / 2 for t in times]
    radius = 40.0 if number < 2 else 0.0
    climb = 0.0 if number < 2 else 3.0
    position = [radius * math.cos(phase) + climb * t for phase, t in zip(phases, times, strict=True)]
    velocity = [-radius * SPEED * math.sin(phase) + climb for phase in phases]
    zero = [0.0] * 10
    return AxisBlock(
        first,
        10,
        position,
        velocity,
        [-radius * SPEED**2 * math.cos(phase) for phase in phases],
        [radius * SPEED**3 * math.sin(phase) for phase in phases],
        [p - v / 16.7 for p, v in zip(position, velocity, strict=True)],
        [v * 0.999 for v in velocity],
        [v / 16.7 for v in velocity],
        velocity,
        zero,
        zero,
        zero,
        zero,
        zero,
        zero,
        [100.0 if first < 700 else 75.0] * 10,
        [1 if first < 10 else 5] * 10,
        [256] * 10,
        [0] * 10,
    )


def _spindle(first: int) -> SpindleBlock:
    speeds = [min(1000.0, 2.0 * (first + i)) for i in range(10)]
    zero = [0.0] * 10
    return SpindleBlock(
        first,
        10,
        speeds,
        [speed * 0.98 for speed in speeds],
        [1000.0] * 10,
        zero,
        zero,
        zero,
        zero,
        zero,
        zero,
        [100.0] * 10,
        zero,
        [0] * 10,
        [2] * 10,
        [1] * 10,
        [speed >= 950.0 for speed in speeds],
        [speed < 1.0 for speed in speeds],
        [False] * 10,
        [True] * 10,
        [False] * 10,
        [5] * 10,
        [4] * 10,
        [0] * 10,
    )


def _channel(first: int, cycles: int) -> ChannelBlock:
    state = 1 if first < 10 else 3 if 600 <= first < 640 else 2 if first < cycles - 100 else 0
    return ChannelBlock(
        first,
        10,
        line=[first // 100 + 1] * 10,
        block_number=[first // 10] * 10,
        path_velocity=[40.0 * SPEED] * 10,
        programmed_feed=[260.0] * 10,
        override_percent=[100.0 if first < 700 else 75.0] * 10,
        distance_to_go=[50.0] * 10,
        state=[state] * 10,
        error_id=[0] * 10,
    )


def time_figure(recorded: Recorded, units: dict[str, str], torque_units: dict[str, str] | None = None) -> go.Figure:
    """All that a report draws over time; `units`: mm or deg by axis, `torque_units`: Nm or N."""
    return rows_figure(recorded, list(time_rows(recorded, units, torque_units or {})))
