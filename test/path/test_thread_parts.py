"""The parts of a thread alone: expected angle of the spindle, fading of a mismatch, axes over the angle."""

from __future__ import annotations

import random

import numpy as np
import pytest

from cnc_ptp.motion import Limits
from cnc_ptp.nc.canonical import Thread
from cnc_ptp.path.geometry import AxisLimits
from cnc_ptp.path.thread.lead import fading
from cnc_ptp.path.thread.spindle_angle import SAMPLES, TREND, SpindleAngle
from cnc_ptp.path.thread.thread_geometry import RESERVE, ThreadGeometry

T = 0.001
AXES = [AxisLimits(300.0, 2000.0, 2000.0, 50_000.0), AxisLimits(400.0, 1500.0, 1800.0, 40_000.0)]


def derivatives(function, at: float, step: float) -> list[float]:
    """First to third derivative by central differences."""
    places = np.array([function(at + n * step) for n in range(-3, 4)])
    first = np.dot(places, [-1, 9, -45, 0, 45, -9, 1]) / 60.0 / step
    second = np.dot(places, [2, -27, 270, -490, 270, -27, 2]) / 180.0 / step**2
    third = np.dot(places, [1, -8, 13, 0, -13, 8, -1]) / 8.0 / step**3
    return [first, second, third]


# the spindle


def test_a_parabola_is_continued_exactly():
    def angle(cycle: float) -> float:
        return 1e5 + 2400.0 * cycle * T - 0.5 * 900.0 * (cycle * T) ** 2

    spindle = SpindleAngle(T)
    for first in range(0, 40, 10):
        spindle.read(first, [angle(cycle) for cycle in range(first, first + 10)])
    for cycle in (39.0, 45.5, 60.0):
        place, speed, gain, _ = spindle.at(cycle)
        assert place == pytest.approx(angle(cycle), abs=1e-6)
        assert speed == pytest.approx(2400.0 - 900.0 * cycle * T, abs=1e-4)
        assert gain == pytest.approx(-900.0, abs=0.1)
    later = spindle.at(39.0 + 1000.0 * TREND + 500.0)
    assert later[1:3] == (pytest.approx(2400.0 - 900.0 * (0.039 + TREND), abs=0.01), 0.0)


def test_a_spindle_that_brakes_is_expected_to_stay_where_it_stops():
    spindle = SpindleAngle(T)
    spindle.read(0, [100.0 * n * T - 0.5 * 6000.0 * (n * T) ** 2 for n in range(12)])
    stop = 100.0 / 6000.0
    assert spindle.at(500.0)[:3] == (pytest.approx(0.5 * 100.0 * stop, abs=1e-6), pytest.approx(0.0, abs=1e-6), 0.0)


def test_behind_a_gap_earlier_cycles_do_not_count():
    spindle = SpindleAngle(T)
    spindle.read(0, [0.0] * SAMPLES)
    assert spindle.known
    spindle.read(100, [5.0] * (SAMPLES - 1))
    assert not spindle.known
    spindle.read(100 + SAMPLES - 1, [5.0])
    assert spindle.known
    assert spindle.at(200.0)[0] == pytest.approx(5.0)


# the mismatch


def test_a_mismatch_fades_out_smoothly_within_the_limits():
    source = random.Random(7)
    limits = Limits(5000.0, 480_000.0, 480_000.0, 1.2e7)
    for _ in range(200):
        mismatch = (source.uniform(-3.0, 3.0), source.uniform(-300.0, 300.0), source.uniform(-6e3, 6e3))
        fade = fading(mismatch, 0.02, -mismatch[2], limits)
        assert fade.at(0.0)[:3] == pytest.approx(mismatch)
        assert fade.at(10.0) == (0.0, 0.0, 0.0, 0.0)
        times = np.linspace(0.0, 0.7, 400)
        rows = np.array([fade.at(t) for t in times])
        assert abs(rows[:, 3]).max() <= limits.jerk
        assert abs(rows[:, 2]).max() <= limits.acceleration
        end = next(t for t, row in zip(times, rows, strict=True) if not any(row))
        assert max(abs(value) for value in fade.at(end - 0.002)[:1]) < 0.01
        at = 0.5 * end
        assert derivatives(lambda t, fade=fade: fade.at(t)[0], at, 1e-4)[:2] == pytest.approx(
            fade.at(at)[1:3], rel=1e-4, abs=1e-2
        )


# the axes


def chain(seed: int, speed: float) -> tuple[ThreadGeometry, list[tuple[float, float]]]:
    """Random blocks, some with a lead that changes; geometry and corners."""
    source = random.Random(seed)
    geometry = ThreadGeometry((36.0, 105.0), AXES, (0, 1))
    corners = [(36.0, 105.0)]
    for _ in range(6):
        x, z = corners[-1]
        target = (x + source.uniform(-10.0, 10.0), z - source.uniform(20.0, 40.0))
        lead, change = source.uniform(0.5, 3.0), source.choice([0.0, 0.0, 0.1, -0.002])
        way = max(abs(target[0] - x), abs(target[1] - z))
        turns = 2.0 * way / (lead + (lead**2 + 2.0 * change * way) ** 0.5)
        geometry.append(target, Thread("S", 360.0 * turns, lead, 1, change=change), speed)
        corners.append(target)
    return geometry, corners


@pytest.mark.parametrize("seed", range(8))
def test_the_derivatives_are_those_of_the_position(seed):
    geometry, _ = chain(seed, 2400.0)
    source = random.Random(seed)
    for block in range(1, 6):
        joint, zone = geometry.begin_of(block), geometry.zone_of(block)
        for angle in (joint + source.uniform(-0.4, 0.4) * zone, joint + zone + 20.0, joint - zone - 20.0):
            for axis in (0, 1):
                q = geometry.shape(angle)[axis]
                step = 0.02 * zone
                found = derivatives(lambda at, axis=axis: geometry.shape(at)[axis][0], angle, step)
                assert found[:2] == pytest.approx(q[1:3], rel=1e-6, abs=1e-8)
                assert found[2] == pytest.approx(q[3], rel=1e-3, abs=1e-7)


@pytest.mark.parametrize("seed", range(8))
def test_position_slope_and_bend_are_continuous_and_blocks_end_at_their_targets(seed):
    geometry, corners = chain(seed, 2400.0)
    tiny = 1e-7
    for block in range(1, 6):
        joint, half = geometry.begin_of(block), 0.5 * geometry.zone_of(block)
        for place in (joint - half, joint + half):
            before, behind = geometry.shape(place - tiny), geometry.shape(place + tiny)
            for one, other in zip(before, behind, strict=True):
                assert one[:3] == pytest.approx(other[:3], rel=1e-6, abs=1e-8)
        assert geometry.start_of(block) == corners[block]
    assert tuple(q for q, *_ in geometry.shape(geometry.end)) == corners[-1]
    assert tuple(q for q, *_ in geometry.shape(0.0)) == corners[0]


@pytest.mark.parametrize("seed", range(8))
def test_axes_keep_their_limits_in_joints_up_to_the_reserve(seed):
    speed = 2400.0
    geometry, _ = chain(seed, speed)
    for block in range(1, 6):
        joint, zone = geometry.begin_of(block), geometry.zone_of(block)
        for x in np.linspace(-0.499, 0.499, 101):
            states = geometry.evaluate(joint + x * zone, RESERVE * speed, 0.0, 0.0)
            for (_, _, a, j), axis in zip(states, AXES, strict=True):
                assert abs(a) <= min(axis.acceleration, axis.deceleration)
                assert abs(j) <= axis.jerk
