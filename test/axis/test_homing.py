"""Homing of an axis: places and coordinates by closed form, every phase and variant, stops, override, refusals."""

from __future__ import annotations

import itertools
import random
from dataclasses import replace
from typing import Any

import pytest
from axis_motion_support import ramp_way
from long_support import long
from machine_support import CYCLE_TIME, MachineBench, UnitBench, axis_bench, axis_parameters

from cnc_ptp.control.drives.reference_marks import ReferenceMarks
from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.axis_states import StatusBit
from cnc_ptp.protocol.jobs import JobStatus

CAM, PULSE = -40.0, -43.0
HOMING = {"fast": 100.0, "slow": 10.0, "cam_position": CAM, "to_zero_pulse": 3.0, "reference_position": PULSE}
SOFT = {"soft_limit_negative": -45.0, "soft_limit_positive": 200.0}


def bench(*, at: float = 0.0, count: int = 10, referenced: bool = False, **homing: Any) -> UnitBench:
    """An axis at `at` in the machine; it counts from 0 unless it is referenced."""
    parameters = axis_parameters(encoder_increment=0.0)
    plant = replace(parameters.control.plant, start_position=at)
    changed = replace(parameters.homing, **{**HOMING, "range": 500.0, **homing})
    start = {"start_position": at} if referenced else {}
    made = axis_bench(
        count=count,
        encoder_increment=0.0,
        **start,
        **SOFT,
        referenced_at_start=referenced,
        homing=changed,
        control=replace(parameters.control, plant=plant),
    )
    made.run(count)
    return made


def home(made: UnitBench, cycles: int = 20_000) -> UnitBench:
    assert made.accepted("home") == ""
    return to_rest(made, cycles)


def to_rest(made: UnitBench, cycles: int = 20_000) -> UnitBench:
    for _ in range(cycles // 10):
        made.run(10)
        if made.state not in (S.HOMING, S.STOPPING):
            break
    made.run(300)
    return made


def machine_position(made: UnitBench) -> float:
    return float(made.unit._loop.encoder)


def shifts(made: UnitBench) -> list[float]:
    """Jumps of the setpoint: of the coordinates, not of the axis."""
    positions, velocities = made.column("set_position"), made.column("set_velocity")
    steps = [after - before for before, after in itertools.pairwise(positions)]
    return [
        step - v * CYCLE_TIME for step, v in zip(steps, velocities, strict=False) if abs(step - v * CYCLE_TIME) > 0.05
    ]


# ---------------------------------------------------------------- the sequence


def test_it_homes_in_three_phases() -> None:
    made = home(bench(at=100.0))
    assert made.state == S.STANDSTILL and made.event_texts() == []
    velocities = made.column("set_velocity")
    assert min(velocities) == pytest.approx(-100.0) and max(velocities) == pytest.approx(10.0)
    turn = velocities.index(max(velocities))
    assert min(velocities[turn:]) == pytest.approx(-10.0)
    assert made.last.actual_position[-1] == pytest.approx(machine_position(made), abs=1e-9)
    (shift,) = shifts(made)
    assert shift == pytest.approx(100.0, abs=0.02)


def test_it_stands_where_the_ramp_behind_the_zero_pulse_ends() -> None:
    """The pulse is seen up to a cycle late, with the following error of the drive behind the setpoint."""
    made = home(bench())
    lag = 10.0 / made.unit._loop.kv
    end = PULSE - ramp_way(10.0, 0.0) - lag
    assert made.last.set_position[-1] == pytest.approx(end, abs=10.0 * CYCLE_TIME + 1e-3)


def test_setpoints_are_smooth_but_for_the_coordinates() -> None:
    made = home(bench(at=100.0))
    (shift,) = shifts(made)
    rows, offset = [], 0.0
    before = made.column("set_position")[0]
    for p, v, a, j in zip(
        *(made.column(f"set_{n}") for n in ("position", "velocity", "acceleration", "jerk")), strict=True
    ):
        if abs(p - before) > 50.0:
            offset = shift
        before = p
        rows.append((p - offset, v, a, j))
    for (p, v, _, _), (q, w, a, _) in itertools.pairwise(rows):
        assert abs(q - p - v * CYCLE_TIME) < 0.02 and abs(w - v) <= 5000.0 * CYCLE_TIME * 1.001 and abs(a) <= 5000.1


@pytest.mark.parametrize("seed", [*range(15), *long(range(15, 40))])
def test_machine_and_axis_agree_wherever_it_starts(seed: int) -> None:
    rng = random.Random(seed)
    direction = rng.choice([-1.0, 1.0])
    cam, pulse = rng.uniform(-80.0, 80.0), rng.uniform(0.0, 9.0)
    made = bench(
        at=rng.uniform(-120.0, 120.0),
        direction=direction,
        cam_position=cam,
        to_zero_pulse=pulse,
        reference_position=cam + direction * pulse,
        fast=rng.uniform(20.0, 300.0),
        slow=rng.uniform(2.0, 20.0),
        fast_off_cam=rng.random() < 0.5,
        cam_length=rng.choice([0.0, 30.0]),
    )
    home(made, 200_000)
    if made.state == S.ERROR_STOP:  # it has started beyond a short cam
        assert "no reference cam within 500 mm" in made.event_texts()[0]
        return
    assert made.state == S.STANDSTILL
    assert made.last.set_position[-1] == pytest.approx(machine_position(made), abs=1e-6)
    assert not made.last.status_bits[-1] & StatusBit.NOT_REFERENCED


@pytest.mark.parametrize("count", [7, *long([1, 10, 100])])
def test_the_length_of_the_blocks_changes_nothing(count: int) -> None:
    reference, other = bench(at=20.0), bench(at=20.0, count=count)
    reference.accepted("home")
    reference.run(4200)
    other.run(-other.cycle % 10 if count < 10 else 0)
    start = reference.cycle - 4200
    while other.cycle < start:
        other.run(count)
    shift = other.cycle - start
    other.accepted("home")
    other.run(4200)
    assert (
        other.column("set_position")[start + shift : start + shift + 4000]
        == (reference.column("set_position")[start : start + 4000])
    )


def test_on_its_cam_it_starts_with_reversing() -> None:
    made = bench(at=-60.0)
    made.accepted("home")
    made.run(200)
    assert made.last.set_velocity[-1] == pytest.approx(10.0)
    to_rest(made)
    assert made.last.set_position[-1] == pytest.approx(machine_position(made), abs=1e-9)


def test_it_reverses_fast_if_it_may() -> None:
    made = bench(at=-60.0, fast_off_cam=True)
    home(made)
    assert max(made.column("set_velocity")) == pytest.approx(100.0)


def test_without_a_cam_it_takes_the_next_zero_pulse() -> None:
    made = bench(at=12.0, without_cam=True, without_reversing=True, reference_position=500.0)
    home(made)
    (shift,) = shifts(made)
    assert min(made.column("set_velocity")) == pytest.approx(-10.0)
    # pulses every 10 mm from -43 on: the next below 12 is 7, the axis counted from 12
    assert shift == pytest.approx(500.0 - (7.0 - 12.0), abs=0.02)


def test_without_reversing_it_goes_to_cam_and_pulse_in_one_phase() -> None:
    made = home(bench(without_reversing=True))
    assert max(made.column("set_velocity")) == 0.0 and min(made.column("set_velocity")) == pytest.approx(-10.0)
    assert made.last.set_position[-1] == pytest.approx(machine_position(made), abs=1e-9)


def test_without_a_zero_pulse_the_edge_of_the_cam_counts_within_a_cycle() -> None:
    made = home(bench(without_zero_pulse=True, reference_position=CAM))
    assert made.last.set_position[-1] == pytest.approx(machine_position(made), abs=10.0 * CYCLE_TIME)


def test_a_single_zero_pulse() -> None:
    made = home(bench(pulse_distance=0.0))
    assert made.last.set_position[-1] == pytest.approx(machine_position(made), abs=1e-9)


def test_a_referenced_axis_homes_again_without_a_jump() -> None:
    made = home(bench(at=100.0, referenced=True))
    assert shifts(made) == [] and made.state == S.STANDSTILL
    assert made.last.set_position[-1] == pytest.approx(machine_position(made), abs=1e-9)


def test_zero_pulses_by_counting() -> None:
    """Against all pulses one by one."""
    rng = random.Random(5)
    marks = ReferenceMarks(replace(axis_parameters().homing, **HOMING, pulse_distance=0.7))
    pulses = [PULSE + 0.7 * n for n in range(-300, 300)]
    for _ in range(3000):
        before = rng.uniform(-100.0, 50.0)
        now = before + rng.uniform(-2.0, 2.0)
        passed = [p for p in pulses if before < p <= now or now <= p < before]
        found = marks.pulse(before, now)
        nearest = min(passed, key=lambda p: abs(p - before), default=None)
        assert found == (None if nearest is None else pytest.approx(nearest, abs=1e-9))


def test_the_reference_point_gets_the_position_of_the_command() -> None:
    made = bench(at=100.0)
    assert made.accepted("home", position=150.0) == ""
    to_rest(made)
    assert made.last.set_position[-1] == pytest.approx(machine_position(made) + 150.0 - PULSE, abs=1e-9)
    home(made)  # without it, the reference point has P-AXIS-00152 again
    assert made.last.set_position[-1] == pytest.approx(machine_position(made), abs=1e-9)


def test_its_job_is_done_when_it_is_referenced_and_at_a_standstill() -> None:
    made = home(bench(at=100.0))
    begun, done = [event for block in made.blocks for event in block.job_events]
    assert (begun.status, done.status, done.error_id) == (JobStatus.ACTIVE, JobStatus.DONE, 0)
    assert made.column("set_velocity")[done.cycle] == made.column("set_acceleration")[done.cycle] == 0.0
    assert not made.column("status_bits")[done.cycle] & StatusBit.NOT_REFERENCED
    assert made.column("state")[done.cycle - 1] == S.HOMING


def test_its_job_ends_with_a_stop_or_a_fault() -> None:
    made = bench(at=100.0)
    made.accepted("home")
    made.run(500)
    made.accepted("stop")
    to_rest(made)
    told = [(event.job, event.status) for block in made.blocks for event in block.job_events]
    assert told == [(1, JobStatus.ACTIVE), (1, JobStatus.ABORTED), (2, JobStatus.ACTIVE), (2, JobStatus.DONE)]
    lost = home(bench(cam_position=-900.0), 100_000)
    events = [event for block in lost.blocks for event in block.job_events]
    assert [(event.status, event.error_id) for event in events] == [(JobStatus.ACTIVE, 0), (JobStatus.FAILED, 70394)]


# ---------------------------------------------------------------- soft limits


def test_soft_limits_count_from_the_reference_on() -> None:
    made = bench(at=100.0)
    assert made.accepted("move_absolute", target=-900.0) == ""
    made.run(3000)
    assert made.accepted("move_absolute", target=0.0) == ""
    made.run(3000)
    home(made)
    assert "target -46.0 mm lies beyond the negative soft limit -45.0 mm (P-AXIS-00177)" in made.refused(
        "move_absolute", target=-46.0
    )


def test_a_jog_of_an_axis_without_reference_is_endless() -> None:
    made = bench(at=0.0)
    assert made.accepted("jog", velocity=-100.0) == ""
    made.run(2000)
    assert made.state == S.CONTINUOUS_MOTION and made.last.set_position[-1] < -100.0


# ---------------------------------------------------------------- stops, override


@pytest.mark.parametrize("command", ["stop", "halt", "emergency_stop", "reset"])
def test_stops_abort_it_on_a_ramp(command: str) -> None:
    made = bench(at=100.0, referenced=True)
    made.accepted("home")
    made.run(500)
    made.give(command)
    made.run(10)
    assert made.state == S.STOPPING
    to_rest(made)
    assert made.state == S.STANDSTILL
    assert made.last.status_bits[-1] & StatusBit.NOT_REFERENCED
    velocities = made.column("set_velocity")
    assert max(abs(w - v) for v, w in itertools.pairwise(velocities)) <= 5000.0 * CYCLE_TIME * 1.001
    home(made)
    assert not made.last.status_bits[-1] & StatusBit.NOT_REFERENCED


def test_without_enable_it_stops() -> None:
    made = bench(at=100.0)
    made.accepted("home")
    made.run(500)
    made.accepted("power", enabled=False)
    to_rest(made)
    assert made.state == S.DISABLED


def test_override_holds_it_and_its_end_is_the_same() -> None:
    straight, held = home(bench(at=50.0)), bench(at=50.0)
    held.accepted("home")
    held.run(300)
    held.accepted("set_override", percent=0.0)
    held.run(3000)
    assert held.state == S.HOMING and held.last.set_velocity[-1] == 0.0
    assert held.last.status_bits[-1] & StatusBit.HAS_JOB
    held.accepted("set_override", percent=100.0)
    to_rest(held)
    assert held.last.set_position[-1] == pytest.approx(straight.last.set_position[-1], abs=0.02)
    assert held.last.set_position[-1] == pytest.approx(machine_position(held), abs=1e-9)


def test_the_override_of_a_channel_ends_with_the_homing() -> None:
    made = bench(at=50.0)
    made.accepted("home")
    made.accepted("set_homing_override", percent=50.0)
    made.run(600)
    assert min(made.column("set_velocity")) == pytest.approx(-50.0)
    made.accepted("stop")
    to_rest(made)
    assert made.accepted("move_relative", distance=50.0, velocity=80.0) == ""
    made.run(2000)
    assert max(made.column("set_velocity")) == pytest.approx(80.0)
    assert made.accepted("set_homing_override", percent=0.0) == ""  # nothing homes: no effect
    assert made.accepted("move_relative", distance=-50.0, velocity=80.0) == ""
    made.run(2000)
    assert made.state == S.STANDSTILL


def test_a_withheld_feed_release_holds_it() -> None:
    made = bench(at=50.0)
    made.accepted("home")
    made.run(300)
    made.accepted("set_feed_release", forward=True, backward=False)
    made.run(1000)
    assert made.state == S.HOMING and made.last.set_velocity[-1] == 0.0
    made.accepted("set_feed_release", forward=True, backward=True)
    to_rest(made)
    assert made.last.set_position[-1] == pytest.approx(machine_position(made), abs=1e-9)


# ---------------------------------------------------------------- faults and refusals


@pytest.mark.parametrize(
    ("homing", "at", "what"),
    [
        ({"cam_position": -900.0}, 0.0, "no reference cam within 500 mm (P-AXIS-00412)"),
        (
            {"cam_position": 900.0, "range": 60.0},
            0.0,
            "the reference cam was not switched off within 60 mm (P-AXIS-00412)",
        ),
        ({"pulse_distance": 0.0, "to_zero_pulse": 700.0}, 0.0, "no zero pulse within 500 mm (P-AXIS-00412)"),
        ({"without_reversing": True, "cam_position": -900.0}, 0.0, "no reference cam within 500 mm (P-AXIS-00412)"),
    ],
)
def test_a_signal_that_does_not_come_is_a_fault(homing: dict[str, Any], at: float, what: str) -> None:
    made = home(bench(at=at, **homing), 100_000)
    assert made.state == S.ERROR_STOP
    assert made.event_texts() == [f"P-ERR-70394 axis x: homing: {what}; the axis stops on its own ramp (ErrorStop)"]
    assert made.last.error_id[-1] == 70394
    assert made.last.status_bits[-1] & StatusBit.NOT_REFERENCED


def refused_home(made: UnitBench) -> str:
    return made.refused("home")


def test_refusals() -> None:
    head, tail = "axis x: home refused: ", "; nothing was changed"
    assert refused_home(bench(kind="DISABLED")) == (
        f"P-ERR-60313 {head}the axis cannot be homed (P-AXIS-00299 = DISABLED){tail}"
    )
    assert refused_home(bench(at=-60.0, without_reversing=True)) == (
        f"P-ERR-23072 {head}the axis is on its reference cam and may not reverse (P-AXIS-00157 = 1); move it off the "
        f"cam{tail}"
    )
    moving = bench()
    moving.accepted("jog", velocity=10.0)
    moving.run(10)
    assert refused_home(moving) == f"P-ERR-23005 {head}the axis is in ContinuousMotion, it must be in Standstill{tail}"
    master = bench()
    master.accepted("lead", slave="y", enabled=True)
    assert refused_home(master) == f"P-ERR-23071 {head}the axis is the master of y; decouple first{tail}"
    homes = bench()
    homes.accepted("home")
    homes.run(10)
    assert refused_home(homes) == f"P-ERR-23005 {head}the axis is in Homing, it must be in Standstill{tail}"
    assert "the axis is in Homing" in homes.refused("move_absolute", target=1.0)
    assert "the axis is in Homing" in homes.refused("jog", velocity=1.0)


def test_a_slave_does_not_home() -> None:
    scenario = """
- {at: 0, to: y, do: couple, master: x, factor: 1}
- {at: 0.1, to: y, do: home}
- {at: 0.2, to: x, do: home}
"""
    made = MachineBench(scenario=scenario).run()
    slave, master = made.refusals()
    assert slave == "P-ERR-23040 axis y: home refused: the axis is a slave of x; decouple it; nothing was changed"
    assert (
        master == "P-ERR-23071 axis x: home refused: the axis is the master of y; decouple first; nothing was changed"
    )


def test_the_reference_takes_other_coordinates_back() -> None:
    """set_position counts until the homing has found the reference point, which counts from the machine again."""
    plain, shifted = bench(at=100.0), bench(at=100.0)
    shifted.accepted("set_position", position=500.0, relative=True)
    for made in (plain, shifted):
        home(made)
    assert shifted.column("set_position")[-1] == pytest.approx(plain.column("set_position")[-1], abs=1e-9)
    bits = shifted.column("status_bits")
    assert bits[15] & StatusBit.COORDINATES_SHIFTED and not bits[-1] & StatusBit.COORDINATES_SHIFTED
