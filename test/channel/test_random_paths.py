"""Random programs through the whole offline machine, against a checker that knows nothing of the planner.

`python -m bench.paths 1000` runs as many as wanted; here is a part of them.
"""

from __future__ import annotations

import numpy as np
import pytest
from long_support import long
from path_checker import Axis, PathChecker, Run, Segment
from path_moments import disturbed
from random_paths import RandomProgram

AXIS = Axis(100.0, 100.0, 1000.0, 1000.0, 20_000.0)


@pytest.mark.parametrize("seed", [2, *long([0, 1, *range(3, 20)])])
def test_random_programs(seed: int) -> None:
    assert RandomProgram(seed).check().texts == []


FAILED = (
    37, 49, 108, 118, 127, 167, 190, 205, 277, 317, 375, 421, 512, 513, 520, 2135, 2221, 5638, 5716, 5737, 5773, 7871,
    8066, 8484, 8496, 9415, 9549,
)  # fmt: skip


@pytest.mark.long
@pytest.mark.parametrize("seed", FAILED)
def test_programs_that_have_failed(seed: int) -> None:
    assert RandomProgram(seed).check().texts == []


@pytest.mark.long
@pytest.mark.parametrize("kind", ["override", "hold", "ramp", "reset", "single block"])
def test_disturbed_programs(kind: str) -> None:
    for seed in range(1):
        assert disturbed(seed, kind).texts == [], seed


# the checker itself


def corner_run(cut: float) -> tuple[PathChecker, Run]:
    """Two lines of 1 mm at 1 mm/s with a corner that is cut by a chord, without dynamics."""
    points = [(x, 0.0) for x in np.arange(0.0, 1.0 - cut, 0.001)] + [(1.0, y) for y in np.arange(cut, 1.0, 0.001)]
    position = np.zeros((len(points) + 1, 3))
    position[:-1, :2], position[-1, :2] = points, (1.0, 1.0)
    zero = np.zeros_like(position)
    segments = [
        Segment(np.zeros(3), np.array([1.0, 0.0, 0.0]), 2.0, deviation=0.01),
        Segment(np.array([1.0, 0.0, 0.0]), np.array([1.0, 1.0, 0.0]), 2.0),
    ]
    return PathChecker(segments, [AXIS] * 3, steps=False), Run(position, zero, zero.copy(), zero.copy())


def found(checker: PathChecker, run: Run) -> str:
    return "; ".join(checker.check(run).texts)


def test_the_checker_sees_a_corner_that_is_cut() -> None:
    assert "was not met" not in found(*corner_run(0.005)) and "end of segment 0" in found(*corner_run(0.05))


def test_the_checker_sees_a_point_beside_the_path() -> None:
    checker, run = corner_run(0.005)
    run.position[300, 1] = 0.0101
    assert "path left in cycle 300" in found(checker, run)
    run.position[300, 1] = 0.0099
    assert "path left" not in found(checker, run)


def test_the_checker_sees_steps_between_cycles() -> None:
    checker, run = corner_run(0.005)
    run.position[300:, 1] += 1e-4
    texts = found(checker, run)
    assert "axis 1 Δ³p/T³" in texts and "axis 1 states and positions" in texts and "ends at" in texts


def test_the_checker_sees_limits_and_feed() -> None:
    checker, run = corner_run(0.005)
    run.velocity[100, 0], run.acceleration[101, 1], run.jerk[102, 2] = 101.0, 1000.1, -20_001.0
    texts = found(checker, run)
    assert all(part in texts for part in ("axis 0 v 101 > 100", "axis 1 a- 1000.1 > 1000", "axis 2 j 20001 > 20000"))
    assert "feed 101 > 2" in texts


def test_the_checker_sees_points_that_come_too_early() -> None:
    checker, run = corner_run(0.005)
    run.position[300:302] = run.position[[1500, 300]]
    assert "path left in cycle 301" in found(checker, run)
