"""The runtime table itself: evaluation before, at, between and after its rows, one by one and many at once."""

from __future__ import annotations

import random

import numpy as np

from cnc_ptp.motion import Limits, Profile, plan_rest_to_rest, plan_to_position, plan_to_velocity

LIMITS = Limits(2000.0, 5000.0, 5000.0, 50000.0)


def test_state_inside_a_segment_is_its_polynomial():
    profile = Profile([(0.0, 1.0, 2.0, 3.0, 6.0), (2.0, 19.0, 20.0, 0.0, 0.0)])
    assert profile.state_at(1.0) == (1.0 + 2.0 + 1.5 + 1.0, 2.0 + 3.0 + 3.0, 9.0, 6.0)


def test_before_the_start_and_after_the_end():
    profile = plan_to_velocity(10.0, 0.0, 0.0, 100.0, LIMITS)
    assert profile.state_at(-1.0) == profile.state_at(0.0) == (10.0, 0.0, 0.0, 50000.0)
    p, v, a = profile.end
    assert profile.state_at(profile.duration) == (p, v, a, 0.0)
    assert profile.state_at(profile.duration + 2.0) == (p + 2.0 * 100.0, 100.0, 0.0, 0.0)


def test_samples_equal_single_states_to_the_bit():
    draw = random.Random(22)
    for _ in range(50):
        profile = plan_to_position(
            draw.uniform(-10, 10), draw.uniform(-500, 500), draw.uniform(-900, 900), draw.uniform(-900, 900), LIMITS
        )
        times = np.array([draw.uniform(-0.1, 1.2) * profile.duration for _ in range(200)] + list(profile.starts))
        together = profile.sample(times)
        assert together.shape == (4, len(times))
        one_by_one = np.array([profile.state_at(float(t)) for t in times]).T
        assert together.tobytes() == one_by_one.tobytes()
        assert profile.sample(times).tobytes() == together.tobytes()


def test_the_same_plan_gives_the_same_bits():
    first, second = (plan_to_position(1.0, 20.0, -30.0, 77.0, LIMITS) for _ in range(2))
    assert first == second
    assert hash(first) == hash(second)
    assert first.rows == second.rows
    assert first != plan_rest_to_rest(1.0, 77.0, LIMITS)
    assert first != "profile"


def test_repr_names_segments_duration_and_end():
    profile = Profile([(0.0, 1.0, 0.0, 0.0, 0.0), (2.0, 1.0, 0.0, 0.0, 0.0)])
    assert repr(profile) == "Profile(1 segments, 2.0 s, end (1.0, 0.0, 0.0))"
