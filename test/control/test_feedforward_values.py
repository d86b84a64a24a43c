"""Output of the feedforward: weights, delays, lead and prefilter against an integrated continuous profile."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import pytest
from loop_support import (
    ACC,
    ADD_ACC,
    ADD_JERK,
    ADD_VEL,
    INERTIA,
    JERK,
    KV,
    NO_FRICTION,
    TA,
    VEL,
    T,
    column,
    lags,
    loop_with,
    motion,
    run,
    trapezoid,
)
from numpy.typing import NDArray
from scipy.interpolate import PPoly

PHASES = [(20, 0.0), *trapezoid(25_000.0, 40, 25, 60, rest=120), *trapezoid(50_000.0, 20, 0, 0, rest=50, sign=-1.0)]
STATES = motion(PHASES)


class Profile:
    """The continuous motion behind `PHASES`: jerk as a step function, the rest by integration; at rest outside."""

    def __init__(self) -> None:
        ends = np.cumsum([0.0] + [cycles * T for cycles, _ in PHASES])
        breaks = np.concatenate([[-1.0], ends, [ends[-1] + 1.0]])
        jerks = np.array([[0.0] + [j for _, j in PHASES] + [0.0]])
        self.jerk = PPoly(jerks, breaks)
        self.acceleration = self.jerk.antiderivative()
        self.velocity = self.acceleration.antiderivative()

    def means(self, of: PPoly, delay: float) -> NDArray[np.float64]:
        """Mean over the cycle that begins `delay` before each setpoint."""
        starts = np.arange(len(STATES)) * T - delay
        return np.array([of.integrate(t, t + T) / T for t in starts])


PROFILE = Profile()


@dataclass
class Means:
    v: NDArray[np.float64]
    a: NDArray[np.float64]
    j: NDArray[np.float64]


def means(velocity_delay: float = 0.0, torque_delay: float = 0.0) -> Means:
    p = PROFILE
    return Means(
        p.means(p.velocity, velocity_delay), p.means(p.acceleration, torque_delay), p.means(p.jerk, torque_delay)
    )


def assert_puts_out(loop, velocity, additive_velocity, torque) -> None:  # type: ignore[no-untyped-def]
    cycles = run(loop, STATES)
    zero = np.zeros(len(STATES))
    for name, expected, tolerance in (
        ("feedforward_velocity", velocity, 1e-8),
        ("additive_velocity", additive_velocity, 1e-8),
        ("additive_torque", torque, 1e-8),
    ):
        off = np.abs(column(cycles, name) - (zero + expected)).max()
        assert off < tolerance, f"{name} is {off} off"


WEIGHTS = {"weight": 0.83, "velocity_weight": 0.96, "torque_weight": 1.2, "jerk_weight": 0.02}


@pytest.mark.parametrize(
    ("mode", "velocity", "additive", "torque"),
    [
        (VEL, (0.83 * 0.96, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)),
        (ACC, (0.0, 0.83 * TA, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)),
        (JERK, (0.0, 0.0, 0.83 * 0.02 * TA / KV), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)),
        (VEL | ACC | JERK, (0.83 * 0.96, 0.83 * TA, 0.83 * 0.02 * TA / KV), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)),
        (ADD_VEL, (0.0, 0.0, 0.0), (0.83 * 0.96, 0.0, 0.0), (0.0, 0.0, 0.0)),
        (ADD_ACC, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.83 * 1.2 * INERTIA, 0.0)),
        (ADD_JERK, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.83 * 0.02 * INERTIA)),
        (VEL | ADD_ACC, (0.83 * 0.96, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.83 * 1.2 * INERTIA, 0.0)),
        (ADD_VEL | ACC, (0.0, 0.83 * TA, 0.0), (0.83 * 0.96, 0.0, 0.0), (0.0, 0.0, 0.0)),
        (
            ADD_VEL | ADD_ACC | ADD_JERK,
            (0.0, 0.0, 0.0),
            (0.83 * 0.96, 0.0, 0.0),
            (0.0, 0.83 * 1.2 * INERTIA, 0.83 * 0.02 * INERTIA),
        ),
        (0x100 | 0x200, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)),
    ],
)
def test_weights_of_all_modes(mode, velocity, additive, torque) -> None:  # type: ignore[no-untyped-def]
    """Factors of mean velocity, acceleration and jerk; ADD_ without the quantity itself is nothing."""
    m = means()
    assert_puts_out(
        loop_with(mode, **WEIGHTS), *(f[0] * m.v + f[1] * m.a + f[2] * m.j for f in (velocity, additive, torque))
    )


DELAYS = [0.0, 0.00015, 0.0004, 0.001, 0.0025, 0.004, 0.005999]


@pytest.mark.parametrize("delay", DELAYS)
def test_delays_of_whole_cycles_and_of_fractions(delay: float) -> None:
    """P-AXIS-00389 for the velocity, P-AXIS-00390 for the torque, each separately."""
    late = means(delay, 0.005999 - delay)
    loop = loop_with(ADD_VEL | ADD_ACC | ADD_JERK, velocity_delay=delay, acceleration_delay=0.005999 - delay)
    assert_puts_out(loop, 0.0, late.v, INERTIA * (late.a + 0.01 * late.j))


def test_delays_act_on_additive_values_only() -> None:
    prompt, late = means(), means(0.0025, 0.0017)
    delays = {"velocity_delay": 0.0025, "acceleration_delay": 0.0017}
    conventional = prompt.v + TA * prompt.a + 0.01 * TA / KV * prompt.j
    assert_puts_out(loop_with(VEL | ACC | JERK, **delays), conventional, 0.0, 0.0)
    assert_puts_out(loop_with(VEL | ADD_ACC, **delays), prompt.v, 0.0, INERTIA * late.a)
    assert_puts_out(loop_with(ADD_VEL | ACC, **delays), TA * prompt.a, late.v, 0.0)
    assert_puts_out(loop_with(ADD_ACC | JERK, **delays), 0.01 * TA / KV * prompt.j, 0.0, INERTIA * late.a)
    assert_puts_out(loop_with(ACC | ADD_JERK, **delays), TA * prompt.a, 0.0, INERTIA * 0.01 * late.j)


@pytest.mark.parametrize("lead", [1, 3, 4])
def test_with_shift_time_the_feedforward_leaves_before_its_setpoint(lead: int) -> None:
    """The values are those of the newest setpoint; the position controller works `lead` cycles behind it."""
    m = means()
    loop = loop_with(VEL | ACC, lead_cycles=lead)
    cycles = run(loop, STATES)
    assert np.abs(column(cycles, "feedforward_velocity") - (m.v + TA * m.a)).max() < 1e-8
    positions = np.array([STATES[max(0, n - lead)][0] for n in range(len(STATES))])
    controller = KV * (positions - column(cycles, "actual_position"))
    conventional = column(cycles, "command_velocity") - column(cycles, "feedforward_velocity")
    assert np.abs(conventional - controller).max() < 1e-9


def test_a_lookahead_of_the_friction_does_not_shift_the_feedforward_against_the_setpoint() -> None:
    friction = type(NO_FRICTION)(True, True, (0.0,), (0.0,), 0.0, 3, 0)
    m = means(3 * T, 3 * T)
    cycles = run(loop_with(VEL | ACC, friction=friction), STATES)
    assert np.abs(column(cycles, "feedforward_velocity") - (m.v + TA * m.a)).max() < 1e-8
    assert np.abs(lags(run(loop_with(VEL | ACC), STATES))[:-3] - _behind(cycles, 3)[3:]).max() < 1e-12


def _behind(cycles, count: int) -> NDArray[np.float64]:  # type: ignore[no-untyped-def]
    """Following errors against the setpoint `count` cycles ago."""
    positions = np.array([STATES[max(0, n - count)][0] for n in range(len(STATES))])
    return positions - column(cycles, "actual_position")


@pytest.mark.parametrize("lead", [0, 2])
@pytest.mark.parametrize("delay", [0.0, 0.0007, 0.003])
def test_lead_and_delay_change_the_lag_in_constant_acceleration(lead: int, delay: float) -> None:
    """a·(Ta + delay - lead·T)/Kv behind the setpoint of the position controller, with velocity feedforward."""
    phases = [(80, 25_000.0), (1000, 0.0)]
    states = motion(phases)
    cycles = run(loop_with(ADD_VEL, lead_cycles=lead, velocity_delay=delay), states)
    lag = states[-1 - lead][0] - cycles[-1].actual_position
    assert lag == pytest.approx(2000.0 * (TA + delay - lead * T) / KV, abs=1e-6)


@pytest.mark.parametrize("cycles", [2, 5, 16])
def test_the_prefilter_is_the_mean_of_the_last_cycles(cycles: int) -> None:
    m = means()
    before = np.zeros(cycles - 1)  # at rest before the start

    def filtered(values: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.convolve(np.concatenate([before, values]), np.full(cycles, 1.0 / cycles), mode="valid")

    loop = loop_with(VEL | ACC | ADD_JERK, prefilter_cycles=cycles)
    assert_puts_out(loop, filtered(m.v) + TA * filtered(m.a), 0.0, 0.01 * INERTIA * filtered(m.j))


def test_a_prefilter_delays_by_half_of_what_it_takes_together() -> None:
    """n cycles are (n - 1)/2 · T later in constant acceleration."""
    states = motion([(80, 25_000.0), (1000, 0.0)])
    error = lags(run(loop_with(VEL, prefilter_cycles=7), states))
    assert error[-1] == pytest.approx(2000.0 * (TA + 3 * T) / KV, abs=1e-6)


@pytest.mark.parametrize("weight", [0.0, 0.3, 1.0, 1.15])
def test_the_global_weight_scales_what_is_left_of_the_lag(weight: float) -> None:
    """P-AXIS-00228 / P-AXIS-00229: (1 - w)·v/Kv; above 1 the axis is ahead."""
    states = motion([(80, 25_000.0), (80, -25_000.0), (1000, 0.0)])
    for mode in (VEL, ADD_VEL):
        error = lags(run(loop_with(mode, weight=weight), states))
        assert error[-1] == pytest.approx((1.0 - weight) * 160.0 / KV, abs=1e-6)


def test_the_velocity_weight_leaves_the_acceleration_alone() -> None:
    """P-AXIS-00514 / P-AXIS-00515 = 0.5: half the lag of the velocity, none of the acceleration."""
    phases = [(80, 25_000.0), (1000, 0.0)]
    states = motion(phases)
    error = lags(run(loop_with(VEL | ACC, velocity_weight=0.5), states))
    mean_velocity = states[-1][1] + 2000.0 * T / 2.0
    lag = 0.5 * (mean_velocity / KV - 2000.0 / KV**2)  # the lag itself grows: half of it is made up late
    assert error[-1] == pytest.approx(lag, abs=1e-6)


def test_the_jerk_part_adds_weight_times_ta_j_over_kv_squared() -> None:
    """P-AXIS-00337 / P-AXIS-00338, as the manual's third lag has it: a tuning value, the axis is ahead by so much."""
    j = 20_000.0
    states = motion([(1500, j)])
    plain, jerk = (lags(run(loop_with(mode, jerk_weight=0.4), states))[-1] for mode in (VEL | ACC, VEL | ACC | JERK))
    assert jerk - plain == pytest.approx(-0.4 * TA * j / KV**2, abs=1e-8)


@pytest.mark.parametrize(
    ("conventional", "additive"),
    [(VEL, ADD_VEL), (VEL | ACC, ADD_VEL | ADD_ACC), (ACC, ADD_ACC), (VEL | ACC, VEL | ADD_ACC)],
)
def test_conventional_and_additive_feedforward_move_the_same_plant_alike(conventional: int, additive: int) -> None:
    """J·a as an additive torque accelerates like Ta·a as a velocity; weights and G136 included."""
    weights = {"weight": 0.9, "velocity_weight": 0.97}
    ways = [column(run(loop_with(mode, **weights), STATES), "actual_position") for mode in (conventional, additive)]
    assert np.abs(ways[0] - ways[1]).max() < 1e-9
    assert np.abs(np.diff(ways[0])).max() > 0.05


def test_mean_values_are_those_of_the_profile_itself() -> None:
    """The oracle against a closed form: the mean velocity over a cycle is the way of that cycle over T."""
    m = means()
    ways = np.diff([state[0] for state in STATES]) / T
    assert np.abs(m.v[:-1] - ways).max() < 1e-8
    assert math.isclose(m.a.max(), 1000.0, rel_tol=1e-9)
