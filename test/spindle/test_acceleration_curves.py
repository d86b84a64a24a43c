"""Acceleration curves against the manual's points, closed forms and SciPy in every cycle."""

from __future__ import annotations

import math
import random

import numpy as np
import pytest
from curve_support import ASYNCHRONOUS, CURVES, HYPERBOLA, POLYNOMIAL, TOP, acceleration, integrated

from cnc_ptp.parameters import CurveParameters
from cnc_ptp.spindle.acceleration_curves import AccelerationCurve
from cnc_ptp.spindle.speed_ramp import plan_speed

CYCLE = 0.001


@pytest.mark.parametrize(
    ("curve", "points"),
    [
        (POLYNOMIAL, [(12_000.0, 16_000.0), (24_000.0, 8000.0), (36_000.0, 4000.0), (48_000.0, 2000.0)]),
        (HYPERBOLA, [(12_000.0, 16_000.0), (24_000.0, 8000.0), (36_000.0, 4000.0)]),
        (ASYNCHRONOUS, [(10_000.0, 16_000.0), (16_000.0, 10_000.0), (20_000.0, 8000.0), (25_000.0, 5120.0)]),
    ],
)
def test_interpolation_points_of_the_manual(curve: CurveParameters, points: list[tuple[float, float]]) -> None:
    """Pages 44, 46 and 48, as far as the printed coefficients have digits."""
    ramp = AccelerationCurve(curve, top_speed=TOP)
    for speed, expected in points:
        assert ramp.acceleration(speed) == pytest.approx(expected, rel=2e-6)
        assert ramp.acceleration(-speed) == ramp.acceleration(speed)


@pytest.mark.parametrize("name", CURVES)
@pytest.mark.parametrize("most", [math.inf, 9000.0, 3000.0])
def test_law_floor_and_cap_at_every_speed(name: str, most: float) -> None:
    ramp = AccelerationCurve(CURVES[name], top_speed=TOP, most=most)
    for speed in np.linspace(0.0, TOP - 1.0, 3001):
        assert ramp.acceleration(speed) == pytest.approx(acceleration(CURVES[name], speed, most), rel=1e-12)


def test_the_floor_of_the_hyperbola_begins_where_the_law_crosses_it() -> None:
    """The example's floor 1400 °/s² lies below the curve at 48000 °/s; a floor of 5000 cuts it."""
    ramp = AccelerationCurve(HYPERBOLA._replace(minimum=5000.0), top_speed=TOP)
    assert ramp.acceleration(31_000.0) > 5000.0 == ramp.acceleration(40_000.0)


RAMPS = [(0.0, TOP), (TOP, 0.0), (0.0, 9000.0), (13_000.0, 47_999.0), (44_000.0, 21_000.0), (-30_000.0, 45_000.0)]


@pytest.mark.parametrize("name", CURVES)
@pytest.mark.parametrize(("begin", "end"), RAMPS)
def test_every_cycle_against_scipy(name: str, begin: float, end: float) -> None:
    """1e-9 relative, and the same of the ramp's end; near 0 (of a stop, a reversal) relative to 10 °/s."""
    table = plan_speed(5.0, begin, end, AccelerationCurve(CURVES[name], top_speed=TOP))
    times = np.arange(0.0, table.duration + 0.05, CYCLE)
    speeds, ways, duration = integrated(CURVES[name], begin, end, times)
    assert table.duration == pytest.approx(duration, rel=1e-9)
    states = np.array([table.state_at(t) for t in times])
    assert np.all(np.abs(states[:, 1] - speeds) <= 1e-9 * np.maximum(np.abs(speeds), 10.0))
    assert np.all(np.abs(states[:, 0] - 5.0 - ways) <= 1e-9 * np.maximum(np.abs(ways), 1000.0))
    assert table.state_at(duration + 1.0)[1:] == (end, 0.0)


@pytest.mark.parametrize("name", CURVES)
def test_the_acceleration_column_is_the_curve_at_the_speed_of_the_cycle(name: str) -> None:
    table = plan_speed(0.0, 0.0, TOP, AccelerationCurve(CURVES[name], top_speed=TOP))
    for t in np.arange(0.0, table.duration - CYCLE, 0.01):
        _, speed, rate = table.state_at(t)
        assert rate == pytest.approx(acceleration(CURVES[name], speed), rel=1e-9)


def test_closed_form_of_the_asynchronous_drive() -> None:
    """Constant to n1, then n² and n³ grow linearly: times N1/a, (N2²-N1²)/(2·a·N1), (n³-N2³)/(3·a·N1·N2), then a_min."""
    a, n1, n2, least = ASYNCHRONOUS.maximum, ASYNCHRONOUS.n1, ASYNCHRONOUS.n2, ASYNCHRONOUS.minimum
    floor_from = math.sqrt(a * n1 * n2 / least)
    times = [
        n1 / a,
        (n2**2 - n1**2) / (2.0 * a * n1),
        (floor_from**3 - n2**3) / (3.0 * a * n1 * n2),
        (TOP - floor_from) / least,
    ]
    ways = [
        n1**2 / (2.0 * a),
        (n2**3 - n1**3) / (3.0 * a * n1),
        (floor_from**4 - n2**4) / (4.0 * a * n1 * n2),
        (TOP**2 - floor_from**2) / (2.0 * least),
    ]
    table = plan_speed(0.0, 0.0, TOP, AccelerationCurve(ASYNCHRONOUS, top_speed=TOP))
    assert table.duration == pytest.approx(sum(times), rel=1e-13)
    assert table.end[0] == pytest.approx(sum(ways), rel=1e-13)
    t = times[0] + 0.3 * times[1]
    assert table.state_at(t)[1] == pytest.approx(math.sqrt(n1**2 + 2.0 * a * n1 * (t - times[0])), rel=1e-13)


def test_closed_form_of_the_hyperbolas_time() -> None:
    """∫ dn / a(n) is a polynomial: (n + b2·n³/(3·g²) + b2·b3·n⁵/(5·g⁴)) / b1."""

    def clock(n: float) -> float:
        g, b2, b3 = HYPERBOLA.limit_speed, HYPERBOLA.b2, HYPERBOLA.b3
        return (n + b2 * n**3 / (3.0 * g**2) + b2 * b3 * n**5 / (5.0 * g**4)) / HYPERBOLA.b1

    table = plan_speed(0.0, 13_000.0, 40_000.0, AccelerationCurve(HYPERBOLA, top_speed=TOP))
    for t in np.linspace(0.0, table.duration, 200):
        assert clock(table.state_at(t)[1]) - clock(13_000.0) == pytest.approx(t, abs=1e-12)


def test_seeded_ramps_mirror_each_other_and_join_without_a_step() -> None:
    draw = random.Random(5)
    for _ in range(60):
        curve = AccelerationCurve(
            draw.choice(list(CURVES.values())), top_speed=TOP, most=draw.choice([math.inf, 7000.0])
        )
        begin, end = draw.uniform(-TOP, TOP), draw.uniform(-TOP, TOP)
        there, mirrored = plan_speed(0.0, begin, end, curve), plan_speed(0.0, -begin, -end, curve)
        back = plan_speed(0.0, end, begin, curve)
        assert there.duration == pytest.approx(back.duration, rel=1e-11, abs=1e-12)
        assert there.end[0] == pytest.approx(back.end[0], rel=1e-9, abs=1e-6)
        assert there.end == tuple(-value for value in mirrored.end) and there.end[1] == end
        for segment, following in zip(there.segments, there.segments[1:], strict=False):
            before = there.state_at(math.nextafter(following.start, 0.0))
            assert before[1] == pytest.approx(following.speed[0], rel=1e-11, abs=1e-8)
            assert (
                before[0] == pytest.approx(following.position[0], rel=1e-12, abs=1e-6)
                and segment.start < following.start
            )


def test_a_polynomial_without_coefficients_is_constant() -> None:
    flat = CurveParameters("polynomial", 0.0, 1000.0, 500.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    table = plan_speed(0.0, 0.0, 3000.0, AccelerationCurve(flat, top_speed=4000.0))
    assert table.duration == pytest.approx(6.0, rel=1e-14) and table.state_at(4.0)[1] == pytest.approx(
        2000.0, rel=1e-14
    )


def test_above_the_top_speed_the_acceleration_stays() -> None:
    curve = AccelerationCurve(ASYNCHRONOUS._replace(minimum=0.0), top_speed=30_000.0)
    assert curve.acceleration(40_000.0) == curve.acceleration(30_000.0) == pytest.approx(3555.5555555)
