"""Trajectories of several axes: one cycle for all, all or none, and one that fails stops the others."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from commands_support import call
from long_support import long
from machine_support import CYCLE_TIME, PTP, ROOT, MachineBench
from scipy.interpolate import CubicHermiteSpline

from cnc_ptp.client import Machine
from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.blocks import CycleTick, PlcBlock
from cnc_ptp.protocol.jobs import JobStatus
from cnc_ptp.recording.reader import read_recording

POINTS = [[0.5, [20.0, -5.0, 90.0], [60.0, 0.0, 0.0]], [1.2, [0.0, 30.0, 45.0], [0.0, 0.0, 0.0]]]
AXES = ["x", "y", "c"]
PTP_FILE = ROOT / "config" / "ptp.yaml"


def bench_of() -> MachineBench:
    return MachineBench(machine=PTP, end_when_idle=False).run(0.1)


def follow(bench: MachineBench, axes: list[str] = AXES, points: Any = POINTS, **options: Any) -> None:
    record = bench.give("plc", "follow_trajectory", axes=axes, points=points, **options)
    assert record.accepted, record.message


def moves(bench: MachineBench, axis: str) -> np.ndarray:
    """Positions from the cycle on in which the axis has begun the trajectory."""
    position = np.array(bench.column(axis, "set_position"))
    return position[bench.column(axis, "state").index(S.DISCRETE_MOTION) :]


def ends(bench: MachineBench, axis: str) -> list[tuple[int, int]]:
    events = [event for block in bench.blocks[axis] for event in block.job_events]
    return [(event.status, event.error_id) for event in events if event.status != JobStatus.ACTIVE]


def test_all_axes_begin_in_the_same_cycle() -> None:
    bench = bench_of()
    follow(bench)
    bench.run(1.6)
    for index, axis in enumerate(AXES):
        times = [0.0, 0.5, 1.2]
        values = [[0.0, *[row[column][index] for row in POINTS]] for column in (1, 2)]
        spline = CubicHermiteSpline(times, *values)
        at = np.arange(1200) * CYCLE_TIME
        assert not moves(bench, axis)[:10].any()
        np.testing.assert_allclose(moves(bench, axis)[10:1210], spline(at), atol=1e-9)
        assert ends(bench, axis) == [(JobStatus.DONE, 0)]
    begins = {bench.column(axis, "state").index(S.DISCRETE_MOTION) for axis in AXES}
    assert begins == {100}


def test_one_axis_needs_not_wait_for_others() -> None:
    bench = bench_of()
    follow(bench, ["y"], [[0.5, [20.0], [0.0]]])
    bench.run(0.6)
    assert 0.0 < moves(bench, "y")[1] < 0.01


def test_if_one_refuses_none_has_moved() -> None:
    bench = bench_of()
    follow(bench, ["x", "y"], [[0.1, [10.0, 5000.0], [0.0, 0.0]]])
    bench.run(0.5)
    assert bench.refusals() == [
        "P-ERR-23004 axis y: begin_trajectory refused: velocity 75000 mm/s at 0.05 s is above the maximum 10000.0 mm/s "
        "(P-AXIS-00212); nothing was changed"
    ]
    assert not any(bench.column("x", "set_position")) and not any(bench.column("y", "set_position"))
    assert ends(bench, "x") == [(JobStatus.ABORTED, 0), (JobStatus.DONE, 0)]  # of the trajectory, of the stop
    assert bench.last("x").state[-1] == S.STANDSTILL


@pytest.mark.parametrize("cycles", [300, *long([20, 700])])
@pytest.mark.parametrize(
    ("command", "arguments"),
    [("stop", {}), ("power", {"enabled": False}), ("upstream_lost", {"source": "plc"}), ("halt", {})],
)
def test_one_that_ends_early_stops_the_others_a_block_later(
    command: str, arguments: dict[str, Any], cycles: int
) -> None:
    bench, other = bench_of(), bench_of()
    for each in (bench, other):
        follow(each)
        each.run(cycles * CYCLE_TIME)
    assert bench.give("y", command, **arguments).accepted
    for each in (bench, other):
        each.run(2.0)
    for axis in ("x", "c"):
        first = bench.column(axis, "state").index(S.STOPPING)
        assert first == 100 + cycles + 10
        assert moves(bench, axis)[: cycles + 10].tolist() == moves(other, axis)[: cycles + 10].tolist()
        assert bench.last(axis).state[-1] == S.STANDSTILL
        assert ends(bench, axis) == [(JobStatus.ABORTED, 0), (JobStatus.DONE, 0)]
        velocity = np.array(bench.column(axis, "set_velocity"))
        assert np.abs(np.diff(velocity)).max() <= 5000.0 * CYCLE_TIME * 1.001


def test_one_that_deviates_too_far_stops_the_others() -> None:
    """The lag of v / Kv is 0.3 mm at 150 mm/s (500 1/s)."""
    bench = bench_of()
    follow(bench, ["x", "y"], [[1.0, [100.0, 1.0], [0.0, 0.0]]], path_tolerance=[0.2, 0.0])
    bench.run(2.0)
    assert [text.split(":")[0] for text in bench.errors()] == ["P-ERR-23065 axis x"]
    assert ends(bench, "x") == [(JobStatus.FAILED, 23065)]
    assert ends(bench, "y")[0] == (JobStatus.ABORTED, 0) and 0.0 < bench.position("y") < 1.0


def test_an_axis_that_is_done_before_the_others_stops_nobody() -> None:
    """y comes into its goal tolerance later than x."""
    bench = bench_of()
    follow(bench, ["x", "y"], [[0.5, [0.1, 100.0], [0.0, 0.0]]], goal_tolerance=[0.2, 1e-6], goal_time=1.0)
    bench.run(1.5)
    assert ends(bench, "x") == ends(bench, "y") == [(JobStatus.DONE, 0)] and not bench.events


def test_an_axis_that_is_lost_stops_the_others() -> None:
    bench = bench_of()
    follow(bench, ["x", "y"], [[1.0, [100.0, 100.0], [0.0, 0.0]]])
    bench.run(0.3)
    reported = {name: blocks[-1] for name, blocks in bench.blocks.items() if name not in ("plc", "y")}
    block = bench.units["plc"].step(CycleTick(400, 10), reported)
    assert isinstance(block, PlcBlock)
    assert [(command.target, command.command) for command in block.commands] == [("x", "stop"), ("y", "stop")]


TWO = ["x", "y"]
REFUSALS: list[tuple[dict[str, Any], str]] = [
    ({"axes": [], "points": []}, "axes is empty; known are: x, y, z, c"),
    ({"axes": ["x", "q"], "points": []}, "there is no axis 'q'; known are: x, y, z, c"),
    ({"axes": [5], "points": []}, "there is no axis 5; known are: x, y, z, c"),
    ({"axes": ["x", "x"], "points": []}, "axis x appears twice in axes"),
    ({"axes": TWO, "points": []}, "points is empty"),
    (
        {"axes": TWO, "points": [[1.0]]},
        "point 1 = [1.0] is not a list of time, positions, velocities, accelerations (the last two may be left out)",
    ),
    ({"axes": TWO, "points": [[1.0, 5.0]]}, "positions of point 1 = 5.0 has not one value of each of x, y"),
    (
        {"axes": TWO, "points": [[1.0, [5.0, 5.0], [0.0, 0.0]], [2.0, [0.0, 0.0], [0.0]]]},
        "velocities of point 2 = [0.0] has not one value of each of x, y",
    ),
    (
        {"axes": TWO, "points": [[1.0, [0.0, 0.0]]], "path_tolerance": [1.0]},
        "path_tolerance has 1 values for 2 axes (x, y)",
    ),
    (
        {"axes": TWO, "points": [[1.0, [0.0, 0.0]]], "goal_tolerance": [1.0, -2.0]},
        "goal_tolerance = -2.0 of y is not a number from 0 on",
    ),
    (
        {"axes": TWO, "points": [[1.0, [0.0, 0.0]]], "goal_tolerance": [1.0, "far"]},
        "goal_tolerance = 'far' of y is not a number from 0 on",
    ),
]


@pytest.mark.parametrize(("arguments", "reason"), REFUSALS)
def test_refusals_of_the_plc(arguments: dict[str, Any], reason: str) -> None:
    bench = bench_of()
    assert bench.refused("plc", "follow_trajectory", **arguments) == (
        f"P-ERR-23064 plc plc: follow_trajectory refused: {reason}; nothing was changed"
    )
    bench.run(0.1)
    assert not any(block.commands for block in bench.blocks["plc"])


def test_another_trajectory_of_an_active_axis_is_refused() -> None:
    bench = bench_of()
    follow(bench)
    bench.run(0.3)
    assert bench.refused("plc", "follow_trajectory", axes=["z", "c"], points=[[1.0, [0.0, 0.0]]]) == (
        "P-ERR-23064 plc plc: follow_trajectory refused: axis c follows another trajectory; stop it first; nothing was "
        "changed"
    )
    follow(bench, ["z"], [[0.3, [5.0], [0.0]]])
    bench.run(1.5)
    assert [ends(bench, axis) for axis in (*AXES, "z")] == [[(JobStatus.DONE, 0)]] * 4
    follow(bench)


PLC_FILE = """
class Plc:
    def cycle(self, io):
        if io.cycle == 100:
            io.follow_trajectory(["x", "y"], [(0.5, [20.0, 30.0], [0.0, 0.0])], goal_tolerance=[0.1, 0.1], goal_time=0.1)
            io.follow_trajectory(["x"], [])
        io.done(io.time > 1.0)
"""


def test_a_plc_in_a_file(tmp_path: Path) -> None:
    file = tmp_path / "trajectory.py"
    file.write_text(PLC_FILE)
    done = call("simulate", PTP_FILE, "--plc", file, "--record", tmp_path / "r.mcap")
    assert "follow_trajectory refused: axis x follows another trajectory; stop it first" in done.output
    commands = [
        record for record in read_recording(tmp_path / "r.mcap").commands if record.command == "begin_trajectory"
    ]
    assert [(record.target, record.cycle, record.accepted) for record in commands] == [
        ("x", 100, True),
        ("y", 100, True),
    ]


def test_a_client_offline() -> None:
    with Machine.offline(PTP_FILE) as m:
        m.plc.follow_trajectory(AXES, POINTS, goal_tolerance=(0.1, 0.1, 0.1), goal_time=0.5)
        m.run_for(2.0)
        assert [m.axes[axis].state.set_position for axis in AXES] == [0.0, 30.0, 45.0]
