"""Friction over velocity from synthetic recordings: a Stribeck curve with weight, noise, transients and stick-slip."""

import numpy as np
import pytest
from commissioning_support import T, friction_run, phases, stribeck, trace_of

from cnc_ptp.commissioning.friction import friction_curve
from cnc_ptp.commissioning.steady_motion import steady_phases
from cnc_ptp.commissioning.timing import Timing, always
from cnc_ptp.errors import CncError

SPEEDS = (0.1, 0.5, 1.0, 2.0, 4.0, 8.0, 20.0, 60.0, 200.0)


def refused(trace, **options):
    with pytest.raises(CncError) as refusal:
        friction_curve(trace, **{"settling": always(0.1), **options})
    return str(refusal.value)


def test_the_stribeck_curve_comes_back():
    curve = friction_curve(friction_run(SPEEDS), settling=always(0.1))
    assert [point.speed for point in curve.points] == pytest.approx(SPEEDS)
    for point in curve.points:
        assert point.friction == pytest.approx(stribeck(point.speed), rel=1e-12)
        assert point.scatter == pytest.approx(0.0, abs=1e-9)
        assert point.seconds == pytest.approx(0.8)
    assert curve.one_way == () and curve.uneven == ()


def test_weight_is_told_apart_and_noise_averages_out():
    noise, load = 20.0, -75.0
    curve = friction_curve(friction_run(SPEEDS, load=load, noise=noise), settling=always(0.1))
    # 400 cycles a direction: standard deviation of the mean of both 20 / sqrt(800) N, of a batch of 80 cycles 20 / sqrt(80).
    for point in curve.points:
        assert abs(point.friction - stribeck(point.speed)) < 5 * noise / np.sqrt(800)
        assert abs(point.load - load) < 5 * noise / np.sqrt(800)
        assert 0.3 < point.scatter / (noise / np.sqrt(80)) < 2.0


@pytest.mark.parametrize("digit", [1.0, 10.0, 40.0])
def test_half_a_digit_of_the_torque_counts_as_scatter(digit):
    """A torque that comes in steps is as steady as it is wrong: by up to half a step."""
    run = friction_run(SPEEDS)
    run.actual_torque[:] = np.round(run.actual_torque / digit) * digit
    for point in friction_curve(run, settling=always(0.1), half_digit=0.5 * digit).points:
        assert abs(point.friction - stribeck(point.speed)) <= point.scatter
        assert point.scatter == pytest.approx(0.5 * digit)


def test_settling_is_thrown_away():
    run = friction_run(SPEEDS, transient=500.0)
    for point in friction_curve(run, settling=always(0.1)).points:
        assert point.friction == pytest.approx(stribeck(point.speed))
    for point in friction_curve(run, settling=always(0.05)).points:
        assert point.friction == pytest.approx(stribeck(point.speed) + 500.0 / 9.0)


def test_several_phases_of_one_speed_are_one_point():
    velocity = phases([5.0, 5.004, 4.996, 50.0])
    curve = friction_curve(
        trace_of(set_velocity=velocity, actual_torque=10.0 * np.sign(velocity)), settling=always(0.1)
    )
    assert [point.speed for point in curve.points] == pytest.approx([5.0, 50.0])
    assert [point.seconds for point in curve.points] == pytest.approx([2.4, 0.8])


def test_speeds_of_one_direction_and_uneven_ones_are_named():
    velocity = np.concatenate([phases([3.0, 30.0]), phases([7.0, 70.0], both=False)])
    run = trace_of(set_velocity=velocity, actual_torque=10.0 * np.sign(velocity))
    sticks = np.abs(velocity) == 3.0
    slipping = np.where(np.arange(len(velocity)) % 40 < 20, 2.0, 0.0)
    run.actual_velocity[sticks] = (velocity * slipping)[sticks]
    run.actual_position[:] = np.cumsum(run.actual_velocity) * T
    curve = friction_curve(run, settling=always(0.1))
    assert [point.speed for point in curve.points] == pytest.approx([30.0])
    assert curve.one_way == (7.0, 70.0)
    assert curve.uneven == (-3.0, 3.0)


@pytest.mark.parametrize("noise", [0.5, 5.0])
def test_noise_of_the_velocity_is_no_stick_slip(noise):
    """Positions are steady: no speed is left out, however slow (0.5 mm/s of noise are 500 % of 0.1 mm/s)."""
    run = friction_run(SPEEDS)
    run.actual_velocity[:] += noise * np.random.default_rng(4).standard_normal(len(run))
    run.actual_position[:] = np.round(run.actual_position / 1e-5) * 1e-5
    curve = friction_curve(run, settling=always(0.1))
    assert [point.speed for point in curve.points] == pytest.approx(SPEEDS)
    assert curve.uneven == ()


@pytest.mark.parametrize("period", [20, 100, 300])
def test_stick_slip_shows_through_the_noise(period):
    velocity = phases([0.3], seconds=1.0)
    moved = velocity * np.where(np.arange(len(velocity)) % period < period // 2, 2.0, 0.0)
    noise = 0.5 * np.random.default_rng(5).standard_normal(len(velocity))
    run = trace_of(
        set_velocity=velocity,
        actual_velocity=moved + noise,
        actual_position=np.cumsum(moved) * T,
        actual_torque=np.sign(velocity),
    )
    assert "moves unevenly at every constant velocity (-0.3, 0.3)" in refused(run)


def test_speeds_at_which_the_axis_stands_still_are_told_apart_from_stick_slip():
    """A torque limit of 150 N: Stribeck friction is above it up to 3.5 mm/s."""
    run = friction_run(SPEEDS)
    held = np.abs(run.actual_torque) > 150.0
    run.actual_torque[:] = np.clip(run.actual_torque, -150.0, 150.0)
    run.actual_velocity[held] = 0.0
    run.actual_position[:] = np.cumsum(run.actual_velocity) * T
    curve = friction_curve(run, settling=always(0.1))
    slow = [speed for speed in SPEEDS if stribeck(speed) > 150.0]
    assert curve.standing == tuple(sorted([-speed for speed in slow] + slow)) and curve.uneven == ()
    assert [point.speed for point in curve.points] == [speed for speed in SPEEDS if stribeck(speed) <= 150.0]


def test_phases_stop_at_gaps_and_ramps():
    """A velocity of 10 mm/s over 1 s in which 100 cycles were lost, then a slow ramp, then a slow sine."""
    velocity = np.concatenate(
        [np.full(900, 10.0), np.linspace(10.0, 11.0, 1000), 10.0 * np.sin(np.arange(5000) * 1e-3)]
    )
    cycle = np.arange(len(velocity)) + np.where(np.arange(len(velocity)) < 400, 0, 100)
    found = steady_phases(trace_of(set_velocity=velocity, cycle=cycle), settling=always(0.1), shortest=0.05)
    assert [(phase.first, phase.end) for phase in found] == [(100, 400), (500, 901)]
    assert {phase.velocity for phase in found} == {10.0}


def test_repeated_and_unordered_cycles_count_once():
    velocity = phases(SPEEDS)
    order = np.random.default_rng(3).permutation(np.repeat(np.arange(len(velocity)), 2))
    torque = np.sign(velocity) * 7.0
    run = trace_of(
        cycle=order, set_velocity=velocity[order], actual_torque=torque[order], actual_velocity=velocity[order]
    )
    assert len(run) == len(velocity) and np.array_equal(run.set_velocity, velocity)


@pytest.mark.parametrize(
    ("trace", "text"),
    [
        (
            trace_of(set_velocity=np.full(20, 5.0), actual_torque=np.ones(20)),
            "P-ERR-27003 axis x: 0.02 s were recorded, at least 0.05 s are needed; nothing was made",
        ),
        (
            trace_of(set_velocity=np.zeros(0)),
            "P-ERR-27003 axis x: 0 s were recorded, at least 0.05 s are needed; nothing was made",
        ),
        (
            trace_of(set_velocity=np.zeros(500), actual_torque=np.ones(500)),
            "P-ERR-27004 axis x: does not move in the recorded 0.5 s; nothing was made",
        ),
        (
            trace_of(set_velocity=phases([5.0]), actual_torque=None),
            "P-ERR-27005 axis x: the recording holds no actual_torque (it was made by an older version); nothing was made, "
            "record again",
        ),
        (
            trace_of(set_velocity=phases([5.0]), actual_torque=np.zeros(len(phases([5.0])))),
            "P-ERR-27005 axis x: the drive reported no torque (actual_torque is 0 in all cycles); nothing was made. The "
            "telegram needs S-0-0084 or object 6077, a simulated drive has friction with simulation.model CASCADED "
            "(P-SIM-00006)",
        ),
        (
            friction_run([5.0], seconds=0.14),
            "P-ERR-27006 axis x: no motion with constant velocity lasts long enough to settle and to be measured: the "
            "longest, at 5, lasts 0.14 s of the 0.15 s that it needs; nothing was made",
        ),
        (
            trace_of(set_velocity=np.sin(np.arange(500) * 0.01), actual_torque=np.ones(500)),
            "P-ERR-27006 axis x: never moves with constant velocity in the recording; nothing was made",
        ),
        (
            friction_run([5.0, 8.0], both=False),
            "P-ERR-27007 axis x: no speed was driven in both directions (constant velocities: 5, 8); weight and friction "
            "cannot be told apart, no table was made, drive each speed in both directions",
        ),
        (
            trace_of(
                set_velocity=phases([5.0]),
                actual_velocity=np.zeros(len(phases([5.0]))),
                actual_position=np.zeros(len(phases([5.0]))),
                actual_torque=phases([5.0]),
            ),
            "P-ERR-27006 axis x: does not move at any constant velocity (-5, 5), the torque comes up to 5 and not above "
            "the friction: is the torque limit of the drive too low, or the axis blocked? no table was made",
        ),
    ],
)
def test_recordings_that_say_nothing_are_refused(trace, text):
    assert refused(trace) == text


def test_cycle_time_is_that_of_the_recording():
    velocity = phases([5.0], cycle_time=4 * T)
    run = trace_of(cycle_time=4 * T, set_velocity=velocity, actual_torque=np.sign(velocity))
    assert friction_curve(run, settling=always(0.1)).points[0].seconds == pytest.approx(0.8)


def test_timing_gives_slow_motions_time_and_fast_ones_a_short_way():
    timing = Timing(kv=50.0)
    assert [timing.settling(speed) for speed in (0.1, 5.0, 10.0, 500.0)] == pytest.approx([0.4, 0.4, 0.3, 0.202])
    assert [timing.steady(speed) for speed in (0.1, 100.0, 200.0, 500.0)] == pytest.approx([0.9, 0.71, 0.455, 0.302])
