"""Runs of the figures' scenarios, and what a PTP motion must be like by the textbook."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from functools import cache
from math import sqrt
from pathlib import Path

import numpy as np

from figures.run import Column, FigureRun, run_figure
from figures.scenario_head import read_head

SCENARIOS = Path(__file__).parents[2] / "examples" / "figures"
CYCLE_TIME = 0.001


def head_and_scenario(folder: Path, head: dict[str, str], scenario: str) -> Path:
    """A scenario file move.yaml with a head."""
    file = folder / "move.yaml"
    file.write_text("".join(f"# {key}: {value}\n" for key, value in head.items()) + scenario, encoding="utf-8")
    return file


def texts_of(svg: str) -> list[str]:
    """All texts of a picture; fails where it is not well formed."""
    root = ElementTree.fromstring(svg)
    return ["".join(text.itertext()) for text in root.iter("{http://www.w3.org/2000/svg}text")]


@cache
def run_of(name: str) -> FigureRun:
    """The run of a scenario, made once."""
    return run_figure(read_head(SCENARIOS / f"{name}.yaml"))


def x(name: str, field: str) -> Column:
    """A column of axis x."""
    return run_of(name).column("x", field)


def cycle_of(name: str, command: int) -> int:
    """The cycle in which a command of the scenario took effect (those of cycle 0 are not counted)."""
    return round(run_of(name).markers[command].time / CYCLE_TIME)


def arrival(name: str) -> int:
    """The first cycle from which on the set position is where it ends, to 1e-9 mm (a cycle before: J·T³/6 = 1e-5)."""
    away = np.abs(x(name, "set_position") - x(name, "set_position")[-1])
    return int(np.flatnonzero(away > 1e-9)[-1]) + 1


def cycles(seconds: float) -> int:
    """Cycles until `seconds` have passed."""
    return int(np.ceil(round(seconds / CYCLE_TIME, 6)))


def ramp_time(velocity: float, a: float, j: float) -> float:
    """From rest to `velocity`: V/A + A/J, or 2·√(V/J) below the critical jerk."""
    return velocity / a + a / j if velocity * j >= a * a else 2.0 * sqrt(velocity / j)


def reachable(distance: float, a: float, j: float) -> float:
    """The velocity at which two equal ramps take `distance`: the root of V·ramp_time(V) = distance."""
    velocity = (distance * distance * j / 4.0) ** (1.0 / 3.0)
    if velocity * j >= a * a:
        velocity = (-a / j + sqrt((a / j) ** 2 + 4.0 * distance / a)) / (2.0 / a)
    return velocity


def seven_phases(distance: float, velocity: float, up: float, down: float, j: float) -> tuple[float, float]:
    """Velocity reached and duration of a positioning from rest to rest."""
    velocity = min(velocity, reachable(distance, min(up, down), j))
    ramps = ramp_time(velocity, up, j) + ramp_time(velocity, down, j)
    return velocity, ramps + (distance - 0.5 * velocity * ramps) / velocity


def through(phases: list[tuple[float, float]], velocity: float, acceleration: float) -> tuple[float, float, float]:
    """Distance, velocity and acceleration after phases of (duration, jerk)."""
    way = 0.0
    for t, j in phases:
        way += velocity * t + acceleration * t**2 / 2.0 + j * t**3 / 6.0
        velocity += acceleration * t + j * t**2 / 2.0
        acceleration += j * t
    return way, velocity, acceleration


def largest_step(values: Column) -> float:
    """Largest change from one cycle to the next."""
    return float(np.max(np.abs(np.diff(values))))


def integrated(name: str) -> Column:
    """Set position as the integral of set velocity and acceleration, exact for constant jerk (error J·T³/12 per cycle)."""
    v, a = x(name, "set_velocity"), x(name, "set_acceleration")
    steps = CYCLE_TIME * 0.5 * (v[1:] + v[:-1]) + CYCLE_TIME**2 / 12.0 * (a[:-1] - a[1:])
    return np.concatenate([[0.0], np.cumsum(steps)])
