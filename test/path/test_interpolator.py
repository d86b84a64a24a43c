"""Path interpolator: exact program times, overrides, feed hold and stop in the midst of motion, refusals."""

from __future__ import annotations

import math
import random

import numpy as np
import pytest
from long_support import long

from cnc_ptp.errors import CncError
from cnc_ptp.motion import Limits, plan_rest_to_rest
from cnc_ptp.path import Line, PathInterpolator
from cnc_ptp.path.planner import STEPS

T = 0.001
LIMITS = Limits(100.0, 2000.0, 3000.0, 50000.0)


def line_of(length: float) -> Line:
    return Line((0.0,), (length,), (0,))


def run_alone(interpolator: PathInterpolator, at_block=lambda block: None, blocks: int = 5000) -> list[tuple]:
    """Rows of one element in blocks of 10 cycles until it ends; `at_block` may command before each block."""
    rows = []
    for block in range(blocks):
        at_block(block)
        rows += interpolator.step(10, T)
        if interpolator.done or interpolator.stopped:
            break
    return rows


def assert_smooth(rows, limits: Limits, start=(0.0, 0.0, 0.0)):
    """No step in v or a, and v and a are what s and v say: from cycle to cycle by integration with |j| <= J."""
    s, v, a = start
    for row in rows:
        assert -1e-9 <= row[1] <= limits.velocity * (1 + 1e-9)
        assert -limits.deceleration * (1 + 1e-9) <= row[2] <= limits.acceleration * (1 + 1e-9)
        assert abs(row[2] - a) <= limits.jerk * T * (1 + 1e-6)
        assert abs(row[1] - v - T * (row[2] + a) / 2) <= limits.jerk * T * T / 4 * (1 + 1e-6)
        assert abs(row[0] - s - T * (row[1] + v) / 2) <= limits.jerk * T**3 / 6 + max(abs(a), abs(row[2])) * T * T / 6
        s, v, a = row[:3]


def test_one_element_cycle_by_cycle():
    interpolator = PathInterpolator()
    interpolator.start(line_of(10.0), LIMITS)
    profile = plan_rest_to_rest(0.0, 10.0, LIMITS)
    rows = run_alone(interpolator)
    assert rows == [(*profile.state_at(cycle * T), False) for cycle in range(1, len(rows) + 1)]
    assert len(rows) == math.floor(profile.duration / T)
    assert interpolator.remaining_time == pytest.approx((len(rows) + 1) * T - profile.duration, abs=1e-15)
    assert interpolator.step(3, T) == [(10.0, 0.0, 0.0, 0.0, True)] * 3
    assert interpolator.remaining_time == 0.0
    assert interpolator.state == (10.0, 0.0, 0.0, 0.0)
    assert interpolator.distance_to_go == 0.0


def test_the_size_of_the_blocks_changes_no_bit():
    results = []
    for size in (1, 7, 10, 1000):
        interpolator = PathInterpolator()
        interpolator.start(line_of(10.0), LIMITS)
        rows = []
        while not interpolator.done:
            rows += interpolator.step(size, T)
        results.append((rows, interpolator.remaining_time))
    assert all(result == results[0] for result in results)


def test_program_time_is_the_sum_of_the_closed_forms():
    draw = random.Random(60)
    lengths = [draw.choice([0.0, draw.uniform(0.001, 3.0)]) for _ in range(400)]
    dwells = {50: 0.1234567, 200: 0.0}
    interpolator, remaining = PathInterpolator(), list(enumerate(lengths))
    cycles, total = 0, 0.0
    pending = []
    for index, length in remaining:
        pending.append((line_of(length), None))
        total += plan_rest_to_rest(0.0, length, LIMITS).duration
        if index in dwells:
            pending.append((None, dwells[index]))
            total += dwells[index]
    follow = iter(pending)
    running = True
    while running:
        filled = 0
        while filled < 10:
            filled += len(interpolator.step(10 - filled, T)) if cycles or filled or not interpolator.done else 0
            if filled < 10:
                element, dwell = next(follow, (None, None))
                if element is not None:
                    interpolator.start(element, LIMITS)
                elif dwell is not None:
                    interpolator.dwell(dwell)
                else:
                    running = False
                    break
        cycles += filled
    assert (cycles + 1) * T - interpolator.remaining_time == pytest.approx(total, rel=1e-12)


def test_the_next_element_starts_inside_the_cycle():
    interpolator = PathInterpolator()
    interpolator.start(line_of(1.0), LIMITS)
    while not interpolator.done:
        interpolator.step(10, T)
    surplus = interpolator.remaining_time
    assert 0.0 < surplus < T
    interpolator.start(line_of(2.0), LIMITS)
    profile = plan_rest_to_rest(0.0, 2.0, LIMITS)
    rows = interpolator.step(2, T)
    assert [row[:4] for row in rows] == [
        pytest.approx(profile.state_at(surplus + n * T), rel=1e-9, abs=1e-15) for n in range(2)
    ]


def test_a_pause_lets_the_next_element_start_at_a_cycle():
    interpolator = PathInterpolator()
    interpolator.start(line_of(1.0), LIMITS)
    while not interpolator.done:
        interpolator.step(10, T)
    interpolator.step(1, T)
    interpolator.start(line_of(2.0), LIMITS)
    assert interpolator.step(1, T)[0][:4] == plan_rest_to_rest(0.0, 2.0, LIMITS).state_at(T)


def test_an_element_without_length_takes_no_cycle():
    interpolator = PathInterpolator()
    interpolator.start(line_of(0.0), LIMITS)
    assert interpolator.step(10, T) == []
    assert interpolator.done
    interpolator.start(line_of(1.0), LIMITS)
    assert interpolator.step(1, T)[0][:4] == plan_rest_to_rest(0.0, 1.0, LIMITS).state_at(T)


def test_override_changes_at_random_blocks_keep_limits_and_continuity_and_the_target():
    draw = random.Random(61)
    for _ in range(60):
        limits = Limits(draw.uniform(20, 200), draw.uniform(500, 5000), draw.uniform(500, 5000), draw.uniform(1e4, 1e5))
        element, interpolator = line_of(draw.uniform(1.0, 60.0)), PathInterpolator()
        interpolator.start(element, limits, draw.uniform(0.3, 1.5) * limits.velocity)

        steps = draw.randrange(1, 8)

        def command(block, interpolator=interpolator, steps=steps):
            if block % steps == 0:
                interpolator.set_override(draw.choice([0.0, 0.1, 0.5, 1.0, 1.2, 1.5, draw.random()]))
            if block == 1000:
                interpolator.set_override(1.0)

        rows = run_alone(interpolator, command)
        assert interpolator.done
        assert_smooth(rows, limits)
        assert rows[-1][0] <= element.length
        assert interpolator.step(1, T) == [(element.length, 0.0, 0.0, 0.0, True)]


def test_override_changes_the_velocity_and_limits_cap_it():
    interpolator = PathInterpolator()
    interpolator.start(line_of(100.0), LIMITS, 50.0)
    fastest = {}
    for factor in (1.0, 0.4, 1.4, 3.0):
        interpolator.set_override(factor)
        fastest[factor] = interpolator.step(200, T)[-1][1]
    assert fastest == pytest.approx({1.0: 50.0, 0.4: 20.0, 1.4: 70.0, 3.0: 100.0}, rel=1e-12)


def test_the_factor_holds_for_later_elements_and_infinite_feed_is_the_limit():
    interpolator = PathInterpolator()
    interpolator.set_override(0.5)
    interpolator.start(line_of(100.0), LIMITS, math.inf)
    assert interpolator.step(200, T)[-1][1] == 50.0


def test_feed_hold_and_resume():
    interpolator = PathInterpolator()
    interpolator.start(line_of(20.0), LIMITS)
    rows = interpolator.step(100, T)
    interpolator.set_override(0.0)
    rows += interpolator.step(200, T)
    assert rows[-1][1:] == (0.0, 0.0, 0.0, False)
    assert not interpolator.stopped
    held = rows[-1][0]
    assert interpolator.distance_to_go == 20.0 - held
    assert interpolator.step(50, T) == [(held, 0.0, 0.0, 0.0, False)] * 50
    interpolator.set_override(1.0)
    rows += run_alone(interpolator)
    assert_smooth(rows, LIMITS)
    assert interpolator.step(1, T)[0] == (20.0, 0.0, 0.0, 0.0, True)


def test_start_under_feed_hold_waits():
    interpolator = PathInterpolator()
    interpolator.set_override(0.0)
    interpolator.start(line_of(5.0), LIMITS)
    assert interpolator.step(20, T) == [(0.0, 0.0, 0.0, 0.0, False)] * 20
    interpolator.set_override(1.0)
    rows = interpolator.step(5, T)
    assert [row[:4] for row in rows] == [plan_rest_to_rest(0.0, 5.0, LIMITS).state_at(n * T) for n in range(1, 6)]


def test_element_without_length_ends_also_under_feed_hold():
    interpolator = PathInterpolator()
    interpolator.set_override(0.0)
    interpolator.start(line_of(0.0), LIMITS)
    assert interpolator.step(1, T) == []
    assert interpolator.done


def test_in_the_brake_phase_the_table_is_kept_to_the_bit():
    plain, commanded = PathInterpolator(), PathInterpolator()
    duration = plan_rest_to_rest(0.0, 10.0, LIMITS).duration
    braking = int((duration - 0.03) / T)
    for interpolator in (plain, commanded):
        interpolator.start(line_of(10.0), LIMITS, 80.0)
        interpolator.step(braking, T)
    assert commanded.state[2] < 0.0
    for factor in (2.0, 0.5, 0.0, 1.0):
        commanded.set_override(factor)
        assert commanded.step(3, T) == plain.step(3, T)


def test_a_factor_before_the_first_cycle_of_an_element_keeps_its_instant():
    interpolator = PathInterpolator()
    interpolator.start(line_of(1.0), LIMITS)
    while not interpolator.done:
        interpolator.step(10, T)
    surplus = interpolator.remaining_time
    interpolator.start(line_of(2.0), LIMITS)
    interpolator.set_override(0.5)
    expected = plan_rest_to_rest(0.0, 2.0, LIMITS._replace(velocity=50.0, acceleration=2000.0)).state_at(surplus)
    assert interpolator.step(1, T)[0][:4] == pytest.approx(expected, rel=1e-9, abs=1e-15)


def test_stop_leaves_the_path_on_the_geometry(draw_arc, draw_axes):
    draw = random.Random(62)
    for _ in range(60):
        arc = draw_arc(draw, 10 ** draw.uniform(0, 2), tilted=False)
        limits = arc.limits(draw.uniform(5.0, 200.0), draw_axes(draw))
        interpolator = PathInterpolator()
        interpolator.start(arc, limits)
        rows = interpolator.step(draw.randrange(1, 400), T)
        interpolator.stop()
        interpolator.stop()
        interpolator.set_override(0.9)
        rows += run_alone(interpolator)
        assert interpolator.stopped
        assert_smooth(rows, limits)
        first, second = arc.plane
        for row in rows:
            places = [state[0] for state in arc.evaluate(*row[:4])]
            radius = math.hypot(places[first] - arc.center[0], places[second] - arc.center[1])
            assert radius == pytest.approx(arc.radius, abs=1e-9)
            normal = 3 - first - second
            share = arc.start[normal] + (arc.target[normal] - arc.start[normal]) * row[0] / arc.length
            assert places[normal] == pytest.approx(share, abs=1e-9)


def test_after_a_stop_another_element_may_start():
    interpolator = PathInterpolator()
    interpolator.start(line_of(50.0), LIMITS)
    interpolator.step(100, T)
    interpolator.stop()
    run_alone(interpolator)
    assert interpolator.stopped
    assert not interpolator.done
    interpolator.dwell(0.005)
    stood = interpolator.step(3, T)
    assert [row[1:] for row in stood] == [(0.0, 0.0, 0.0, False)] * 3
    assert interpolator.step(10, T)[1:] == []
    interpolator.start(line_of(1.0), LIMITS)
    assert not interpolator.stopped
    run_alone(interpolator)
    assert interpolator.done


def test_stop_between_elements_is_at_once():
    interpolator = PathInterpolator()
    interpolator.stop()
    assert interpolator.stopped


def test_override_does_not_touch_a_dwell():
    interpolator = PathInterpolator()
    interpolator.dwell(0.0105)
    interpolator.step(4, T)
    interpolator.set_override(0.0)
    assert len(interpolator.step(100, T)) == 6
    assert interpolator.remaining_time == pytest.approx(0.0005, abs=1e-15)


def test_a_new_cycle_time_goes_on_from_the_last_cycle():
    interpolator = PathInterpolator()
    interpolator.start(line_of(10.0), LIMITS)
    interpolator.step(10, 0.001)
    rows = interpolator.step(3, 0.004)
    profile = plan_rest_to_rest(0.0, 10.0, LIMITS)
    assert [row[:4] for row in rows] == [profile.state_at(0.01 + 0.004 * n) for n in (1, 2, 3)]


@pytest.mark.parametrize("length", [200.0, *long([1000.0])])
def test_long_elements_gather_no_rounding(length):
    interpolator = PathInterpolator()
    interpolator.start(line_of(length), LIMITS, 1.0)
    profile = plan_rest_to_rest(0.0, length, LIMITS._replace(velocity=1.0))
    rows = []
    while not interpolator.done:
        rows += interpolator.step(10, T)
    times = np.arange(1, len(rows) + 1) * T
    assert np.array([row[:4] for row in rows]).T.tobytes() == profile.sample(times).tobytes()


def test_refusals():
    interpolator = PathInterpolator()

    def refused(call):
        before = interpolator.state, interpolator.override
        with pytest.raises(CncError) as fault:
            call()
        assert (interpolator.state, interpolator.override) == before
        return str(fault.value)

    assert refused(lambda: interpolator.start(line_of(1.0), LIMITS, 0.0)) == (
        "P-ERR-22111 path feed 0.0 mm/s must be greater than 0; the element is not started"
    )
    assert refused(lambda: interpolator.start(line_of(1.0), LIMITS._replace(jerk=0.0))) == (
        "P-ERR-23001 motion limit jerk = 0.0 must be between 1e-09 and 1e+12; the motion is refused"
    )
    assert refused(lambda: interpolator.dwell(math.nan)) == (
        "P-ERR-22112 dwell of nan s must be between 0 and 1e+09 s; it is not started"
    )
    assert refused(lambda: interpolator.dwell(-1.0)) == (
        "P-ERR-22112 dwell of -1.0 s must be between 0 and 1e+09 s; it is not started"
    )
    for factor, text in ((-0.1, "-0.1"), (math.nan, "nan"), (1e4, "10000.0")):
        assert refused(lambda factor=factor: interpolator.set_override(factor)) == (
            f"P-ERR-22113 path override {text} must be between 0 and 1000; it is not changed"
        )
    interpolator.start(line_of(10.0), LIMITS)
    interpolator.step(1, T)
    assert refused(lambda: interpolator.start(line_of(10.0), LIMITS)) == (
        "P-ERR-22110 the next element was started 9.99999 mm before the end of the running path element; "
        "the active one continues"
    )
    assert refused(lambda: interpolator.dwell(1.0)) == (
        "P-ERR-22110 a dwell was started 9.99999 mm before the end of the running path element; the active one continues"
    )


def test_steps_take_the_closed_form_time_across_elements():
    """With steps of the acceleration: D/V + V/2·(1/A+ + 1/A-) each, one directly after the other."""
    interpolator = PathInterpolator()
    rows, lengths = [], (10.0, 7.0, 0.2)
    for length in lengths:
        interpolator.start(line_of(length), LIMITS, planner=STEPS)
        rows += run_alone(interpolator)
    half = 0.5 * (1.0 / 2000.0 + 1.0 / 3000.0)
    expected = sum(d / 100.0 + 100.0 * half for d in lengths[:2]) + math.sqrt(4.0 * lengths[2] * half)
    assert (len(rows) + 1) * T - interpolator.remaining_time == pytest.approx(expected, abs=1e-12)
    assert {row[3] for row in rows} == {0.0}


@pytest.mark.parametrize("seed", range(40))
def test_steps_under_random_overrides_holds_and_stops(seed):
    """Every row follows from the one before it with an acceleration within the limits; it stops on the deceleration."""
    draw = random.Random(seed)
    interpolator = PathInterpolator()
    length = draw.choice([0.5, 5.0, 50.0])
    interpolator.start(line_of(length), LIMITS, feed=draw.choice([20.0, 100.0]), planner=STEPS)
    stop_at = draw.choice([None, draw.randrange(40)])

    def at_block(block):
        if block == stop_at:
            interpolator.stop()
        elif draw.random() < 0.3 and block < 60:
            interpolator.set_override(draw.choice([0.0, 0.3, 1.0, 1.7]))
        elif block >= 60 and stop_at is None:
            interpolator.set_override(1.0)

    rows = run_alone(interpolator, at_block)
    s = v = 0.0
    for row in rows:
        assert -1e-9 <= row[1] <= LIMITS.velocity * (1.0 + 1e-9)
        assert row[2] in (0.0, LIMITS.acceleration, -LIMITS.deceleration) and row[3] == 0.0
        assert -LIMITS.deceleration * T * (1.0 + 1e-9) <= row[1] - v <= LIMITS.acceleration * T * (1.0 + 1e-9)
        assert (
            abs(row[0] - s - T * (row[1] + v) / 2.0) <= (LIMITS.acceleration + LIMITS.deceleration) * T * T / 8.0 + 1e-9
        )
        s, v = row[:2]
    if interpolator.done:
        assert v <= LIMITS.deceleration * T * (1.0 + 1e-9) and interpolator.step(1, T) == [
            (length, 0.0, 0.0, 0.0, True)
        ]
    else:
        assert interpolator.stopped and interpolator.state[1:] == (0.0, 0.0, 0.0)
