"""The PTP generator alone: what it refuses, hands over and keeps."""

from __future__ import annotations

import pytest
from error_support import attributes

from cnc_ptp.axis.ptp import PtpGenerator, reaches, standing
from cnc_ptp.axis.two_stage import Request
from cnc_ptp.errors import CncError
from cnc_ptp.motion import Limits, Profile

LIMITS = Limits(100.0, 1000.0, 1000.0, 10_000.0)


def generator(kind: int = 1, position: float = 0.0) -> PtpGenerator:
    return PtpGenerator(position=position, cycle_time=0.001, override_type=kind)


def test_it_stands_where_it_was_put() -> None:
    ptp = generator(position=12.5)
    assert ptp.state(0) == ptp.state(10**9) == (12.5, 0.0, 0.0, 0.0)
    assert ptp.finished(0) and ptp.arrived(0) and ptp.job is None


@pytest.mark.parametrize("kind", [1, 2, 3, 4])
@pytest.mark.parametrize("override", [0.5, 1.0])
@pytest.mark.parametrize("limits", [LIMITS._replace(jerk=0.0), LIMITS._replace(acceleration=1e-300)])
def test_a_start_that_cannot_be_planned_changes_nothing(kind: int, override: float, limits: Limits) -> None:
    ptp = generator(kind, 3.0)
    ptp.set_override(0, override)
    with pytest.raises(CncError) as caught:
        ptp.start(5, 10.0, limits)
    assert caught.value.number == 23001
    assert ptp.job is None and ptp.state(100) == (3.0, 0.0, 0.0, 0.0)


def test_a_target_out_of_all_range() -> None:
    ptp = generator()
    with pytest.raises(CncError) as caught:
        ptp.start(0, 1e13, LIMITS)
    assert str(caught.value) == (
        "P-ERR-23002 motion value target = 10000000000000.0 must be between -1e+12 and 1e+12; the motion is refused"
    )
    assert ptp.job is None


def test_a_table_of_cycle_c_gives_its_start_at_c() -> None:
    ptp = generator(position=7.0)
    ptp.start(1000, 50.0, LIMITS)
    assert ptp.state(1000)[:3] == (7.0, 0.0, 0.0) and ptp.state(1001)[0] > 7.0
    assert ptp.state(0)[0] == 7.0


@pytest.mark.parametrize("first_cycle", [0, 95, 100, 480, 700, 10**6])
def test_states_of_a_block_are_those_of_its_cycles(first_cycle: int) -> None:
    ptp = generator(position=-0.0)
    assert list(map(repr, ptp.setpoints(first_cycle, 10).states())) == [
        repr(ptp.state(first_cycle + n)) for n in range(10)
    ]
    ptp.start(100, 20.0, LIMITS)
    assert ptp.setpoints(first_cycle, 10).states() == [ptp.state(first_cycle + n) for n in range(10)]
    ptp.take_over(100, 5.0, 0.0, 3.0)  # at rest for one instant only
    assert ptp.setpoints(first_cycle, 10).states() == [ptp.state(first_cycle + n) for n in range(10)]


def test_take_over_goes_on_from_any_state_until_a_stop_follows() -> None:
    ptp = generator()
    ptp.take_over(10, 5.0, 40.0, 100.0)
    p, v, a, j = ptp.state(11)
    assert (p, v, a, j) == pytest.approx((5.0 + 0.04 + 0.5 * 100.0 * 1e-6, 40.1, 100.0, 0.0))
    ptp.stop(11, LIMITS)
    assert ptp.state(11)[:3] == (p, v, a)
    assert ptp.state(1000)[1:3] == (0.0, 0.0) and ptp.finished(1000) and ptp.arrived(1000)
    ptp.finish()
    assert ptp.job is None


def test_override_without_a_job_counts_for_the_next_start() -> None:
    ptp = generator(2)
    assert not ptp.set_override(0, 0.5) and ptp.override == 0.5
    ptp.start(0, 1000.0, LIMITS)
    assert ptp.state(2000)[1] == pytest.approx(50.0)
    assert ptp.set_override(2000, 0.25) and ptp.state(3000)[1] == pytest.approx(25.0)
    ptp.stop(3000, LIMITS)
    assert not ptp.set_override(3000, 1.0) and ptp.override == 1.0


def test_an_override_below_one_step_is_0() -> None:
    ptp = generator()
    ptp.set_override(0, 0.99e-6)
    assert ptp.override == 0.0
    ptp.set_override(0, 1e-6)
    assert ptp.override == 1e-6


def test_reaches_looks_for_a_stretch_at_the_velocity() -> None:
    rows = [(0.0, 0.0, 0.0, 10.0, 0.0), (1.0, 5.0, -10.0, 0.0, 0.0), (2.0, 15.0, 10.0, -1.0, 0.0)]
    assert reaches(Profile(rows), 10.0) and not reaches(Profile(rows[:1]), 10.0)
    assert not reaches(Profile(rows[2:]), 10.0) and not reaches(standing(1.0), 10.0)


def test_a_stop_in_the_brake_phase_ends_the_job_at_once_and_keeps_the_table() -> None:
    ptp = generator()
    ptp.start(0, 50.0, LIMITS)
    cycle = 600
    assert ptp.state(cycle)[2] < 0.0
    later = [ptp.state(cycle + n) for n in range(200)]
    ptp.stop(cycle, LIMITS._replace(deceleration=1.0))
    assert ptp.job is None and [ptp.state(cycle + n) for n in range(200)] == later
    assert later[-1][:2] == (50.0, 0.0) and ptp.arrived(cycle + 199)


def test_without_a_positioning_there_is_nothing_to_redirect() -> None:
    ptp = generator(position=2.0)
    assert not ptp.can_redirect
    ptp.redirect(5, Request(100.0, 50.0, 10.0))
    ptp.advance(5)
    assert ptp.job is None and ptp.state(1000) == (2.0, 0.0, 0.0, 0.0) and ptp.arrived(1000)


@pytest.mark.parametrize(("request_", "error_id"), [(Request(1e13), 23002), (Request(50.0, 1e-300), 23001)])
@pytest.mark.parametrize("stopped", [False, True])
def test_a_request_that_no_table_can_be_made_for_changes_nothing(
    request_: Request, error_id: int, stopped: bool
) -> None:
    """Neither the table, nor what waits: an activation, or a request that waits for the end of a stop."""
    ptp = generator()
    ptp.start(0, 500.0, LIMITS)
    ptp.redirect(300, Request(600.0, 50.0, 200.0))
    if stopped:
        ptp.stop(400, LIMITS)
        ptp.redirect(400, Request(-100.0))
    before = attributes(ptp)
    with pytest.raises(CncError) as caught:
        ptp.redirect(410, request_)
    assert caught.value.number == error_id and attributes(ptp) == before


@pytest.mark.parametrize("duration_cycles", range(40, 60))
def test_a_waiting_request_begins_at_exact_rest(duration_cycles: int) -> None:
    """Stop ramps of whole numbers of cycles, where rounding says which cycle is the first after them."""
    ptp = generator()
    seconds = 0.001 * duration_cycles
    limits = LIMITS._replace(velocity=2500.0 * seconds * seconds)  # the ramp takes 2·√(v/J)
    ptp.start(0, 500.0, limits)
    ptp.stop(1000, limits)
    ptp.redirect(1000, Request(0.0))
    for cycle in range(1000, 1100):
        ptp.advance(cycle)
        if ptp.job is not None:
            break
    assert ptp.job is not None and ptp.state(cycle)[1:3] == (0.0, 0.0)
    assert cycle - 1000 in (duration_cycles, duration_cycles + 1)
