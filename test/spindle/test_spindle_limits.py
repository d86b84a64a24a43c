"""Limits of a tool: from standstill on, minimum in endless rotation only, back to those of the gear (2.8.5)."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from curve_support import CURVES, TOP, integrated
from error_support import Refused, refused
from machine_support import UnitBench, spindle_bench, spindle_parameters
from spindle_support import RPM, StuckDrive, bench_of

from cnc_ptp.protocol.spindle_states import SpindleBit


def with_limits(bench: UnitBench | None = None, **limits: float) -> UnitBench:
    bench = bench or spindle_bench()
    bench.accepted("set_limits", **limits)
    return bench


def test_limits_of_the_manuals_example() -> None:
    """Page 50: 60 to 3000 °/s (10 to 500 rpm), 3000 °/s²."""
    bench = with_limits(max_speed_rpm=500.0, min_speed_rpm=10.0, max_acceleration=3000)
    warning = bench.accepted("start", direction="cw", speed_rpm=800.0)
    assert warning == "P-WARN-24029 spindle s: speed 800.0 rpm is above the maximum of the tool, 500 rpm is used"
    bench.run(1200)
    column = bench.columns()
    assert column["set_speed_rpm"][-1] == 500.0 and column["speed_reached"][-1]
    assert set(column["set_acceleration_deg_s2"][:999]) == {3000.0}
    assert column["programmed_speed_rpm"][-1] == 800.0
    assert all(bits & SpindleBit.TOOL_LIMITS for bits in column["status_bits"])
    bench.accepted("stop")
    bench.run(500)
    assert bench.column("set_acceleration_deg_s2")[1300] == -3000.0


def test_the_minimum_counts_in_endless_rotation_only() -> None:
    bench = with_limits(min_speed_rpm=200.0)
    warning = bench.accepted("start", direction="ccw", speed_rpm=50.0)
    assert warning == "P-WARN-24029 spindle s: speed 50.0 rpm is below the minimum of the tool, 200 rpm is used"
    bench.run(100)
    assert bench.column("set_speed_rpm")[-1] == -200.0
    bench.accepted("stop")
    bench.run(200)
    bench.accepted("orient", position_deg=180.0, speed_rpm=20.0)
    bench.run(300)
    assert max(map(abs, bench.column("set_speed_rpm")[300:])) == pytest.approx(20.0)


def test_the_maximum_counts_in_a_homing() -> None:
    """Homing speed of the mill 60 rpm."""
    bench = with_limits(spindle_bench(zero_pulse=200.0, referenced_at_start=False), max_speed_rpm=40.0)
    bench.accepted("home")
    bench.run(1500)
    assert max(bench.column("set_speed_rpm")) == pytest.approx(40.0) and bench.column("referenced")[-1]
    bench.accepted("start", direction="ccw", speed_rpm=20.0)
    bench.run(100)
    bench.accepted("home")
    bench.run(1500)
    assert min(bench.column("set_speed_rpm")) == pytest.approx(-40.0)


def test_a_zero_pulse_that_does_not_come_at_the_speed_of_the_tool() -> None:
    bench = with_limits(bench_of(spindle_parameters(referenced_at_start=False), drive=StuckDrive()), max_speed_rpm=40.0)
    bench.accepted("home")
    bench.run(3300)
    assert bench.event_texts() == [
        "P-ERR-24010 spindle s: no zero pulse came in 720 deg at homing speed 240 deg/s (P-AXIS-00218); the spindle stops "
        "on its ramp (ErrorStop)"
    ]


def test_a_positioning_that_the_tool_makes_slower_says_so() -> None:
    bench = with_limits(max_speed_rpm=40.0)
    above = "is above the maximum of the tool, 40 rpm is used"
    assert (
        bench.accepted("orient", position_deg=90.0, speed_rpm=80.0) == f"P-WARN-24029 spindle s: speed 80 rpm {above}"
    )
    bench.run(500)
    assert bench.accepted("orient", position_deg=0.0) == f"P-WARN-24029 spindle s: speed 600 rpm {above}"
    bench.run(500)
    assert max(map(abs, bench.column("set_speed_rpm"))) == pytest.approx(40.0) and bench.column("in_position")[-1]
    assert bench.accepted("orient", position_deg=0.0, speed_rpm=40.0) == ""


def test_the_minimum_holds_under_the_override_but_0_stops() -> None:
    bench = with_limits(min_speed_rpm=200.0)
    bench.accepted("start", direction="cw", speed_rpm=300.0)
    bench.run(100)
    bench.accepted("set_override", percent=10.0)
    bench.run(100)
    assert bench.column("set_speed_rpm")[-1] == 200.0
    bench.accepted("set_override", percent=0.0)
    bench.run(100)
    assert bench.column("set_speed_rpm")[-1] == 0.0


def test_limits_are_taken_over_from_standstill() -> None:
    bench = spindle_bench()
    bench.accepted("start", direction="cw", speed_rpm=1000.0)
    bench.run(300)
    with_limits(bench, max_speed_rpm=600.0)
    bench.accepted("start", direction="cw", speed_rpm=1200.0)
    bench.run(300)
    assert bench.column("set_speed_rpm")[-1] == 1200.0
    bench.accepted("stop")
    bench.run(300)
    bench.accepted("start", direction="cw", speed_rpm=1200.0)
    bench.run(300)
    assert bench.column("set_speed_rpm")[-1] == 600.0


def test_reset_limits() -> None:
    bench = with_limits(max_speed_rpm=600.0)
    bench.accepted("reset_limits")
    bench.accepted("start", direction="cw", speed_rpm=1200.0)
    bench.run(300)
    assert bench.column("set_speed_rpm")[-1] == 1200.0
    assert not bench.column("status_bits")[-1] & SpindleBit.TOOL_LIMITS


def test_what_is_left_out_is_that_of_the_gear() -> None:
    bench = with_limits(max_acceleration=9000.0)
    bench.accepted("start", direction="cw", speed_rpm=3000.0)
    bench.run(2100)
    assert bench.column("set_speed_rpm")[-1] == 3000.0


@pytest.mark.parametrize(
    ("limits", "wanted"),
    [
        ({"max_speed_rpm": 0.0}, refused(24018, argument="max_speed_rpm", value=0.0, low=0.001 / 6.0, high=2e6 / 6.0)),
        ({"max_acceleration": 0.5}, refused(24018, argument="max_acceleration", value=0.5, low=1.0, high=100000000.0)),
        ({"min_speed_rpm": -0.5}, refused(24018, argument="min_speed_rpm", value=-0.5, low=0.0, high=2e6 / 6.0)),
        ({"min_speed_rpm": 500.0, "max_speed_rpm": 400}, refused(24018, low=500.0, high=400)),
    ],
)
def test_refused_limits(limits: dict[str, Any], wanted: Refused) -> None:
    bench = spindle_bench()
    assert bench.refusal("set_limits", **limits) == wanted
    bench.run(10)
    assert not bench.column("status_bits")[-1] & SpindleBit.TOOL_LIMITS


# ---------------------------------------------------------------- curves in the unit


@pytest.mark.parametrize("name", CURVES)
@pytest.mark.parametrize("most", [None, 7000.0])
def test_curve_controlled_acceleration_in_every_cycle(name: str, most: float | None) -> None:
    """Run-up and M05 against SciPy, 1e-9 relative; the tool cuts the curve."""

    bench = spindle_bench(curve=CURVES[name], max_speed=TOP)
    if most is not None:
        with_limits(bench, max_acceleration=most)
    bench.accepted("start", direction="cw", speed_rpm=TOP / RPM)
    times = np.arange(0, 9500) * 0.001
    speeds, ways, _ = integrated(CURVES[name], 0.0, TOP, times, most or float("inf"))
    bench.run(len(times))
    column = bench.columns()
    assert np.all(np.abs(np.array(column["set_speed_rpm"]) * RPM - speeds) <= 1e-9 * np.maximum(speeds, 10.0))
    assert np.all(np.abs(np.array(column["set_position_deg"]) - ways) <= 1e-9 * np.maximum(ways, 10.0))
    bench.accepted("stop")
    bench.run(9500)
    begin = bench.column("set_speed_rpm")[9500] * RPM
    speeds, _, _ = integrated(CURVES[name], begin, 0.0, times, most or float("inf"))
    down = np.array(bench.column("set_speed_rpm")[9500:]) * RPM
    assert np.all(np.abs(down - speeds) <= 1e-9 * np.maximum(speeds, 100.0))


def test_each_gear_has_its_curve_and_positioning_has_none() -> None:
    bench = spindle_bench(curve=CURVES["asynchronous"])
    bench.accepted("orient", position_deg=180.0, speed_rpm=300.0)
    bench.run(400)
    assert {abs(a) for a in bench.column("set_acceleration_deg_s2")} == {0.0, 36_000.0, 40_000.0}
