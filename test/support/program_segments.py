"""What a program means for the path checker: the motions of its canonical stream as segments in machine coordinates."""

from __future__ import annotations

from collections.abc import Iterable
from math import inf, radians
from typing import Any

import numpy as np
from example_support import ExampleRun
from machine_support import ROOT
from path_checker import Axis, Findings, PathChecker, Run, Segment

from cnc_ptp.channel.program_check import ProgramCheck
from cnc_ptp.machine.program_files import read_program
from cnc_ptp.machine.run_entries import program_search
from cnc_ptp.nc.canonical import STEP, CanonicalBlock, CircularMove, HomeAxes, LinearMove
from cnc_ptp.nc.contour import DEV, POS, Transition
from cnc_ptp.parameters import MachineParameters

JOINT = 0.25
"""mm; where two blocks of a thread meet, the slopes of the axes change within a zone."""


def findings(machine: str, program: str) -> list[str]:
    """Runs a program of the folder of the project on one of its machines; what the checker says of the run.

    Of a program whose motions only the run knows, or lie behind a kinematics, the limits of the axes alone are checked.
    """
    dialect = "iso" if program.endswith(".ngc") else "twincat"
    bench = ExampleRun(str(ROOT / machine), str(ROOT / program), dialect=dialect)
    found = [event.text for event in bench.events if event.severity == 2]
    blocks, complete = canonical(bench.machine, program, dialect)
    channel = next(iter(bench.machine.channels.values()))
    steps = channel.slope == STEP or any(getattr(block.motion, "slope", "") == STEP for block in blocks)
    start = [bench.machine.axes[axis.node].start_position for axis in channel.axes]
    segments = segments_of(blocks, start) if complete else None
    checker = PathChecker(segments or [], axes_of(bench.machine), path_axes(channel), steps=steps)
    run = run_of(bench)
    if segments is None:
        checker.limits(run, result := Findings())
        return found + result.texts
    return found + checker.check(run).texts


def canonical(machine: MachineParameters, program: str, dialect: str) -> tuple[list[CanonicalBlock], bool]:
    """Its blocks from the start positions of the machine; whether these are all."""
    text, files = read_program(str(ROOT / program), program_search(machine))
    check = ProgramCheck.of_first_channel(machine, program)
    known = check.known_ahead(check.parse(text, program, files, dialect), check.start, check.state({}, {}, {}))
    return known.blocks, known.complete


def axes_of(machine: MachineParameters) -> list[Axis]:
    """Of the first channel."""
    axes = [machine.axes[axis.node] for axis in next(iter(machine.channels.values())).axes]
    return [Axis(a.max_velocity, a.rapid_velocity, a.acceleration, a.deceleration, a.jerk) for a in axes]


def path_axes(channel: Any) -> list[int]:
    """Places of the axes of the feed."""
    return [place for place, axis in enumerate(channel.axes) if axis.name in ("X", "Y", "Z")]


def run_of(bench: ExampleRun) -> Run:
    nodes = [axis.node for axis in next(iter(bench.machine.channels.values())).axes]
    names = ("position", "velocity", "acceleration", "jerk")
    return Run(*[np.column_stack([bench.column(node, f"set_{name}") for node in nodes]) for name in names])


def segments_of(blocks: Iterable[CanonicalBlock], start: Iterable[float]) -> list[Segment] | None:
    """None where they are not known before the run, or are not those of the axes."""
    found: list[Segment] = []
    place = np.array(list(start))
    for block in blocks:
        motion = block.motion
        if isinstance(motion, HomeAxes) or getattr(motion, "kinematics", None) is not None:
            return None
        if not isinstance(motion, (LinearMove, CircularMove)):
            continue
        target = np.array(motion.target[: len(place)])
        segment = Segment(place, target, feed_of(motion), stop=motion.transition.stops)
        if isinstance(motion, CircularMove):
            if motion.directions is not None:
                return None
            segment.center, segment.plane, segment.sweep = motion.center, motion.plane, radians(motion.sweep)
        permit(segment, motion.transition)
        if isinstance(motion, LinearMove) and motion.thread is not None:
            segment.deviation = JOINT
        if segment.arc or np.abs(target - place).max() > 0.0:
            found.append(segment)
        place = target
    return found


def feed_of(motion: LinearMove | CircularMove) -> float:
    """mm/s; inf where a spindle decides it and in rapid traverse."""
    if motion.per_turn is not None or (isinstance(motion, LinearMove) and (motion.rapid or motion.thread is not None)):
        return inf
    return motion.feed


def permit(segment: Segment, transition: Transition) -> None:
    """How far the path may leave the segment."""
    contour, smoothing = transition.contour, transition.smoothing
    if contour is not None:
        segment.deviation = contour.path_dev if contour.mode == DEV else max(contour.pre_dist, contour.post_dist)
        if contour.mode == POS:  # the curve goes a little beyond its interim point
            apart = float(np.linalg.norm(np.array(contour.point[: len(segment.end)]) - segment.end))
            segment.deviation = max(segment.deviation, 1.2 * apart)
        segment.track = contour.track_dev
    if smoothing is not None:
        segment.everywhere, segment.track_everywhere = smoothing.path_dev, smoothing.track_dev or inf
