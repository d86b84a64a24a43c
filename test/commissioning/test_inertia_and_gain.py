"""Inertia from torque, stability limit and proposal of the position controller gain."""

import math
import random

import numpy as np
import pytest
from commissioning_support import T, stribeck, trace_of
from long_support import long
from scipy.integrate import cumulative_trapezoid

from cnc_ptp.commissioning import inertia
from cnc_ptp.commissioning.dynamics import DriveFit
from cnc_ptp.commissioning.gain import propose_gain, spectral_radius, stability_limit


def fit_inertia(trace):
    """Of an axis whose drive is a lag of 3 ms."""
    return inertia.fit_inertia(trace, time_constant=0.003)


def torque_run(
    k=0.05,
    load=0.0,
    noise=0.0,
    quantum=0.0,
    friction=stribeck,
    mean_velocity=False,
    top=200.0,
    velocity_noise=0.0,
    digit=0.0,
    lag=0,
    momentary=False,
    seed=2,
):
    """Smooth motions with M = k·a + friction(v) + load; the torque of a row is the mean of the cycle before it, or the
    one of its beginning, whole digits of it.

    The velocity is the momentary one, or that of a telegram without it: the distance of the cycle before it; the set one is
    `lag` cycles ahead.
    """
    fine = 20
    time = np.arange(3000 * fine) * T / fine
    velocity = top * np.sin(2 * np.pi * time) * np.sin(0.5 * np.pi * time) ** 2
    acceleration = np.gradient(velocity, time)
    torque = k * acceleration + np.sign(velocity) * friction(np.abs(velocity)) + load
    position = cumulative_trapezoid(velocity, time, initial=0.0)
    draw = np.random.default_rng(seed)
    mean = np.concatenate([[0.0], torque.reshape(-1, fine).mean(axis=1)[:-1]])
    mean = torque[::fine] if momentary else mean
    mean = mean + noise * draw.standard_normal(len(mean))
    mean = np.round(mean / digit) * digit if digit else mean
    actual = np.diff(position[::fine], prepend=0.0) / T if mean_velocity else velocity[::fine]
    if quantum:
        actual = np.round(actual / quantum) * quantum
    actual = actual + velocity_noise * draw.standard_normal(len(actual))
    return trace_of(
        set_velocity=np.concatenate([velocity[::fine][lag:], np.zeros(lag)]),
        actual_velocity=actual,
        actual_position=position[::fine],
        actual_torque=mean,
        mean_velocity=mean_velocity,
    )


@pytest.mark.parametrize("mean_velocity", [False, True])
def test_inertia_and_friction_come_back(mean_velocity):
    fit = fit_inertia(torque_run(friction=lambda v: 120.0 + 0.3 * v, load=-60.0, mean_velocity=mean_velocity))
    assert fit.torque_per_acceleration == pytest.approx(0.05, rel=1e-3)
    assert fit.coulomb == pytest.approx(120.0, rel=1e-3)
    assert fit.viscous == pytest.approx(0.3, rel=1e-2)
    assert fit.deviation < 1e-4


@pytest.mark.parametrize("top", [3.0, 5.0, 8.0, 15.0])
def test_friction_that_is_no_straight_line_shows_in_the_deviation(top):
    """At a few mm/s the Stribeck curve (4 mm/s) bends, and a straight line leaves percents, however many cycles."""
    fit = fit_inertia(torque_run(k=1.0, top=top))
    assert abs(fit.torque_per_acceleration - 1.0) <= fit.deviation
    assert fit.deviation > 0.03
    assert fit_inertia(torque_run(k=1.0, top=top, friction=lambda v: 120.0 + 0.3 * v)).deviation < 1e-3


@pytest.mark.parametrize("mean_velocity", [False, True])
@pytest.mark.parametrize("momentary", [False, True])
@pytest.mark.parametrize("lag", [0, 7, 40])
def test_neither_the_age_of_the_torque_nor_a_lag_of_the_axis_bends_it(lag, momentary, mean_velocity):
    run = torque_run(friction=lambda v: 120.0 + 0.3 * v, lag=lag, momentary=momentary, mean_velocity=mean_velocity)
    assert fit_inertia(run).torque_per_acceleration == pytest.approx(0.05, rel=1e-4)


@pytest.mark.parametrize("noise", [5.0, *long([0.5, 2.0])])
def test_noise_of_the_velocity_does_not_make_the_inertia_smaller(noise):
    """Least squares give k·(1 - 2·noise²/mean of Δv²): 6 % too little with 5 mm/s."""
    found = [
        fit_inertia(
            torque_run(friction=lambda v: 120.0 + 0.3 * v, lag=10, velocity_noise=noise, seed=seed)
        ).torque_per_acceleration
        for seed in range(20)
    ]
    assert abs(np.mean(found) - 0.05) < 3.0 * np.std(found) / np.sqrt(20)
    assert np.mean(found) == pytest.approx(0.05, rel=0.015)


def of_a_seed(seed):
    """Axis, friction, noise, digits and telegram by chance; true k, fit, whether the torque is momentary."""
    draw = random.Random(seed)
    k, coulomb, viscous = 10.0 ** draw.uniform(-3.0, 1.0), draw.uniform(0.0, 0.5), draw.uniform(0.0, 0.002)
    largest = 1000.0 * k
    options = {
        "load": draw.uniform(-0.3, 0.3) * largest,
        "noise": draw.uniform(0.0, 0.05) * largest,
        "velocity_noise": draw.uniform(0.0, 1.0),
        "digit": draw.choice([0.0, 0.01, 0.05]) * largest,
        "lag": draw.randrange(30),
        "momentary": draw.random() < 0.5,
        "mean_velocity": draw.random() < 0.5,
    }
    run = torque_run(k=k, friction=lambda v: largest * (coulomb + viscous * v), seed=seed, **options)
    return k, fit_inertia(run), options["momentary"]


def test_the_deviation_covers_the_truth_in_95_of_100_runs():
    runs = [of_a_seed(seed) for seed in range(200)]
    errors = np.array([fit.torque_per_acceleration / k - 1.0 for k, fit, _ in runs])
    deviations = np.array([fit.deviation / k for k, fit, _ in runs])
    of_means = np.array([not momentary for _, _, momentary in runs])
    assert np.sum(np.abs(errors) <= deviations) >= 190
    assert abs(np.mean(errors)) < 3.0 * np.std(errors) / np.sqrt(200)
    assert np.median(deviations[of_means]) < 4.0 * np.std(errors[of_means]), "and says no more than that"


def test_friction_that_hides_the_inertia_leaves_none():
    assert fit_inertia(torque_run(k=0.5, top=8.0)) is None


@pytest.mark.parametrize(("noise", "quantum"), [(20.0, 0.0), (0.0, 2.0), (20.0, 2.0)])
def test_noise_and_quantisation_average_out(noise, quantum):
    fit = fit_inertia(torque_run(noise=noise, quantum=quantum))
    assert fit.torque_per_acceleration == pytest.approx(0.05, rel=0.03)
    assert abs(fit.torque_per_acceleration - 0.05) < 6 * fit.deviation


def test_without_torque_or_acceleration_there_is_no_inertia():
    run = torque_run()
    columns = {name: getattr(run, name) for name in ("set_velocity", "actual_velocity", "actual_position")}
    assert fit_inertia(trace_of(**columns, actual_torque=None)) is None
    assert fit_inertia(trace_of(**columns, actual_torque=np.zeros(3000))) is None
    constant = np.full(3000, 50.0)
    assert fit_inertia(trace_of(set_velocity=constant, actual_torque=np.ones(3000))) is None
    assert fit_inertia(trace_of(set_velocity=constant[:20], actual_torque=np.ones(20))) is None
    noise = np.random.default_rng(1).standard_normal(3000)
    assert fit_inertia(trace_of(**columns, actual_torque=noise)) is None


def runs_away(kv, time_constant, dead, cycles=40_000):
    """Whether the loop grows: a simulation of controller, dead time, lag and integrator, cycle by cycle."""
    pole = math.exp(-T / time_constant) if time_constant else 0.0
    position, velocity, waiting = 1.0, 0.0, [0.0] * dead
    largest = [0.0, 0.0]
    for cycle in range(cycles):
        waiting.append(-kv * position)
        command = waiting.pop(0)
        surplus = velocity - command
        position += command * T + surplus * time_constant * (1.0 - pole)
        velocity = command + surplus * pole
        half = 2 * cycle // cycles
        largest[half] = max(largest[half], abs(position))
        if abs(position) > 1e6:
            return True
    return largest[1] > largest[0]


@pytest.mark.parametrize("time_constant", [0.0, 0.0005, 0.003, 0.02])
@pytest.mark.parametrize("dead", [1, *long([0, 4])])
def test_the_limit_is_where_the_loop_begins_to_run_away(time_constant, dead):
    limit = stability_limit(time_constant, dead, T)
    assert not runs_away(0.98 * limit, time_constant, dead)
    assert runs_away(1.02 * limit, time_constant, dead)


@pytest.mark.parametrize("time_constant", [0.0005, 0.003, 0.02])
def test_the_limit_without_dead_time_is_the_closed_form(time_constant):
    """Jury's criterion of z² + … : Kv < (1 - p)/(L - p·T) and, where it is positive, Kv < 2(1 + p)/(T(1 + p) - 2L)."""
    pole = math.exp(-T / time_constant)
    lag = time_constant * (1.0 - pole)
    limits = [(1.0 - pole) / (lag - pole * T), 2.0 * (1.0 + pole) / (T * (1.0 + pole) - 2.0 * lag)]
    assert stability_limit(time_constant, 0, T) == pytest.approx(min(x for x in limits if x > 0.0), rel=1e-9)


def test_the_limit_of_an_ideal_drive():
    assert stability_limit(0.0, 0, T) == pytest.approx(2.0 / T)
    assert stability_limit(0.0, 1, T) == pytest.approx(1.0 / T)


@pytest.mark.parametrize(
    ("time_constant", "dead"), [(0.003, 0), (0.003, 2), (0.010, 4), (0.0, 0), (0.0, 5), (0.0004, 0)]
)
def test_the_proposal_does_not_overshoot(time_constant, dead):
    """The damping of the slowest poles is at least 0.9: no overshoot above 0.2 %, and far from the limit."""
    proposal = propose_gain(DriveFit(time_constant, dead, 1.0, 0.0, 1000, T))
    assert proposal.total == pytest.approx(time_constant + dead * T + T / 2)
    assert proposal.limit == stability_limit(time_constant, dead, T)
    assert proposal.proposed <= proposal.limit / 3.0
    assert proposal.proposed < proposal.fastest
    assert spectral_radius(proposal.proposed, time_constant, dead, T) < 1.0
    position, velocity, waiting, highest = 0.0, 0.0, [0.0] * dead, 0.0
    pole = math.exp(-T / time_constant) if time_constant else 0.0
    for _ in range(2000):
        waiting.append(proposal.proposed * (1.0 - position))
        command = waiting.pop(0)
        surplus = velocity - command
        position += command * T + surplus * time_constant * (1.0 - pole)
        velocity = command + surplus * pole
        highest = max(highest, position)
    assert 1.0 - 1e-6 < highest < 1.002


def test_the_proposal_of_the_mill():
    """Ta = 3 ms, T = 1 ms: 1 / (4 · 3.5 ms)."""
    proposal = propose_gain(DriveFit(0.003, 0, 1.0, 0.0, 1000, T))
    assert proposal.proposed == pytest.approx(71.43, abs=0.01)
    assert proposal.fastest == pytest.approx(142.86, abs=0.01)


def test_the_limit_reckons_with_all_that_fits():
    fit = DriveFit(0.003, 0, 1.0, 0.0, 1000, T, alternatives=((0.003, 0), (0.001, 2)))
    proposal = propose_gain(fit)
    assert proposal.limit == stability_limit(0.001, 2, T) < stability_limit(0.003, 0, T)
    assert proposal.proposed == pytest.approx(71.43, abs=0.01)
