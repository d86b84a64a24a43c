"""A turned part as its program names it: the profile, the unrolled cylinder and the face, with the path of the tools.

The head names the work, each with its first block number and the first one behind it: `turns: contour = N320 N520; …`.
What is done within #CYL is drawn over the length of arc, within #FACE over x, all else as radius over Z. Positions are
those that the channel shows, one for each block of cycles.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from cnc_ptp.plots.colours import BY_AXIS, FAINT
from cnc_ptp.plots.sheet import GAP, HEADER, LEFT, PLOT, Name, Sheet, draw_header, style_plot
from cnc_ptp.protocol.blocks import ChannelBlock
from figures.circle import named_turns
from figures.run import Column, FigureRun
from figures.scenario_head import FigureError, FigureScenario

PROFILE, LOWER, SPACE = 300.0, 270.0, 60.0
BESIDE = 3.0
"""mm of rapid traverse that is drawn around the work."""
RAPID = 60.0
"""mm/s; a larger feed is rapid traverse."""


@dataclass(frozen=True, slots=True)
class Work:
    """One of `turns`: positions of the channel's axes at the end of each block of cycles, and whether it cuts there."""

    name: str
    colour: str
    places: Column
    cuts: Column
    kinematics: str


def draw(figure: FigureScenario, run: FigureRun) -> Figure:
    """The picture of a figure with X, Z and a C axis. Raises FigureError."""
    works = list(works_of(figure, run))
    sheet = Sheet(figure, 2.0 * HEADER + PROFILE + LOWER + 4.0 * GAP)
    half, below = 0.5 * (PLOT - SPACE), sheet.upper + 2.0 * HEADER + PROFILE + 4.0 * GAP
    plots = (
        ("", "radius over Z in mm", (1, 0), sheet.plot(sheet.upper + HEADER, PROFILE)),
        ("#CYL", "Z over the length of arc in mm", (2, 1), sheet.plot(below, LOWER, width=half)),
        ("#FACE", "y over x on the face in mm", (0, 2), sheet.plot(below, LOWER, left=LEFT + half + SPACE, width=half)),
    )
    for kinematics, title, axes, plot in plots:
        shown = [work for work in works if work.kinematics == kinematics]
        if not shown:
            raise FigureError(figure.path, f"none of its turns is drawn as {title}")
        draw_plan(plot, shown, axes)
        draw_header(plot, title, [Name(work.name, work.colour) for work in shown])
    return sheet.drawing


def works_of(figure: FigureScenario, run: FigureRun) -> Iterator[Work]:
    """Those of the head. Raises FigureError for one that the program does not have."""
    channel = next(iter(run.machine.channels.values()))
    if not figure.program_path or channel.path_axes != ("X", "Z", channel.c_axis or "C"):
        raise FigureError(figure.path, "a turned part needs 'program: ...' and a channel with X, Z and a C axis")
    blocks = [block for tick in run.ticks if isinstance(block := tick[channel.name].block, ChannelBlock)]
    numbers = np.array([block.block_number[-1] for block in blocks])
    places = np.array([block.programmed_position for block in blocks])
    feeds = np.array([block.programmed_feed[-1] for block in blocks])
    systems = np.array(list(systems_of(blocks)))
    for (name, (first, *_, behind)), colours in zip(named_turns(figure), BY_AXIS, strict=False):
        begins, ends = np.flatnonzero(numbers == first), np.flatnonzero(numbers == behind)
        if not begins.size or not ends.size:
            raise FigureError(figure.path, f"turns '{name}': the program is never in N{first} and N{behind}")
        part = np.arange(begins[0], ends[0])
        part = part[systems[part] == systems[part[-1]]]
        yield Work(name, colours.set, places[part], (feeds[part] > 0.0) & (feeds[part] < RAPID), systems[part[-1]])


def systems_of(blocks: Sequence[ChannelBlock]) -> Iterator[str]:
    """#FACE, #CYL or nothing at the end of each block."""
    active = ""
    for block in blocks:
        for offsets in block.offsets:
            active = next((name.split()[0] for name in offsets.systems if name.startswith(("#FACE", "#CYL"))), "")
        yield active


def draw_plan(plot: Axes, works: Sequence[Work], axes: tuple[int, int]) -> None:
    """Rapid traverse is faint; all is at the same scale."""
    style_plot(plot)
    plot.tick_params(labelbottom=True)
    for work in works:
        across, along = (work.places[:, axis] for axis in axes)
        plot.plot(across, along, color=FAINT, linewidth=0.6)
        plot.plot(
            np.where(work.cuts, across, np.nan), np.where(work.cuts, along, np.nan), color=work.colour, linewidth=1.2
        )
    cut = np.concatenate([work.places[work.cuts][:, list(axes)] for work in works])
    low, high = cut.min(axis=0) - BESIDE, cut.max(axis=0) + BESIDE
    plot.set_aspect("equal", adjustable="box", anchor="NW")
    plot.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]))
