"""Lines, arcs and helices: positions by hand, derivatives against difference quotients, axis limits in every sample."""

from __future__ import annotations

import math
import random

import numpy as np
import pytest
from long_support import examples

from cnc_ptp.errors import CncError
from cnc_ptp.motion import Limits, plan_rest_to_rest, plan_to_position
from cnc_ptp.path import Arc, AxisLimits, Line

AXES = [AxisLimits(500.0, 3000.0, 2000.0, 30000.0)] * 3
XYZ = (0, 1, 2)
"""The axes of the feed."""


def test_line_by_hand():
    line = Line((1.0, 2.0, 3.0), (4.0, 6.0, 3.0), XYZ)
    assert line.length == 5.0
    states = line.evaluate(2.5, 10.0, -5.0, 1.0)
    assert states[0] == pytest.approx((2.5, 6.0, -3.0, 0.6), rel=1e-15)
    assert states[1] == pytest.approx((4.0, 8.0, -4.0, 0.8), rel=1e-15)
    assert states[2] == (3.0, 0.0, 0.0, 0.0)
    assert line.evaluate(0.0, 0.0, 0.0, 0.0) == ((1.0, 0, 0, 0), (2.0, 0, 0, 0), (3.0, 0, 0, 0))


def test_the_feed_belongs_to_the_path_axes_and_others_travel_along():
    line = Line((0.0, 0.0, 0.0, 0.0), (3.0, 4.0, 0.0, 90.0), XYZ)
    assert line.length == 5.0
    assert line.evaluate(2.5, 10.0, 0.0, 0.0)[3] == (45.0, 180.0, 0.0, 0.0)
    turning = Line((0.0, 0.0, 0.0, 0.0), (0.0, 1e-12, 0.0, 90.0), XYZ)
    assert turning.length == 90.0
    flat = Line((0.0, 0.0), (0.0, 7.0), path_axes=(0,))
    assert flat.length == 7.0


def test_quarter_circle_by_hand():
    arc = Arc((10.0, 0.0, 5.0), (0.0, 10.0, 5.0), (0.0, 0.0), (0, 1), 10.0, 90.0, XYZ)
    assert arc.length == pytest.approx(5.0 * math.pi, rel=1e-15)
    middle = arc.evaluate(arc.length / 2.0, 100.0, 0.0, 0.0)
    root = math.sqrt(0.5)
    assert middle[0] == pytest.approx((10 * root, -100 * root, -1000 * root, 10000 * root), rel=1e-12)
    assert middle[1] == pytest.approx((10 * root, 100 * root, -1000 * root, -10000 * root), rel=1e-12)
    assert middle[2] == (5.0, 0.0, 0.0, 0.0)


def test_helix_by_hand():
    arc = Arc((10.0, 0.0, 0.0), (10.0, 0.0, 15.0), (0.0, 0.0), (0, 1), 10.0, -360.0, XYZ)
    assert arc.length == pytest.approx(math.hypot(20.0 * math.pi, 15.0), rel=1e-15)
    quarter = arc.evaluate(arc.length / 4.0, 0.0, 0.0, 0.0)
    assert [state[0] for state in quarter] == pytest.approx([0.0, -10.0, 3.75], abs=1e-13)


def test_arc_of_axes_beyond_the_path_axes():
    arc = Arc((10.0, 0.0, 0.0, 0.0), (-10.0, 0.0, 0.0, 180.0), (0.0, 0.0), (0, 1), 10.0, 180.0, XYZ)
    assert arc.length == pytest.approx(10.0 * math.pi, rel=1e-15)
    assert arc.evaluate(arc.length / 2.0, 10.0, 0.0, 0.0)[3] == pytest.approx((90.0, 1800.0 / arc.length, 0.0, 0.0))


def test_ends_are_exact(draw_arc, draw_line):
    draw = random.Random(50)
    for _ in range(1000):
        for element in (draw_line(draw, 5), draw_arc(draw, 10 ** draw.uniform(-3, 4), 5)):
            assert tuple(state[0] for state in element.evaluate(element.length, 0.0, 0.0, 0.0)) == element.target
            begin = [state[0] for state in element.evaluate(0.0, 0.0, 0.0, 0.0)]
            assert begin == pytest.approx(element.start, rel=1e-15, abs=1e-12)
            before = element.evaluate(element.length * (1 - 1e-15), 0.0, 0.0, 0.0)
            assert [state[0] for state in before] == pytest.approx(element.target, rel=1e-12, abs=1e-9)


def test_rounded_centre_is_spread_over_the_path():
    arc = Arc((10.0, 0.0, 0.0), (0.004, 10.003, 0.0), (0.0, 0.0), (0, 1), 10.0, 90.0, XYZ)
    halfway = arc.evaluate(arc.length / 2.0, 0.0, 0.0, 0.0)
    assert halfway[0][0] == pytest.approx(10.0 * math.sqrt(0.5) + 0.002, abs=1e-12)
    assert halfway[1][0] == pytest.approx(10.0 * math.sqrt(0.5) + 0.0015, abs=1e-12)


def test_derivatives_are_those_of_the_position(draw_arc, draw_line):
    """Along a cubic s(t) the five-point difference quotients of each order must give the next order."""
    draw = random.Random(51)
    stencil, step = np.array([1.0, -8.0, 0.0, 8.0, -1.0]) / 12.0, 1e-3
    for _ in range(300):
        radius = 10 ** draw.uniform(0, 3)
        for element in (draw_arc(draw, radius, 4), draw_line(draw, 4)):
            if element.length == 0.0:
                continue
            size = min(radius, element.length)
            s, v = 0.5 * element.length, draw.uniform(0.1, 1.0) * size
            a, j = draw.uniform(-1.0, 1.0) * size, draw.uniform(-1.0, 1.0) * size
            values = []
            for n in range(-2, 3):
                t = n * step
                values.append(
                    element.evaluate(s + v * t + a * t * t / 2 + j * t**3 / 6, v + a * t + j * t * t / 2, a + j * t, j)
                )
            table = np.array(values)
            quotients = np.einsum("n,naq->aq", stencil, table)[:, :3] / step
            scale = np.abs(table[2]).max() + size
            assert np.abs(quotients - table[2][:, 1:]).max() <= 1e-6 * scale


def test_shape_is_what_evaluate_makes_a_motion_of(draw_arc, draw_line):
    """q, q1, q2, q3 are what a motion with velocity 1 has as states."""
    draw = random.Random(53)
    for _ in range(300):
        radius = 10 ** draw.uniform(-1, 3)
        for element in (draw_arc(draw, radius, 5), draw_line(draw, 5)):
            s = draw.choice([0.0, draw.random(), 1.0]) * element.length
            q, q1, q2, q3 = np.array(element.shape(s)).T
            moving = np.array(element.evaluate(s, 1.0, 0.0, 0.0))
            assert [tuple(q), tuple(q1)] == [tuple(moving[:, 0]), tuple(moving[:, 1])]
            assert np.column_stack([q2, q3]) == pytest.approx(moving[:, 2:], rel=1e-14, abs=1e-300)
            assert element.speed(s, XYZ) == pytest.approx(math.hypot(*q1[:3]), rel=1e-15)


def test_bounds_hold_and_are_reached(draw_arc, draw_line):
    draw = random.Random(54)
    for _ in range(examples(300)):
        for element in (draw_arc(draw, 10 ** draw.uniform(-1, 3), 5), draw_line(draw, 5)):
            begin, end = sorted(draw.random() ** 2 * element.length for _ in range(2))
            sampled = np.abs([element.shape(s) for s in np.linspace(begin, end, 500)])[:, :, 1:].max(axis=0)
            bounds = np.array(element.bounds(begin, end))
            assert (sampled <= bounds * (1 + 1e-13)).all()
            assert (bounds <= sampled * (1 + 1e-3) + 1e-12).all()


def test_line_limits_are_projections():
    axes = [
        AxisLimits(100.0, 1000.0, 500.0, 9000.0),
        AxisLimits(80.0, 3000.0, 2000.0, 90000.0),
        AxisLimits(1.0, 1.0, 1.0, 1.0),
    ]
    limits = Line((0.0, 0.0, 0.0), (3.0, 4.0, 0.0), XYZ).limits(math.inf, axes)
    assert limits == pytest.approx((100.0, 1000.0 / 0.6, 500.0 / 0.6, 15000.0), rel=1e-14)
    assert Line((0.0, 0.0, 0.0), (3.0, 4.0, 0.0), XYZ).limits(50.0, axes).velocity == 50.0
    assert Line((0.0, 0.0, 0.0), (3.0, 4.0, 0.0), XYZ).limits(50.0, axes, override_max=1.5).velocity == 75.0


def test_element_without_length():
    line = Line((1.0, 2.0), (1.0, 2.0), XYZ)
    assert line.length == 0.0
    assert line.evaluate(0.0, 0.0, 0.0, 0.0) == ((1.0, 0.0, 0.0, 0.0), (2.0, 0.0, 0.0, 0.0))
    assert line.limits(math.inf, AXES[:2]) == Limits(1e12, 1e12, 1e12, 1e12)


def test_arc_limits_tend_to_those_of_a_line_where_the_curvature_is_low():
    arc = Arc((1e6, 0.0), (0.0, 1e6), (0.0, 0.0), (0, 1), 1e6, 90.0, XYZ)
    assert arc.limits(50.0, AXES[:2]) == pytest.approx((50.0, 3000.0, 2000.0, 30000.0), rel=1e-2)


def test_arc_velocity_by_centripetal_acceleration_and_by_jerk():
    soft = [AxisLimits(1e4, 2000.0, 3000.0, 1e9)] * 2
    arc = Arc((10.0, 0.0), (0.0, 10.0), (0.0, 0.0), (0, 1), 10.0, 90.0, XYZ)
    assert arc.limits(1e4, soft) == pytest.approx(
        (math.sqrt(0.8 * 2000.0 * 10.0), 0.6 * 2000.0, math.sqrt(3000.0**2 - 1600.0**2), 1e9), rel=1e-3
    )
    limp = [AxisLimits(1e4, 1e6, 1e6, 1e4)] * 2
    assert arc.limits(1e4, limp).velocity == pytest.approx((0.3 * 1e4 * 100.0) ** (1 / 3), rel=1e-12)


def assert_axes_hold(element, profile, axes):
    """Every axis within its own limits in every sample: |v|, A+ while |v| grows, A- while it shrinks, |j|."""
    s, v, a, j = profile.sample(np.linspace(0.0, profile.duration, 400))
    states = np.array([element.evaluate(*each) for each in zip(s, v, a, j, strict=True)])
    for axis, limits in enumerate(axes):
        _, velocity, acceleration, jerk = states[:, axis].T
        growing = velocity * acceleration > 0.0
        assert np.abs(velocity).max() <= limits.velocity * (1 + 1e-9)
        assert np.abs(acceleration[growing]).max(initial=0.0) <= limits.acceleration * (1 + 1e-9)
        assert np.abs(acceleration[~growing]).max(initial=0.0) <= limits.deceleration * (1 + 1e-9)
        assert np.abs(jerk).max() <= limits.jerk * (1 + 1e-9)


@pytest.mark.parametrize("kind", ["line", "arc"])
def test_no_axis_exceeds_its_limits_also_after_a_change_of_override(kind, draw_axes, draw_arc, draw_line):
    draw = random.Random(52)
    for _ in range(examples(250)):
        axes = draw_axes(draw)
        element = draw_line(draw) if kind == "line" else draw_arc(draw, 10 ** draw.uniform(-3, 4))
        if element.length == 0.0:
            continue
        feed = draw.choice([10 ** draw.uniform(0, 3), math.inf])
        limits = element.limits(feed, axes, override_max=1.5)
        profile = plan_rest_to_rest(0.0, element.length, limits)
        assert_axes_hold(element, profile, axes)
        s, v, a, _ = profile.state_at(draw.random() * profile.duration)
        changed = limits._replace(velocity=limits.velocity * draw.choice([0.2, 0.7]))
        again = plan_to_position(s, v, a, element.length, changed)
        assert_axes_hold(element, again, axes)
        s, v, a, _ = again.state_at(draw.random() * again.duration)
        assert_axes_hold(element, plan_to_position(s, v, a, element.length, limits), axes)


@pytest.mark.parametrize(
    ("build", "message"),
    [
        (lambda: Line((0.0,), (1.0, 2.0), XYZ), "P-ERR-22100 path from 1 to 2 axes; the motion is refused"),
        (
            lambda: Line((0.0, math.nan), (1.0, 2.0), XYZ),
            "P-ERR-22100 path start of axis 1 = nan must be a finite number; the motion is refused",
        ),
        (
            lambda: Arc((0.0, 1.0), (math.inf, 2.0), (0.0, 0.0), (0, 1), 1.0, 90.0, XYZ),
            "P-ERR-22100 path target of axis 0 = inf must be a finite number; the motion is refused",
        ),
        (
            lambda: Arc((10.0, 0.0), (0.0, 10.1), (0.0, 0.0), (0, 1), 10.0, 90.0, XYZ),
            "P-ERR-22101 arc around (0.0, 0.0) with radius 10 mm (programmed 10 mm) ends 0.1 mm away from its target; "
            "the limit is 0.011 mm; the motion is refused",
        ),
        (
            lambda: Arc((0.0, 0.0), (1.0, 1.0), (0.0, 0.0), (0, 1), 1.0, 90.0, XYZ),
            "P-ERR-22102 arc with radius 0.0 mm and sweep 90.0 deg: both must be finite and not 0; "
            "the motion is refused",
        ),
        (
            lambda: Arc((1.0, 0.0), (1.0, 0.0), (0.0, 0.0), (0, 1), 1.0, math.nan, XYZ),
            "P-ERR-22102 arc with radius 1.0 mm and sweep nan deg: both must be finite and not 0; "
            "the motion is refused",
        ),
        (
            lambda: Line((0.0, 0.0, 0.0), (1.0, 2.0, 3.0), XYZ).limits(0.0, AXES),
            "P-ERR-22103 path feed 0.0 mm/s must be greater than 0; the motion is refused",
        ),
        (
            lambda: Arc((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0), (0, 1), 1.0, 90.0, XYZ).limits(math.nan, AXES),
            "P-ERR-22103 path feed nan mm/s must be greater than 0; the motion is refused",
        ),
    ],
)
def test_refusals(build, message):
    with pytest.raises(CncError) as fault:
        build()
    assert str(fault.value) == message
