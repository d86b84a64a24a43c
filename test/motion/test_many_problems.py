"""100,000 seeded problems: start states of all kinds over eight decades, checked, compared with Ruckig, planned again.

CNC_PTP_RANDOM_PROBLEMS sets another number (some millions before a release).
"""

from __future__ import annotations

import os
import random

import pytest
from motion_checker import assert_motions
from motion_problems import Problem, random_problems
from ruckig_peer import RuckigPeer

from cnc_ptp.motion import Profile
from cnc_ptp.motion.limits import LARGEST_STATE

COUNT = int(os.environ.get("CNC_PTP_RANDOM_PROBLEMS", "100000"))
CHUNK = 5000
CHUNKS = range((COUNT + CHUNK - 1) // CHUNK)


def way_of(problem: Problem, profile: Profile) -> float:
    """The farthest that a motion gets from its start, mm."""
    return max(abs(row[1] - problem.position) for row in profile.rows)


def assert_not_slower_than_ruckig(problems: list[Problem], profiles: list[Profile]) -> None:
    peer, compared = RuckigPeer(), 0
    for problem, profile in zip(problems, profiles, strict=True):
        distance = way_of(problem, profile)
        if profile.duration == 0.0 or distance == 0.0:
            continue
        peer.scale(profile.duration, distance)
        theirs = peer.duration(problem)
        if theirs is not None:
            compared += 1
            longest = theirs * (1 + 1e-9) + peer.margin(problem, distance)
            assert profile.duration <= longest or peer.breaks_velocity(problem), (problem, theirs)
    assert compared > 0.85 * len(problems)


def planned_again(problems: list[Problem], profiles: list[Profile], seed: int) -> list[tuple[int, float, Problem]]:
    """A problem from one state of each table, between or on its rows: number, moment, problem.

    States that no planner takes (beyond 1e12) are left out.
    """
    draw, again = random.Random(seed), []
    for number, (problem, profile) in enumerate(zip(problems, profiles, strict=True)):
        t = draw.choice((draw.random() * profile.duration, draw.choice(profile.starts)))
        state = profile.state_at(t)[:3]
        if max(map(abs, state)) <= LARGEST_STATE:
            again.append((number, t, Problem(*state, *problem[3:])))
    return again


def assert_lands_at_the_same_end(problems: list[Problem], profiles: list[Profile], seed: int) -> None:
    """Exactly at the same end, within the limits, and not later; not earlier either where nothing can be gained.

    Near the target the time is the cube root of the distance, so one unit in its last place moves it by 1e-5 of the whole.
    Only a return from a stop (seven phases at reduced velocity, TX1250 2.1) can be planned faster once it moves.
    """
    again = planned_again(problems, profiles, seed)
    late = [problem.plan() for _, _, problem in again]
    assert_motions([problem for _, _, problem in again], late)
    for (number, t, problem), profile in zip(again, late, strict=True):
        duration = profiles[number].duration
        assert t + profile.duration <= duration * (1 + 1e-5), (problems[number], problem)
        if problem.direct:
            assert t + profile.duration >= duration * (1 - 1e-5), (problems[number], problem)


@pytest.mark.long
@pytest.mark.parametrize("chunk", CHUNKS)
def test_any_problem_is_solved_exactly_in_shortest_time_and_again_from_any_state(chunk):
    problems = random_problems(chunk, CHUNK)
    profiles = [problem.plan() for problem in problems]
    assert_motions(problems, profiles)
    assert_not_slower_than_ruckig(problems, profiles)
    assert_lands_at_the_same_end(problems, profiles, chunk)
