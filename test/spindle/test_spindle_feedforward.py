"""Feedforward of spindles: what it leaves of the following error, in all gears, and its commands."""

from __future__ import annotations

from typing import Any

import pytest
from error_support import refused
from machine_support import CYCLE_TIME, UnitBench

from cnc_ptp.control.feedforward import Feedforward
from cnc_ptp.parameters import load_machine
from cnc_ptp.spindle.spindle_unit import SpindleUnit

KV, TIME_CONSTANT, ACCELERATION = 50.0, 0.003, 18_000.0


def bench(vorsteuer: str = "vorsteuerung: VEL | ACC, vs_a_faktor: 3000") -> UnitBench:
    """A spindle with a first-order drive of 3 ms and an ideal encoder that is under control at all speeds."""
    gear = (
        "{kv: 5000, vb_regelgrenze: 0, dynamik: {vb_max: 36000000, a_max: 36000}, "
        "slope_profil: {a_beschl: 18000, a_brems: 18000}}"
    )
    machine = load_machine(
        "/machine: {ros__parameters: {spindles: [s]}}\n"
        f"/s: {{ros__parameters: {{vorsteuer: {{{vorsteuer}}}, getriebe: {{'0': {gear}}}, "
        "simulation: {drive_time_constant: 3000, encoder: 0}}}\n",
        "m.yaml",
    )
    return UnitBench(SpindleUnit(machine.spindles["s"], cycle_time=CYCLE_TIME))


def turn(bench: UnitBench) -> list[Any]:
    """600 rpm in 0.2 s, then 0.8 s of constant speed; the following error of each cycle, deg."""
    bench.accepted("start", direction="cw", speed_rpm=600.0)
    bench.run(1000)
    return bench.column("following_error_deg")


def test_lags_are_the_closed_forms_without_it() -> None:
    errors = turn(bench())
    assert errors[-1] == pytest.approx(3600.0 / KV, abs=1e-9)


def test_velocity_feedforward_leaves_the_lag_of_the_acceleration() -> None:
    spindle = bench("vorsteuerung: VEL")
    assert spindle.accepted("set_feedforward", enabled=True) == ""
    errors = turn(spindle)
    assert errors[190] == pytest.approx(ACCELERATION * TIME_CONSTANT / KV, rel=1e-3)
    assert errors[-1] == pytest.approx(0.0, abs=1e-9)


def test_velocity_and_acceleration_feedforward_leave_nothing_while_the_acceleration_is_constant() -> None:
    spindle = bench()
    spindle.accepted("set_feedforward", enabled=True)
    errors = turn(spindle)
    assert abs(errors[190]) < 1e-4 and abs(errors[-1]) < 1e-9
    assert max(map(abs, errors)) < 0.3


def test_weight_and_reset() -> None:
    spindle = bench("vorsteuerung: VEL")
    spindle.accepted("set_feedforward", enabled=True, weight_percent=75.0)
    assert turn(spindle)[-1] == pytest.approx(0.25 * 3600.0 / KV, abs=1e-9)
    spindle.accepted("reset_feedforward")
    spindle.run(1000)
    assert spindle.column("following_error_deg")[-1] == pytest.approx(3600.0 / KV, abs=1e-9)


def test_refusal_and_warning() -> None:
    assert bench().refusal("set_feedforward", weight_percent=-1.0) == refused(23060, weight_percent=-1.0)
    assert bench("vorsteuerung: NONE").accepted("set_feedforward", enabled=True) == (
        "spindle s: feedforward without effect, P-AXIS-00223 (vorsteuer.vorsteuerung) is NONE"
    )


SELECTED: dict[str, Any] = {"enabled": True}


@pytest.mark.parametrize("speed", [700.0, 33.0, 2.5])
@pytest.mark.parametrize("selected_first", [True, False])
def test_a_start_in_the_cycle_of_the_selection_has_all_of_it(speed: float, selected_first: bool) -> None:
    """S[G135] and S[M03 REV700] in one block of cycles, in either order: as if it had been on for long."""
    before, together = bench(), bench()
    before.accepted("set_feedforward", **SELECTED)
    before.run(20)
    before.accepted("start", direction="ccw", speed_rpm=speed)
    together.run(20)
    orders = [("set_feedforward", SELECTED), ("start", {"direction": "ccw", "speed_rpm": speed})]
    for command, arguments in orders if selected_first else orders[::-1]:
        together.accepted(command, **arguments)
    for spindle in (before, together):
        spindle.run(400)
    for column in ("following_error_deg", "drive_output", "feedforward_percent"):
        assert before.column(column)[20:] == together.column(column)[20:]
    assert max(map(abs, together.column("following_error_deg"))) < 0.3


def test_off_and_a_smaller_weight_at_a_standstill_act_at_once_too() -> None:
    spindle = bench("vorsteuerung: VEL")
    spindle.accepted("set_feedforward", **SELECTED)
    spindle.run(20)
    spindle.accepted("set_feedforward", weight_percent=60.0)
    spindle.accepted("start", direction="cw", speed_rpm=600.0)
    spindle.run(10)
    assert spindle.column("feedforward_percent")[20:] == [60.0] * 10
    spindle.run(200)
    spindle.accepted("set_feedforward", enabled=False)
    spindle.run(10)
    assert 0.0 < spindle.column("feedforward_percent")[-1] < 60.0, "softly in motion"


def test_another_gear_has_it_from_its_first_cycle_on() -> None:
    """What is selected holds in all gears; the selection comes in the cycle of the gear change."""
    gear = "{kv: 5000, vb_regelgrenze: 0, dynamik: {vb_max: 36000000, a_max: 36000}}"
    gears = ", ".join(f"'{stage}': {gear}" for stage in range(3))
    machine = load_machine(
        "/machine: {ros__parameters: {spindles: [s]}}\n"
        f"/s: {{ros__parameters: {{vorsteuer: {{vorsteuerung: VEL}}, getriebe: {{{gears}}}, "
        "simulation: {drive_time_constant: 0, encoder: 0}}}\n",
        "m.yaml",
    )
    spindle = UnitBench(SpindleUnit(machine.spindles["s"], cycle_time=CYCLE_TIME))
    spindle.run(20)
    spindle.accepted("set_feedforward", **SELECTED)
    spindle.accepted("select_gear", stage=3)
    spindle.accepted("start", direction="cw", speed_rpm=600.0)
    spindle.run(100)
    assert spindle.column("feedforward_percent")[20:] == [100.0] * 100


@pytest.mark.interpreted
def test_feedforward_without_room_is_told_in_the_unit_of_rotary_axes(monkeypatch: pytest.MonkeyPatch) -> None:
    """deg/s, as an axis tells it; the wait itself is that of test_axis_control."""
    spindle = bench()
    waits = iter([None, 36_000.0])
    monkeypatch.setattr(Feedforward, "take_wait", lambda _: next(waits, None))
    spindle.run(30)
    assert spindle.event_texts() == [
        "P-ERR-23061 spindle s: feedforward waits: at 0 deg/s there is no room up to 36000 deg/s (P-AXIS-00212) to make "
        "up the following error; 0 % is active, the rest follows when the motion is slower"
    ]
