"""The runs behind the figures of feedforward and friction compensation: printed numbers, closed forms, the plant."""

import numpy as np
import pytest
from figure_support import CYCLE_TIME, SCENARIOS, run_of

from cnc_ptp.parameters import read_machine
from figures.circle import evaluated
from figures.friction_curve import measured
from figures.scenario_head import ROOT, read_head
from figures.weights import counted_velocity, full_current

KV, TA = 50.0, 0.005
"""1/s, s; of config/feedforward.yaml, drives of first order with an ideal encoder."""
NAMES = {"without": "x", "velocity": "x", "acceleration": "y", "additive": "z"}


def lag(name, axis):
    return run_of(f"control_lag_{name}").column(axis, "following_error")


def setpoint(name, axis, field):
    return run_of(f"control_lag_{name}").column(axis, f"set_{field}")


def constant(values, cycles=250):
    """The cycles in which a value has been constant for some time (12 time constants and more)."""
    same = np.concatenate([[0], np.cumsum(np.diff(values) != 0.0)])
    return np.flatnonzero(np.concatenate([np.full(cycles, False), same[cycles:] == same[:-cycles]]))


# following error: feedforward manual, figures 3 to 5


def test_the_four_figures_show_the_same_motion():
    motions = [setpoint(name, axis, "position") for name, axis in NAMES.items()]
    assert all(np.array_equal(motion, motions[0]) for motion in motions)


def test_lag_without_feedforward_is_v_over_kv():
    moving = [cycle for cycle in constant(setpoint("without", "x", "velocity")) if 300 < cycle < 750]
    assert len(moving) > 100
    assert lag("without", "x")[moving] == pytest.approx(500.0 / KV, abs=1e-4)
    assert lag("without", "x").max() == pytest.approx(10.0, abs=1e-4)


def test_velocity_feedforward_leaves_the_lag_of_the_acceleration():
    """Nothing at constant velocity; in the ramps less than A · Ta/Kv = 0.5 mm, in the direction of the acceleration."""
    velocity, acceleration = (setpoint("velocity", "x", field) for field in ("velocity", "acceleration"))
    moving = [cycle for cycle in constant(velocity) if 300 < cycle < 750]
    assert lag("velocity", "x")[moving] == pytest.approx(0.0, abs=1e-4)
    assert 0.4 < lag("velocity", "x").max() < 5000.0 * TA / KV
    strong = np.abs(acceleration) > 2500.0
    assert (np.sign(lag("velocity", "x")[strong]) == np.sign(acceleration[strong])).all()


@pytest.mark.parametrize("name", ["acceleration", "additive"])
def test_acceleration_feedforward_leaves_what_the_held_command_cannot_follow(name):
    """j · T²/(12 · Kv) = 0.083 µm, against the jerk; the larger part of the lag is gone."""
    axis = NAMES[name]
    rest = 50_000.0 * CYCLE_TIME**2 / (12.0 * KV)
    assert rest == pytest.approx(0.0833e-3, abs=1e-6)
    assert np.abs(lag(name, axis)).max() == pytest.approx(rest, rel=1e-2)
    jerk = setpoint(name, axis, "jerk")
    ends = np.flatnonzero((np.diff(jerk) != 0.0) & (jerk[:-1] != 0.0))
    assert lag(name, axis)[ends] == pytest.approx(-jerk[ends] * CYCLE_TIME**2 / (12.0 * KV), rel=2e-2)
    assert np.abs(lag("velocity", "x")).max() > 5000.0 * np.abs(lag(name, axis)).max()


def test_additive_torque_is_the_force_of_the_mass():
    """100 kg: 0.1 N for 1 mm/s², of the mean acceleration of each cycle; the drive shows the same one cycle later."""
    run = run_of("control_lag_additive")
    a, j = run.column("z", "set_acceleration"), run.column("z", "set_jerk")
    assert run.column("z", "additive_torque") == pytest.approx(0.1 * (a + 0.5 * j * CYCLE_TIME), abs=1e-9)
    assert run.column("z", "actual_torque")[1:] == pytest.approx(run.column("z", "additive_torque")[:-1], abs=3.0)
    assert not run.column("z", "feedforward_velocity").any()


# weighting and coupling


def test_weighting_leaves_its_part_of_the_lag():
    run = run_of("control_weighting")
    lag_of_x, velocity = run.column("x", "following_error"), run.column("x", "set_velocity")
    steady = constant(velocity, cycles=600)
    forwards = steady[velocity[steady] == 100.0]
    for begin, end, left in ((0.0, 3.0, 1.0), (3.0, 6.0, 0.0), (6.0, 9.0, 0.5)):
        cycles = forwards[(forwards * CYCLE_TIME >= begin) & (forwards * CYCLE_TIME < end)]
        assert len(cycles) > 100
        assert lag_of_x[cycles] == pytest.approx(left * 100.0 / KV, abs=1e-3)


def test_feedforward_comes_and_goes_within_the_limits_of_the_axis():
    """10000 mm/s², 50000 mm/s³; the lag of 10 mm is made up while it is on."""
    run = run_of("control_coupling")
    feedforward, lag_of_y = run.column("y", "feedforward_velocity"), run.column("y", "following_error")
    on, off = (round(marker.time / CYCLE_TIME) for marker in run.markers[1:])
    assert not feedforward[:on].any()
    assert feedforward[off - 1] == pytest.approx(500.0, abs=1e-6)
    assert feedforward[off + 300] == 0.0
    change = np.diff(feedforward) / CYCLE_TIME
    assert np.abs(change).max() <= 10_000.0
    assert np.abs(np.diff(change)).max() / CYCLE_TIME <= 50_000.0 * (1.0 + 1e-6)
    assert (lag_of_y[on], lag_of_y[off], lag_of_y[off + 500]) == pytest.approx((10.0, 0.0, 10.0), abs=1e-2)
    assert np.abs(np.diff(run.column("y", "actual_velocity"))).max() / CYCLE_TIME <= 10_000.0


# friction: friction manual, figures 1, 5, 7 and 8


def plant_friction(axis, speed):
    plant = read_machine(ROOT / "config" / "mill.yaml").raw(axis)
    coulomb, static, stribeck, viscous = (float(plant.number(f"P-SIM-000{n}")) for n in (12, 13, 14, 15))
    return coulomb + (static - coulomb) * np.exp(-((speed / stribeck) ** 2)) + viscous * speed / 1000.0


def test_friction_curve_is_that_of_the_plant():
    figure = read_head(SCENARIOS / "control_friction_curve.yaml")
    points = measured(figure, run_of(figure.name), "x")
    assert [point.speed for point in points] == [0.5, 1, 1.5, 2, 2.5, 3, 4, 5, 7, 10, 50, 100, 200, 300]
    for point in points:
        expected = plant_friction("x", point.speed)
        assert (point.positive, -point.negative) == pytest.approx((expected, expected), rel=0.03)


def test_torque_at_constant_velocity_is_the_friction():
    run = run_of("control_constant_velocity")
    torque, velocity = run.column("x", "actual_torque"), run.column("x", "set_velocity")
    steady = constant(velocity, cycles=400)
    for speed in (20.0, -20.0, 200.0, -200.0):
        cycles = steady[velocity[steady] == speed]
        assert len(cycles) > 200
        expected = np.sign(speed) * plant_friction("x", abs(speed))
        assert torque[cycles] == pytest.approx(expected, rel=0.01)
    assert np.abs(torque).max() > 2.0 * plant_friction("x", 200.0)  # in the ramps inertia comes to it


def test_weight_falls_over_the_cycles_before_and_rises_with_the_way_after_a_reversal():
    run = run_of("control_weights")
    friction = run.machine.axes["x"].control.friction
    assert (friction.reversal_lookahead, friction.position_delay) == (4, 0.001)
    velocity = counted_velocity(friction, run.column("x", "set_velocity"))
    position = np.concatenate([np.zeros(4), run.column("x", "set_position")[:-4]])
    moving = np.flatnonzero(velocity)
    turn = int(moving[1:][np.diff(np.sign(velocity[moving])) != 0.0][0])
    last = int(moving[moving < turn][-1])
    weight = run.column("x", "friction_current") / np.where(velocity == 0.0, np.inf, full_current(friction, velocity))
    assert weight[last - 6 : last + 1] == pytest.approx([1.0, 1.0, 1.0, 1.0, 0.75, 0.5, 0.25], abs=1e-9)
    way = position[turn - 30 : turn + 30].max() - position[turn : turn + 30]  # from the outermost position
    assert weight[turn : turn + 30] == pytest.approx(np.minimum(1.0, way / 0.001), abs=1e-9)
    assert weight[turn + 29] == 1.0


def circles(name):
    figure = read_head(SCENARIOS / f"{name}.yaml")
    return [curve.result for curve in evaluated(figure, run_of(name))]


def test_friction_compensation_makes_the_circle_round():
    without, with_compensation = circles("control_circle")
    assert without.largest_peak > 5.0 * with_compensation.largest_peak
    assert without.circular_deviation > 10.0 * with_compensation.circular_deviation
    assert {peak.reversing for peak in without.peaks} == {0, 1}
    assert [result.fitted.radius for result in (without, with_compensation)] == pytest.approx([25.0, 25.0], abs=1e-3)


def test_feedforward_makes_the_circle_round():
    """Without it the circle is smaller by R · (w/Kv)² · (1/2 - Kv · Ta), w the angular velocity, Ta 3 ms (P-SIM-00001)."""
    without, with_feedforward = circles("control_circle_feedforward")
    assert without.circular_deviation > 10.0 * with_feedforward.circular_deviation
    omega, radius = 2000.0 / 60.0 / 25.0, 25.0
    smaller = radius * (omega / KV) ** 2 * (0.5 - KV * 0.003)
    assert without.fitted.radius == pytest.approx(radius - smaller, abs=0.001)
    assert with_feedforward.fitted.radius == pytest.approx(radius, abs=1e-4)
