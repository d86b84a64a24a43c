"""Homing by a SERCOS drive: the axis follows it and takes its reference over; faults, stops, override, a PLC's S-0-0148."""

from __future__ import annotations

import itertools
from math import ceil
from typing import Any

import pytest
from machine_support import CYCLE_TIME, MachineBench, axis_bench
from sercos_support import EXAMPLE, MARK, START, A, J, SercosBench, V, home, ramp, sercos_bench, to_rest

from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.axis_states import StatusBit
from cnc_ptp.protocol.jobs import JobStatus

HEAD, TAIL = "axis x: home refused: ", "; nothing was changed"
ON_ITS_RAMP = "the drive stops on its ramp (ErrorStop)"


def texts(bench: SercosBench) -> list[str]:
    return [event.text for event in bench.all_events]


def jobs(bench: SercosBench) -> list[tuple[int, int]]:
    return [(event.job, event.status) for block in bench.blocks for event in block.job_events]


def steps(bench: SercosBench, column: str) -> list[tuple[int, float]]:
    """Jumps of a position beyond what the axis moves in a cycle: cycle and distance."""
    pairs = enumerate(itertools.pairwise(bench.column(column)), 1)
    return [(cycle, after - before) for cycle, (before, after) in pairs if abs(after - before) > 1.1 * V * CYCLE_TIME]


def cycles_in(bench: SercosBench, state: S) -> list[int]:
    return [cycle for cycle, value in enumerate(bench.column("state")) if value == state]


# ---------------------------------------------------------------- the sequence


def test_it_follows_its_drive_and_takes_the_reference_over() -> None:
    bench = home(sercos_bench())
    assert bench.state == S.STANDSTILL and bench.referenced and bench.events == []
    homing = cycles_in(bench, S.HOMING)
    positions, actual = bench.column("set_position"), bench.column("actual_position")
    assert homing[0] == 10 and all(positions[cycle] == actual[cycle] for cycle in homing)
    assert {bench.column("following_error")[cycle] for cycle in homing} == {0.0}
    assert bench.last.set_position[-1] == pytest.approx(MARK, abs=1e-4)
    assert bench.last.actual_position[-1] == pytest.approx(bench.encoder, abs=1e-12)


def test_set_and_actual_position_jump_once_and_together() -> None:
    """The coordinates change in the cycle in which the drive is homed, at a standstill; nothing else ever jumps."""
    bench = home(sercos_bench())
    ((cycle, distance),) = steps(bench, "set_position")
    assert steps(bench, "actual_position") == [(cycle, distance)]
    assert distance == pytest.approx(START, abs=1e-3)  # it has counted from 0 at 85 mm
    assert bench.column("state")[cycle - 1 : cycle + 1] == [S.HOMING, S.STANDSTILL]
    after = bench.column("set_position")[cycle:]
    assert max(after) == min(after)


def test_its_reference_is_closed_form() -> None:
    """The marker pulse behind the edge of the switch has the position P-AXIS-00152, wherever the axis has started."""
    for at, place in ((85.0, -4.0), (17.3, -4.0), (-55.0, -4.0)):
        bench = home(sercos_bench(at=at, reference_position=12.5))
        shift = bench.last.set_position[-1] - bench.encoder
        assert shift == pytest.approx(12.5 - place, abs=1e-12)


def test_the_recording_shows_the_phases() -> None:
    bench = home(sercos_bench())
    assert texts(bench) == [
        "axis x: drive: homing, moves to the home switch",
        "x: Standstill -> Homing",
        "axis x: drive: homing, moves to the marker pulse",
        "axis x: drive: homing, the reference is found",
        "axis x: drive: homing is completed",
        "axis x: the reference of the drive is taken over (S-0-0403 is set)",
        "x: Homing -> Standstill",
    ]
    assert all(event.severity == 0 for event in bench.all_events)


def test_a_referenced_axis_homes_again_without_a_jump() -> None:
    bench = home(sercos_bench(referenced=True))
    assert steps(bench, "set_position") == [] and bench.referenced
    assert bench.last.set_position[-1] == pytest.approx(MARK, abs=1e-4)


@pytest.mark.parametrize("count", [1, 7, 100])
def test_the_length_of_the_blocks_changes_nothing(count: int) -> None:
    def run(of: int) -> list[float]:
        bench = sercos_bench(count=of)
        bench.run(700 - bench.cycle)
        bench.accepted("home")
        bench.run(3500)
        return bench.column("set_position")[:4000]

    assert run(count) == run(10)


@pytest.mark.parametrize("interface", ["velocity", "position"])
@pytest.mark.parametrize("bus_delay", [0, 3])
def test_a_lagging_drive_behind_its_telegram(interface: str, bus_delay: int) -> None:
    """Whole digits, an encoder of 0.1 µm, 2 ms of lag: nothing jumps when the axis gets its drive back."""
    bench = home(sercos_bench(ideal=False, interface=interface, bus_delay=bus_delay))
    assert bench.state == S.STANDSTILL and bench.events == []
    ((cycle, _),) = steps(bench, "actual_position")
    rest = bench.column("actual_position")[cycle:]
    assert max(rest) - min(rest) <= 2e-4 and bench.last.set_position[-1] == pytest.approx(MARK, abs=3e-4)
    assert bench.accepted("move_absolute", target=30.0) == ""
    bench.run(2000)
    assert bench.last.actual_position[-1] == pytest.approx(30.0, abs=1e-3)


def test_soft_limits_count_from_the_reference_on() -> None:
    bench = sercos_bench()
    assert bench.accepted("move_relative", distance=-400.0) == ""
    bench.run(5000)
    home(bench)
    assert "target 401.0 mm lies beyond the positive soft limit 400.0 mm" in bench.refused(
        "move_absolute", target=401.0
    )


def test_the_reference_point_gets_the_position_of_the_command() -> None:
    bench = home(sercos_bench(), position=100.0)
    assert bench.last.set_position[-1] == pytest.approx(100.0, abs=1e-4)
    assert bench.read("S-0-0052") == 1_000_000
    home(bench)
    assert bench.last.set_position[-1] == pytest.approx(MARK, abs=1e-4) and bench.read("S-0-0052") == -40_000


def test_the_job_is_done_when_the_axis_is_referenced_and_at_a_standstill() -> None:
    bench = home(sercos_bench())
    (begun, done) = [event for block in bench.blocks for event in block.job_events]
    assert (begun.status, done.status) == (JobStatus.ACTIVE, JobStatus.DONE)
    assert bench.column("set_velocity")[done.cycle] == 0.0
    assert not bench.column("status_bits")[done.cycle] & StatusBit.NOT_REFERENCED
    assert bench.column("status_bits")[done.cycle - 1] & StatusBit.HAS_JOB


# ---------------------------------------------------------------- faults of the drive


@pytest.mark.parametrize(
    ("changes", "number", "reason"),
    [
        (
            {"fault": "ABORTED"},
            23123,
            "the drive has aborted S-0-0148 with an error: excessive position deviation (16#FFFFFFFE)",
        ),
        (
            {"fault": "NO_SWITCH", "range": 150.0},
            23123,
            "the drive has aborted S-0-0148 with an error: no home switch within 150 mm (16#FFFFFFFE)",
        ),
        (
            {"fault": "NO_MARKER", "range": 150.0},
            23123,
            "the drive has aborted S-0-0148 with an error: no marker pulse within 150 mm (16#FFFFFFFE)",
        ),
        (
            {"fault": "NO_REFERENCE"},
            23124,
            "S-0-0148 is completed, the drive has not set its reference flag S-0-0403 (16#FFFFFFFD)",
        ),
        (
            {"fault": "NO_ANSWER", "timeout": 4.0},
            23125,
            "the drive has not acknowledged S-0-0148 within 4 s (P-MACH-00062)",
        ),
    ],
)
def test_faults(changes: dict[str, Any], number: int, reason: str) -> None:
    bench = home(sercos_bench(**changes))
    assert bench.event_texts() == [f"P-ERR-{number} axis x: homing: {reason}; {ON_ITS_RAMP}"]
    assert (bench.state, bench.last.error_id[-1], bench.referenced) == (S.ERROR_STOP, number, False)
    bench.run(1000)
    assert bench.last.set_velocity[-1] == 0.0 and bench.read("S-0-0148") == 0
    assert jobs(bench) == [(1, JobStatus.ACTIVE), (1, JobStatus.FAILED)]
    assert steps(bench, "set_position") == []
    assert bench.accepted("reset") == ""
    bench.run(10)
    assert bench.state == S.STANDSTILL and bench.accepted("move_relative", distance=5.0) == ""


def test_an_aborted_drive_is_followed_to_its_standstill() -> None:
    """The fault comes with the error bit, while the drive still moves at 60 mm/s; a reset has to wait."""
    bench = sercos_bench(fault="ABORTED")
    bench.accepted("home")
    bench.run(10)
    while bench.state == S.HOMING:
        bench.run(10)
    assert bench.refused("reset") == (
        "P-ERR-23008 axis x: reset refused: the axis still moves on its error ramp; wait for standstill; nothing was "
        "changed"
    )
    bench.run(ceil(ramp(V, A, J)[0] / CYCLE_TIME) + 10)
    fault = cycles_in(bench, S.ERROR_STOP)[0]
    way = bench.column("set_position")[fault] - bench.last.set_position[-1]
    assert way == pytest.approx(ramp(V, A, J)[1], abs=V * CYCLE_TIME)
    assert bench.accepted("reset") == ""


def test_a_fault_of_the_axis_stops_the_drive() -> None:
    bench = sercos_bench()
    bench.accepted("home")
    bench.run(600)
    bench.accepted("upstream_lost", source="plc")
    to_rest(bench)
    assert bench.event_texts() == [
        f"P-ERR-26101 axis x: no block of 'plc' came within the watchdog time; {ON_ITS_RAMP}"
    ]
    assert bench.state == S.ERROR_STOP and not bench.referenced


# ---------------------------------------------------------------- stops


def stopped_by(bench: SercosBench, command: str, **arguments: Any) -> str:
    """Stops a homing at 60 mm/s; the warning."""
    bench.accepted("home")
    bench.run(600)
    warning = bench.accepted(command, **arguments)
    bench.run(10)
    assert bench.state == S.STOPPING
    to_rest(bench)
    return warning


@pytest.mark.parametrize("command", ["stop", "halt", "emergency_stop", "reset"])
def test_stops_take_the_procedure_away_and_the_drive_stops_on_its_ramp(command: str) -> None:
    bench = sercos_bench()
    assert stopped_by(bench, command) == ""
    assert bench.state == S.STANDSTILL and not bench.referenced and bench.events == []
    assert bench.read("S-0-0148") == 0 and bench.read("S-0-0403") == 0
    stopping = cycles_in(bench, S.STOPPING)
    way = bench.column("set_position")[stopping[0]] - bench.last.set_position[-1]
    assert way == pytest.approx(ramp(V, A, J)[1], abs=1e-6)
    assert steps(bench, "set_position") == []
    assert "axis x: drive: homing is cancelled, the drive stops" in texts(bench)
    home(bench)
    assert bench.referenced and bench.last.set_position[-1] == pytest.approx(MARK, abs=1e-4)


def test_an_emergency_stop_has_the_ramp_of_the_drive() -> None:
    bench = sercos_bench()
    assert stopped_by(bench, "emergency_stop", deceleration=2000.0) == (
        "P-WARN-23016 axis x: emergency_stop: the drive stops on its own ramp (S-0-0042, S-0-0349); deceleration and "
        "jerk have no effect"
    )
    assert bench.state == S.STANDSTILL


def test_two_stops_and_other_commands_while_the_drive_stops() -> None:
    bench = sercos_bench()
    bench.accepted("home")
    bench.run(600)
    bench.accepted("stop")
    bench.run(10)
    assert "without effect in Stopping" in bench.accepted("stop")
    assert bench.accepted("emergency_stop") == ""
    assert "no positioning is active" in bench.refused("new_target", target=1.0)
    assert "must be in Standstill" in bench.refused("home")
    assert bench.refused("write_drive_parameter", idn="S-0-0148", value=3) == (
        "P-ERR-23121 axis x: write_drive_parameter refused: S-0-0148 was cancelled and the drive still stops "
        "(SERCOS error 0x7010); nothing was changed"
    )
    to_rest(bench)
    assert bench.state == S.STANDSTILL


def test_without_enable_the_drive_stops_on_its_ramp() -> None:
    bench = sercos_bench()
    bench.accepted("home")
    bench.run(600)
    bench.accepted("power", enabled=False)
    to_rest(bench)
    assert bench.state == S.DISABLED and not bench.referenced and steps(bench, "set_position") == []
    assert jobs(bench) == [(1, JobStatus.ACTIVE), (1, JobStatus.ABORTED)]
    bench.accepted("power", enabled=True)
    bench.run(10)
    home(bench)
    assert bench.referenced


def test_a_stop_in_the_cycle_of_the_acknowledgement() -> None:
    """The drive is homed in the cycle in which the stop comes: the axis counts as its drive does."""
    reference = home(sercos_bench(count=1))
    ((cycle, _),) = steps(reference, "set_position")
    for early, referenced in ((1, False), (0, True)):
        bench = sercos_bench(count=1)
        bench.accepted("home")
        bench.run(cycle - early - bench.cycle)
        bench.accepted("stop")
        to_rest(bench)
        assert (bench.state, bench.referenced) == (S.STANDSTILL, referenced), early
        assert bench.referenced == bool(bench.read("S-0-0403"))


# ---------------------------------------------------------------- override, feed release


def test_the_override_is_that_of_the_drive() -> None:
    bench = sercos_bench()
    bench.accepted("set_override", percent=50.0)
    bench.accepted("home")
    bench.run(700)
    assert bench.last.set_velocity[-1] == pytest.approx(-30.0) and bench.read("S-0-0108") == 5000
    assert bench.accepted("set_override", percent=0.0) == ""
    bench.run(500)
    bits = bench.last.status_bits[-1]
    assert bench.state == S.HOMING and bench.last.set_velocity[-1] == 0.0
    assert bits & StatusBit.HAS_JOB and not bits & StatusBit.IN_TARGET_POSITION
    bench.accepted("set_override", percent=100.0)
    to_rest(bench)
    assert bench.referenced and min(bench.column("set_velocity")) == pytest.approx(-V)


def test_the_override_of_a_channel_counts_besides() -> None:
    bench = sercos_bench()
    bench.accepted("set_override", percent=50.0)
    bench.accepted("home")
    bench.accepted("set_homing_override", percent=50.0)
    bench.run(700)
    assert bench.last.set_velocity[-1] == pytest.approx(-15.0)
    bench.accepted("stop")
    to_rest(bench)
    home(bench)
    assert min(bench.column("set_velocity")) == pytest.approx(-30.0)


@pytest.mark.parametrize("release", [(True, False), (False, True)])
def test_it_needs_both_feed_releases(release: tuple[bool, bool]) -> None:
    """The axis does not know where its drive goes."""
    bench = sercos_bench(timeout=4.0)
    bench.accepted("home")
    bench.run(600)
    forward, backward = release
    bench.accepted("set_feed_release", forward=forward, backward=backward)
    bench.run(5000)
    assert bench.state == S.HOMING and bench.last.set_velocity[-1] == 0.0
    assert bench.last.status_bits[-1] & StatusBit.FEED_WITHHELD
    bench.accepted("set_feed_release", forward=True, backward=True)
    to_rest(bench)
    assert bench.referenced and bench.events == []


# ---------------------------------------------------------------- a PLC that writes S-0-0148


def test_a_plc_homes_the_axis_step_by_step() -> None:
    bench = sercos_bench()
    assert bench.read("S-0-0044") == 0x41
    bench.write("S-0-0041", 1_800_000)
    bench.write("S-0-0148", 3)
    bench.run(10)
    assert bench.state == S.HOMING and bench.read("S-0-0148") == 7 and jobs(bench) == []
    while bench.read("S-0-0148") == 7:
        bench.run(100)
    assert (bench.read("S-0-0148"), bench.read("S-0-0403")) == (3, 3)
    assert bench.state == S.HOMING and bench.referenced
    assert bench.unit.waits_for() == "axis x waits for S-0-0148 = 0"
    assert min(bench.column("set_velocity")) == pytest.approx(-30.0)
    bench.write("S-0-0148", 0)
    assert bench.accepted("move_absolute", target=20.0, velocity=50.0) == ""
    bench.run(2000)
    assert bench.state == S.STANDSTILL and bench.last.set_position[-1] == 20.0
    assert bench.unit.waits_for() == "" and len(steps(bench, "set_position")) == 1


def test_a_plc_takes_the_procedure_away_while_the_drive_moves() -> None:
    bench = sercos_bench()
    bench.write("S-0-0148", 3)
    bench.run(600)
    bench.write("S-0-0148", 0)
    bench.run(10)
    assert bench.state == S.STOPPING
    to_rest(bench)
    assert bench.state == S.STANDSTILL and not bench.referenced and bench.read("S-0-0148") == 0


def test_a_plc_sees_the_error_of_the_drive() -> None:
    bench = sercos_bench(fault="NO_SWITCH", range=100.0)
    bench.write("S-0-0148", 3)
    bench.run(6000)
    assert bench.state == S.HOMING and bench.read("S-0-0148") == 15 and bench.events == []
    assert bench.read("S-0-0095") == "no home switch within 100 mm"
    assert bench.unit.waits_for() == "axis x waits for S-0-0148 = 0"
    bench.write("S-0-0148", 0)
    bench.run(20)
    assert bench.state == S.STANDSTILL and not bench.referenced


def test_a_plc_takes_the_procedure_away_in_the_cycle_of_the_acknowledgement() -> None:
    bench = sercos_bench(count=1)
    bench.write("S-0-0148", 3)
    while bench.unit._loop.drive.service.homing.acknowledgement == 7:  # type: ignore[attr-defined]
        bench.run(1)
    bench.write("S-0-0148", 0)
    bench.run(10)
    assert bench.state == S.STANDSTILL and bench.referenced
    assert bench.last.set_position[-1] == pytest.approx(MARK, abs=1e-4)


def test_a_prepared_procedure_moves_nothing() -> None:
    bench = sercos_bench()
    bench.write("S-0-0148", 1)
    bench.run(100)
    assert bench.state == S.STANDSTILL and bench.read("S-0-0148") == 5
    bench.write("S-0-0148", 0)
    assert bench.state == S.STANDSTILL and bench.read("S-0-0148") == 0
    bench.write("S-0-0148", 3)
    bench.run(500)
    bench.write("S-0-0148", 1)
    bench.run(500)
    assert bench.state == S.HOMING and bench.last.set_velocity[-1] == 0.0
    bench.write("S-0-0148", 3)
    bench.run(4000)
    assert bench.referenced


def test_a_homing_of_the_axis_is_not_the_plcs() -> None:
    bench = sercos_bench()
    bench.accepted("home")
    bench.run(500)
    for value in (0, 1, 3):
        assert bench.refused("write_drive_parameter", idn="S-0-0148", value=value) == (
            "P-ERR-23121 axis x: write_drive_parameter refused: S-0-0148 is active for home; stop ends it (SERCOS "
            "error 0x7010); nothing was changed"
        )
    assert bench.read("S-0-0148") == 7


# ---------------------------------------------------------------- refusals


def test_refusals_of_home() -> None:
    scaled = sercos_bench(parameter_scaling=True)
    assert scaled.refused("home") == (
        f"P-ERR-23122 {HEAD}the drive scales velocities by parameters (S-0-0044 = 0x49), supported is preferred scaling "
        f"(16#FFFFFFFF){TAIL}"
    )
    bench = sercos_bench()
    assert bench.refused("home", position=401.0) == (
        f"P-ERR-23126 {HEAD}position 401.0 mm is not within the soft limits -10 ... 400 mm (P-AXIS-00177, P-AXIS-00178)"
        f"{TAIL}"
    )
    assert axis_bench().refused("home", position=-2e5) == (
        f"P-ERR-23126 {HEAD}position -200000.0 mm is not within the soft limits -100000 ... 100000 mm (P-AXIS-00177, "
        f"P-AXIS-00178){TAIL}"
    )
    bench.accepted("move_relative", distance=5.0)
    bench.run(10)
    assert bench.refused("home") == (f"P-ERR-23005 {HEAD}the axis is in DiscreteMotion, it must be in Standstill{TAIL}")
    to_rest(bench)
    bench.run(1000)
    bench.accepted("lead", slave="y", enabled=True)
    assert bench.refused("home") == f"P-ERR-23071 {HEAD}the axis is the master of y; decouple first{TAIL}"
    unsuited = sercos_bench(interface="torque")
    assert unsuited.refused("home") == (
        f"P-ERR-23121 {HEAD}S-0-0148 cannot be executed, the drive takes torques (SERCOS error 0x7012){TAIL}"
    )
    assert bench.state == S.STANDSTILL and bench.read("S-0-0148") == 0


def test_refusals_of_drive_parameters() -> None:
    without = "the axis has no SERCOS drive (P-AXIS-00020), which has such parameters; nothing was changed"
    other = axis_bench()
    assert other.refused("read_drive_parameter", idn="S-0-0051") == (
        f"P-ERR-23120 axis x: read_drive_parameter refused: {without}"
    )
    assert other.refused("write_drive_parameter", idn="S-0-0148", value=3) == (
        f"P-ERR-23120 axis x: write_drive_parameter refused: {without}"
    )
    bench = sercos_bench()
    assert bench.refused("read_drive_parameter", idn="S-0-51") == (
        "P-ERR-23121 axis x: read_drive_parameter refused: 'S-0-51' is not S-0- and four digits (SERCOS error 0x1001); "
        "nothing was changed"
    )
    assert bench.refused("write_drive_parameter", idn="S-0-0403", value=1) == (
        "P-ERR-23121 axis x: write_drive_parameter refused: S-0-0403 (position feedback value status) can only be read "
        "(SERCOS error 0x7004); nothing was changed"
    )
    assert bench.refused("write_drive_parameter", idn="S-0-0041", value=1.5) == (
        "P-ERR-22001 axis x: write_drive_parameter refused: value = 1.5 is not an integer; nothing was changed"
    )
    bench.accepted("move_relative", distance=5.0)
    bench.run(10)
    assert bench.refused("write_drive_parameter", idn="S-0-0148", value=3) == (
        "P-ERR-23005 axis x: write_drive_parameter refused: the axis is in DiscreteMotion, it must be in Standstill; "
        "nothing was changed"
    )


def test_home_writes_what_the_axis_list_says() -> None:
    bench = sercos_bench()
    bench.write("S-0-0041", 1)
    bench.write("S-0-0052", 99)
    home(bench)
    assert (bench.read("S-0-0041"), bench.read("S-0-0052")) == (3_600_000, -40_000)


# ---------------------------------------------------------------- in a machine


def test_the_answer_of_the_plc_has_what_was_read() -> None:
    scenario = (
        "- {at: 0.0, to: x, do: read_drive_parameter, idn: S-0-0042}\n- {at: 0.1, to: x, do: home, position: 900}"
    )
    bench = MachineBench(None, scenario, machine=EXAMPLE).run()
    read, refused = [answer for block in bench.blocks["x"] for answer in block.answers]
    assert (read.error_id, read.message, read.values) == (0, "S-0-0042 = 400000", {"S-0-0042": 400_000})
    assert refused.error_id == 23126 and refused.values == {"position": 900.0, "low": -10.0, "high": 400.0}
