"""Decoupling of slaves: at standstill and in every phase of the master, with a target, a velocity, an override."""

from __future__ import annotations

import numpy as np
import pytest
from error_support import Refused, refused
from long_support import long
from machine_support import PTP, assert_axis_smooth, machine
from slave_support import (
    COMPENSATION,
    DYNAMICS,
    HAS_JOB,
    PROTECTED,
    STOPPED,
    A,
    D,
    J,
    SlaveBench,
    assert_linear,
    axes_named,
)

from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.blocks import Command


def moving(factor: float = 0.5, *, target: float = 20_000.0, seconds: float = 1.0, **kwargs: object) -> SlaveBench:
    """x runs to `target` at 2000 mm/s (reached after 0.5 s), y is its slave, z the slave of y with factor -2."""
    bench = SlaveBench(**kwargs)  # type: ignore[arg-type]
    bench.send_all(
        [
            ("y", "couple", {"master": "x", "factor": factor}),
            ("z", "couple", {"master": "y", "factor": -2.0}),
            ("x", "move_absolute", {"target": target, **DYNAMICS}),
        ]
    )
    bench.run(seconds - 0.01)
    return bench


def velocity(bench: SlaveBench, axis: str = "y") -> float:
    return float(bench.last(axis).set_velocity[-1])


def assert_smooth(bench: SlaveBench, axis: str = "y") -> None:
    assert_axis_smooth(bench.blocks[axis], acceleration=A, jerk=J)


def test_at_standstill_the_slave_is_a_master_again() -> None:
    bench = SlaveBench()
    bench.do("y", "couple", master="x", factor=0.5)
    assert bench.do("y", "decouple") == ""
    assert bench.state("y") == S.STANDSTILL and not bench.bits("y", PROTECTED)[-1] and bench.last("y").master == ""
    bench.send_all([("x", "move_absolute", {"target": 100.0}), ("y", "move_absolute", {"target": 30.0})])
    bench.settle()
    assert (bench.position("x"), bench.position("y")) == (100.0, 30.0)


@pytest.mark.parametrize(
    ("arguments", "unused"),
    [
        ({"target": 5.0}, "target 5"),
        ({"velocity": 7.5}, "velocity 7.5"),
        ({"target": 5.0, "velocity": 7.5}, "target 5 and velocity 7.5"),
    ],
)
def test_at_standstill_target_and_velocity_are_not_used(arguments: dict[str, float], unused: str) -> None:
    bench = SlaveBench()
    bench.do("y", "couple", master="x", factor=0.5)
    assert bench.do("y", "decouple", **arguments) == (
        f"P-WARN-23057 axis y: decouple: the axis is at a standstill; {unused} is not used, start it"
    )
    bench.run(0.1)
    assert bench.state("y") == S.STANDSTILL and set(bench.column("y", "set_position")) == {0.0}


def test_while_override_0_holds_the_master_the_slave_is_decoupled_offline() -> None:
    bench = moving()
    bench.send("x", "set_override", percent=0.0)
    bench.run(1.0)
    bench.do("y", "decouple")
    assert bench.state("y") == S.STANDSTILL
    bench.send("x", "set_override", percent=100.0)
    bench.settle()
    assert velocity(bench) == 0.0 and bench.position("x") == 20_000.0 and bench.position("y") < 2000.0


PHASES = {
    "jerk up": 0.05,
    "ramp": 0.25,
    "last jerk up": 0.45,
    "constant": 0.75,
    "brakes": 1.05,
    "brake ramp": 1.25,
    "last jerk": 1.45,
}


@pytest.mark.parametrize("factor", [-0.25, *long([1.0, 0.5, -1.0])])
@pytest.mark.parametrize("phase", PHASES)
def test_in_every_phase_of_the_master(phase: str, factor: float) -> None:
    """Continues with v + a·|a|/2J, the velocity that is left when its own jerk has taken the acceleration out."""
    bench = moving(factor, target=2000.0, seconds=PHASES[phase])
    cycle = bench.cycle
    bench.do("y", "decouple")
    v, a = bench.values("y", "set_velocity")[cycle], bench.values("y", "set_acceleration")[cycle]
    left = v + a * abs(a) / (2.0 * J)
    if left * v < 0.0 or abs(left) < 0.1:
        left = 0.0
    bench.run(1.0)
    assert velocity(bench) == pytest.approx(left, abs=1e-6)
    assert bench.state("y") == (S.CONTINUOUS_MOTION if left else S.STANDSTILL)
    assert bench.bits("y", HAS_JOB)[-1] == bool(left) and not bench.bits("y", PROTECTED)[-1]
    if left:
        assert bench.do("y", "stop") == ""
        assert bench.bits("y", STOPPED)[-1]
    bench.run(1.0)
    assert bench.state("y") == S.STANDSTILL and bench.position("x") == 2000.0
    assert_smooth(bench)
    assert_linear(bench, "y", "z", -2.0)


@pytest.mark.long
@pytest.mark.parametrize("factor", [1.0, -0.7, 3.0])
@pytest.mark.parametrize("target", [1000.0, 1000.0137])
def test_no_slave_creeps_on_after_the_very_end_of_its_master(factor: float, target: float) -> None:
    """Decoupled in each of the last cycles: what the end within a cycle seems to leave is no velocity."""
    for early in range(4):
        bench = moving(factor, target=target, seconds=0.02, machine=axes_named("x", "y", "z", block_cycles=1))
        total = bench.units["x"]._axis.ptp._profile.duration
        while bench.cycle < int(total / 0.001) + 2 - early:
            bench.tick()
        bench.do("y", "decouple")
        for _ in range(100):
            bench.tick()
        assert abs(velocity(bench)) == 0.0 and bench.state("y") == S.STANDSTILL
        assert bench.position("y") == pytest.approx(factor * target, abs=2e-3)


def test_the_manuals_figure_decouple_slave_stop_master_stop() -> None:
    bench = moving(0.5)
    bench.do("y", "decouple")
    bench.run(1.0)
    assert velocity(bench) == 1000.0
    bench.do("y", "stop")
    bench.run(1.0)
    assert (velocity(bench), velocity(bench, "x")) == (0.0, 2000.0)
    bench.do("x", "stop")
    bench.settle()
    coupled, alone, braked = 0.5 * (500.0 + 1000.0), 1010.0, 150.0
    assert bench.position("y") == pytest.approx(coupled + alone + braked)
    assert bench.errors() == []


@pytest.mark.parametrize("command", ["halt", "stop", "emergency_stop"])
def test_a_pseudo_master_is_stopped_on_its_own(command: str) -> None:
    bench = moving()
    bench.do("y", "decouple")
    bench.do("y", command, **({"deceleration": 20_000.0, "jerk": 500_000.0} if command == "emergency_stop" else {}))
    bench.run(1.0)
    assert velocity(bench) == 0.0 and bench.state("y") == S.STANDSTILL and velocity(bench, "x") == 2000.0


# target


@pytest.mark.parametrize("phase", PHASES)
@pytest.mark.parametrize("target", [-500.0, *long([4000.0, 700.0, 3.0])])
def test_a_new_target_in_and_against_the_direction(target: float, phase: str) -> None:
    """Reached exactly and without a step, from every phase of the master."""
    bench = moving(0.75, target=2000.0, seconds=PHASES[phase])
    assert bench.do("y", "decouple", target=target) == ""
    assert bench.state("y") == S.DISCRETE_MOTION
    bench.settle()
    assert bench.position("y") == target and bench.state("y") == S.STANDSTILL
    assert bench.bits("y", 1 << 4)[-1], "in target position"
    assert_smooth(bench)
    assert_linear(bench, "y", "z", -2.0)
    assert np.abs(bench.values("y", "set_velocity")).max() <= 1500.0 * (1 + 1e-9)


def test_the_three_figures_of_the_manual() -> None:
    for factor, target in ((0.8, 5000.0), (-0.8, -5000.0), (0.75, -1000.0)):
        bench = moving(factor)
        bench.do("y", "decouple", target=target)
        bench.settle()
        assert bench.position("y") == target and bench.position("x") == 20_000.0
        assert_smooth(bench)


def test_a_target_can_come_later_too() -> None:
    bench = moving()
    bench.do("y", "decouple")
    bench.run(0.5)
    bench.do("y", "new_velocity_and_target", velocity=500.0, target=3000.0, activation_position=0.0)
    assert bench.state("y") == S.DISCRETE_MOTION
    bench.settle()
    assert bench.position("y") == 3000.0
    assert_smooth(bench)


@pytest.mark.parametrize(
    ("arguments", "wanted"),
    [
        ({"target": 600.0}, refused(120002, target=600.0, limit=500.0)),
        ({"target": -600.0}, refused(120003, target=-600.0, limit=-500.0)),
        ({"velocity": 0.0}, refused(23003, argument='velocity', value=0.0)),
        ({"velocity": -5.0}, refused(23003, argument='velocity', value=-5.0)),
        ({"velocity": 1e5}, refused(23004, velocity=100000.0, limit=10000.0)),
        ({"target": float("nan")}, refused(22001, argument='target')),
    ],
)  # fmt: skip
def test_a_refused_decoupling_leaves_the_slave_coupled(arguments: dict[str, float], wanted: Refused) -> None:
    limits = {"soft_limit_negative": -500.0, "soft_limit_positive": 500.0}
    bench = moving(seconds=0.5, machine=machine(PTP, y=limits))
    assert bench.denial("y", "decouple", **arguments) == wanted
    bench.run(0.05)
    assert bench.state("y") == S.SYNCHRONIZED_MOTION and bench.bits("y", PROTECTED)[-1]
    assert_linear(bench, "x", "y", 0.5)


# velocity and override


@pytest.mark.parametrize("phase", PHASES)
@pytest.mark.parametrize("wanted", [1700.0, *long([100.0])])
def test_a_new_velocity(wanted: float, phase: str) -> None:
    bench = moving(-0.5, target=2000.0, seconds=PHASES[phase])
    assert bench.do("y", "decouple", velocity=wanted) == ""
    bench.run(1.5)
    assert velocity(bench) == pytest.approx(-wanted) and bench.state("y") == S.CONTINUOUS_MOTION
    bench.do("y", "set_override", percent=50.0)
    bench.run(1.0)
    assert velocity(bench) == pytest.approx(-0.5 * wanted)
    assert_smooth(bench)


@pytest.mark.parametrize("kind", [1, 2, 3, 4])
def test_override_refers_to_the_factor_times_the_masters_target_velocity(kind: int) -> None:
    """The master runs at 30 % when y is decoupled: 30 % stay until an override comes, 100 % of 1500 mm/s then."""
    bench = moving(-0.75, target=60_000.0)
    bench.do("y", "set_override_type", type=kind)
    bench.send("x", "set_override", percent=30.0)
    bench.run(1.0)
    bench.do("y", "decouple")
    bench.run(1.0)
    assert velocity(bench) == pytest.approx(-450.0)
    for percent in (100.0, 20.0, 0.0, 60.0):
        bench.do("y", "set_override", percent=percent)
        bench.run(1.0)
        assert velocity(bench) == pytest.approx(-15.0 * percent)
        assert bench.state("y") == S.CONTINUOUS_MOTION
    assert velocity(bench, "x") == pytest.approx(600.0)
    assert_smooth(bench)


def test_override_refers_to_the_target_velocity_while_a_compensation_made_the_slave_faster() -> None:
    bench = moving(1.0)
    bench.do("y", "compensation_start", **COMPENSATION)
    bench.run(1.0)
    fast = velocity(bench)
    assert fast > 2100.0
    bench.do("y", "decouple")
    bench.run(1.0)
    assert velocity(bench) == pytest.approx(fast, abs=1e-6), "the velocity of the compensation is kept permanently"
    bench.do("y", "set_override", percent=50.0)
    bench.run(1.0)
    assert velocity(bench) == pytest.approx(1000.0)


@pytest.mark.parametrize("compensating", ["x", "y"])
def test_a_compensation_is_never_completed_after_decoupling(compensating: str) -> None:
    """Of the slave itself or of its master: the velocity of that moment stays; the bit goes."""
    bench = moving(1.0)
    bench.do(compensating, "compensation_start", **COMPENSATION)
    bench.run(0.6)
    before = velocity(bench)
    assert 2200.0 < before <= 2300.0
    bench.do("y", "decouple")
    bench.run(4.0)
    assert velocity(bench) == pytest.approx(before, abs=0.6), "at most one cycle of the compensation's ramp further"
    assert not bench.bits("y", 1 << 13)[-1]
    p, v = bench.values("y"), bench.values("y", "set_velocity")
    assert np.abs(np.diff(v)).max() <= 0.001 * (A + 500.0)
    assert np.abs(np.diff(p) - 0.0005 * (v[1:] + v[:-1])).max() < 1e-4


@pytest.mark.parametrize("seconds", [0.3, *long([0.1, 0.6])])
def test_decoupling_during_the_ramps_of_a_compensation_with_a_target(seconds: float) -> None:
    bench = moving(1.0)
    bench.do("y", "compensation_start", **{**COMPENSATION, "difference": -500.0})
    bench.run(seconds)
    bench.do("y", "decouple", target=9000.0)
    bench.settle()
    assert bench.position("y") == 9000.0


def test_on_the_way_to_a_target_the_velocity_of_a_compensation_stays() -> None:
    bench = moving(1.0)
    bench.do("y", "compensation_start", **COMPENSATION)
    bench.run(1.0)
    fast = velocity(bench)
    assert fast > 2200.0
    bench.do("y", "decouple", target=15_000.0)
    bench.run(1.0)
    assert velocity(bench) == pytest.approx(fast, abs=1e-6)
    bench.settle()
    assert bench.position("y") == 15_000.0


# cascade


@pytest.mark.parametrize("gone", ["a1", "a4", *long(["a2", "a3"])])
def test_anywhere_in_a_cascade(gone: str) -> None:
    """Above the one that goes all follow the master, below it all follow the pseudo master."""
    names = ["a0", "a1", "a2", "a3", "a4"]
    factors = dict(zip(names[1:], (0.5, -1.5, 0.8, -0.9), strict=True))
    bench = SlaveBench(machine=axes_named("a3", "a0", "a4", "a1", "a2"))
    masters = dict(zip(names[1:], names, strict=False))
    bench.send_all([(s, "couple", {"master": masters[s], "factor": f}) for s, f in reversed(factors.items())])
    bench.send("a0", "move_absolute", target=20_000.0, **DYNAMICS)
    bench.run(1.0)
    bench.do(gone, "decouple")
    decoupled = bench.cycle
    bench.run(0.2)
    bench.do(gone, "stop")
    bench.settle()
    for slave, factor in factors.items():
        assert_linear(bench, masters[slave], slave, factor, end=decoupled - 10 if slave == gone else None)
    assert bench.position("a0") == 20_000.0
    assert bench.errors() == [] and bench.state(gone) == S.STANDSTILL
    bench.do(gone, "couple", master="a0", factor=1.0)


def test_a_slave_of_a_pseudo_master_is_decoupled_too() -> None:
    bench = moving()
    bench.do("y", "decouple")
    bench.do("z", "decouple")
    bench.do("y", "stop")
    bench.run(1.0)
    assert (velocity(bench, "z"), velocity(bench), velocity(bench, "x")) == (-2000.0, 0.0, 2000.0)
    bench.do("z", "set_override", percent=25.0)
    bench.run(1.0)
    assert velocity(bench, "z") == pytest.approx(-500.0)


def test_a_slave_that_is_faster_than_its_axis_may_be_comes_down_for_a_target_or_an_override() -> None:
    """5 · 2000 mm/s are above 8000 mm/s: as a slave it is the user's business, an own positioning keeps P-AXIS-00212."""
    bench = moving(5.0, machine=machine(PTP, y={"max_velocity": 8000.0}))
    bench.do("y", "decouple", target=40_000.0)
    bench.run(1.5)
    assert velocity(bench) == pytest.approx(8000.0)
    bench.settle()
    assert bench.position("y") == 40_000.0


def test_a_pseudo_master_at_its_soft_limit_stops_with_an_error() -> None:
    bench = moving(machine=machine(PTP, y={"soft_limit_positive": 2000.0}))
    bench.do("y", "decouple")
    bench.settle()
    y = bench.values("y")
    assert bench.errors()[0] == (
        f"P-ERR-120002 axis y: set position {y[y > 2000.0][0]} mm is beyond the positive soft limit 2000.0 mm "
        "(P-AXIS-00178); the axis stops on its own ramp (ErrorStop)"
    )
    assert bench.position("x") == 20_000.0, "the former master is of another group"
    assert bench.state("z") == S.ERROR_STOP, "the slave of the pseudo master is of its group"


def test_power_off_and_on_of_a_pseudo_master() -> None:
    bench = moving()
    bench.do("y", "decouple")
    bench.do("y", "power", enabled=False)
    assert bench.state("y") == S.STOPPING
    bench.run(1.0)
    assert bench.state("y") == S.DISABLED
    bench.do("y", "power", enabled=True)
    bench.do("y", "move_absolute", target=0.0)
    bench.settle()
    assert bench.position("y") == 0.0 and bench.errors() == []


def test_a_run_that_only_an_endless_pseudo_master_keeps_going_is_ended() -> None:
    """A modulo axis meets no soft limit; 10 s after the end of everything else it is stopped, and the run has failed."""
    scenario = f"""
- {{at: 0, to: c, do: couple, master: x, factor: 1}}
- {{at: 0, to: "y", do: couple, master: c, factor: -0.5}}
- {{at: 0, to: x, do: move_absolute, target: 2000, {D}}}
- {{at: 0.7, to: c, do: decouple}}
"""
    bench = SlaveBench(scenario, end_when_idle=True)
    for outputs in bench.offline.run():
        bench._take(outputs)
        assert bench.cycle < 20_000
    assert bench.errors() == [
        "P-ERR-22014 plc plc: axis c moves endlessly, but the scenario is finished; everything is stopped and the run ends"
    ]
    assert bench.failed and not bench.last("c").set_velocity[-1] and bench.position("x") == 2000.0
    assert_linear(bench, "c", "y", -0.5)


@pytest.mark.parametrize("together", [True, False], ids=["same block", "next block"])
def test_stop_all_stops_a_slave_that_is_just_being_decoupled(together: bool) -> None:
    bench = moving()
    bench.units["plc"].input(Command("y", "decouple", {}))
    if not together:
        bench.tick()
    bench.give("plc", "stop_all")
    bench.settle()
    assert [bench.state(axis) for axis in "xyz"] == [S.STANDSTILL, S.STANDSTILL, S.SYNCHRONIZED_MOTION]
    assert bench.errors() == [] and bench.refusals() == []
    assert_linear(bench, "y", "z", -2.0)
