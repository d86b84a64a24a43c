"""Questions that the PTP functions ask of a runtime table, on tables made by hand and by sampling."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from long_support import examples

from cnc_ptp.axis.tables import last_leg, peak_velocity, reaches, standing
from cnc_ptp.motion import Limits, Profile, plan_rest_to_rest, plan_to_position

MANY = settings(max_examples=examples(200), deadline=None, derandomize=True)


def test_a_standing_table() -> None:
    assert standing(3.5).state_at(100.0) == (3.5, 0.0, 0.0, 0.0)
    assert peak_velocity(standing(3.5).rows) == 0.0 and not reaches(standing(3.5), 1.0)


def test_reaches_a_stretch_or_an_instant_without_acceleration() -> None:
    stretch = [(0.0, 0.0, 0.0, 10.0, 0.0), (1.0, 5.0, -10.0, 0.0, 0.0), (2.0, 15.0, 10.0, -1.0, 0.0)]
    assert reaches(Profile(stretch), 10.0)
    assert not reaches(Profile(stretch[:1]), 10.0) and not reaches(Profile(stretch[2:]), 10.0)
    instant = [(0.0, 0.0, 0.0, 2.0, -2.0), (2.0, 0.0, 0.0, -2.0, 0.0)]  # v = 2t - t²: 1 at 1 s
    assert reaches(Profile(instant), 1.0) and not reaches(Profile(instant), 1.0 + 1e-6)
    assert not reaches(Profile(instant), 0.5)


def test_a_reduced_velocity_that_is_only_touched_is_reached_from_anywhere_on_the_way_up() -> None:
    """800 mm: up and down without a stretch; planned again from any state before the top it is the same motion."""
    limits = Limits(2000.0, 5000.0, 5000.0, 50_000.0)
    table = plan_rest_to_rest(0.0, 800.0, limits)
    top = peak_velocity(table.rows)
    for k in range(1, 400, 7):
        state = table.state_at(0.001 * k)[:3]
        assert reaches(plan_to_position(*state, 800.0, limits._replace(velocity=top)), top), k


@MANY
@given(
    velocity=st.floats(-300.0, 300.0),
    acceleration=st.floats(-900.0, 900.0),
    target=st.floats(-500.0, 500.0),
    limits=st.builds(Limits, st.floats(1.0, 500.0), st.floats(50.0, 900.0), st.floats(50.0, 900.0), st.just(5000.0)),
)
def test_peak_velocity_is_the_largest_sample(
    velocity: float, acceleration: float, target: float, limits: Limits
) -> None:
    table = plan_to_position(0.0, velocity, acceleration, target, limits)
    samples = np.abs(table.sample(np.linspace(0.0, table.duration, 20_001))[1]).max()
    step = table.duration / 20_000
    assert samples <= peak_velocity(table.rows) * (1 + 1e-12) + 1e-30
    assert peak_velocity(table.rows) <= samples + 1000.0 * step  # |a| may be up to 1000 between two samples


@pytest.mark.parametrize(("target", "returns"), [(500.0, False), (5.0, True), (-50.0, True)])
def test_last_leg_is_the_way_back(target: float, returns: bool) -> None:
    """From 100 mm/s with A 500, J 5000 a stop takes 100·(0.2 + 0.1)/2 = 15 mm."""
    table = plan_to_position(0.0, 100.0, 0.0, target, Limits(100.0, 500.0, 500.0, 5000.0))
    leg = last_leg(table)
    assert (leg[0][2] == 0.0) is returns
    assert leg[0][1] == pytest.approx(15.0 if returns else 0.0) and leg[-1] == table.rows[-1]
    if returns:
        assert all(row[2] <= 0.0 for row in leg)
