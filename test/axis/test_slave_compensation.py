"""Position compensation of slaves: the manual's figures, every axis of a cascade on its own, passed on to followers."""

from __future__ import annotations

import numpy as np
import pytest
from error_support import refused
from long_support import long
from machine_support import PTP, machine, position_after, seven_phases
from slave_support import COMPENSATING, COMPENSATION, DYNAMICS, A, J, SlaveBench, assert_linear

from cnc_ptp.protocol.axis_states import AxisStateCode as S


def running(
    *,
    factor: float = 1.0,
    begin: float = 0.0,
    target: float = 10_000.0,
    velocity: float = 2000.0,
    bench: SlaveBench | None = None,
) -> SlaveBench:
    """y starts at `begin` as the slave of x, z (factor -0.5) follows y; 1 s after the start of x."""
    bench = bench or SlaveBench()
    if begin:
        bench.do("y", "move_absolute", target=begin)
        bench.settle()
    bench.send_all(
        [
            ("z", "couple", {"master": "y", "factor": -0.5}),
            ("y", "couple", {"master": "x", "factor": factor}),
            ("x", "move_absolute", {"target": target, **DYNAMICS, "velocity": velocity}),
        ]
    )
    return bench.run(0.99)  # type: ignore[return-value]


def compensated(bench: SlaveBench, axis: str, master: str, factor: float) -> float:
    """How far the axis has left its master, mm."""
    p, m = bench.values(axis), bench.values(master)
    return float(p[-1] - factor * m[-1])


def trapezoid(length: float, difference: float, vp: float, vk: float, up: float, down: float) -> float:
    """What is compensated of D over the time L/VP (bisection for the peak; D > 0)."""
    time = length / vp
    low, high = 0.0, min(vk, time / (1.0 / up + 1.0 / down))

    def distance(v: float) -> float:
        return v * time - 0.5 * v * v * (1.0 / up + 1.0 / down)

    if distance(high) <= difference:
        return distance(high)
    for _ in range(200):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if distance(middle) < difference else (low, middle)
    return distance(low)


def test_the_slave_is_making_up() -> None:
    """Slave at -500 makes up 500 over 5000 mm: both end at 10000; z has it too, times its factor."""
    bench = running(begin=-500.0)
    assert bench.do("y", "compensation_start", **COMPENSATION) == ""
    bench.settle()
    assert bench.position("y") == pytest.approx(10_000.0, abs=1e-6) and bench.position("x") == 10_000.0
    assert_linear(bench, "y", "z", -0.5, -250.0, begin=bench.cycle - 4000)
    assert bench.position("z") == pytest.approx(-0.5 * 10_500.0, abs=1e-6)
    peak = (bench.values("y", "set_velocity") - bench.values("x", "set_velocity")).max()
    assert 200.0 < peak <= 300.0
    bits = bench.bits("y", COMPENSATING)
    assert bits.sum() == pytest.approx(2500, abs=2), "over the whole length: 5000 mm at 2000 mm/s"
    assert not bench.bits("x", COMPENSATING).any() and not bench.bits("z", COMPENSATING).any()


def test_the_slave_slows_down() -> None:
    """Slave at 500 falls back by 500: both end at 10000."""
    bench = running(begin=500.0)
    assert bench.do("y", "compensation_start", **{**COMPENSATION, "difference": -500.0}) == ""
    bench.settle()
    assert bench.position("y") == pytest.approx(10_000.0, abs=1e-6)
    assert bench.position("z") == pytest.approx(-0.5 * 9500.0, abs=1e-6)


def test_what_cannot_be_reached_is_cut_with_a_warning() -> None:
    bench = running()
    data = {**COMPENSATION, "length": 2000.0}
    reached = trapezoid(2000.0, 500.0, 2000.0, 300.0, 500.0, 1000.0)
    assert reached == pytest.approx(165.0)
    assert bench.do("y", "compensation_start", **data) == (
        "P-WARN-23023 axis y: compensation_start: difference 500 mm cannot be reached over 2000 mm; 165 mm is used"
    )
    bench.settle()
    assert compensated(bench, "y", "x", 1.0) == pytest.approx(165.0, abs=1e-6)


@pytest.mark.parametrize("factor", [0.5, -2.0, *long([1.0, -0.5])])
@pytest.mark.parametrize("difference", [200.0, -200.0])
def test_it_counts_along_the_motion_whatever_the_factor(factor: float, difference: float) -> None:
    """With a negative factor 'making up' is still more distance: away from where the slave comes from."""
    bench = running(factor=factor)
    speed = 2000.0 * abs(factor)
    data = {**COMPENSATION, "difference": difference, "process_velocity": speed, "length": 2.5 * speed}
    bench.do("y", "compensation_start", **data)
    bench.settle()
    assert compensated(bench, "y", "x", factor) == pytest.approx(np.sign(factor) * difference, abs=1e-6)


def test_every_axis_of_a_cascade_compensates_on_its_own_and_passes_it_on() -> None:
    bench = running()
    bench.send_all(
        [
            ("x", "compensation_start", {**COMPENSATION, "difference": 300.0}),
            ("y", "compensation_start", {**COMPENSATION, "difference": -200.0}),
            (
                "z",
                "compensation_start",
                {**COMPENSATION, "difference": 100.0, "process_velocity": 1000.0, "length": 2500.0},
            ),
        ]
    )
    bench.run(0.5)
    assert all(bench.bits(axis, COMPENSATING)[-1] for axis in "xyz")
    bench.settle()
    assert bench.position("x") == pytest.approx(10_300.0, abs=1e-6)
    # y and z run faster or slower than their process velocity in part of the time only: VP > v gives less, never more
    assert 10_100.0 <= bench.position("y") < 10_101.0
    assert compensated(bench, "z", "y", -0.5) == pytest.approx(-100.0, abs=6.0)
    assert bench.errors() == []


def test_velocities_of_compensations_in_a_cascade_add_up() -> None:
    """Manual 3.2.4, special note 4: at the peaks y runs at 2000 + 200 (of x) + 100 (its own)."""
    bench = running(target=20_000.0)
    data = {**COMPENSATION, "length": 10_000.0}
    bench.send_all(
        [
            ("x", "compensation_start", {**data, "difference": 900.0, "velocity_increase": 200.0}),
            ("y", "compensation_start", {**data, "difference": 450.0, "velocity_increase": 100.0}),
        ]
    )
    bench.run(2.0)
    x, y = bench.values("x", "set_velocity")[-1], bench.values("y", "set_velocity")[-1]
    assert 2150.0 < x <= 2200.0 and 75.0 < y - x <= 100.0


def test_below_the_process_velocity_less_is_compensated() -> None:
    """Override 50 % after the start: v/VP = 0.5 for the rest, D_real between D/2 and D."""
    bench = running(target=20_000.0)
    bench.send("x", "set_override", percent=50.0)
    bench.run(1.0)
    bench.do("y", "compensation_start", **COMPENSATION)
    bench.settle(30.0)
    assert compensated(bench, "y", "x", 1.0) == pytest.approx(250.0, abs=1e-6)


def test_override_0_of_the_master_freezes_it() -> None:
    bench = running()
    bench.do("y", "compensation_start", **COMPENSATION)
    bench.run(1.0)
    bench.send("x", "set_override", percent=0.0)
    bench.run(1.0)
    frozen = bench.position("y")
    bench.run(3.0)
    assert bench.position("y") == frozen and bench.bits("y", COMPENSATING)[-1]
    bench.send("x", "set_override", percent=100.0)
    bench.settle()
    gap = compensated(bench, "y", "x", 1.0)
    peak = (2.5 - np.sqrt(2.5**2 - 2 * 500.0 * 0.003)) / 0.003
    t = np.linspace(0.0, 0.8, 8001)
    phases = seven_phases(1e6, 2000.0, A, A, J)
    wanted = peak * np.array([position_after(phases, x)[1] for x in t]) / 2000.0
    speed = 500.0 * t + np.minimum.accumulate(wanted - 500.0 * t)  # AK+ = 500 lets it rise no faster
    lost = 0.25 * peak + np.trapezoid(peak - speed, t)
    assert speed[-1] == pytest.approx(peak) and lost > 0.5 * peak, "0.5 s down with v, whose mean is half, up later"
    assert gap == pytest.approx(500.0 - lost, abs=1e-3)
    assert not bench.bits("y", COMPENSATING)[-1]


@pytest.mark.parametrize("end", ["target", "stop"])
def test_the_end_of_the_masters_path_ends_it(end: str) -> None:
    bench = running(target=10_000.0 if end == "stop" else 4000.0)
    bench.do("y", "compensation_start", **COMPENSATION)
    bench.run(0.5)
    if end == "stop":
        bench.send("x", "stop")
    bench.settle()
    bench.run(0.1)
    gap = compensated(bench, "y", "x", 1.0)
    assert 50.0 < gap < 400.0 and not bench.bits("y", COMPENSATING)[-1]
    bench.send("x", "move_absolute", target=0.0)
    bench.settle()
    assert compensated(bench, "y", "x", 1.0) == pytest.approx(gap, abs=1e-9), "it does not continue automatically"
    bench.send("x", "move_absolute", target=10_000.0, **DYNAMICS)
    bench.run(1.0)
    assert bench.do("y", "compensation_start", **{**COMPENSATION, "difference": 100.0}) == ""
    bench.settle()
    assert compensated(bench, "y", "x", 1.0) == pytest.approx(gap + 100.0, abs=1e-6)


@pytest.mark.parametrize("seconds", [0.5, *long([0.1, 1.5])])
def test_stop_of_a_compensation_on_a_slave(seconds: float) -> None:
    bench = running()
    bench.do("y", "compensation_start", **COMPENSATION)
    bench.run(seconds)
    assert bench.do("y", "compensation_stop") == ""
    bench.run(0.5)
    assert not bench.bits("y", COMPENSATING)[-1]
    gap = compensated(bench, "y", "x", 1.0)
    bench.settle()
    assert compensated(bench, "y", "x", 1.0) == pytest.approx(gap, abs=1e-9) and 0.0 < gap < 500.0


def test_the_relation_holds_again_after_it() -> None:
    """slave = factor · master + offset, with the offset that the compensation has left; also during the return."""
    bench = running()
    bench.do("y", "compensation_start", **COMPENSATION)
    bench.settle()
    begin = bench.cycle
    bench.send("x", "move_absolute", target=-500.0, **DYNAMICS)
    bench.settle()
    y, x = bench.values("y"), bench.values("x")
    assert_linear(bench, "x", "y", 1.0, y[begin] - x[begin], begin=begin)
    assert_linear(bench, "y", "z", -0.5)
    bench.do("y", "decouple")
    bench.do("y", "move_absolute", target=0.0)
    bench.settle()
    assert bench.position("y") == 0.0


def test_a_factor_change_during_it() -> None:
    bench = running()
    bench.do("y", "compensation_start", **COMPENSATION)
    bench.run(1.0)
    bench.do("y", "set_coupling_factor", factor=0.9)
    p = bench.values("y")
    assert np.abs(np.diff(p[-20:])).max() < 2.4, "no step of the position"
    bench.settle()
    assert bench.errors() == [] and bench.state("y") == S.SYNCHRONIZED_MOTION
    assert_linear(bench, "y", "z", -0.5)


# refusals


def test_a_standing_slave_cannot_compensate() -> None:
    bench = SlaveBench()
    bench.do("y", "couple", master="x", factor=1.0)
    assert bench.denial("y", "compensation_start", **COMPENSATION) == refused(23021)


def test_no_second_start() -> None:
    bench = running()
    bench.do("y", "compensation_start", **COMPENSATION)
    assert bench.denial("y", "compensation_start", **COMPENSATION) == refused(23019)
    bench.do("z", "compensation_start", **COMPENSATION)


def test_the_velocity_limit_counts_for_slaves_too() -> None:
    bench = running(bench=SlaveBench(machine=machine(PTP, y={"max_velocity": 2200.0})))
    assert bench.denial("y", "compensation_start", **COMPENSATION) == refused(
        23004, velocity=2232.4081207560016, limit=2200.0
    )


def test_a_virtual_slave_cannot_compensate() -> None:
    bench = running(bench=SlaveBench(machine=machine(PTP, y={"virtual": True})))
    assert bench.denial("y", "compensation_start", **COMPENSATION) == refused(23022)


@pytest.mark.parametrize("factor", [1.0, -1.0])
def test_a_compensation_that_leads_out_of_the_soft_limits_ends_with_an_error(factor: float) -> None:
    limits = {"soft_limit_negative": -5200.0, "soft_limit_positive": 5200.0}
    bench = running(factor=factor, target=5100.0, bench=SlaveBench(machine=machine(PTP, y=limits)))
    bench.do("y", "compensation_start", **{**COMPENSATION, "length": 3000.0})
    bench.settle()
    assert bench.state("y") == bench.state("x") == S.ERROR_STOP
    sign, number, name = ("positive", 120002, "P-AXIS-00178") if factor > 0 else ("negative", 120003, "P-AXIS-00177")
    assert bench.errors()[0].startswith(f"P-ERR-{number} axis y: set position ")
    assert bench.errors()[0].endswith(
        f"mm is beyond the {sign} soft limit {factor * 5200.0} mm ({name}); the axis stops on its own ramp (ErrorStop)"
    )


def test_a_slave_whose_master_becomes_faster_never_gets_above_its_maximum() -> None:
    """1500 mm/s and 300 of the compensation; the master continues to 2100: 23036 at 2200, which is not exceeded."""
    bench = SlaveBench(machine=machine(PTP, y={"max_velocity": 2200.0}))
    bench.do("y", "couple", master="x", factor=1.0)
    bench.do("x", "move_absolute", target=20_000.0, velocity=1500.0)
    bench.run(1.0)
    values = {"length": 6000.0, "difference": 900.0, "process_velocity": 1500.0, "velocity_increase": 300.0}
    bench.do("y", "compensation_start", acceleration=2000.0, deceleration=2000.0, **values)
    bench.run(0.5)
    bench.do("x", "new_velocity_and_target", velocity=2100.0, target=20_000.0, activation_position=0.0)
    bench.settle()
    text = bench.errors()[0]
    assert text.startswith("P-ERR-23036 axis y: the superimposed motions would add up to 220")
    v = bench.values("y", "set_velocity")
    assert 2190.0 < np.abs(v).max() <= 2200.0
    assert (np.abs(np.diff(v)) <= 7000.0 * 0.001 * (1.0 + 1e-9)).all()
