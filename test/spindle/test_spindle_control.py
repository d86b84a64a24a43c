"""Control loop of a spindle: limits of the following error by type and gear, modulo compensation, drives, block sizes."""

from __future__ import annotations

from typing import Any

import pytest
from long_support import long
from loop_support import feedforward
from machine_support import UnitBench, spindle_bench, spindle_parameters
from spindle_support import RPM, StuckDrive, bench_of, first_cycle, two_gears

from cnc_ptp.parameters import load_machine
from cnc_ptp.parameters.view.control_view import ADD_VEL, VEL, ModuloError
from cnc_ptp.protocol.axis_states import AxisStateCode as S

KV = 50.0
SETTLING = 100
"""Cycles of 5/Kv."""
ENDING = "; the spindle stops on its ramp (ErrorStop)"


def watched(kind: int, *, stuck: bool = True, **changes: Any) -> tuple[UnitBench, StuckDrive]:
    """A spindle with type `kind` of monitoring, 10° moving and 2° standing unless changed."""
    drive = StuckDrive(stuck=stuck)
    limits = {"following_error_limit": 10.0, "standstill_limit": 2.0, **changes}
    return bench_of(spindle_parameters(monitoring=kind, **limits), drive=drive), drive


def push(drive: StuckDrive, distance: float) -> None:
    """Something turns the standing spindle, which does not get back."""
    drive.stuck = True
    drive._true_position += distance


@pytest.mark.parametrize("filter_time", [0.0, 0.004])
def test_a_spindle_that_does_not_follow(filter_time: float) -> None:
    bench, _ = watched(4)
    loop = bench.unit.spindle.loop.control  # type: ignore[attr-defined]
    loop.monitor._needed = round(filter_time / 0.001)
    bench.accepted("start", direction="cw", speed_rpm=1000.0)
    bench.run(300)
    cycle, position = bench.events[0].cycle, bench.column("set_position_deg")
    assert cycle == first_cycle(bench, "set_position_deg", lambda p: p > 10.0) + round(filter_time / 0.001)
    text = f"P-ERR-17744 spindle s: following error {position[cycle]:.4f} deg exceeds 10.0 deg (P-AXIS-00168)"
    assert bench.event_texts() == [text + ENDING]
    assert bench.column("state")[cycle] == S.ERROR_STOP and bench.column("set_speed_rpm")[-1] == 0.0


@pytest.mark.parametrize(
    ("kind", "limits", "source", "limit"),
    [
        (2, {"following_error_limit": 1e-9, "dynamic": 0}, "P-AXIS-00167, linear", lambda v: v / KV),
        (2, {"following_error_limit": 1e-9, "dynamic": 512}, "P-AXIS-00167, linear", lambda v: 2.0 * v / KV),
        (2, {"following_error_limit": 50.0, "dynamic": 0}, "P-AXIS-00168", lambda v: 50.0),
        (1, {"standstill_limit": 1e-9, "dynamic": 0}, "P-AXIS-00167, estimated", lambda v: 0.001 * v),
        (1, {"standstill_limit": 3.0, "dynamic": 512}, "P-AXIS-00169", lambda v: 3.0),
        (1, {"standstill_limit": 20.0, "following_error_limit": 9.0}, "P-AXIS-00168", lambda v: 9.0),
    ],
)
def test_texts_name_the_parameter_that_has_set_the_limit(kind: int, limits: Any, source: str, limit: Any) -> None:
    bench, _ = watched(kind, **limits)
    bench.accepted("start", direction="cw", speed_rpm=3000.0)
    bench.run(300)
    cycle = bench.events[0].cycle
    error, speed = bench.column("set_position_deg")[cycle], bench.column("set_speed_rpm")[cycle] * RPM
    text = f"following error {error:.4f} deg exceeds {round(limit(speed), 4)} deg ({source})"
    assert bench.event_texts() == [f"P-ERR-17744 spindle s: {text}{ENDING}"]


@pytest.mark.parametrize("kind", [1, 2])
def test_a_factor_of_1024_switches_the_monitoring_off(kind: int) -> None:
    bench, _ = watched(kind, dynamic=1024)
    bench.accepted("start", direction="cw", speed_rpm=3000.0)
    bench.run(300)
    assert bench.events == []


@pytest.mark.parametrize("kind", [2, 4])
def test_a_standing_spindle_that_is_pushed_away(kind: int) -> None:
    """P-AXIS-00169 counts from 5/Kv after the end of the motion on."""
    bench, drive = watched(kind, stuck=False, following_error_limit=400.0)
    bench.accepted("start", direction="cw", speed_rpm=1000.0)
    bench.run(500)
    bench.accepted("stop")
    bench.run(160)
    end = first_cycle(bench, "set_speed_rpm", lambda speed: speed == 0.0, 500)
    push(drive, -3.0)
    bench.run(200)
    error = bench.column("following_error_deg")[-1]
    text = f"P-ERR-17744 spindle s: following error {error:.4f} deg exceeds 2.0 deg (P-AXIS-00169)"
    assert bench.event_texts() == [text + ENDING] and error > 3.0
    assert bench.events[0].cycle == pytest.approx(end + SETTLING, abs=1)
    assert bench.state == S.ERROR_STOP


def test_within_the_limit_of_standstill_nothing_happens() -> None:
    bench, drive = watched(4, stuck=False)
    bench.run(300)
    push(drive, 1.999)
    bench.run(100)
    assert bench.events == []
    push(drive, 0.002)
    bench.run(10)
    assert bench.event_texts() == [
        "P-ERR-17744 spindle s: following error -2.0010 deg exceeds 2.0 deg (P-AXIS-00169)" + ENDING
    ]


def test_each_gear_has_its_limits() -> None:
    drive = StuckDrive(stuck=False)
    second = {"standstill_limit": 0.5}
    parameters = two_gears(monitoring=4, following_error_limit=500.0, standstill_limit=2.0, second=second)
    bench = bench_of(parameters, drive=drive)
    bench.accepted("select_gear", stage=2)
    bench.run(400)
    bench.accepted("gear_changed")
    bench.run(200)
    push(drive, 0.75)
    bench.run(10)
    assert bench.event_texts() == [
        "P-ERR-17744 spindle s: following error -0.7500 deg exceeds 0.5 deg (P-AXIS-00169)" + ENDING
    ]


@pytest.mark.parametrize("changes", [{"control_limit": 600.0}, {"velocity_control_on": 600.0}, {"open_loop": True}])
def test_an_open_loop_has_no_following_error_to_watch(changes: dict[str, Any]) -> None:
    bench = spindle_bench(monitoring=4, following_error_limit=15.0, **changes)
    bench.accepted("start", direction="cw", speed_rpm=3000.0)
    bench.run(700)
    assert bench.events == [] and bench.state == S.CONTINUOUS_MOTION


def test_without_power_nothing_is_watched() -> None:
    bench, drive = watched(4, stuck=False)
    bench.accepted("power", enabled=False)
    bench.run(300)
    push(drive, 30.0)
    bench.run(100)
    assert bench.events == [] and bench.state == S.DISABLED


# ---------------------------------------------------------------- modulo compensation


class ShortTurns(StuckDrive):
    """A drive whose encoder shows 359.5° after a turn."""

    __slots__ = ()

    def step(self, command: float, additive_velocity: float = 0.0, additive_torque: float = 0.0) -> None:
        super().step(command)
        self.position = round(self._true_position * 359.5 / 360.0 / 0.01) * 0.01


@pytest.mark.parametrize("missing", [0.0, 50.0])
def test_turns_that_the_encoder_is_short_of(missing: float) -> None:
    """After a minute at 1000 rpm M19 finds the place that the drive has left, or is 500° away from it."""
    drive = ShortTurns(stuck=False)
    modulo_error = ModuloError(360.0 if missing else 0.0, 0.01, missing)
    bench = bench_of(spindle_parameters(modulo_error=modulo_error), drive=drive)
    bench.accepted("start", direction="cw", speed_rpm=1000.0)
    bench.run(60_000)
    bench.accepted("orient", position_deg=90.0)
    bench.run(1000)
    assert bench.state == S.STANDSTILL and bench.column("set_position_deg")[-1] % 360.0 == pytest.approx(90.0)
    away = abs(drive._true_position - bench.column("set_position_deg")[-1])
    assert away <= 0.02 if missing else away > 400.0


# ---------------------------------------------------------------- drives


def of_type(kind: int, lines: str = "", **simulation: Any) -> UnitBench:
    """The spindle of a machine file with drive type `kind` (P-AXIS-00020)."""
    gear = "{kv: 5000, vb_regelgrenze: 0, dynamik: {vb_max: 36000000, a_max: 36000}, wegaufz: 100, wegaufn: 1, load: 0.002, "
    gear += "slope_profil: {a_beschl: 18000, a_brems: 18000}}"
    plant = ", ".join(f"{name}: {value}" for name, value in {"drive_time_constant": 3000, **simulation}.items())
    machine = load_machine(
        "/machine: {ros__parameters: {spindles: [s]}}\n"
        f"/s: {{ros__parameters: {{kenngr: {{antr_typ: {kind}}}, {lines} getriebe: {{'0': {gear}}}, "
        f"simulation: {{{plant}}}}}}}\n",
        "m.yaml",
    )
    return bench_of(machine.spindles["s"])


@pytest.mark.parametrize(
    ("kind", "lines", "simulation"),
    [
        (2, "", {}),
        (3, "", {}),
        (7, "antr: {telegram: {commands: [S-0-0047], feedback: [S-0-0051, S-0-0040]}},", {}),
        (8, "antr: {v_reso_num: 1000, v_reso_denom: 360000},", {}),
        (4, "", {"model": "CASCADED", "velocity_integral_time": 8000, "current_time_constant": 500}),
        (4, "", {"bus_delay_cycles": 2}),
    ],
)
def test_a_spindle_turns_and_positions_with_every_drive(kind: int, lines: str, simulation: dict[str, Any]) -> None:
    """The lag at constant speed is v/Kv behind every interface, plus the cycles of the bus."""
    bench = of_type(kind, lines, **simulation)
    bench.accepted("start", direction="ccw", speed_rpm=600.0)
    bench.run(1500)
    assert bench.column("following_error_deg")[-1] == pytest.approx(-3600.0 / KV, abs=0.2)
    bench.accepted("orient", position_deg=90.0)
    bench.run(3500)
    assert bench.state == S.STANDSTILL and bench.column("in_position")[-1]
    assert bench.column("actual_position_deg")[-1] % 360.0 == pytest.approx(90.0, abs=0.06)


def test_a_virtual_spindle_is_where_its_setpoint_is() -> None:
    bench = of_type(16, referenced_at_start=0, zero_pulse=77.0)
    bench.accepted("start", direction="cw", speed_rpm=600.0)
    bench.run(300)
    bench.accepted("home")
    bench.run(4000)
    bench.accepted("orient", position_deg=90.0)
    bench.run(3500)
    column = bench.columns()
    assert column["actual_position_deg"] == column["set_position_deg"]
    assert column["actual_speed_rpm"] == column["set_speed_rpm"]
    assert set(column["following_error_deg"]) == {0.0} and column["referenced"][-1] and column["in_position"][-1]


def test_a_shift_of_the_coordinates_does_not_move_a_spindle_behind_a_delay_line() -> None:
    """Homing in motion with a lead: setpoints under way are counted anew too, whatever the reference position is."""
    lead = feedforward(VEL | ADD_VEL, lead_cycles=3, always_active=True)
    speeds = []
    for reference in (0.0, 123.0):
        bench = spindle_bench(
            feedforward=lead, referenced_at_start=False, reference_position=reference, encoder_increment=0.0
        )
        bench.accepted("home")
        bench.run(1500)
        assert bench.state == S.STANDSTILL and bench.column("referenced")[-1]
        speeds.append(bench.column("actual_speed_rpm"))
    assert speeds[0] == pytest.approx(speeds[1], abs=1e-6) and max(speeds[0]) > 50.0


# ---------------------------------------------------------------- block sizes


SPINDLES: dict[str, dict[str, Any]] = {
    "type 1": {"monitoring": 1, "following_error_limit": 200.0, "standstill_limit": 1e-3, "dynamic": 1010},
    "type 2": {"monitoring": 2, "following_error_limit": 9.0, "standstill_limit": 2.0, "dynamic": 200},
    "type 4": {"monitoring": 4, "following_error_limit": 60.0, "standstill_limit": 2.0},
    "modulo error": {"modulo_error": ModuloError(360.0, 0.01, 7.0)},
    "feedforward": {"feedforward": feedforward(VEL | ADD_VEL, velocity_delay=0.0016)},
    "delay line": {"feedforward": feedforward(VEL, lead_cycles=3, prefilter_cycles=4), "monitoring": 4},
    "control limit": {"monitoring": 4, "following_error_limit": 60.0, "control_limit": 700.0 * RPM},
}


@pytest.mark.parametrize("size", [7, *long([1])])
@pytest.mark.parametrize("name", SPINDLES)
def test_the_block_size_changes_no_bit(name: str, size: int) -> None:
    """With commands in multiples of 70 cycles; one spindle of each kind is too far away at last."""
    found = {}
    for count in (size, 10):
        bench = spindle_bench(count=count, **SPINDLES[name])
        for command, arguments in (
            ("start", {"direction": "cw", "speed_rpm": 300.0}),
            ("set_feedforward", {"enabled": True, "weight_percent": 90.0}),
            ("set_speed", {"speed_rpm": 650.0}),
            ("orient", {"position_deg": 200.0}),
            ("set_feedforward", {"enabled": False}),
            ("power", {"enabled": False}),
            ("power", {"enabled": True}),
            ("start", {"direction": "ccw", "speed_rpm": 4000.0}),
            ("reset", {}),
        ):
            bench.give(command, **arguments)
            bench.run(420)
        found[count] = repr(bench.columns()), bench.event_texts()
    assert found[size] == found[10]
    assert bool(found[10][1]) is ("monitoring" in SPINDLES[name])


def test_the_share_of_the_limit_is_reckoned_in_degrees_per_second() -> None:
    """Type 2: the lag v/Kv under the limit v/Kv · 1024/(1024 - 200)."""
    bench = spindle_bench(monitoring=2, following_error_limit=1.0, standstill_limit=2.0, dynamic=200)
    bench.accepted("start", direction="cw", speed_rpm=1000.0)
    bench.run(2000)
    assert bench.unit.lag_share(bench.last) == pytest.approx(824.0 / 1024.0, rel=1e-3)
