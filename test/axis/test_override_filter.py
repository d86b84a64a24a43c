"""The override filter alone: steps, interval, 0 and 100 % at once, the latest value wins."""

from __future__ import annotations

import itertools
import random

import pytest

from cnc_ptp.axis.override_filter import OverrideFilter


def test_without_steps_everything_passes_at_once() -> None:
    passing = OverrideFilter(steps=0, interval_cycles=150)
    assert [passing.take(cycle, 0.1 * cycle) for cycle in range(5)] == [0.0, 0.1, 0.2, pytest.approx(0.3), 0.4]
    assert passing.due_cycle is None and passing.due(1000) is None


def test_values_snap_to_the_nearest_of_200_steps() -> None:
    for asked, used in ((0.26, 0.5), (33.3, 33.5), (33.2, 33.0), (50.0, 50.0), (99.7, 99.5), (99.9, 100.0)):
        fresh = OverrideFilter(steps=200, interval_cycles=150)
        assert fresh.take(0, asked) == pytest.approx(used, abs=1e-12)


def test_the_second_value_waits_for_the_interval() -> None:
    waiting = OverrideFilter(steps=200, interval_cycles=150)
    assert waiting.take(10, 50.0) == 50.0
    assert waiting.take(20, 60.0) is None and waiting.due_cycle == 160
    assert waiting.due(159) is None and waiting.due_cycle == 160
    assert waiting.due(160) == 60.0
    assert waiting.due(10**6) is None and waiting.due_cycle is None


def test_the_latest_value_wins() -> None:
    waiting = OverrideFilter(steps=200, interval_cycles=150)
    waiting.take(0, 50.0)
    assert [waiting.take(cycle, 50.0 + cycle) for cycle in range(1, 10)] == [None] * 9
    assert waiting.due(150) == 59.0


@pytest.mark.parametrize("percent", [0.0, 100.0])
def test_0_and_100_pass_at_once_and_delete_what_waits(percent: float) -> None:
    waiting = OverrideFilter(steps=200, interval_cycles=150)
    waiting.take(0, 50.0)
    waiting.take(1, 60.0)
    assert waiting.take(2, percent) == percent
    assert waiting.due_cycle is None
    assert waiting.take(3, 70.0) is None and waiting.due_cycle == 152


def test_an_interval_of_0_only_snaps() -> None:
    snapping = OverrideFilter(steps=4, interval_cycles=0)
    assert [snapping.take(5, percent) for percent in (30.0, 60.0, 90.0)] == [25.0, 50.0, 100.0]


@pytest.mark.parametrize(("steps", "step"), [(4, 25.0), (200, 0.5), (1, 100.0)])
def test_above_0_the_axis_moves(steps: int, step: float) -> None:
    """What lies below half a step would stand for a stop that nobody asked for."""
    for percent in (1e-4, 0.1, 0.4 * step, 0.5 * step):
        assert OverrideFilter(steps=steps, interval_cycles=150).take(0, percent) == step
    assert OverrideFilter(steps=steps, interval_cycles=150).take(0, 0.0) == 0.0


def test_random_values_come_through_at_most_once_an_interval() -> None:
    """Also when nothing but the last value of a burst is of a step of its own; 0 and 100 excepted."""
    rng = random.Random(3)
    filtered = OverrideFilter(steps=200, interval_cycles=150)
    passed: list[tuple[int, float]] = []
    latest = None
    for cycle in range(20_000):
        value = filtered.due(cycle)
        if value is not None:
            passed.append((cycle, value))
        if rng.random() < 0.05:
            latest = rng.uniform(1.0, 99.0)
            value = filtered.take(cycle, latest)
            if value is not None:
                passed.append((cycle, value))
    assert len(passed) > 100 and latest is not None
    assert all(after - before >= 150 for (before, _), (after, _) in itertools.pairwise(passed))
    assert all(abs(value * 2.0 - round(value * 2.0)) < 1e-9 for _, value in passed)
