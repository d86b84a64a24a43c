"""The table in drive units: digits, scaling factor, thinning; and what cannot be one."""

import numpy as np
import pytest
from commissioning_support import stribeck

from cnc_ptp.commissioning.friction import FrictionCurve, FrictionPoint
from cnc_ptp.commissioning.friction_table import Scaling, friction_table
from cnc_ptp.errors import CncError


def curve(points, scatter=0.0):
    return FrictionCurve("x", tuple(FrictionPoint(v, f, -f, scatter, 1.0) for v, f in points))


def values(table, digits):
    """The meaning of the table by the manual: velocity in mm/s, torque in N."""
    speeds = [entry.velocity / 1000 for entry in table.entries]
    return speeds, [entry.current * table.scaling_factor / 1000 / digits for entry in table.entries]


def test_digits_are_those_of_the_manual_example():
    """Feedforward 4.2: 500 digits are 0.45 Nm. A tenth of it is 50 digits, at 20 deg/s = 20000 (0.001 deg/s)."""
    table = friction_table(curve([(20.0, 0.045), (30.0, 0.45)]), Scaling(500, 1, 0.45), max_points=20)
    assert [(entry.velocity, entry.current * table.scaling_factor / 1000) for entry in table.entries] == [
        (20000, pytest.approx(50.0)),
        (30000, pytest.approx(500.0)),
    ]


@pytest.mark.parametrize(
    ("friction", "factor"),
    [(1000.0, 1000), (200.0, 1000), (199.0, 100), (20.0, 100), (19.0, 10), (2.0, 10), (0.3, 1), (0.01, 1)],
)
def test_scaling_factor_keeps_rounding_small(friction, factor):
    """Half a digit is at most 0.25 % where a finer scale is left: 200 digits are the fewest."""
    table = friction_table(curve([(1.0, friction)]), Scaling(1, 1, 1), max_points=20)
    assert table.scaling_factor == factor
    assert table.entries[0].current == round(friction * 1000 / factor)


def test_scaling_factor_leaves_room_for_the_largest_value():
    table = friction_table(curve([(1.0, 0.5), (2.0, 3e8)]), Scaling(1, 1, 1), max_points=20)
    assert table.scaling_factor == 1000
    assert table.entries[1].current == 300_000_000
    table = friction_table(curve([(1.0, 0.5), (2.0, 2e8)]), Scaling(1, 1, 1), max_points=20)
    assert table.scaling_factor == 100


@pytest.mark.parametrize("most", [1, 2, 5, 12, 20])
def test_a_thinned_table_has_the_ends_and_misses_little(most):
    speeds = np.geomspace(0.1, 500.0, 60)
    table = friction_table(curve(zip(speeds, stribeck(speeds), strict=True)), Scaling(1000, 1, 100.0), max_points=most)
    assert len(table.entries) == most and table.dropped == 60 - most
    ins = [entry.velocity for entry in table.entries]
    assert ins == sorted(set(ins)) and ins[0] == 100
    if most > 1:
        assert ins[-1] == 500_000
    if most >= 12:
        misses = np.abs(np.interp(speeds, *values(table, 10.0)) / stribeck(speeds) - 1.0)
        assert misses.max() < 0.02


def test_speeds_without_friction_are_left_out_and_named():
    points = [(1.0, -0.2), (2.0, 0.0), (3.0, 5.0), (4.0, 6.0)]
    table = friction_table(curve(points), Scaling(1000, 1, 1), max_points=20)
    assert [entry.velocity for entry in table.entries] == [3000, 4000]
    assert (table.without_friction, table.dropped) == ((1.0, 2.0), 0)


@pytest.mark.parametrize(("friction", "current"), [(0.0006, 1), (0.0014, 1), (0.0016, 2)])
def test_the_least_friction_of_a_table_is_half_a_digit_of_it(friction, current):
    table = friction_table(curve([(1.0, friction)]), Scaling(1, 1, 1), max_points=20)
    assert (table.scaling_factor, table.entries[0].current) == (1, current)


def test_speeds_that_are_one_whole_number_are_one_entry():
    table = friction_table(
        curve([(0.0003, 5.0), (0.0101, 5.0), (0.0102, 6.0), (0.02, 7.0)]), Scaling(1000, 1, 1), max_points=20
    )
    assert [entry.velocity for entry in table.entries] == [10, 20]


@pytest.mark.parametrize(
    ("points", "scatter", "scaling", "text"),
    [
        (
            [(1.0, 0.0), (2.0, 1e-15)],
            1e-12,
            Scaling(1, 1, 1),
            "P-ERR-27008 axis x: no friction was found: the largest torque at constant velocity is 1e-15, within its "
            "scatter; no table was made",
        ),
        (
            [(1.0, 0.4e-6), (2.0, -0.3e-6)],
            1e-9,
            Scaling(1000, 1, 1),
            "P-ERR-27008 axis x: no friction was found: the largest torque at constant velocity is 4e-07, below half a digit "
            "of the finest table (5e-07 with P-COMP-00045 = 1); no table was made",
        ),
        (
            [(1.0, -5.0), (2.0, -6.0)],
            0.1,
            Scaling(1, 1, 1),
            "P-ERR-27008 axis x: no friction was found: the torque at constant velocity acts in the direction of the motion "
            "(largest -5); no table was made, check the sign of the torque",
        ),
        (
            [(1.0, 5.0)],
            0.0,
            Scaling(1, 0, 1),
            "P-ERR-27009 axis x: P-AXIS-00326 is 0, so torque has no drive unit (P-ERR-110465); no table was made, set it",
        ),
        (
            [(1.0, 5.0)],
            0.0,
            Scaling(1, 1, 0.0),
            "P-ERR-27009 axis x: P-AXIS-00392 is 0, so torque has no drive unit (P-ERR-110465); no table was made, set it",
        ),
        (
            [(1.0, 5.0)],
            0.0,
            Scaling(1e10, 1, 1),
            "P-ERR-27009 axis x: a table value of 5e+10 is beyond 2147483646 (P-COMP-00047); no table was made, check "
            "P-AXIS-00325, P-AXIS-00326 and P-AXIS-00392",
        ),
    ],
)
def test_what_cannot_be_a_table(points, scatter, scaling, text):
    with pytest.raises(CncError) as refusal:
        friction_table(curve(points, scatter), scaling, max_points=20)
    assert str(refusal.value) == text
