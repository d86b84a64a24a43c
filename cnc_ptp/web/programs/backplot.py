"""The path of a program as a polyline with feed and line: interpreted, not run; made in a process beside the server."""

from __future__ import annotations

import struct
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import acos, ceil, hypot, radians
from pathlib import Path

import numpy as np
import numpy.typing as npt

from cnc_ptp.channel.program_check import ProgramCheck
from cnc_ptp.errors import CncError
from cnc_ptp.kinematics.kinematics import Kinematics
from cnc_ptp.machine.program_files import Search, folder_of
from cnc_ptp.nc.awaited import reads_the_run
from cnc_ptp.nc.canonical import CanonicalBlock, CircularMove, HomeAxes, LinearMove
from cnc_ptp.nc.coordinates.coordinates import NO_CHANGES, OffsetChanges
from cnc_ptp.nc.interpreter import interpret
from cnc_ptp.parameters import ParameterSet
from cnc_ptp.parameters.view.axis_view import axis_view
from cnc_ptp.parameters.view.channel_view import channel_view
from cnc_ptp.parameters.view.spindle_view import spindle_view
from cnc_ptp.path.geometry import Arc

MOST_POINTS = 1_000_000
LONGEST = 60.0
"""Seconds of interpretation: an endless program is drawn as far as it came."""
LOOK_EVERY = 100
"""Blocks between two looks at the time, and at whether anybody still wants the drawing."""
PART = 0.5
"""mm of a line of #FACE or #CYL, on which the axes go along a curve; at most as many as chords of an arc."""
CHORD = 0.005
"""mm by which a chord of an arc leaves it; of large arcs at most …"""
MOST_CHORDS = 180
"""… so many chords."""
COLUMNS = 5
"""x, y, z (mm), feed (mm/min, 0: rapid), line."""
HEAD = struct.Struct("<4I")
"""Version, points n, flags, number of the program; then n x 5 values of float32, little endian."""
VERSION = 1
TURNING, CUT_OFF = 1, 2
"""Flags: a lathe; the program continues, but no further than that is known, or shown."""


@dataclass(frozen=True, slots=True)
class Drawing:
    """What is needed to draw a program: parameters by unit, the text, and where programs that it calls are."""

    channel: str
    kinds: Mapping[str, str]
    sets: Mapping[str, ParameterSet]
    cycle_time: float
    text: str
    file: str
    dialect: str | None = None
    files: Mapping[str, str] | None = None
    """Texts of the programs that it calls, by name; None: they are looked for."""
    changes: OffsetChanges = NO_CHANGES
    """Zero offsets that are not those of the parameters."""
    clamp_index: int = 0
    """The clamp position of now."""


def is_always_wanted() -> bool:
    return True


def draw(
    drawing: Drawing,
    *,
    most: int = MOST_POINTS,
    seconds: float = LONGEST,
    is_wanted: Callable[[], bool] = is_always_wanted,
) -> bytes:
    """HEAD and points, as far as it came when it is no longer wanted.

    Raises ProgramError for a program that is refused when it is loaded.
    """
    check, turning = program_check(drawing)
    files = drawing.files
    if files is None:
        files = Search(check_folders(drawing), {}).called(drawing.text, folder_of(drawing.file))
    program = check.parse(drawing.text, drawing.file, files, drawing.dialect)
    pen = Pen(check.axis_names, check.start, most)
    state = check.state({}, {}, {}, drawing.changes, drawing.clamp_index)
    blocks = interpret(program, check.start, check.nc, state=state.modal, values=state.values, runs=True)
    end = time.monotonic() + seconds
    is_whole = True
    try:
        for number, block in enumerate(blocks):
            is_late = number % LOOK_EVERY == 0 and (time.monotonic() > end or not is_wanted())
            if reads_the_run(block) or pen.is_full or is_late:
                is_whole = False
                break
            pen.draw(block)
    except CncError:
        is_whole = False  # the channel says what is wrong when it is started
    points = pen.points()
    flags = TURNING * turning | CUT_OFF * (not is_whole)
    return HEAD.pack(VERSION, len(points), flags, 0) + points.tobytes()


def program_check(drawing: Drawing) -> tuple[ProgramCheck, bool]:
    """The channel as programs see it, and whether it turns."""
    sets, kinds = drawing.sets, drawing.kinds
    axes = {unit: axis_view(sets[unit], drawing.cycle_time) for unit, kind in kinds.items() if kind == "axis"}
    spindles = {unit: spindle_view(sets[unit], drawing.cycle_time) for unit, kind in kinds.items() if kind == "spindle"}
    channel = channel_view(sets[drawing.channel], sets, Path())
    turning = any(axes[axis.node].facing for axis in channel.axes)
    return ProgramCheck(channel, axes, spindles), turning


def check_folders(drawing: Drawing) -> tuple[str, ...]:
    return channel_view(drawing.sets[drawing.channel], drawing.sets, Path()).folders


class Pen:
    """Draws motions one after the other, as positions of the axes; with #FACE X is the distance from the centre."""

    def __init__(self, axes: Sequence[str], start: Sequence[float], most: int) -> None:
        """`axes`: names in programs; `start` in mm; `most` points."""
        names = [name.upper() for name in axes]
        self._places = [names.index(name) if name in names else -1 for name in "XYZ"]
        self._path_axes = tuple(place for place in self._places if place >= 0)
        self._here = tuple(start)
        """Where the axes are."""
        self._most = most
        self._values: list[float] = []
        self._add(self._here, 0.0, 0)

    @property
    def is_full(self) -> bool:
        return len(self._values) >= self._most * COLUMNS

    def draw(self, block: CanonicalBlock) -> None:
        motion = block.motion
        if isinstance(motion, LinearMove):
            self._line(motion, block.source.line)
        elif isinstance(motion, CircularMove):
            self._arc(motion, block.source.line)
        elif isinstance(motion, HomeAxes):
            self._break(block.source.line)

    def _line(self, motion: LinearMove, line: int) -> None:
        feed, kinematics = 0.0 if motion.rapid else motion.feed * 60.0, motion.kinematics
        if kinematics is not None:
            begin = kinematics.forward(self._here)
            way = [end - start for start, end in zip(begin, motion.target, strict=True)]
            count = min(MOST_CHORDS, ceil(hypot(*(way[place] for place in kinematics.plane)) / PART))
            for number in range(1, count):
                place = [start + number / count * part for start, part in zip(begin, way, strict=True)]
                self._go(place, kinematics, feed, line)
        self._go(motion.target, kinematics, feed, line)

    def _arc(self, motion: CircularMove, line: int) -> None:
        plane, directions, kinematics = motion.plane, motion.directions, motion.kinematics
        begin = self._here if kinematics is None else kinematics.forward(self._here)
        arc = Arc(begin, motion.target, motion.center, plane, motion.radius, motion.sweep, self._path_axes, directions)
        count = chords(motion.radius, motion.sweep)
        for number in range(1, count):
            state = arc.evaluate(arc.length * number / count, 0.0, 0.0, 0.0)
            self._go([axis[0] for axis in state], kinematics, motion.feed * 60.0, line)
        self._go(motion.target, kinematics, motion.feed * 60.0, line)

    def _go(self, target: Sequence[float], kinematics: Kinematics | None, feed: float, line: int) -> None:
        """Straight to a programmed place."""
        programmed = tuple(target)
        self._here = programmed if kinematics is None else kinematics.inverse(programmed, self._here)
        self._add(self._here, feed, line)

    def _add(self, position: Sequence[float], feed: float, line: int) -> None:
        self._values += [position[place] if place >= 0 else 0.0 for place in self._places]
        self._values += (feed, line)

    def _break(self, line: int) -> None:
        """Where the next motion begins is not known: a point without a place."""
        self._values += (float("nan"), float("nan"), float("nan"), 0.0, line)

    def points(self) -> npt.NDArray[np.float32]:
        """(n, 5)"""
        return np.array(self._values, dtype="<f4").reshape(-1, COLUMNS)


def chords(radius: float, sweep: float) -> int:
    """Number of chords of an arc; radius in mm, sweep in deg."""
    if radius <= CHORD:
        return 2
    return max(2, min(MOST_CHORDS, ceil(radians(abs(sweep)) / (2.0 * acos(1.0 - CHORD / radius)))))
