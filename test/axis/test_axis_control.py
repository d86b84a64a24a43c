"""Feedforward, friction compensation and following errors of an axis unit; the fast and the slow computation agree."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from axis_control_support import (
    BOTH,
    COMPENSATED,
    CONVENTIONAL,
    MECHANICS,
    control_bench,
    control_of,
    move,
    plain_control,
)
from error_support import refused
from long_support import long, long_sets
from loop_support import KV, PLANT, TA, BlockedDrive, feedforward
from machine_support import CYCLE_TIME, MILL, UnitBench, changed

from cnc_ptp.axis.axis_unit import AxisUnit
from cnc_ptp.axis.monitoring import Monitoring
from cnc_ptp.parameters.view.control_view import ControlParameters, LagMonitoring
from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.axis_states import StatusBit
from cnc_ptp.protocol.blocks import CycleTick, EventValue, Severity

# ---------------------------------------------------------------- what a user sees


def test_feedforward_takes_the_lag_away_while_the_axis_moves() -> None:
    """200 mm/s at Kv 50/s lag 4 mm; G135 in motion, then nothing; G136 50: half."""
    bench = control_bench(plain_control(CONVENTIONAL))
    move(bench, 800.0)
    bench.run(500)
    assert bench.column("following_error")[-1] == pytest.approx(200.0 / KV, abs=1e-6)
    assert bench.accepted("set_feedforward", enabled=True) == ""
    bench.run(500)
    assert bench.column("following_error")[-1] == pytest.approx(0.0, abs=1e-6)
    bench.accepted("set_feedforward", weight_percent=50)
    bench.run(500)
    assert bench.column("following_error")[-1] == pytest.approx(0.5 * 200.0 / KV, abs=1e-6)
    assert bench.column("feedforward_velocity")[-1] == pytest.approx(100.0, abs=1e-9)
    bench.accepted("reset_feedforward")
    bench.run(500)
    assert bench.column("following_error")[-1] == pytest.approx(200.0 / KV, abs=1e-6)
    actual = np.diff(bench.column("actual_velocity")) / 0.001
    assert np.abs(actual).max() <= 4000.0


@pytest.mark.parametrize("selected_first", [True, False])
@pytest.mark.parametrize("delay", [0, 4])
@pytest.mark.parametrize("mode", [CONVENTIONAL, BOTH])
@pytest.mark.parametrize(("target", "jerk"), [(-0.2, 2_000_000.0), *long_sets([(5.0, 40_000.0)])])
def test_feedforward_selected_in_the_cycle_of_a_start_is_there_at_once(
    mode: int, delay: int, target: float, jerk: float, selected_first: bool
) -> None:
    """In either order, after a motion before it, with and without a delay line: as if it had been on for long."""
    lookahead = replace(COMPENSATED, reversal_lookahead=delay, active=False)
    benches = [
        control_bench(control_of(plant=PLANT, of_feedforward=feedforward(mode), friction=lookahead)) for _ in "12"
    ]
    for bench, enabled in zip(benches, (True, False), strict=True):
        bench.accepted("set_feedforward", enabled=enabled)
        move(bench, 3.0)
        bench.run(1000)
        if not enabled and selected_first:
            bench.accepted("set_feedforward", enabled=True)
        move(bench, target, jerk=jerk)
        if not enabled and not selected_first:
            bench.accepted("set_feedforward", enabled=True)
        bench.run(300)
    long_on, together = (np.array(bench.column("following_error"))[1000:] for bench in benches)
    assert benches[1].column("feedforward_percent")[1000:] == [100.0] * 300
    assert together == pytest.approx(long_on, abs=1e-9)


def test_lags_of_a_ptp_motion() -> None:
    """v/Kv and a·Ta/Kv in a motion that the axis plans itself."""
    for mode, lag in ((0x1, 1000.0 * TA / KV), (CONVENTIONAL, 0.0)):
        bench = control_bench(plain_control(mode))
        bench.accepted("set_feedforward", enabled=True)
        move(bench, 900.0, velocity=480.0, acceleration=1000.0, jerk=400_000.0)
        bench.run(450)
        assert bench.column("set_acceleration")[-1] == 1000.0
        assert bench.column("following_error")[-1] == pytest.approx(lag, abs=1e-6)


@pytest.mark.parametrize("target", [-100.0, -37.7, -3.3, -0.5])
def test_what_velocity_and_acceleration_feedforward_leave_of_a_whole_motion(target: float) -> None:
    """z of the mill without encoder: j T²/(12 Kv) of a held command, and Ta j T²/2 where the jerk changes in a cycle.

    Not below 1e-6 mm: that holds at constant velocity and acceleration (test_control_loop_lags.py).
    """
    z = changed(MILL.axes["z"], encoder_increment=0.0)
    bench = UnitBench(AxisUnit(z, cycle_time=CYCLE_TIME))
    bench.accepted("set_feedforward", enabled=True)
    bench.accepted(
        "move_absolute", target=target, velocity=200.0, acceleration=1500.0, deceleration=1700.0, jerk=z.jerk
    )
    bench.run(2500)
    error = np.abs(bench.column("following_error"))
    jerk_in_a_cycle = z.jerk * CYCLE_TIME**2
    assert 5e-5 < error.max() < jerk_in_a_cycle * (1.0 / (12.0 * KV) + TA / 2.0) < 1.2e-4
    assert error[-1] < 1e-6 and bench.column("set_position")[-1] == target


def test_refusals_and_warnings_of_the_unit() -> None:
    bench = control_bench(plain_control())
    assert bench.accepted("set_feedforward", enabled=True) == (
        "axis x: feedforward without effect, P-AXIS-00223 (vorsteuer.vorsteuerung) is NONE"
    )
    assert bench.refusal("set_feedforward", weight_percent=-0.5) == refused(23060, weight_percent=-0.5)
    assert bench.refusal("set_friction_compensation", enabled=True) == refused(70495)
    assert bench.refusal("set_feedforward", enabled="yes") == refused(22001, argument="enabled")
    bench.run(10)
    assert [event.severity for event in bench.events] == [Severity.WARNING] * 3


# ---------------------------------------------------------------- following errors


def monitored(kind: int, **changes: Any) -> LagMonitoring:
    of = LagMonitoring(kind=kind, moving_limit=1.0, standstill_limit=0.2, dynamic=960, filter_time=0.0)
    return replace(of, **changes)


@pytest.mark.parametrize("filter_time", [0.0, 0.004])
def test_a_following_error_on_the_way(filter_time: float) -> None:
    bench = control_bench(plain_control(monitoring=monitored(4, filter_time=filter_time)), drive=BlockedDrive())
    move(bench, 100.0)
    bench.run(1000)
    cycle, position = bench.events[0].cycle, bench.column("set_position")
    assert bench.event_texts() == [
        f"P-ERR-17744 axis x: following error {position[cycle]:.4f} mm exceeds 1.0 mm (P-AXIS-00168); the axis stops on "
        "its own ramp (ErrorStop)"
    ]
    first = next(k for k, x in enumerate(position) if abs(x) > 1.0)
    assert cycle == first + round(filter_time / 0.001)
    assert bench.column("state")[cycle] == S.ERROR_STOP and bench.column("set_velocity")[-1] == 0.0


@pytest.mark.parametrize(
    ("monitoring", "source", "limit"),
    [
        (monitored(2, moving_limit=1e-9, dynamic=0), "P-AXIS-00167, linear", lambda v, _: v / KV),
        (monitored(2, moving_limit=50.0, dynamic=0), "P-AXIS-00168", lambda v, _: 50.0),
        (monitored(1, standstill_limit=1e-9, dynamic=0), "P-AXIS-00167, estimated", lambda v, _: v * 0.001),
        (monitored(1, dynamic=512), "P-AXIS-00169", lambda v, _: 0.2),
    ],
)
def test_texts_name_the_parameter_that_has_set_the_limit(
    monitoring: LagMonitoring, source: str, limit: Callable[[float, float], float]
) -> None:
    bench = control_bench(plain_control(monitoring=monitoring), drive=BlockedDrive())
    move(bench, 100.0)
    bench.run(400)
    cycle = bench.events[0].cycle
    x, v = bench.column("set_position")[cycle], bench.column("set_velocity")[cycle]
    assert bench.event_texts() == [
        f"P-ERR-17744 axis x: following error {x:.4f} mm exceeds {round(limit(v, x), 4)} mm ({source}); the axis stops "
        "on its own ramp (ErrorStop)"
    ]


def test_a_standing_axis_that_is_pushed_out_of_place() -> None:
    """P-AXIS-00169 counts from 5/Kv = 100 ms after the end of the motion on."""
    bench = control_bench(plain_control(monitoring=monitored(4, moving_limit=5.0)), drive=BlockedDrive())
    move(bench, 0.5)
    bench.run(1000)
    end = next(k for k in range(1, 1000) if bench.column("set_velocity")[k] == 0.0)
    assert bench.event_texts() == [
        "P-ERR-17744 axis x: following error 0.5000 mm exceeds 0.2 mm (P-AXIS-00169); the axis stops on its own ramp "
        "(ErrorStop)"
    ]
    event = bench.events[0]
    assert event.cycle == pytest.approx(end + 100, abs=1)
    assert event.limit == EventValue("limit", 0.2, "mm", "limit")
    assert event.actual == EventValue("following_error", pytest.approx(0.5, abs=5e-5), "mm", "actual")


def test_behind_a_delay_line_the_text_has_the_error_of_the_position_controller() -> None:
    """4 cycles of shift_time at 200 mm/s are 0.8 mm, and no following error."""
    of_feedforward = feedforward(CONVENTIONAL, lead_cycles=4, always_active=True)
    control = replace(plain_control(monitoring=monitored(4)), feedforward=of_feedforward)
    bench = control_bench(control, drive=BlockedDrive())
    move(bench, 100.0)
    bench.run(400)
    cycle, position = bench.events[0].cycle, bench.column("set_position")
    first = next(k for k, x in enumerate(position) if x > 1.0)
    assert cycle == first + 4
    assert bench.event_texts() == [
        f"P-ERR-17744 axis x: following error {position[first]:.4f} mm exceeds 1.0 mm (P-AXIS-00168); the axis stops on "
        "its own ramp (ErrorStop)"
    ]


# ---------------------------------------------------------------- the same bits


CONTROLS: dict[str, Callable[[], ControlParameters]] = {
    "everything": control_of,
    "everything under torque": lambda: control_of("torque"),
    "lead, delays, prefilter": lambda: control_of(
        "lag",
        of_feedforward=feedforward(
            BOTH, lead_cycles=3, velocity_delay=0.0016, acceleration_delay=0.0003, prefilter_cycles=4
        ),
    ),
    "conventional in front of a position drive": lambda: control_of(
        "position", of_feedforward=feedforward(CONVENTIONAL)
    ),
    "monitored": lambda: plain_control(
        CONVENTIONAL, monitoring=monitored(1, moving_limit=12.0, dynamic=1000, filter_time=0.003)
    ),
    "friction alone": lambda: control_of(of_feedforward=feedforward(0), plant=replace(MECHANICS, backlash=0.01)),
    "coarse encoder": lambda: control_of(plant=replace(MECHANICS, encoder_increment=0.01)),
}

SCRIPT: list[tuple[int, str, dict[str, Any]]] = [
    (0, "set_feedforward", {"enabled": True}),
    (70, "move_absolute", {"target": 90.0, "velocity": 200.0, "acceleration": 2000.0, "jerk": 40_000.0}),
    (210, "set_feedforward", {"weight_percent": 60.0}),
    (280, "set_override", {"percent": 40.0}),
    (420, "new_target", {"target": -5.0}),
    (490, "set_friction_compensation", {"enabled": False}),
    (560, "set_feedforward", {"enabled": False}),
    (700, "set_override", {"percent": 100.0}),
    (1050, "set_friction_compensation", {"enabled": True}),
    (1120, "set_feedforward", {"enabled": True, "weight_percent": 100.0}),
    (1400, "move_absolute", {"target": 300.0, "velocity": 450.0, "acceleration": 4000.0, "jerk": 50_000.0}),
    (1610, "stop", {}),
    (1680, "power", {"enabled": False}),
    (2170, "power", {"enabled": True}),
    (2240, "move_absolute", {"target": 0.0, "velocity": 300.0, "acceleration": 3000.0, "jerk": 50_000.0}),
    (2590, "upstream_lost", {"source": "plc"}),
    (3150, "reset", {}),
]


def scripted(control: ControlParameters, count: int, *, slowly: bool = False) -> dict[str, list[Any]]:
    """All columns of a run in which the commands of `SCRIPT` come at their cycles, whatever the blocks."""
    if not control.friction.permitted:
        script = [entry for entry in SCRIPT if entry[1] != "set_friction_compensation"]
    else:
        script = SCRIPT
    bench = control_bench(control, count=count)
    if slowly:
        bench.unit._undisturbed_cycles = lambda *_: 0  # type: ignore[attr-defined]
    for cycle, command, arguments in script:
        bench.run(cycle - bench.cycle)
        bench.accepted(command, **arguments)
    bench.run(3500 - bench.cycle)
    assert bench.state == S.STANDSTILL
    return bench.columns()


def differing(ours: dict[str, list[Any]], theirs: dict[str, list[Any]]) -> list[str]:
    """Names and first cycles of columns that are not equal to the bit."""
    result = []
    for name, values in ours.items():
        pairs = zip(map(repr, values), map(repr, theirs[name]), strict=True)
        cycle = next((k for k, (a, b) in enumerate(pairs) if a != b), None)
        if cycle is not None:
            result.append(f"{name} at {cycle}")
    return result


@pytest.mark.interpreted
@pytest.mark.parametrize("name", CONTROLS)
def test_the_fast_way_is_the_slow_way(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """`_undisturbed_cycles` against `_cycle`, in states in which the one or the other is taken."""
    control = CONTROLS[name]()
    fast = scripted(control, 10)
    monkeypatch.setattr(Monitoring, "undisturbed", lambda *_: False)
    assert differing(fast, scripted(control, 10)) == []
    assert np.abs(fast["following_error"]).max() > 0.01


@pytest.mark.parametrize("count", [7, *long([1])])
@pytest.mark.parametrize("name", CONTROLS)
def test_the_size_of_the_blocks_changes_nothing(name: str, count: int) -> None:
    control = CONTROLS[name]()
    blocks_of_ten = scripted(control, 10)
    assert differing(blocks_of_ten, scripted(control, count)) == []


def test_a_fault_in_the_middle_of_a_block_is_at_the_same_cycle_in_all_blocks() -> None:
    """The fast computation stops before the following error that is too large, and the filter time has counted on."""
    columns = []
    for count in (1, 7, 10, 100):
        control = plain_control(CONVENTIONAL, monitoring=monitored(4, moving_limit=2.0, filter_time=0.013))
        bench = control_bench(control, count=count)
        move(bench, 300.0)
        bench.run(700)
        assert len(bench.events) == 1
        columns.append((bench.events[0].cycle, bench.columns()))
    for cycle, theirs in columns[1:]:
        assert cycle == columns[0][0] and differing(columns[0][1], theirs) == []


def test_feedforward_off_is_the_plain_axis_to_the_bit() -> None:
    def run(mode: int) -> UnitBench:
        bench = control_bench(plain_control(mode))
        move(bench, 300.0)
        bench.run(400)
        bench.accepted("stop")
        bench.run(600)
        return bench

    assert differing(run(0).columns(), run(CONVENTIONAL).columns()) == []


def test_a_virtual_axis_shows_its_setpoints() -> None:
    bench = control_bench(control_of("none", plant=PLANT, monitoring=monitored(4, moving_limit=1e-6)))
    bench.accepted("set_feedforward", enabled=True)
    move(bench, 300.0)
    bench.run(400)
    bench.accepted("power", enabled=False)
    bench.run(1000)
    assert bench.events == [] and bench.state == S.DISABLED
    assert bench.column("actual_position") == bench.column("set_position")
    assert set(bench.column("following_error")) == {0.0}


def test_feedforward_without_room_is_a_warning_with_number_and_text() -> None:
    bench = control_bench(plain_control(0x1))
    move(bench, 5000.0, velocity=500.0)
    bench.run(800)
    bench.accepted("set_feedforward", enabled=True)
    bench.run(2000)
    assert [event.severity for event in bench.events] == [Severity.WARNING]
    assert bench.event_texts() == [
        "P-ERR-23061 axis x: feedforward waits: at 500 mm/s there is no room up to 500 mm/s (P-AXIS-00212) to make up the "
        f"following error; {bench.last.feedforward_percent[-1]:g} % is active, the rest follows when the motion is slower"
    ]


def test_the_status_says_whether_friction_compensation_is_on() -> None:
    """In every mode in which cycles are computed: standing, moving, superimposed, without power."""
    bench = control_bench()
    bit = int(StatusBit.FRICTION_COMPENSATION)
    assert bit == 65536

    def shown(cycles: int) -> set[int]:
        bench.run(cycles)
        return {bits & bit for bits in bench.column("status_bits")[-cycles:]}

    assert shown(20) == {bit}
    move(bench, 50.0)
    assert shown(100) == {bit}
    bench.accepted("set_friction_compensation", enabled=False)
    assert shown(100) == {0}
    bench.run(1000)
    bench.accepted("set_friction_compensation", enabled=True)
    move(bench, 450.0)
    bench.accepted(
        "compensation_start",
        length=100.0,
        difference=5.0,
        process_velocity=200.0,
        velocity_increase=50.0,
        acceleration=500.0,
        deceleration=500.0,
    )
    assert shown(200) == {bit}
    bench.run(3500)
    bench.accepted("power", enabled=False)
    assert shown(20) == {bit}
    bench.accepted("set_friction_compensation", enabled=False)
    assert shown(20) == {0}
    assert control_bench(plain_control()).unit.step(CycleTick(0, 10), {}).status_bits[0] & bit == 0
