"""The trapezoid of a position compensation and its distance along a basic motion, against geometry and quadrature."""

from __future__ import annotations

from math import cos, pi, sin

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from long_support import examples, long
from scipy.integrate import cumulative_simpson, quad, simpson
from scipy.optimize import brentq

from cnc_ptp.axis.compensation import Compensation, plan_compensation
from cnc_ptp.motion import Profile

QUICK = settings(max_examples=examples(100), deadline=None, derandomize=True, database=None)
CYCLE_TIME = 0.001


def trapezoid(t: float, peak: float, first: float, last: float, seconds: float) -> float:
    """Velocity: up with `first`, held at `peak`, down with `last` so that it ends at `seconds`."""
    return max(0.0, min(first * t, peak, last * (seconds - t)))


def area(peak: float, first: float, last: float, seconds: float) -> float:
    """Distance of a trapezoid as the mean of its two parallel sides times its height."""
    top = seconds - peak / first - peak / last
    return 0.5 * (seconds + top) * peak


def highest(first: float, last: float, seconds: float) -> float:
    """Where the two ramps meet: seconds = v/first + v/last."""
    return seconds * first * last / (first + last)


def way_by_quadrature(table: Profile, first: float, last: float) -> float:
    peak = max(abs(row[2]) for row in table.rows)
    corners = [peak / first, table.duration - peak / last]
    distance, _ = quad(trapezoid, 0.0, table.duration, (peak, first, last, table.duration), points=corners)
    return float(distance)


# what is reached


@pytest.mark.parametrize(
    ("length", "difference", "increase", "reached"),
    [
        (5000.0, 250.0, 300.0, 250.0),
        (2000.0, 500.0, 300.0, 165.0),  # 300·1 - 300²/2·(1/500 + 1/1000)
        (5000.0, -250.0, 300.0, -250.0),
        (2000.0, 500.0, 500.0, 1.0 / 0.006),  # the ramps meet at 333.3 mm/s: T²/(2·0.003)
        (2000.0, -500.0, 1e6, -1.0 / 0.006),
        (2000.0, 165.0, 300.0, 165.0),  # VK is just what D needs
        (2000.0, 1.0 / 0.006, 1e3, 1.0 / 0.006),  # the triangle is just what D needs
    ],
)
def test_examples_of_the_manual_and_their_limits(
    length: float, difference: float, increase: float, reached: float
) -> None:
    table = plan_compensation(length, difference, 2000.0, increase, 500.0, 1000.0)
    assert table.end == (pytest.approx(reached, rel=1e-15), 0.0, 0.0)
    assert table.duration == length / 2000.0
    if reached == difference:
        assert table.end[0] == difference  # to the bit: no warning then


@pytest.mark.parametrize(("difference", "rates"), [(100.0, (500.0, -1000.0)), (-100.0, (-1000.0, 500.0))])
def test_the_sign_orders_the_ramps(difference: float, rates: tuple[float, float]) -> None:
    """D > 0 begins with AK+ and ends with AK-; D < 0 begins with AK- and ends with AK+."""
    table = plan_compensation(2000.0, difference, 1000.0, 300.0, 500.0, 1000.0)
    assert (table.rows[0][3], table.rows[2][3]) == rates
    assert table.rows[1][2] * difference > 0.0 and table.rows[1][3] == 0.0


def test_a_ramp_takes_the_time_of_its_rate() -> None:
    """D = 300·(10 - 0.45) needs 300 mm/s exactly: up in 0.6 s, down in 0.3 s."""
    table = plan_compensation(20000.0, 300.0 * 9.55, 2000.0, 400.0, 500.0, 1000.0)
    assert [row[0] for row in table.rows] == pytest.approx([0.0, 0.6, 9.7, 10.0])
    assert [row[1] for row in table.rows] == pytest.approx([0.0, 90.0, 2820.0, 2865.0])
    assert table.rows[1][2] == pytest.approx(300.0, rel=1e-13)


def test_a_difference_is_spread_over_the_whole_length() -> None:
    """A small D is not done fast and early: its peak follows from the time L/VP."""
    table = plan_compensation(4000.0, 1.0, 2000.0, 300.0, 500.0, 1000.0)
    peak = brentq(lambda v: area(v, 500.0, 1000.0, 2.0) - 1.0, 0.0, highest(500.0, 1000.0, 2.0), xtol=1e-15)
    assert table.rows[1][2] == pytest.approx(peak, rel=1e-12)
    assert table.rows[-1][0] == 2.0


positive = st.floats(0.01, 1e5)


@QUICK
@given(
    length=positive, difference=positive, negative=st.booleans(), vp=positive, vk=positive, up=positive, down=positive
)
def test_every_plan_is_the_largest_trapezoid_that_is_allowed(
    length: float, difference: float, negative: bool, vp: float, vk: float, up: float, down: float
) -> None:
    table = plan_compensation(length, -difference if negative else difference, vp, vk, up, down)
    first, last = (down, up) if negative else (up, down)
    seconds = length / vp
    most = area(min(vk, highest(first, last, seconds)), first, last, seconds)
    sign = -1.0 if negative else 1.0
    assert sign * table.end[0] == pytest.approx(min(difference, most), rel=1e-12)
    assert table.end[1:] == (0.0, 0.0)
    assert table.duration == pytest.approx(seconds, rel=1e-12)
    assert abs(table.rows[1][2]) <= vk * (1.0 + 1e-9)
    for (t, p, v, a, _), (t1, p1, v1, _, _) in zip(table.rows, table.rows[1:], strict=False):
        d = t1 - t
        assert d >= 0.0
        rounding = 1e-15 * seconds * max(up, down)
        assert v + a * d == pytest.approx(v1, rel=1e-7, abs=1e-7 * abs(table.rows[1][2]) + rounding)
        assert p + 0.5 * (v + v1) * d == pytest.approx(p1, rel=1e-7, abs=1e-7 * difference)
    assert way_by_quadrature(table, first, last) == pytest.approx(abs(table.end[0]), rel=1e-6)


# along a basic motion

VP, SECONDS = 2000.0, 2.0
TABLE = plan_compensation(VP * SECONDS, 300.0, VP, 500.0, 1000.0, 2000.0)
PEAK = brentq(lambda v: area(v, 1000.0, 2000.0, SECONDS) - 300.0, 0.0, 600.0, xtol=1e-14)


def follow(velocity: object, derivative: object, cycles: int, *, direction: float = 1.0) -> np.ndarray:
    """The additional (p, v, a) of `cycles` cycles over a basic motion v(t) that is at rest at 0."""
    compensation = Compensation(cycle_time=CYCLE_TIME)
    base = lambda k: (0.0, velocity(k * CYCLE_TIME), derivative(k * CYCLE_TIME), 0.0)  # type: ignore[operator]  # noqa: E731
    compensation.start(0, base(0), direction=direction, process_velocity=VP, profile=TABLE)
    rows = []
    for k in range(cycles):
        p, v, a, _ = compensation.at(k, base(k))
        rows.append((p, v - velocity(k * CYCLE_TIME), a - derivative(k * CYCLE_TIME)))  # type: ignore[operator]
    assert not compensation.active
    return np.array(rows)


@pytest.mark.parametrize("share", [0.001, 0.25, 0.9999, 1.0, 1.0001, 3.0])
@pytest.mark.parametrize("direction", [-1.0, *long([1.0])])
def test_a_constant_velocity_v_compensates_d_times_the_smaller_of_1_and_v_by_vp(share: float, direction: float) -> None:
    rows = follow(lambda t: direction * share * VP, lambda t: 0.0, 2100, direction=direction)
    assert rows[-1][0] == pytest.approx(direction * 300.0 * min(1.0, share), rel=1e-12)
    t = np.arange(2001) * CYCLE_TIME
    expected = [direction * min(1.0, share) * trapezoid(x, PEAK, 1000.0, 2000.0, SECONDS) for x in t]
    assert rows[:2001, 1] == pytest.approx(np.array(expected), abs=1e-8)


def wave(t: float) -> float:
    return 1500.0 + 1400.0 * sin(2.0 * pi * 1.7 * t)


def wave_slope(t: float) -> float:
    return 1400.0 * 2.0 * pi * 1.7 * cos(2.0 * pi * 1.7 * t)


def lagging_speed(velocity: np.ndarray, dt: float) -> np.ndarray:
    """Speed that follows w·min(1, v/VP) as far as 1000 and 2000 mm/s² let it, in steps that are as good as none."""
    t = np.arange(len(velocity)) * dt
    wanted = np.minimum(np.minimum(1000.0 * t, PEAK), 2000.0 * (SECONDS - t)) * np.clip(velocity / VP, 0.0, 1.0)
    speed = np.zeros(len(wanted))
    for k in range(1, len(wanted)):
        speed[k] = min(max(wanted[k], speed[k - 1] - 2000.0 * dt), speed[k - 1] + 1000.0 * dt)
    return speed


def test_a_varying_velocity_above_and_below_vp() -> None:
    """The speed is w·min(1, v/VP), but changes by no more than the rates; position is its integral in every cycle."""
    rows = follow(wave, wave_slope, 2100)
    dt = 1e-5
    t = np.arange(200_001) * dt
    speed = lagging_speed(1500.0 + 1400.0 * np.sin(2.0 * pi * 1.7 * t), dt)
    assert np.count_nonzero(np.isclose(np.abs(np.diff(speed)) / dt, 1000.0, rtol=1e-6)) > 20_000
    assert rows[:2000, 1] == pytest.approx(speed[::100][:2000], abs=0.5)
    distance = cumulative_simpson(speed, x=t, initial=0.0)
    assert rows[:2001, 0] == pytest.approx(distance[::100], abs=5e-3)
    assert (np.abs(np.diff(rows[:, 0]) - 0.5 * CYCLE_TIME * (rows[1:, 1] + rows[:-1, 1])) <= 5e-4).all()


def test_the_additional_acceleration_keeps_its_rates() -> None:
    rows = follow(wave, wave_slope, 2100)
    assert rows[:, 2].max() == pytest.approx(1000.0) and rows[:, 2].min() == pytest.approx(-2000.0)
    change = np.diff(rows[:, 1]) / CYCLE_TIME
    assert change.max() <= 1000.0 * (1.0 + 1e-9) and change.min() >= -2000.0 * (1.0 + 1e-9)


def test_a_slow_change_of_the_velocity_is_followed_exactly() -> None:
    """100 mm/s² on 2000 mm/s take h in by 0.05/s: way = ∫ w·min(1, v/VP) dt, by a fine Simpson rule."""
    rows = follow(lambda t: 1700.0 - 100.0 * t, lambda t: -100.0, 2100)
    t = np.linspace(0.0, SECONDS, 2_000_001)
    w = np.minimum(np.minimum(1000.0 * t, PEAK), 2000.0 * (SECONDS - t))
    integrand = w * (1700.0 - 100.0 * t) / VP
    assert rows[-1][0] == pytest.approx(simpson(integrand, x=t), abs=1e-5)
    assert rows[:2000, 1] == pytest.approx(integrand[::1000][:2000], abs=1e-8)
    slope = np.gradient(integrand, t)[::1000]
    assert np.count_nonzero(np.abs(rows[:2000, 2] - slope[:2000]) > 1.0) <= 4  # the corners of the trapezoid


def test_it_stands_while_the_basic_motion_stands() -> None:
    """0.5 s at VP, 1 s of rest, then on: down with 2000 mm/s², up again with 1000 mm/s²; that much of D is lost."""

    def velocity(t: float) -> float:
        return 0.0 if 0.5 < t < 1.5 else VP

    compensation = Compensation(cycle_time=CYCLE_TIME)
    compensation.start(0, (0.0, VP, 0.0, 0.0), direction=1.0, process_velocity=VP, profile=TABLE)
    offsets = []
    tail = PEAK / 2000.0
    rest = round((1.0 - tail) / CYCLE_TIME)
    for k in range(3600):
        compensation.at(k, (0.0, velocity(k * CYCLE_TIME), 0.0, 0.0))
        offsets.append(compensation.offset)
        assert compensation.active == (k < 2000 + rest - 2) or abs(k - 2000 - rest) < 4
        assert compensation.moving or k == 0 or k > 1998 + rest - 4 or 500 + tail / CYCLE_TIME - 1 < k < 1503
    stood = offsets[502 + round(tail / CYCLE_TIME) : 1500]
    assert stood == [stood[0]] * len(stood) and len(stood) > 900
    lost = 0.5 * PEAK * PEAK / 2000.0 + 0.5 * PEAK * PEAK / 1000.0
    assert offsets[-1] == pytest.approx(300.0 - lost, abs=CYCLE_TIME * 2.0 * PEAK)


def test_against_the_direction_nothing_is_compensated() -> None:
    rows = follow(lambda t: -VP, lambda t: 0.0, 2100)
    assert not rows.any()


def test_the_same_cycle_may_be_asked_twice() -> None:
    once, twice = Compensation(cycle_time=CYCLE_TIME), Compensation(cycle_time=CYCLE_TIME)
    for compensation in (once, twice):
        compensation.start(5, (0.0, wave(0), 0.0, 0.0), direction=1.0, process_velocity=VP, profile=TABLE)
    for k in range(5, 2200):
        base = (k * 1.0, wave(k * CYCLE_TIME), wave_slope(k * CYCLE_TIME), 0.0)
        first = once.at(k, base)
        assert twice.at(k, base) == twice.at(k, base) == first


velocities = st.lists(st.tuples(st.floats(0.0, 3.0), st.integers(1, 400)), min_size=1, max_size=12)


@QUICK
@given(
    parts=velocities,
    difference=st.floats(1.0, 500.0),
    negative=st.booleans(),
    vk=st.floats(1.0, 800.0),
    up=st.floats(10.0, 1e4),
    down=st.floats(10.0, 1e4),
    stop=st.integers(0, 3000),
)
def test_whatever_the_basic_motion_does_rates_and_difference_are_kept(
    parts: list[tuple[float, int]], difference: float, negative: bool, vk: float, up: float, down: float, stop: int
) -> None:
    """Velocities that jump between 0 and 3·VP: the speed is an integral of its rates, D is never exceeded."""
    sign = -1.0 if negative else 1.0
    table = plan_compensation(VP, sign * difference, VP, vk, up, down)
    first, last = (down, up) if negative else (up, down)
    basic = np.concatenate([np.full(cycles, share * VP) for share, cycles in parts] + [np.zeros(200)])
    compensation = Compensation(cycle_time=CYCLE_TIME)
    compensation.start(0, (0.0, basic[0], 0.0, 0.0), direction=1.0, process_velocity=VP, profile=table)
    rows = []
    for k, v in enumerate(basic):
        p, total, a, _ = compensation.at(k, (0.0, v, 0.0, 0.0))
        rows.append((sign * p, sign * (total - v), sign * a))
        if k == stop:
            compensation.stop()
    p, u, a = np.array(rows).T
    rounding = 1e-9 * (1.0 + difference)
    assert (u >= -rounding).all() and (u <= abs(table.rows[1][2]) + 3.0 * VP * 1e-12 + rounding).all()
    assert (np.diff(u) <= first * CYCLE_TIME * (1.0 + 1e-9) + 1e-9).all()
    assert (np.diff(u) >= -last * CYCLE_TIME * (1.0 + 1e-9) - 1e-9).all()
    assert (a <= first * (1.0 + 1e-9)).all() and (a >= -last * (1.0 + 1e-9)).all()
    step = np.abs(np.diff(p) - 0.5 * CYCLE_TIME * (u[1:] + u[:-1]))
    assert (step <= (first + last) / 3.0 * CYCLE_TIME**2 + rounding).all()
    assert (np.diff(p) >= -rounding).all() and p[-1] <= sign * table.end[0] + rounding
