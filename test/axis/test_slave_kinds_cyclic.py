"""Cyclic slave, flying saw and cam as commands of an axis: acceptance, refusals, what then happens."""

from __future__ import annotations

from math import cos, pi

import numpy as np
import pytest
from error_support import refused
from long_support import long
from machine_support import assert_axis_smooth
from slave_support import DYNAMICS, SlaveBench

from cnc_ptp.errors import CncError
from cnc_ptp.plc.cam_file import parse_cam
from cnc_ptp.plc.scenario import ScenarioError, parse_scenario
from cnc_ptp.protocol.axis_states import AxisStateCode as S

COSINE = [[30.0 * k, 50.0 * (1.0 - cos(pi * k / 6.0))] for k in range(13)]


def started(**couple: object) -> SlaveBench:
    """y is coupled cyclically to x, x is on its way to 10000 mm."""
    bench = SlaveBench()
    bench.do("y", "couple_cyclic", **{"master": "x", "acc_bound": 8000.0, **couple})
    bench.do("x", "move_absolute", target=10_000.0, **DYNAMICS)
    return bench


# cyclic


def test_cyclic_slave_keeps_its_bound_through_a_sequence_of_factors() -> None:
    bench = started(acc_bound=10_000.0)
    for factor in (0.5, 0.52, -0.3, 0.0, 1.5, 2.0, -2.0):
        assert bench.do("y", "set_cyclic_factor", factor=factor) == ""
        bench.run(0.2)
    bench.settle()
    acceleration, velocity = bench.values("y", "set_acceleration"), bench.values("y", "set_velocity")
    assert np.abs(acceleration).max() <= 10_000.0 * (1.0 + 1e-9)
    assert np.abs(np.diff(velocity)).max() <= 10.0 * (1.0 + 1e-9)
    assert bench.errors() == []
    assert bench.state("y") == S.SYNCHRONIZED_MOTION


def test_bound_below_stability_is_warned_about_and_kept() -> None:
    bench = started(acc_bound=3000.0)
    warning = (
        "P-WARN-23049 axis y: set_cyclic_factor: AccBound 3000 is below |factor|·max(A+, A-) = 5000 mm/s² of the "
        "master x; the slave may lag behind"
    )
    assert bench.do("y", "set_cyclic_factor", factor=-1.0) == warning
    assert bench.do("y", "set_cyclic_factor", factor=0.6) == ""
    assert bench.do("y", "set_cyclic_factor", factor=-1.0) == warning
    bench.settle()
    assert np.abs(bench.values("y", "set_acceleration")).max() == pytest.approx(3000.0, rel=1e-9)


def test_cyclic_refusals() -> None:
    bench = SlaveBench()
    assert bench.denial("y", "couple_cyclic", master="x", acc_bound=0.0) == refused(23048, acc_bound=0.0)
    assert bench.denial("y", "set_cyclic_factor", factor=1.0) == refused(23047, state="Standstill")
    bench.do("y", "couple", master="x", factor=1.0)
    assert bench.denial("y", "set_cyclic_factor", factor=1.0) == refused(23050)
    bench.do("z", "couple_cyclic", master="x", acc_bound=8000.0)
    assert bench.denial("z", "set_cyclic_factor", factor=float("nan")) == refused(22001, argument="factor")
    assert bench.denial("z", "set_coupling_factor", factor=2.0) == refused(23050)


def test_cyclic_slave_without_further_factors_goes_on_with_the_last() -> None:
    """The factor freezes; 0.5 from 0.1 s on, before that 0: the slave is linear all the way to the stop."""
    bench = SlaveBench()
    bench.do("y", "couple_cyclic", master="x", acc_bound=8000.0)
    bench.do("y", "set_cyclic_factor", factor=0.5)
    bench.do("x", "move_absolute", target=3000.0, **DYNAMICS)
    bench.settle()
    assert np.abs(bench.values("y") - 0.5 * bench.values("x")).max() <= 1e-9


def test_cyclic_slave_decouples_in_motion() -> None:
    bench = started()
    bench.do("y", "set_cyclic_factor", factor=0.5)
    bench.run(1.0)
    bench.do("y", "decouple")
    bench.run(0.2)
    assert bench.values("y", "set_velocity")[-1] == pytest.approx(1000.0)
    bench.do("y", "stop")
    bench.settle()
    assert np.abs(np.diff(bench.values("y", "set_velocity"))).max() <= 8.0 * (1.0 + 1e-9)


# flying saw


def saw(bench: SlaveBench, **changes: float) -> str:
    arguments = {"factor": 1.0, "master_position": 3000.0, "slave_position": 1000.0, **DYNAMICS, **changes}
    return bench.do("y", "couple_flying_saw", master="x", **arguments)


@pytest.mark.parametrize("sign", [-1.0, *long([1.0])])
@pytest.mark.parametrize("factor", [1.0, -0.5])
def test_flying_saw_is_synchronous_and_can_be_taken_off(sign: float, factor: float) -> None:
    bench = SlaveBench()
    bench.do("x", "move_absolute", target=sign * 10_000.0, **DYNAMICS)
    bench.run(0.69)
    saw(bench, factor=factor, master_position=sign * 3000.0, slave_position=sign * factor * 1000.0)
    bench.run(2.0)
    x, y = bench.values("x"), bench.values("y")
    met = np.flatnonzero(sign * x >= 3000.0)
    assert y[met] == pytest.approx(factor * (x[met] - sign * 2000.0), abs=1e-9)
    assert_axis_smooth(bench.blocks["y"], acceleration=5000.0, jerk=50000.0)
    bench.do("y", "decouple", target=0.0)
    bench.settle()
    assert bench.position("y") == pytest.approx(0.0, abs=1e-9)
    assert bench.errors() == []


@pytest.mark.parametrize(
    ("moves", "changes", "reason"),
    [
        (True, {"master_position": 1300.0}, "the run-up takes 0.75 s, the master is there in 0.2 s"),
        (True, {"slave_position": 400.0}, "the run-up takes 500 mm, the synchronous position is 400 mm away"),
        (True, {"velocity": 1500.0}, "it would have to run at 2000 mm/s, its velocity is limited to 1500 mm/s"),
        (False, {}, "the master is at a standstill; a flying saw needs a moving master"),
    ],
)
def test_flying_saw_that_cannot_be_is_told_and_the_axis_stays_free(
    moves: bool, changes: dict[str, float], reason: str
) -> None:
    bench = SlaveBench()
    if moves:
        bench.do("x", "move_absolute", target=10_000.0, **DYNAMICS)
        bench.run(0.69)  # 900 mm
    saw(bench, **changes)
    events = [(event.severity, event.error_id, event.text) for event in bench.events]
    assert events == [(1, 23051, f"axis y: cannot follow x: {reason}; the axis is at a standstill and not coupled")]
    assert bench.state("y") == S.STANDSTILL
    assert bench.values("y").tolist() == [0.0] * bench.cycle
    bench.run(0.02)
    bench.do("y", "move_absolute", target=100.0, **DYNAMICS)
    bench.settle()
    assert bench.position("y") == 100.0
    assert bench.errors() == []


def test_flying_saw_refusals() -> None:
    bench = SlaveBench()
    arguments = {"master": "x", "factor": 1.0, "master_position": 3000.0, "slave_position": 1000.0}
    assert bench.denial("y", "couple_flying_saw", **arguments | {"factor": 0.0}) == refused(
        23043, argument="factor", value=0.0
    )
    assert bench.denial("y", "couple_flying_saw", **arguments | {"slave_position": 1e6}) == refused(
        120002, target=1000000.0, limit=100000.0
    )


# cam


def test_cam_slave_and_change_of_table() -> None:
    bench = SlaveBench()
    bench.do("y", "couple_cam", master="x", table=COSINE)
    bench.do(
        "x", "move_absolute", target=1080.0, velocity=360.0, acceleration=1000.0, deceleration=1000.0, jerk=10_000.0
    )
    bench.run(1.5)
    bench.do("y", "change_cam", table=[[x, 2.0 * y] for x, y in COSINE])
    bench.settle()
    x, y = bench.values("x"), bench.values("y")
    turn = np.where(x < 720.0, 1.0, 2.0)
    assert y == pytest.approx(turn * 50.0 * (1.0 - np.cos(np.deg2rad(x))), abs=0.05)  # 13 points: 0.04 mm
    assert np.abs(np.diff(y, 2)).max() * 1e6 < 5000.0


def test_cam_with_slave_offset_is_told_when_the_slave_stands_elsewhere() -> None:
    bench = SlaveBench()
    bench.do("y", "couple_cam", master="x", table=COSINE, slave_offset=7.0)
    text = (
        "axis y: cannot follow x: the cam table puts the slave at 7 with its slave_offset, the axis is at 0; "
        "the axis is at a standstill and not coupled"
    )
    assert [(event.error_id, event.text) for event in bench.events] == [(23053, text)]
    assert bench.state("y") == S.STANDSTILL
    bench.run(0.02)
    bench.do("y", "move_absolute", target=7.0, **DYNAMICS)
    bench.settle()
    bench.do("y", "couple_cam", master="x", table=COSINE, slave_offset=7.0)
    bench.run(0.02)
    assert bench.state("y") == S.SYNCHRONIZED_MOTION


def test_cam_refusals() -> None:
    bench = SlaveBench()
    head = "axis y: couple_cam refused:"
    table = bench.denied("y", "couple_cam", master="x", table=[[0, 0], [1, 1]])
    assert table == f"P-ERR-23052 {head} a cam table needs 3 points or more, it has 2; nothing was changed"
    for name in ("master_scaling", "slave_scaling"):
        assert bench.denial("y", "couple_cam", master="x", table=COSINE, **{name: 0.0}) == refused(
            23043, argument=name, value=0.0
        )
    assert bench.denial("y", "change_cam", table=COSINE) == refused(23050)
    bench.do("y", "couple_cam", master="x", table=COSINE, cyclic=False)
    assert bench.denial("y", "change_cam", table=COSINE) == refused(23050)
    bench.do("z", "couple_cam", master="x", table=COSINE)
    assert bench.denial("z", "change_cam", table=[[0, 0], [1, 1], [1, 2]]) == refused(23052, position=1.0, before=1.0)


# files

FILES = {
    "": "1: column 'master' is missing; the first line must name master, slave",
    "master,slave,slave\n": "1: column 'slave' occurs twice; the first line must name master, slave",
    "master,slave\n0,0\n1\n": "3: '1' has 1 values instead of 2",
    "master,slave\n0,0\n1,x\n": "3: '1, x' are not two numbers",
    "master,slave\n0,0\n1,nan\n2,2\n": "3: '1, nan' are not two finite numbers",
    "master,slave\n0,0\n1,1\n1,2\n2,2\n": "4: master position 1 comes after 1; a cam table must ascend by 1e-06 or more",
    "master,slave\n0,0\n\n1,1\n": "4: a cam table needs 3 points or more, it has 2",
    "master,slave\n0,0\n1,1e13\n2,2\n": "4: the points of a cam table must lie within ±1e+12",
}


@pytest.mark.parametrize("text", FILES)
def test_bad_cam_file(text: str) -> None:
    with pytest.raises(CncError) as caught:
        parse_cam(text, "cam.csv")
    message = f"cam file cam.csv:{FILES[text]}; nothing was started"
    assert (caught.value.number, caught.value.message) == (25103, message)


def test_cam_file_of_a_scenario() -> None:
    entry = "- {at: 0, to: y, do: couple_cam, master: x, file: cam.csv}"
    kinds = {"x": "axis", "y": "axis"}
    entries = parse_scenario(
        entry, "s.yaml", kinds, lambda what, path: "\ufeffrow, slave, master\n1,5,0\n2,6,10\n3,7,20"
    )
    assert entries[0].command.arguments["table"] == [[0.0, 5.0], [10.0, 6.0], [20.0, 7.0]]
    with pytest.raises(ScenarioError) as caught:
        parse_scenario(entry, "s.yaml", kinds, lambda what, path: "master,slave\n0,0\n")
    text = "s.yaml:1: cam file cam.csv:2: a cam table needs 3 points or more, it has 1; nothing was started"
    assert caught.value.message == f"{text}\nnothing was started"
