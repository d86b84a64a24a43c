"""Position control: processor time of one axis per cycle, from setpoint to actual values.

Each figure is the least of several rounds over one turn of a circle of 25 mm at 2000 mm/min (4.7 s, two reversals):
a round takes milliseconds, and other programs on the machine make it longer, never shorter.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

from bench.figures import Effort, Figure, ShowProgress, stopwatch
from bench.jobs import ROOT
from cnc_ptp.control.control_loop import ControlColumns, ControlLoop
from cnc_ptp.control.drives import CascadedDrive, Drive, FirstOrderDrive, make_drive
from cnc_ptp.control.feedforward import CouplingLimits
from cnc_ptp.motion.setpoints import Setpoints
from cnc_ptp.parameters import read_machine
from cnc_ptp.parameters.view.control_view import ADD_ACC, ADD_VEL, ControlParameters

MACHINE = ROOT / "config" / "mill.yaml"
RADIUS, FEED = 25.0, 2000.0 / 60.0
GOAL = 1.0
"""µs: controller, cascaded drive, friction compensation and feedforward."""
ADDITIVE = 0x001 | ADD_VEL | 0x002 | ADD_ACC
ROUNDS = 5
BLOCK = 10
"""Cycles."""
State = tuple[float, float, float, float]


def circle(cycle_time: float) -> list[State]:
    """Setpoints of one axis for a turn."""
    rate = FEED / RADIUS
    states = []
    for cycle in range(round(2.0 * math.pi / rate / cycle_time)):
        angle = rate * cycle * cycle_time
        sine, cosine = RADIUS * math.sin(angle), RADIUS * math.cos(angle)
        states.append((sine, rate * cosine, -(rate**2) * sine, -(rate**3) * cosine))
    return states


def of_loop(control: ControlParameters, setpoints: Sequence[State], cycle_time: float, limits: CouplingLimits) -> float:
    """µs per cycle of the whole loop, which takes a block at a time."""
    loop = ControlLoop(control, cycle_time=cycle_time, limits=limits, drive=make_drive(control, cycle_time))
    blocks = [Setpoints.of(setpoints[n : n + BLOCK]) for n in range(0, len(setpoints), BLOCK)]
    with stopwatch() as watch:
        for block in blocks:
            loop.follow(block, True, ControlColumns(), watched=True)
    return 1e6 * watch.cpu / len(setpoints)


def of_drive(make: Callable[[], Drive], setpoints: Sequence[State]) -> float:
    """µs per cycle of a drive that is commanded the velocities."""
    step = make().step
    with stopwatch() as watch:
        for _, velocity, _, _ in setpoints:
            step(velocity)
    return 1e6 * watch.cpu / len(setpoints)


def least_of(rounds: int, measures: Sequence[Callable[[], float]]) -> list[float]:
    """The least value of each measure, taken in turn."""
    return [min(column) for column in zip(*[[measure() for measure in measures] for _ in range(rounds)], strict=True)]


def figures(effort: Effort, show: ShowProgress) -> Iterator[Figure]:
    """All figures; the axis is x of config/mill.yaml, with its friction table switched on."""
    axis = read_machine(MACHINE).axes["x"]
    cycle_time = 1e-6 * read_machine(MACHINE).cycle_time_us
    control, plant = axis.control, axis.control.plant
    limits = CouplingLimits(axis.max_velocity, axis.max_acceleration, axis.jerk)
    setpoints = circle(cycle_time)
    conventional = replace(control, feedforward=replace(control.feedforward, always_active=True))
    additive = replace(control, feedforward=replace(control.feedforward, mode=ADDITIVE, always_active=True))
    bare = replace(
        control,
        feedforward=replace(control.feedforward, mode=0),
        friction=replace(control.friction, permitted=False, active=False),
    )
    show("loops and drives, in turn")
    values = least_of(
        ROUNDS * effort.runs,
        [
            lambda: of_loop(control, setpoints, cycle_time, limits),
            lambda: of_loop(conventional, setpoints, cycle_time, limits),
            lambda: of_loop(additive, setpoints, cycle_time, limits),
            lambda: of_loop(bare, setpoints, cycle_time, limits),
            lambda: of_drive(lambda: CascadedDrive(plant, cycle_time=cycle_time), setpoints),
            lambda: of_drive(
                lambda: FirstOrderDrive(
                    cycle_time=cycle_time, time_constant=plant.time_constant, encoder_increment=plant.encoder_increment
                ),
                setpoints,
            ),
        ],
    )
    names = (
        "controller, cascaded drive, friction compensation",
        "the same with velocity and acceleration feedforward",
        "the same with additive velocity and torque",
        "controller and cascaded drive alone",
        "cascaded drive alone",
        "first-order drive alone",
    )
    for index, (name, value) in enumerate(zip(names, values, strict=True)):
        yield Figure(f"{name} (least)", value, "µs/cycle", goal=GOAL if index == 1 else None, at_most=True)
