"""The parts of a thread alone: expected angle of the spindle, fading of a mismatch, axes over the angle."""

from __future__ import annotations

import random

import numpy as np
import pytest
from long_support import examples

from cnc_ptp.motion import Limits
from cnc_ptp.nc.canonical import Thread
from cnc_ptp.path.geometry import AxisLimits
from cnc_ptp.path.thread.lead import QuickFading, SmoothFading, fading
from cnc_ptp.path.thread.spindle_angle import SAMPLES, TREND, SpindleAngle, SpindleReport, coming, largest_jerk
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


def report(first: int, angles: list[float], speeds: list[float], acceleration: float, wanted: float) -> SpindleReport:
    return SpindleReport(first, angles, speeds, acceleration, wanted)


def told(spindle: SpindleAngle, cycles: range, angle, speed, gain: float, wanted: float) -> None:
    """Blocks of ten cycles; angle and speed are functions of the time."""
    for first in range(cycles.start, cycles.stop, 10):
        times = [cycle * T for cycle in range(first, first + 10)]
        spindle.read(report(first, [angle(t) for t in times], [speed(t) for t in times], gain, wanted))


def test_a_spindle_goes_on_to_its_commanded_speed_and_keeps_it():
    """From 2400 to 2000 deg/s with 9000 deg/s²; 0.5 deg behind its set motion."""
    spindle = SpindleAngle(T)
    told(
        spindle,
        range(20),
        lambda t: 1e5 + 2400.0 * t - 4500.0 * t**2 - 0.5,
        lambda t: 2400.0 - 9000.0 * t,
        -9000.0,
        2000.0,
    )
    knee = 400.0 / 9000.0
    for cycle in (19.0, 30.5, 44.0):
        t = cycle * T
        expected = (1e5 + 2400.0 * t - 4500.0 * t**2 - 0.5, 2400.0 - 9000.0 * t, -9000.0, 0.0)
        assert spindle.at(cycle) == pytest.approx(expected, abs=1e-6)
    place = 1e5 + 2400.0 * knee - 4500.0 * knee**2 - 0.5
    assert spindle.at(244.0) == pytest.approx((place + 2000.0 * (0.244 - knee), 2000.0, 0.0, 0.0), abs=1e-6)
    assert spindle.rest is None


def test_what_the_set_motion_does_not_tell_is_a_parabola_for_a_while():
    """A load slows the spindle down, whose set speed is constant."""
    spindle = SpindleAngle(T)
    told(spindle, range(40), lambda t: 1e5 + 2400.0 * t - 450.0 * t**2, lambda _: 2400.0, 0.0, 2400.0)
    for cycle in (39.0, 45.5, 60.0):
        t = cycle * T
        expected = (1e5 + 2400.0 * t - 450.0 * t**2, 2400.0 - 900.0 * t, -900.0)
        assert spindle.at(cycle)[:3] == pytest.approx(expected, abs=1e-4)
    assert (spindle.speed, spindle.acceleration) == (pytest.approx(2400.0 - 900.0 * 0.039), pytest.approx(-900.0))
    later = spindle.at(39.0 + 1000.0 * TREND + 500.0)
    assert later[1:3] == (pytest.approx(2400.0 - 900.0 * (0.039 + TREND), abs=0.01), 0.0)


def test_an_acceleration_away_from_the_commanded_speed_is_taken_to_end_soon():
    spindle = SpindleAngle(T)
    told(spindle, range(20), lambda t: 1000.0 * t + 500.0 * t**2, lambda t: 1000.0 + 1000.0 * t, 1000.0, 500.0)
    assert spindle.at(400.0)[1] == pytest.approx(1000.0 + 1000.0 * (0.019 + TREND), abs=1e-6)


def test_a_spindle_that_brakes_is_expected_to_stay_where_it_stops():
    spindle = SpindleAngle(T)
    told(spindle, range(20), lambda t: 200.0 * t - 3000.0 * t**2, lambda t: 200.0 - 6000.0 * t, -6000.0, 0.0)
    stop = 200.0 / 6000.0
    assert spindle.rest == (pytest.approx(0.5 * 200.0 * stop, abs=1e-9), pytest.approx(stop / T))
    assert spindle.at(500.0) == pytest.approx((0.5 * 200.0 * stop, 0.0, 0.0, 0.0), abs=1e-6)


def test_behind_a_gap_earlier_cycles_do_not_count():
    spindle = SpindleAngle(T)
    spindle.read(report(0, [0.0] * SAMPLES, [0.0] * SAMPLES, 0.0, 0.0))
    assert spindle.known
    spindle.read(report(100, [5.0] * (SAMPLES - 1), [0.0] * (SAMPLES - 1), 0.0, 0.0))
    assert not spindle.known
    assert spindle.speed == 0.0
    spindle.read(report(100 + SAMPLES - 1, [5.0], [0.0], 0.0, 0.0))
    assert spindle.known
    assert spindle.at(200.0)[0] == pytest.approx(5.0)


@pytest.mark.parametrize("lasts", [0.030, 0.004, 0.0005])
def test_the_end_of_an_acceleration_keeps_a_jerk(lasts):
    """Gently where there is time, harder up to a bound, and on the straight line behind it where there is none."""
    gain, gentle, most = -6000.0, 2e5, 9e5
    motion = coming(100.0, 2400.0, gain, lasts, gentle, most)
    times = np.linspace(0.0, 0.1, 20_001)
    p, v, a, j = motion.sample(times)
    step = times[1]
    assert abs(np.diff(p) - step * 0.5 * (v[1:] + v[:-1])).max() < 1e-8
    assert abs(np.diff(v) - step * 0.5 * (a[1:] + a[:-1])).max() < 1e-8
    bound = gentle if lasts == 0.030 else most
    assert abs(j).max() <= bound * (1.0 + 1e-12)
    assert abs(np.diff(a)).max() <= bound * step * (1.0 + 1e-9)
    # behind the change the motion is that of an acceleration that ends at once, but for gain·(2·half)²/24
    place = 100.0 + 2400.0 * lasts + 0.5 * gain * lasts**2 + (2400.0 + gain * lasts) * (0.1 - lasts)
    assert v[-1] == pytest.approx(2400.0 + gain * lasts, abs=1e-9)
    half = min(lasts, 0.5 * abs(gain) / gentle)
    assert p[-1] == pytest.approx(place, abs=abs(gain) * half**2 / 6.0 + 1e-9)
    assert largest_jerk(motion) == abs(j).max()


# the mismatch


def test_a_mismatch_fades_out_within_the_limits():
    """A small one smoothly within the horizon, a large one as fast as the limits permit; both to 0 exactly."""
    source = random.Random(7)
    limits = Limits(900.0, 480_000.0, 480_000.0, 1.2e7)
    kinds = set()
    for _ in range(examples(200)):
        size = source.choice([0.01, 1.0])
        mismatch = tuple(size * source.uniform(-most, most) for most in (3.0, 300.0, 6e3))
        fade = fading(mismatch, 0.02, -mismatch[2], limits)
        kinds.add(type(fade))
        assert fade.at(0.0)[:3] == pytest.approx(mismatch)
        assert fade.at(10.0) == (0.0, 0.0, 0.0, 0.0)
        times = np.linspace(0.0, 0.7, 7001)
        rows = np.array([fade.at(t) for t in times])
        assert abs(rows[:, 3]).max() <= limits.jerk * (1.0 + 1e-12)
        assert abs(rows[:, 2] - mismatch[2]).max() <= limits.acceleration
        assert abs(rows[:, 1]).max() <= limits.velocity
        step = times[1]
        for place in (0, 1):
            grown = np.diff(rows[:, place]) - step * 0.5 * (rows[1:, place + 1] + rows[:-1, place + 1])
            assert abs(grown).max() <= limits.jerk * (step**3 / 6.0 if place == 0 else step**2 / 2.0)
        end = times[np.flatnonzero(rows.any(axis=1))[-1]]
        assert end <= 0.0201 or type(fade) is QuickFading
    assert kinds == {SmoothFading, QuickFading}


def test_the_quick_one_is_not_slower_than_the_polynomial_that_keeps_the_limits():
    limits = Limits(1e5, 480_000.0, 480_000.0, 1.2e7)
    mismatch = (0.9, 180.0, 18_000.0)
    quick = fading(mismatch, 0.02, -18_000.0, limits)
    assert type(quick) is QuickFading
    horizon = 0.02
    while max(abs(SmoothFading(mismatch, horizon).at(horizon * n / 400.0)[3]) for n in range(400)) > limits.jerk:
        horizon *= 1.01
    times = np.linspace(0.0, 0.1, 1001)
    largest = [max(abs(fade.at(t)[0]) for t in times) for fade in (quick, SmoothFading(mismatch, horizon))]
    assert largest[0] < 0.9 * largest[1]


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
