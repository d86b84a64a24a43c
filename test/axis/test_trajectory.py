"""Trajectories of an axis: against SciPy's splines, with tolerances, ends and refusals by their exact texts."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from job_support import ABORTED, ACTIVE, DONE, FAILED, end_of, job, start_of
from long_support import examples, long
from machine_support import CYCLE_TIME, UnitBench, axis_bench
from scipy.interpolate import BPoly, CubicHermiteSpline

from cnc_ptp.motion.polynomials import derivative, roots_between, value
from cnc_ptp.motion.trajectory import Trajectory, TrajectoryPoint
from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.axis_states import StatusBit

ROWS = [[0.0, 0.0, 0.0, 0.0], [0.5, 40.0, 100.0, -50.0], [1.0, 70.0, -20.0, 30.0], [1.7, 20.0, 0.0, 0.0]]
"""Time, position, velocity, acceleration."""
WIDE = {
    "position_window": 0.05,
    "max_velocity": 2000.0,
    "reference_velocity": 2000.0,
    "max_acceleration": 20_000.0,
    "soft_limit_negative": -1000.0,
    "soft_limit_positive": 1000.0,
}


def bench_of(**changes: Any) -> UnitBench:
    bench = axis_bench(**{**WIDE, **changes})
    bench.run(20)
    return bench


def begin(bench: UnitBench, columns: int = 3, rows: list[list[float]] = ROWS, **arguments: Any) -> int:
    """Begins the trajectory with so many values in each row; the number of its job."""
    return job(bench, "begin_trajectory", points=[row[:columns] for row in rows], **arguments)


def states(bench: UnitBench) -> np.ndarray:
    return np.array([bench.column(f"set_{name}") for name in ("position", "velocity", "acceleration", "jerk")])


# ---------------------------------------------------------------- the curve


@pytest.mark.parametrize("columns", [3, 4])
def test_setpoints_are_those_of_the_spline(columns: int) -> None:
    bench = bench_of()
    number = begin(bench, columns)
    bench.run(1800)
    times, position, velocity, acceleration = np.array(ROWS).T
    spline: Any = CubicHermiteSpline(times, position, velocity)
    if columns == 4:
        spline = BPoly.from_derivatives(times, np.array([position, velocity, acceleration]).T)
    at = np.arange(1700) * CYCLE_TIME
    for order, values in enumerate(states(bench)[:, 20:1720]):
        knots = np.isin(np.arange(1700), [500, 1000]) & (order > 1)  # which side counts there is up to the library
        expected = spline(at) if order == 0 else spline.derivative(order)(at)
        np.testing.assert_allclose(values[~knots], expected[~knots], rtol=1e-9, atol=1e-6)
    assert start_of(bench, number) == 20
    assert end_of(bench, number) == (number, DONE, 1720, 0)
    assert states(bench)[:, -1].tolist() == [20.0, 0.0, 0.0, 0.0] and bench.state == S.STANDSTILL


def test_a_first_point_in_the_position_window_is_where_the_axis_stands() -> None:
    bench = bench_of()
    begin(bench, rows=[[0.0, 0.049, 0.0], [1.0, 10.0, 0.0]])
    bench.run(1100)
    assert states(bench)[0, 20] == 0.0 and states(bench)[0, -1] == 10.0


def test_positions_alone_are_joined_by_lines() -> None:
    rows = [[0.0, 0.0], [0.5, 4.0], [1.0, 0.0]]
    bench = bench_of()
    begin(bench, 2, rows)
    bench.run(1100)
    at = np.arange(1080) * CYCLE_TIME
    expected = np.interp(at, *np.array(rows).T)
    np.testing.assert_allclose(states(bench)[0, 20:1100], expected, atol=1e-12)


def test_without_a_point_at_0_s_it_begins_where_the_axis_stands() -> None:
    bench = bench_of()
    bench.accepted("set_position", position=5.0)
    begin(bench, rows=[[1.0, 25.0, 0.0]])
    bench.run(1100)
    at = np.arange(1000) * CYCLE_TIME
    np.testing.assert_allclose(states(bench)[0, 20:1020], 5.0 + 20.0 * (3.0 * at**2 - 2.0 * at**3), atol=1e-9)


def test_a_delay_lets_it_wait_in_place() -> None:
    bench, other = bench_of(), bench_of()
    number = begin(bench, delay=0.03)
    begin(other)
    bench.run(1830)
    other.run(1800)
    np.testing.assert_allclose(states(bench)[:, 50:1800], states(other)[:, 20:1770], atol=1e-6)
    assert not states(bench)[:, 20:50].any()
    assert bench.column("state")[20:1750] == [S.DISCRETE_MOTION] * 1730
    assert end_of(bench, number).cycle == 1750


def test_in_a_dwell_the_axis_has_its_job_and_no_target() -> None:
    bench = bench_of()
    number = begin(bench, rows=[[0.0, 0.0, 0.0], [0.2, 5.0, 0.0], [1.5, 5.0, 0.0], [1.7, 0.0, 0.0]])
    bench.run(2000)
    bits = np.array(bench.column("status_bits"))
    assert (bits[20:1720] & StatusBit.HAS_JOB != 0).all() and not (bits[20:1720] & StatusBit.IN_TARGET_POSITION).any()
    assert bits[-1] & StatusBit.IN_TARGET_POSITION and not bits[-1] & StatusBit.HAS_JOB
    assert end_of(bench, number).cycle == 1720 and not bench.events


values = st.floats(-100.0, 100.0, allow_subnormal=False)


@given(st.lists(st.tuples(values, values, values), min_size=2, max_size=4), st.floats(0.05, 3.0))
@settings(max_examples=examples(150), deadline=None)
def test_extrema_are_not_exceeded_anywhere(points: list[tuple[float, float, float]], seconds: float) -> None:
    """Ten thousand samples of each quantity stay within what the closed forms tell, and come near to it."""
    rows = [TrajectoryPoint(index * seconds, *point) for index, point in enumerate(points)]
    for segment in Trajectory(rows).segments:
        at = np.linspace(0.0, seconds, 10_000)
        for polynomial in (segment.position, segment.velocity, segment.acceleration):
            samples = np.polynomial.polynomial.polyval(at, np.array(polynomial))
            found = [extremum.value for extremum in segment.extrema(polynomial)]
            size = max(1.0, np.abs(samples).max())
            assert samples.max() <= max(found) + 1e-9 * size and samples.min() >= min(found) - 1e-9 * size
            assert max(found) - samples.max() <= 1e-4 * size and samples.min() - min(found) <= 1e-4 * size


def test_roots_are_those_of_numpy() -> None:
    rng = np.random.default_rng(17)
    for _ in range(300):
        inside = np.sort(rng.uniform(0.05, 0.95, rng.integers(1, 5)))
        if (np.diff(inside) < 0.01).any():
            continue
        polynomial = np.polynomial.polynomial.polyfromroots(np.append(inside, -2.0)).tolist()
        np.testing.assert_allclose(roots_between(polynomial, 0.0, 1.0, touching=True), inside, atol=1e-9)
    assert roots_between([0.0, 1.0], 0.0, 1.0) == [] and roots_between([-1.0, 2.0], 0.0, 1.0) == [0.5]
    assert derivative([3.0]) == [] and value([], 5.0) == 0.0
    cube, square = [-0.125, 0.75, -1.5, 1.0], [0.25, -1.0, 1.0]  # (d - 1/2)³, (d - 1/2)²
    assert roots_between(cube, 0.0, 1.0, touching=True) == roots_between(square, 0.0, 1.0, touching=True) == [0.5]
    assert roots_between(square, 0.0, 1.0) == []


# ---------------------------------------------------------------- tolerances


def test_a_path_tolerance_stops_the_axis_on_its_ramp() -> None:
    """Without feedforward the lag of the position controller is v / Kv: 100 mm/s and 50 1/s make 2 mm."""
    bench = bench_of(kv=50.0, drive_time_constant=0.0)
    rows = [[0.0, 0.0, 0.0], [0.5, 40.0, 100.0], [1.5, 140.0, 100.0], [2.0, 180.0, 0.0]]
    number = begin(bench, rows=rows, path_tolerance=1.0)
    bench.run(2500)
    end = end_of(bench, number)
    lag = np.array(bench.column("set_position")) - np.array(bench.column("actual_position"))
    first = int(np.argmax(np.abs(lag) > 1.0))
    assert (end.status, end.error_id) == (FAILED, 23065) and first == end.cycle
    position, actual = bench.column("set_position")[first], bench.column("actual_position")[first]
    assert bench.event_texts() == [
        f"P-ERR-23065 axis x: {position - actual:g} mm away from the trajectory {(first - 20) * CYCLE_TIME:.4g} s after "
        f"its start (set position {position:g} mm, actual position {actual:g} mm), more than the path tolerance 1 mm; "
        "the axis stops on its own ramp (ErrorStop)"
    ]
    velocity, acceleration = states(bench)[1:3, first:]
    assert bench.state == S.ERROR_STOP and velocity[-1] == 0.0
    assert np.abs(np.diff(velocity)).max() <= bench.unit._axis.own_limits.deceleration * CYCLE_TIME * (1.0 + 1e-9)  # type: ignore[attr-defined]
    assert np.abs(acceleration).max() <= bench.unit._axis.own_limits.deceleration + 200.0  # type: ignore[attr-defined]


def test_within_its_tolerances_it_is_done_when_the_axis_is_at_its_goal() -> None:
    bench = bench_of(kv=50.0, drive_time_constant=0.0)
    number = begin(bench, path_tolerance=10.0, goal_tolerance=0.01, goal_time=1.0)
    bench.run(2500)
    end = end_of(bench, number)
    lag = np.abs(np.array(bench.column("actual_position")) - 20.0)
    inside = 1720 + int(np.argmax(lag[1720:] <= 0.01))
    assert inside > 1720 and end == (number, DONE, inside + 1, 0) and not bench.events


def test_a_goal_that_is_missed_fails_the_job_at_a_standstill() -> None:
    bench = bench_of(kv=50.0, drive_time_constant=0.0)
    rows = [[0.0, 0.0, 0.0], [0.2, 20.0, 0.0]]
    number = begin(bench, rows=rows, goal_tolerance=1e-4, goal_time=0.05)
    bench.run(1000)
    assert end_of(bench, number) == (number, FAILED, 20 + 200 + 50, 23066)
    actual = bench.column("actual_position")[270]
    assert bench.event_texts() == [
        f"P-ERR-23066 axis x: {20.0 - actual:g} mm away from its goal 20 mm (actual position {actual:g} mm) 0.05 s after "
        "its end, more than the goal tolerance 0.0001 mm; the axis is at a standstill"
    ]
    assert bench.state == S.STANDSTILL
    begin(bench, rows=[[0.5, 0.0, 0.0]])


# ---------------------------------------------------------------- what ends it

STOPS = [
    ("stop", {}, S.STOPPING, ABORTED),
    ("halt", {}, S.DISCRETE_MOTION, ABORTED),
    ("emergency_stop", {"deceleration": 5000.0, "jerk": 100_000.0}, S.STOPPING, ABORTED),
    ("reset", {}, S.STOPPING, ABORTED),
    ("power", {"enabled": False}, S.STOPPING, ABORTED),
    ("set_feed_release", {"forward": True, "backward": False}, S.STOPPING, ABORTED),
    ("feed_hold", {"enabled": True}, S.STOPPING, ABORTED),
    ("upstream_lost", {"source": "plc"}, S.ERROR_STOP, FAILED),
    ("move_absolute", {"target": 500.0, "buffer_mode": "aborting"}, S.DISCRETE_MOTION, ABORTED),
    ("move_velocity", {"velocity": 100.0, "buffer_mode": "aborting"}, S.CONTINUOUS_MOTION, ABORTED),
]


@pytest.mark.parametrize("columns", [4, *long([3])])
@pytest.mark.parametrize(("command", "arguments", "state", "status"), STOPS, ids=[row[0] for row in STOPS])
@pytest.mark.parametrize("cycles", [300, 1690, *long([1, 760])])
def test_what_ends_it_continues_from_its_state(
    command: str, arguments: dict[str, Any], state: S, status: int, columns: int, cycles: int
) -> None:
    """No step of position or velocity; the acceleration of the trajectory may end, none is above that of both."""
    bench = bench_of()
    number = begin(bench, columns)
    bench.run(cycles)
    bench.accepted(command, **arguments)
    bench.run(4000)
    assert bench.column("state")[20 + cycles] == state
    end = end_of(bench, number)
    assert (end.status, end.cycle) == (status, 20 + cycles)
    position, velocity = states(bench)[:2]
    most = max(2500.0, 10_000.0)
    assert np.abs(np.diff(velocity)).max() <= most * CYCLE_TIME
    steps = np.abs(np.diff(position) - 0.5 * CYCLE_TIME * (velocity[1:] + velocity[:-1]))
    assert steps.max() <= 2e-6 * most


def test_a_feed_release_that_is_taken_away_ends_it_with_a_warning() -> None:
    bench = bench_of()
    begin(bench)
    bench.run(300)
    assert bench.accepted("set_feed_release", forward=True, backward=False) == (
        "P-WARN-23068 axis x: the trajectory is aborted, a direction is no longer released; the axis stops on its ramp"
    )
    bench.run(1000)
    bench.accepted("set_feed_release", forward=True, backward=True)
    bench.run(100)
    assert bench.state == S.STANDSTILL and states(bench)[1, -1] == 0.0


def test_an_override_does_not_change_it() -> None:
    bench, other = bench_of(), bench_of()
    for each in (bench, other):
        begin(each)
        each.run(300)
    assert bench.accepted("set_override", percent=0.0) == (
        "axis x: override 0.0 % does not change the active motion (a trajectory keeps its times)"
    )
    for each in (bench, other):
        each.run(1600)
    assert (states(bench) == states(other)).all()


BESIDE: list[tuple[str, dict[str, Any]]] = [
    ("move_superimposed", {"distance": 1.0}),
    ("compensation_start", {"length": 9.0, "difference": 1.0, "process_velocity": 50.0, "velocity_increase": 5.0}),
    ("external_enable", {"mode": "relative"}),
    ("set_position", {"position": 5.0}),
    ("move_absolute", {"target": 5.0, "buffer_mode": "buffered"}),
    ("move_absolute", {"target": 5.0, "buffer_mode": "blending_low"}),
]


@pytest.mark.parametrize(("command", "arguments"), BESIDE)
def test_nothing_moves_the_axis_away_from_it(command: str, arguments: dict[str, Any]) -> None:
    bench, other = bench_of(), bench_of()
    for each in (bench, other):
        begin(each)
        each.run(300)
    assert bench.refused(command, **arguments) == (
        f"P-ERR-23067 axis x: {command} refused: the axis follows a trajectory; stop it first; nothing was changed"
    )
    for each in (bench, other):
        each.run(1600)
    assert (states(bench) == states(other)).all()


def test_another_trajectory_is_refused_while_one_is_active() -> None:
    bench = bench_of()
    number = begin(bench)
    bench.run(300)
    assert bench.refused("begin_trajectory", points=[[1.0, 5.0, 0.0]]) == (
        "P-ERR-23005 axis x: begin_trajectory refused: the axis is in DiscreteMotion, it must be in Standstill; nothing "
        "was changed"
    )
    bench.run(1600)
    assert end_of(bench, number).status == DONE and ACTIVE


# ---------------------------------------------------------------- refusals

NAN = float("nan")
LIST = "is not a list of time, position, velocity, acceleration (the last two may be left out)"
REFUSALS: list[tuple[list[Any], str]] = [
    ([], "23064 it has no points"),
    ([5.0], f"23064 point 1 = 5.0 {LIST}"),
    ([[0.0, 0.0], [1.0]], f"23064 point 2 = [1.0] {LIST}"),
    ([[0.0, 0.0], [1.0, NAN]], "23064 position = nan of point 2 is not a number within ±1e+12"),
    ([[True, 0.0]], "23064 time = True of point 1 is not a number within ±1e+12"),
    ([[0.0, 0.0, "5"]], "23064 velocity = '5' of point 1 is not a number within ±1e+12"),
    ([[0.0, 1e13]], "23064 position = 10000000000000.0 of point 1 is not a number within ±1e+12"),
    ([[-0.5, 0.0], [1.0, 1.0]], "23064 time = -0.5 of point 1 is negative"),
    ([[0.0, 0.0, 0.0], [1.0, 5.0]], "23064 point 2 has other values than point 1; time, position, velocity are needed"),
    (
        [[0.0, 0.0], [1.0, 5.0], [1.0, 6.0]],
        "23064 the point at 1 s comes after that at 1 s; at least 1e-06 s must lie between them",
    ),
    (
        [[0.0, 5.0, 0.0], [1.0, 9.0, 0.0]],
        "23064 the axis is at 0.0 mm, the first point at 0 s is 5.0 mm; they may differ by the position window 0.05 mm (P-AXIS-00236)",
    ),
    (
        [[0.0, 0.0, 3.0], [1.0, 9.0, 0.0]],
        "23064 velocity 3.0 mm/s in the first point at 0 s; the axis is at a standstill",
    ),
    (
        [[0.0, 0.0, 0.0], [1.0, 9.0, -2.0]],
        "23064 velocity -2.0 mm/s in the last point at 1 s; a trajectory ends at a standstill",
    ),
    ([[0.0, 0.0, 0.0]], "23064 its only point is at 0 s, where the axis is already"),
    # the peak of 3·d² - 2·d³ over 1 s is 1.5 times the distance, in the middle; its acceleration 6 times, at the ends
    (
        [[1.0, 500.0, 0.0], [2.0, 1000.5, 0.0]],
        "120002 position 1000.5 mm at 2 s is beyond the positive soft limit 1000.0 mm (P-AXIS-00178)",
    ),
    (
        [[1.0, -1001.0, 0.0]],
        "120003 position -1001 mm at 1 s is beyond the negative soft limit -1000.0 mm (P-AXIS-00177)",
    ),
    ([[0.5, 700.0, 0.0]], "23004 velocity 2100 mm/s at 0.25 s is above the maximum 2000.0 mm/s (P-AXIS-00212)"),
    ([[0.1, 40.0, 0.0]], "23013 acceleration 24000 mm/s² at 0 s is above the maximum 20000.0 mm/s² (P-AXIS-00008)"),
    (
        [[1.0, 100.0]],
        "23013 without velocities the velocity steps by 100 mm/s at 0 s, more than 20 mm/s in a cycle (P-AXIS-00008); "
        "give velocities",
    ),
    (
        [[1.0, 15.0], [2.0, 0.0]],
        "23013 without velocities the velocity steps by 30 mm/s at 1 s, more than 20 mm/s in a cycle (P-AXIS-00008); "
        "give velocities",
    ),
]


@pytest.mark.parametrize(("points", "text"), REFUSALS)
def test_refusals(points: list[Any], text: str) -> None:
    bench = bench_of()
    number, reason = text.split(" ", 1)
    refused = bench.refused("begin_trajectory", points=points)
    assert refused == f"P-ERR-{number} axis x: begin_trajectory refused: {reason}; nothing was changed"
    bench.run(100)
    assert not states(bench).any() and bench.state == S.STANDSTILL


def test_a_soft_limit_is_exceeded_between_two_points() -> None:
    """From 990 mm at 200 mm/s back to 990 mm: d·(1-d/T)²·v + … has its peak 200 · T / 4 further, with T = 0.5 s."""
    bench = bench_of()
    rows = [[5.0, 990.0, 200.0], [5.5, 990.0, -200.0], [10.0, 0.0, 0.0]]
    assert bench.refused("begin_trajectory", points=rows) == (
        "P-ERR-120002 axis x: begin_trajectory refused: position 1015 mm at 5.25 s is beyond the positive soft limit "
        "1000.0 mm (P-AXIS-00178); nothing was changed"
    )


def test_the_reference_velocity_counts_too() -> None:
    bench = bench_of(reference_velocity=100.0)
    assert bench.refused("begin_trajectory", points=[[1.0, 90.0, 0.0]]) == (
        "P-ERR-23011 axis x: begin_trajectory refused: velocity 135 mm/s at 0.5 s is above the reference velocity 100.0 "
        "mm/s (P-MACH-00008); nothing was changed"
    )


def test_an_axis_beyond_its_soft_limit_may_come_back() -> None:
    bench = bench_of(start_position=1010.0)
    begin(bench, rows=[[1.0, 900.0, 0.0]])
    bench.run(1100)
    assert bench.column("set_position")[-1] == 900.0


@pytest.mark.parametrize(
    ("prepare", "text"),
    [
        ([("power", {"enabled": False})], "23005 the axis is in Disabled, it must be in Standstill"),
        ([("external_enable", {"mode": "absolute"})], "23027 external setpoints are enabled; disable them"),
        (
            [("set_feed_release", {"forward": True, "backward": False})],
            "23058 both directions must be released (set_feed_release)",
        ),
    ],
)
def test_it_is_refused_where_it_cannot_begin(prepare: list[Any], text: str) -> None:
    bench = bench_of()
    for command, arguments in prepare:
        bench.accepted(command, **arguments)
    number, reason = text.split(" ", 1)
    refused = bench.refused("begin_trajectory", points=ROWS)
    assert refused == f"P-ERR-{number} axis x: begin_trajectory refused: {reason}; nothing was changed"


@pytest.mark.parametrize("name", ["path_tolerance", "goal_tolerance", "goal_time", "delay"])
def test_no_tolerance_is_negative(name: str) -> None:
    assert bench_of().refused("begin_trajectory", points=ROWS, **{name: -1.0}) == (
        f"P-ERR-23064 axis x: begin_trajectory refused: {name} = -1.0 must not be negative; nothing was changed"
    )
