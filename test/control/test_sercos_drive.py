"""A SERCOS drive that homes its axis on its own: sequence, places and ramps by closed form, faults, service channel."""

from __future__ import annotations

import itertools
import random
from math import ceil, copysign
from typing import Any

import pytest
from long_support import long
from machine_support import CYCLE_TIME, position_after, seven_phases
from sercos_support import EDGE, MARK, START, A, DriveBench, J, V, ramp

from cnc_ptp.control.drives.sercos import idns
from cnc_ptp.control.drives.sercos.service_channel import ServiceError

T = CYCLE_TIME
TO_SWITCH, TO_MARKER = "homing, moves to the home switch", "homing, moves to the marker pulse"
OFF_SWITCH, FOUND = "homing, moves off the home switch", "homing, the reference is found"
DONE = "homing is completed"
KNOWN = (
    "S-0-0040, S-0-0041, S-0-0042, S-0-0044, S-0-0045, S-0-0046, S-0-0047, S-0-0051, S-0-0052, S-0-0057, S-0-0076, "
    "S-0-0095, S-0-0108, S-0-0124, S-0-0147, S-0-0148, S-0-0160, S-0-0349, S-0-0400, S-0-0403"
)
STOPS_BEHIND = 0x05
"""S-0-0147: in negative direction, the drive stops behind the reference point."""


# ---------------------------------------------------------------- the sequence


def test_it_goes_to_switch_and_marker_and_back_to_the_reference() -> None:
    bench = DriveBench().home()
    assert bench.diagnoses == [TO_SWITCH, TO_MARKER, FOUND, DONE]
    assert bench.answer == 0x3 and bench.service.read(idns.FEEDBACK_STATUS) == 3
    assert bench.positions[-1] == pytest.approx(MARK, abs=1e-6)
    assert bench.service.read(idns.POSITION_FEEDBACK) == -40_000
    bench.service.write(idns.HOMING, 0)
    assert bench.answer == 0 and bench.service.read(idns.DIAGNOSIS) == "follows its cyclic commands"


def test_it_meets_the_closed_form_cycle_by_cycle() -> None:
    """Ramp to 60 mm/s, on at 60 mm/s past the marker, stop and return: an ideal drive is where its motion is."""
    bench = DriveBench().home()
    time, way = ramp(V, A, J)
    passed = time + (START - MARK - way) / V
    seen = ceil(passed / T - 1e-9)
    for cycle, position in enumerate(bench.positions[: seen + 1]):
        gone = position_after(seven_phases(10_000.0, V, A, A, J), cycle * T)[0]
        assert position == pytest.approx(START - gone, abs=1e-9), cycle
    turn = START - way - V * (seen * T - time) - way
    assert min(bench.positions) == pytest.approx(turn, abs=V * A / J * T)
    back = seven_phases(MARK - turn, *reachable(MARK - turn))
    arrival = seen * T + time + sum(duration for duration, _ in back)
    first = next(cycle for cycle in range(seen, len(bench.positions)) if abs(bench.positions[cycle] - MARK) < 1e-7)
    assert first == pytest.approx(arrival / T, abs=2.0)


def reachable(distance: float) -> tuple[float, float, float, float]:
    """V, A+, A-, J of a return over a short distance: two equal ramps, by bisection."""
    low, high = 0.0, V
    for _ in range(100):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if 2.0 * ramp(middle, A, J)[1] <= distance else (low, middle)
    return low, A, A, J


def test_it_stops_behind_the_reference_if_bit_7_says_so() -> None:
    bench = DriveBench()
    bench.service.write(idns.HOMING_PARAMETER, STOPS_BEHIND)
    bench.home()
    before, after = next(pair for pair in itertools.pairwise(bench.positions) if pair[0] > MARK >= pair[1])
    assert before > MARK
    assert bench.positions[-1] == pytest.approx(after - ramp(V, A, J)[1], abs=1e-6)
    shown = bench.service.read(idns.POSITION_FEEDBACK)
    assert shown == round((-4.0 + bench.positions[-1] - MARK) * 10_000)


@pytest.mark.parametrize("seed", [*range(10), *long(range(10, 30))])
def test_wherever_it_starts_its_position_is_that_of_the_machine(seed: int) -> None:
    """The reference is given the place of the marker: from then on the drive counts as the machine does."""
    rng = random.Random(seed)
    direction = rng.choice([-1.0, 1.0])
    edge, behind = rng.uniform(-80.0, 80.0), rng.uniform(0.0, 9.0)
    bench = DriveBench(
        at=rng.uniform(-150.0, 150.0),
        direction=direction,
        cam_position=edge,
        to_zero_pulse=behind,
        reference_position=round(edge + direction * behind, 4),
        fast=rng.uniform(5.0, 200.0),
        acceleration=rng.uniform(100.0, 3000.0),
        jerk=rng.uniform(1000.0, 50_000.0),
        without_zero_pulse=False,
    ).home(60_000)
    assert bench.answer == 0x3
    mark = edge + direction * behind
    assert bench.positions[-1] == pytest.approx(mark, abs=1e-4)
    assert bench.service.homing.origin == pytest.approx(round(mark, 4) - mark, abs=1e-12)


def test_on_its_switch_it_moves_off_first() -> None:
    bench = DriveBench(at=-60.0).home()
    assert bench.diagnoses == [OFF_SWITCH, TO_SWITCH, TO_MARKER, FOUND, DONE]
    assert max(bench.positions) > EDGE and bench.positions[-1] == pytest.approx(MARK, abs=1e-6)


def test_without_the_switch_the_next_marker_counts() -> None:
    """Marker pulses every 10 mm from -4 on: the next below 12 is 6."""
    bench = DriveBench(at=12.0)
    bench.service.write(idns.HOMING_PARAMETER, 0xA5)
    bench.home()
    assert bench.diagnoses == [TO_MARKER, FOUND, DONE]
    assert bench.positions[-1] == pytest.approx(6.0, abs=1e-6)


def test_without_the_marker_the_edge_of_the_switch_counts_within_a_cycle() -> None:
    bench = DriveBench()
    bench.service.write(idns.HOMING_PARAMETER, 0xC5)
    bench.home()
    assert bench.diagnoses == [TO_SWITCH, FOUND, DONE]
    assert EDGE - V * T <= bench.positions[-1] <= EDGE + 1e-9


def test_in_positive_direction() -> None:
    bench = DriveBench(at=-100.0, direction=1.0, cam_position=-20.0, to_zero_pulse=3.0).home()
    assert bench.positions[-1] == pytest.approx(-17.0, abs=1e-6) and bench.service.read(idns.HOMING_PARAMETER) == 0x84


@pytest.mark.parametrize("seed", range(6))
def test_it_keeps_to_its_own_limits(seed: int) -> None:
    """By the differences of its positions, which are exact for an ideal drive."""
    rng = random.Random(seed)
    v, a, j = rng.uniform(10.0, 200.0), rng.uniform(100.0, 3000.0), rng.uniform(2000.0, 60_000.0)
    bench = DriveBench(fast=v, acceleration=a, jerk=j, at=rng.uniform(-60.0, 120.0)).home(60_000)
    velocities = bench.velocities()
    accelerations = [(w - u) / T for u, w in itertools.pairwise(velocities)]
    jerks = [(b - c) / T for c, b in itertools.pairwise(accelerations)]
    assert max(map(abs, velocities)) <= v + 1e-3
    assert max(map(abs, accelerations)) <= a + 0.01
    assert max(map(abs, jerks)) <= 2.0 * j + 1.0  # from +J to -J within the three cycles of a difference
    assert bench.answer == 0x3


# ---------------------------------------------------------------- override, interruption, cancel


def test_the_override_acts_on_its_velocity() -> None:
    bench = DriveBench()
    bench.service.homing.set_override(0.25)
    bench.service.write(idns.HOMING, 3)
    bench.run(600)
    assert min(bench.velocities()) == pytest.approx(-0.25 * V)
    bench.service.homing.set_override(0.0)
    bench.run(600)
    assert bench.velocities()[-1] == 0.0 and bench.answer == 0x7
    bench.service.homing.set_override(1.0)
    bench.home()
    assert bench.positions[-1] == pytest.approx(MARK, abs=1e-6) and bench.answer == 0x3


def test_an_override_of_0_on_the_way_back_to_the_reference_holds_it_there() -> None:
    bench = DriveBench()
    bench.service.write(idns.HOMING, 3)
    while bench.service.read(idns.DIAGNOSIS) != FOUND:
        bench.run(1)
    bench.run(20)
    bench.service.homing.set_override(0.0)
    bench.run(1000)
    assert bench.answer == 0x7 and abs(bench.positions[-1] - MARK) > 1.0
    bench.service.homing.set_override(0.5)
    bench.home()
    assert bench.answer == 0x3 and bench.positions[-1] == pytest.approx(MARK, abs=1e-6)


def test_without_the_enable_the_procedure_is_interrupted() -> None:
    bench = DriveBench()
    bench.service.write(idns.HOMING, 1)
    assert bench.answer == 0x5 and bench.run(50).positions[-1] == START
    bench.service.write(idns.HOMING, 3)
    bench.run(500)
    bench.service.write(idns.HOMING, 1)
    bench.run(500)
    assert bench.answer == 0x5 and bench.velocities()[-1] == 0.0
    assert bench.home().answer == 0x3 and bench.positions[-1] == pytest.approx(MARK, abs=1e-6)


def test_a_cancelled_drive_stops_on_its_ramp_and_follows_its_commands_again() -> None:
    bench = DriveBench()
    bench.service.write(idns.HOMING, 3)
    bench.run(600)
    begin = bench.positions[-1]
    bench.service.write(idns.HOMING, 0)
    assert bench.answer == 0
    bench.run(1, command=50.0)
    assert bench.service.read(idns.DIAGNOSIS) == "homing is cancelled, the drive stops"
    with pytest.raises(ServiceError) as refused:
        bench.service.write(idns.HOMING, 3)
    assert (refused.value.code, refused.value.reason) == (0x7010, "S-0-0148 was cancelled and the drive still stops")
    time, way = ramp(V, A, J)
    bench.run(ceil(time / T), command=50.0)
    assert min(bench.positions) == pytest.approx(begin - way, abs=1e-9)
    bench.run(100, command=50.0)
    assert bench.velocities()[-1] == pytest.approx(50.0)
    assert bench.service.read(idns.FEEDBACK_STATUS) == 0


def test_the_reference_is_lost_when_it_starts() -> None:
    bench = DriveBench(referenced=True)
    assert bench.service.read(idns.FEEDBACK_STATUS) == 3 and bench.service.read(idns.POSITION_FEEDBACK) == 850_000
    bench.service.write(idns.HOMING, 3)
    bench.run(10)
    assert bench.service.read(idns.FEEDBACK_STATUS) == 0


@pytest.mark.parametrize("count", [1, 5])
def test_a_lagging_plant_behind_a_position_interface_and_a_bus(count: int) -> None:
    """The drive waits until it is in its windows; what the bus still holds moves nothing afterwards."""
    bench = DriveBench(ideal=False, interface="position", bus_delay=count)
    bench.service.write(idns.HOMING, 3)
    while bench.answer == 0x7:
        bench.run(1, command=bench.drive.position)
    assert bench.positions[-1] == pytest.approx(MARK, abs=2e-4)
    bench.service.write(idns.HOMING, 0)
    bench.run(100, command=bench.drive.position)
    assert bench.positions[-1] == pytest.approx(MARK, abs=2e-4)


# ---------------------------------------------------------------- faults


@pytest.mark.parametrize(
    ("changes", "diagnosis"),
    [
        ({"fault": "NO_SWITCH", "range": 120.0}, "no home switch within 120 mm"),
        ({"fault": "NO_MARKER", "range": 120.0}, "no marker pulse within 120 mm"),
        ({"fault": "ABORTED"}, "excessive position deviation"),
        ({"fast": 0.0}, "the homing velocity S-0-0041 is 0"),
        ({"at": -60.0, "cam_position": 200.0, "range": 90.0}, "the home switch was not switched off within 90 mm"),
    ],
)
def test_faults_are_acknowledged_with_an_error(changes: dict[str, Any], diagnosis: str) -> None:
    bench = DriveBench(**changes).home(20_000)
    assert bench.answer == 0xF and bench.service.read(idns.DIAGNOSIS) == diagnosis
    assert bench.service.read(idns.FEEDBACK_STATUS) == 0
    place = bench.run(1000, command=copysign(10.0, bench.positions[-1])).positions[-1]
    assert bench.velocities()[-1] == 0.0  # it holds its position, whatever the cyclic commands are
    bench.service.write(idns.HOMING, 0)
    assert bench.answer == 0 and bench.run(100).positions[-1] == pytest.approx(place)


def test_it_completes_without_its_reference_flag() -> None:
    bench = DriveBench(fault="NO_REFERENCE").home()
    assert bench.answer == 0x3 and bench.service.read(idns.FEEDBACK_STATUS) == 0
    assert bench.service.read(idns.POSITION_FEEDBACK) == round((MARK - START) * 10_000)


def test_it_never_answers() -> None:
    bench = DriveBench(fault="NO_ANSWER").home(10_000)
    assert bench.answer == 0x7 and bench.positions[-1] == pytest.approx(MARK, abs=1e-6)


# ---------------------------------------------------------------- service channel


def test_values_at_start() -> None:
    """In digits: µm/min, 0.001 mm/s², 0.1 µm; preferred scaling, linear, at the load."""
    service = DriveBench().service
    values = {
        "S-0-0040": 0, "S-0-0041": 3_600_000, "S-0-0042": 400_000, "S-0-0044": 0x41, "S-0-0045": 1, "S-0-0046": -6,
        "S-0-0047": 0, "S-0-0051": 0, "S-0-0052": -40_000, "S-0-0057": 500, "S-0-0076": 0x41,
        "S-0-0095": "follows its cyclic commands", "S-0-0108": 10_000, "S-0-0124": 60, "S-0-0147": 0x85,
        "S-0-0148": 0, "S-0-0160": 0x41, "S-0-0349": 8_000_000, "S-0-0400": 0, "S-0-0403": 0,
    }  # fmt: skip
    assert {name: service.read(name) for name in idns.IDNS} == values


def test_live_values() -> None:
    bench = DriveBench(at=-30.0)
    assert bench.service.read(idns.HOME_SWITCH) == 1
    bench.service.write(idns.HOMING, 3)
    bench.run(300)
    assert bench.service.read(idns.VELOCITY_FEEDBACK) == round(bench.drive.velocity * 60_000) > 0
    assert bench.service.read(idns.POSITION_FEEDBACK) == round((bench.positions[-1] + 30.0) * 10_000)
    assert bench.service.read(idns.POSITION_COMMAND) == bench.service.read(idns.POSITION_FEEDBACK)


def test_parameter_scaling_has_ten_times_the_digits() -> None:
    service = DriveBench(parameter_scaling=True).service
    assert [service.read(f"S-0-00{n}") for n in (41, 44, 45, 46)] == [36_000_000, 0x49, 1, -7]


def test_written_values_count_from_the_next_start_on() -> None:
    bench = DriveBench()
    bench.service.write(idns.HOMING_VELOCITY, 600_000)
    bench.service.write(idns.HOMING_ACCELERATION, 2_000_000)
    bench.service.write(idns.JERK, 100_000_000)
    bench.service.write(idns.REFERENCE_DISTANCE, 1_234_567)
    bench.home(60_000)
    assert min(bench.velocities()) == pytest.approx(-10.0)
    assert bench.service.read(idns.POSITION_FEEDBACK) == 1_234_567
    accelerations = [(w - u) / T for u, w in itertools.pairwise(bench.velocities())]
    assert max(map(abs, accelerations)) <= 2000.0 + 0.01


@pytest.mark.parametrize(
    ("idn", "value", "code", "reason"),
    [
        ("S-0-0403", 1, 0x7004, "S-0-0403 (position feedback value status) can only be read"),
        ("S-0-0044", 1, 0x7004, "S-0-0044 (velocity data scaling type) can only be read"),
        ("S-0-0041", -1, 0x7006, "S-0-0041 = -1 is below its smallest value 0"),
        ("S-0-0042", 0, 0x7006, "S-0-0042 = 0 is below its smallest value 1"),
        ("S-0-0041", 2**31, 0x7007, "S-0-0041 = 2147483648 is above its largest value 2147483647"),
        ("S-0-0148", 2, 0x7008, "S-0-0148 = 2 is not 0 (cancel), 1 (set) or 3 (set and enable)"),
        (
            "S-0-0147",
            0x81,
            0x7008,
            "S-0-0147 = 0x81: the drive supports 0x04 and, with it, 0x01, 0x20, 0x40, 0x80",
        ),
        ("S-0-0147", 0x65, 0x7008, "S-0-0147 = 0x65 leaves homing without a signal (0x20 and 0x40)"),
        ("S-0-0108", 5000, 0x700A, "S-0-0108 is written cyclically, by override and feed release of the axis"),
        ("S-0-0401", 1, 0x1001, f"the drive has no S-0-0401, it has {KNOWN}"),
        ("S-0-41", 1, 0x1001, "'S-0-41' is not S-0- and four digits"),
    ],
)
def test_what_it_refuses(idn: str, value: int, code: int, reason: str) -> None:
    service = DriveBench().service
    before = {name: service.read(name) for name in idns.IDNS}
    with pytest.raises(ServiceError) as refused:
        service.write(idn, value)
    assert (refused.value.code, refused.value.reason) == (code, reason)
    assert {name: service.read(name) for name in idns.IDNS} == before


def test_what_it_refuses_while_it_homes() -> None:
    bench = DriveBench()
    bench.service.write(idns.HOMING, 3)
    for name in (*(f"S-0-00{n}" for n in (41, 42, 52)), "S-0-0147", "S-0-0349"):
        with pytest.raises(ServiceError) as refused:
            bench.service.write(name, 0x85)
        assert (refused.value.code, refused.value.reason) == (
            0x700C,
            f"{name} cannot be written while S-0-0148 is active",
        )


def test_a_drive_that_takes_torques_cannot_home() -> None:
    bench = DriveBench(interface="torque")
    with pytest.raises(ServiceError) as refused:
        bench.service.write(idns.HOMING, 3)
    assert (refused.value.code, refused.value.reason) == (
        0x7012,
        "S-0-0148 cannot be executed, the drive takes torques",
    )
