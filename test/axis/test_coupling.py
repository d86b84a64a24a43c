"""The linear coupling alone: offset, factor, another way of counting the master."""

from __future__ import annotations

import pytest
from slave_support import follow

from cnc_ptp.axis.coupling import LinearCoupling

MASTER = [(10.0, 1.0, 2.0, 3.0), (11.0, 1.5, 2.5, 3.5), (12.5, -1.0, 0.0, -0.0)]


def test_the_first_cycle_gives_the_offset_and_the_factor_scales_all_derivatives() -> None:
    """p = -2·pm + offset with 100 = -2·10 + offset."""
    coupling = LinearCoupling("x", -2.0)
    assert follow(coupling, 100.0, MASTER) == [
        (100.0, -2.0, -4.0, -6.0),
        (98.0, -3.0, -5.0, -7.0),
        (95.0, 2.0, 0.0, 0.0),
    ]
    assert coupling.offset == 120.0 and coupling.master == "x" and coupling.ratio == -2.0


def test_the_position_given_later_does_not_count() -> None:
    coupling = LinearCoupling("x", 0.5)
    follow(coupling, 0.0, MASTER[:1])
    assert follow(coupling, 12345.0, MASTER[1:]) == [(0.5, 0.75, 1.25, 1.75), (1.25, -0.5, 0.0, -0.0)]


def test_a_new_factor_counts_from_the_next_cycle_computed_with_continuous_position() -> None:
    coupling = LinearCoupling("x", 0.5)
    follow(coupling, 0.0, MASTER[:1])
    coupling.set_factor(7.0)
    coupling.set_factor(-3.0)
    assert coupling.ratio == 0.5, "nothing has been computed with it yet"
    states = follow(coupling, 0.0, MASTER[1:])
    assert states == [(0.5, -4.5, -7.5, -10.5), (-4.0, 3.0, 0.0, 0.0)]
    assert coupling.ratio == -3.0 and coupling.offset == 33.5


def test_a_factor_set_before_the_first_cycle_keeps_the_begin() -> None:
    coupling = LinearCoupling("x", 0.5)
    coupling.set_factor(2.0)
    assert follow(coupling, 5.0, MASTER[:2]) == [(5.0, 2.0, 4.0, 6.0), (7.0, 3.0, 5.0, 7.0)]


@pytest.mark.parametrize("factor", [1.0, -0.25])
def test_a_master_that_counts_otherwise_does_not_move_the_slave(factor: float) -> None:
    coupling = LinearCoupling("x", factor)
    follow(coupling, 1.0, MASTER[:1])
    coupling.change_source(10.0, 1010.0)
    assert follow(coupling, 0.0, [(1010.0, 0.0, 0.0, 0.0), (1011.0, 0.0, 0.0, 0.0)]) == [
        (1.0, 0.0, 0.0, 0.0),
        (1.0 + factor, 0.0, 0.0, 0.0),
    ]


def test_before_the_first_cycle_there_is_nothing_to_keep() -> None:
    coupling = LinearCoupling("x", 2.0)
    coupling.change_source(0.0, 500.0)
    assert coupling.offset is None
    assert follow(coupling, 3.0, [(500.0, 0.0, 0.0, 0.0)])[0][0] == 3.0


def test_the_limit_of_a_gantry_pair() -> None:
    assert LinearCoupling("x", 1.0).difference_limit is None
    assert LinearCoupling("x", 1.0, difference_limit=0.5).difference_limit == 0.5
