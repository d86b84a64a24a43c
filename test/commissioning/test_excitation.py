"""Motions for identification: their length against the motion planner, and that they stay where they may be."""

import itertools
import math
import random

import pytest

from cnc_ptp.commissioning.coverage import missing_speeds, scenario_lines
from cnc_ptp.commissioning.excitation import (
    PAUSE,
    Motion,
    Room,
    check_speeds,
    forth_and_back,
    highest_velocity,
    motion_distance,
    motion_time,
    ramp_time,
    speed_ladder,
)
from cnc_ptp.commissioning.timing import always
from cnc_ptp.errors import CncError
from cnc_ptp.motion import Limits, plan_rest_to_rest

MILL = Room("x", "mm", 0.0, -300.0, 300.0, 500.0, 2000.0, 2400.0, 50000.0, 1e-4)


def random_room(draw):
    low = -draw.choice([0.0, 5.0, 300.0, 1e5])
    high = low + draw.choice([20.0, 600.0, 1e5, math.inf])
    position = draw.uniform(low, min(high, 1e5))
    limits = [10.0 ** draw.uniform(1.0, 4.0) for _ in range(3)]
    return Room(
        "x", "mm", position, low if high < math.inf else -math.inf, high, *limits, 10.0 ** draw.uniform(2.0, 6.0)
    )


@pytest.mark.parametrize("seed", range(30))
def test_way_and_time_are_those_of_the_planner(seed):
    """The planner covers the distance in that time, with the steady seconds at full velocity."""
    draw = random.Random(seed)
    room = random_room(draw)
    velocity, steady = room.max_velocity * draw.uniform(0.01, 1.0), draw.uniform(0.01, 2.0)
    limits = Limits(velocity, room.acceleration, room.deceleration, room.jerk)
    profile = plan_rest_to_rest(0.0, motion_distance(room, velocity, steady), limits)
    assert profile.duration == pytest.approx(motion_time(room, velocity, steady), rel=1e-6)
    at_velocity = [
        later[0] - row[0] for row, later in itertools.pairwise(profile.rows) if row[3] == row[4] == 0.0 and row[2] > 0.0
    ]
    # With different accelerations the planner needs room for the smaller one on both sides.
    ramps = [ramp_time(velocity, a, room.jerk) for a in (room.acceleration, room.deceleration)]
    assert sum(at_velocity) == pytest.approx(max(steady, abs(ramps[0] - ramps[1]) / 2), rel=1e-6)


@pytest.mark.parametrize("seed", range(60))
def test_motions_stay_within_soft_limits_and_follow_each_other(seed):
    draw = random.Random(seed)
    room = random_room(draw)
    steady, rest = draw.uniform(0.05, 1.0), draw.uniform(0.05, 0.5)
    try:
        speeds = speed_ladder(room, always(steady))
    except CncError as refusal:
        assert refusal.number == 27010 and room.travel < 1000.0
        return
    place, free = room.position, rest
    motions = forth_and_back(room, speeds, steady=always(steady), rest=rest)
    for motion in motions:
        assert motion.at >= free - 1e-9
        limits = Limits(motion.velocity, room.acceleration, room.deceleration, room.jerk)
        assert plan_rest_to_rest(0.0, motion.distance, limits).duration <= motion.duration * (1 + 1e-6)
        place += motion.distance
        assert room.low <= place <= room.high
        free = motion.at + motion.duration + PAUSE
    driven = [motion.velocity * math.copysign(1.0, motion.distance) for motion in motions[-2 * len(speeds) :]]
    assert sorted(driven) == pytest.approx(sorted([*speeds, *(-speed for speed in speeds)]))


def test_speeds_of_the_mill():
    speeds = speed_ladder(MILL, always(0.7))
    assert len(speeds) == 30
    assert speeds[0] == 0.1 and speeds[-1] == pytest.approx(500.0)
    assert all(1.2 < later / speed < 1.45 for speed, later in itertools.pairwise(speeds))


def test_the_highest_velocity_is_what_the_travel_allows():
    short = Room("z", "mm", 0.0, -10.0, 10.0, 500.0, 2000.0, 2400.0, 50000.0)
    velocity = highest_velocity(short, always(0.5))
    assert motion_distance(short, velocity, 0.5) == pytest.approx(0.98 * 20.0)
    assert highest_velocity(MILL, always(0.5)) == 500.0


def test_ramp_time_without_and_with_full_acceleration():
    assert ramp_time(100.0, 1000.0, 10_000.0) == pytest.approx(0.2)  # a = v reached for an instant: 2 a / j
    assert ramp_time(25.0, 1000.0, 10_000.0) == pytest.approx(0.1)
    assert ramp_time(400.0, 1000.0, 10_000.0) == pytest.approx(0.5)


@pytest.mark.parametrize(
    ("room", "text"),
    [
        (
            Room("z", "mm", 0.0, -0.01, 0.01, 500.0, 2000.0, 2400.0, 50000.0),
            "P-ERR-27010 axis z: the soft limits leave 0.02 mm (P-AXIS-00177, P-AXIS-00178), too little to drive 0.7 s with "
            "constant velocity; nothing was started",
        ),
        (
            Room("z", "mm", 0.0, 5.0, 5.0, 500.0, 2000.0, 2400.0, 50000.0),
            "P-ERR-27010 axis z: the soft limits leave 0 mm (P-AXIS-00177, P-AXIS-00178), too little to drive 0.7 s with "
            "constant velocity; nothing was started",
        ),
    ],
)
def test_no_room(room, text):
    with pytest.raises(CncError) as refusal:
        speed_ladder(room, always(0.7))
    assert str(refusal.value) == text


@pytest.mark.parametrize(
    ("speeds", "text"),
    [
        (
            [1.0, 600.0],
            "P-ERR-27011 axis x: the velocity 600 mm/s is not above 0 and up to 500 mm/s (P-AXIS-00212); nothing was started",
        ),
        (
            [0.0],
            "P-ERR-27011 axis x: the velocity 0 mm/s is not above 0 and up to 500 mm/s (P-AXIS-00212); nothing was started",
        ),
        (
            [math.nan],
            "P-ERR-27011 axis x: the velocity nan mm/s is not above 0 and up to 500 mm/s (P-AXIS-00212); nothing was started",
        ),
        (
            [400.0],
            "P-ERR-27011 axis x: 400 mm/s need 890.9 mm of travel, the soft limits leave 588 mm (P-AXIS-00177, P-AXIS-00178); "
            "nothing was started",
        ),
    ],
)
def test_speeds_that_cannot_be_driven(speeds, text):
    with pytest.raises(CncError) as refusal:
        check_speeds(MILL, speeds, always(2.0))
    assert str(refusal.value) == text


def test_speeds_are_sorted_and_single():
    assert check_speeds(MILL, [5.0, 1.0, 5.0], always(0.5)) == [1.0, 5.0]


def test_missing_speeds_and_the_scenario_that_drives_them():
    assert missing_speeds([1.0, 2.0, 4.0, 8.0, 16.0], [2.1, 13.0]) == [1.0, 4.0, 8.0]
    assert missing_speeds([1.0, 2.0], []) == [1.0, 2.0]
    lines = scenario_lines(MILL, [Motion(0.2, 12.5, 10.0, 1.5), Motion(1.9, -12.5, 10.0, 1.5)])
    assert lines == [
        "- {at: 0.200, to: x, do: move_relative, distance: 12.5000, velocity: 10}",
        "- {at: 1.900, to: x, do: move_relative, distance: -12.5000, velocity: 10}",
    ]
