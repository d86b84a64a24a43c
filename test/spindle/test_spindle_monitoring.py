"""Monitoring of a spindle: time limit of the speed, following error under all ways of control, HLI columns and bits."""

from __future__ import annotations

import math

import pytest
from machine_support import spindle_bench, spindle_parameters
from spindle_support import DOWN, RPM, UP, StuckDrive, bench_of, first_cycle

from cnc_ptp.control.drives.first_order import FirstOrderDrive
from cnc_ptp.protocol.axis_states import AxisStateCode as S
from cnc_ptp.protocol.spindle_states import SpindleBit


def test_a_speed_that_is_not_reached_in_time() -> None:
    """A drive that makes 400 rpm at most; 0.25 s after the setpoint has got to 1000 rpm."""
    drive = StuckDrive(stuck=False, limit=400.0 * RPM)
    bench = bench_of(spindle_parameters(speed_time=0.25), drive=drive)
    bench.accepted("start", direction="cw", speed_rpm=1000.0)
    bench.run(1000)
    assert bench.events[0].cycle == math.ceil((1000.0 * RPM / UP + 0.25) * 1000.0 - 1e-6)
    assert bench.event_texts() == [
        "P-ERR-24013 spindle s: speed 1000 rpm was not reached 0.25 s after the setpoint (P-AXIS-00217, "
        "P-MACH-00050); the spindle stops on its ramp (ErrorStop)"
    ]
    assert bench.state == S.ERROR_STOP and not any(bench.column("speed_reached")[:400])


class CreepingDrive(FirstOrderDrive):
    """A drive that cannot turn slower than 2 rpm."""

    __slots__ = ()

    def __init__(self) -> None:
        super().__init__(cycle_time=0.001, time_constant=0.0, encoder_increment=0.0)

    def step(self, command: float, additive_velocity: float = 0.0, additive_torque: float = 0.0) -> None:
        super().step(max(2.0 * RPM, command))


@pytest.mark.parametrize("zero_rpm", [1.0, 3.0])
def test_a_spindle_that_does_not_come_to_rest_in_time(zero_rpm: float) -> None:
    """After M05 it creeps at 2 rpm: too fast for the first limit of speed zero, P-AXIS-00216, not for the second."""
    bench = bench_of(spindle_parameters(speed_time=0.25, zero_speed=zero_rpm * RPM), drive=CreepingDrive())
    bench.accepted("start", direction="cw", speed_rpm=600.0)
    bench.run(600)
    bench.accepted("stop")
    stands = math.ceil((600.0 * RPM / DOWN) * 1000.0 - 1e-6) + 600
    bench.run(1000)
    assert bench.column("state")[stands] == S.STANDSTILL and bench.column("set_speed_rpm")[stands] == 0.0
    if zero_rpm > 2.0:
        assert bench.events == [] and bench.state == S.STANDSTILL
        return
    assert bench.events[0].cycle == math.ceil((600.0 * RPM / DOWN + 0.25) * 1000.0 - 1e-6) + 600
    assert bench.event_texts() == [
        "P-ERR-24013 spindle s: speed 0 rpm was not reached 0.25 s after the setpoint (P-AXIS-00216, "
        "P-MACH-00050); the spindle stops on its ramp (ErrorStop)"
    ]
    assert bench.state == S.ERROR_STOP


def test_a_speed_that_is_lost_and_does_not_come_back() -> None:
    """The drive gets stuck in steady rotation; for 20 ms only at first, then permanently."""
    drive = StuckDrive(stuck=False)
    bench = bench_of(spindle_parameters(speed_time=0.25), drive=drive)
    bench.accepted("start", direction="cw", speed_rpm=600.0)
    bench.run(500)
    for stuck, cycles in ((True, 20), (False, 1000), (True, 500)):
        assert bench.events == []
        drive.stuck = stuck
        bench.run(cycles)
    lost = first_cycle(bench, "speed_reached", lambda reached: not reached, begin=1500)
    assert bench.events[0].cycle == lost + 250 and 1520 <= lost <= 1530
    assert bench.event_texts() == [
        "P-ERR-24013 spindle s: speed 600 rpm was lost and has not come back for 0.25 s (P-AXIS-00217, P-MACH-00050); "
        "the spindle stops on its ramp (ErrorStop)"
    ]


@pytest.mark.parametrize("count", [1, 10, 100])
def test_a_patience_below_the_length_of_a_block(count: int) -> None:
    """The fault comes in the same cycle, however long blocks are."""
    drive = StuckDrive(stuck=False)
    bench = bench_of(spindle_parameters(speed_time=0.02), count=count, drive=drive)
    bench.accepted("start", direction="cw", speed_rpm=600.0)
    bench.run(1000)
    drive.stuck = True
    bench.run(100)
    lost = first_cycle(bench, "speed_reached", lambda reached: not reached, begin=1000)
    assert [event.cycle for event in bench.events] == [lost + 20] and lost < 1030


def test_an_override_that_does_not_change_gives_no_more_time() -> None:
    bench = bench_of(spindle_parameters(speed_time=0.25), drive=StuckDrive(stuck=False, limit=400.0 * RPM))
    bench.accepted("start", direction="cw", speed_rpm=1000.0)
    for _ in range(10):
        bench.accepted("set_override", percent=100.0)
        bench.accepted("suppress_override", enabled=False)
        bench.run(100)
    assert bench.events[0].cycle == math.ceil((1000.0 * RPM / UP + 0.25) * 1000.0 - 1e-6)


@pytest.mark.parametrize(
    ("commands", "failed"),
    [
        ([("start", {"direction": "cw", "speed_rpm": 1000.0})], True),
        ([("start", {"direction": "cw", "speed_rpm": 300.0}), ("power", {"enabled": False})], False),
        ([("start", {"direction": "ccw", "speed_rpm": 300.0})], True),
        ([("orient", {"position_deg": 10.0}), ("power", {"enabled": False})], True),
    ],
    ids=["speed not reached", "no active job", "refused with an error", "positioning"],
)
def test_hli_job_error(commands: list[tuple[str, dict[str, object]]], failed: bool) -> None:
    """What was active, or was refused, has failed; a reset takes the bit back (2.9)."""
    drive = StuckDrive(stuck=False, limit=400.0 * RPM)
    bench = bench_of(spindle_parameters(speed_time=0.25, preferred_direction=1), drive=drive)
    for command, arguments in commands:
        bench.give(command, **arguments)
        bench.run(1000 if command == "start" else 20)
    bench.run(1000)
    assert bench.state == S.ERROR_STOP
    assert bool(bench.column("status_bits")[-1] & SpindleBit.JOB_ERROR) == failed
    bench.accepted("reset")
    bench.run(10)
    assert not bench.column("status_bits")[-1] & SpindleBit.JOB_ERROR


def test_without_a_time_limit_it_goes_on_trying() -> None:
    drive = StuckDrive(stuck=False, limit=400.0 * RPM)
    bench = bench_of(spindle_parameters(speed_time=0.0), drive=drive)
    bench.accepted("start", direction="cw", speed_rpm=1000.0)
    bench.run(12000)
    assert bench.state == S.CONTINUOUS_MOTION and bench.events == []


def test_override_0_is_no_speed_that_is_missing() -> None:
    bench = spindle_bench(speed_time=0.1)
    bench.accepted("set_override", percent=0.0)
    bench.accepted("start", direction="cw", speed_rpm=1000.0)
    bench.run(1000)
    assert bench.events == [] and not any(bench.column("speed_reached"))


def test_the_following_error_is_watched_in_steady_rotation_too() -> None:
    """The drive gets stuck in a block in which nothing else happens."""
    drive = StuckDrive(stuck=False)
    bench = bench_of(spindle_parameters(following_error_monitoring=True, following_error_limit=100.0), drive=drive)
    bench.accepted("start", direction="cw", speed_rpm=600.0)
    bench.run(500)
    drive.stuck = True
    bench.run(100)
    fault = bench.events[0].cycle
    errors = bench.column("following_error_deg")
    assert errors[fault - 1] <= 100.0 < errors[fault]
    assert bench.event_texts() == [
        f"P-ERR-17744 spindle s: following error {errors[fault]:.4f} deg exceeds 100.0 deg (P-AXIS-00168); the spindle stops "
        "on its ramp (ErrorStop)"
    ]
    assert bench.column("state")[fault - 1 : fault + 1] == [S.CONTINUOUS_MOTION, S.ERROR_STOP]


def test_above_the_control_limit_no_following_error_is_watched() -> None:
    limits = {"following_error_monitoring": True, "following_error_limit": 100.0, "control_limit": 600.0 * RPM}
    bench = spindle_bench(**limits)
    bench.accepted("start", direction="cw", speed_rpm=3000.0)
    bench.run(700)
    assert bench.events == [] and max(bench.column("following_error_deg")) == pytest.approx(360.0, abs=1e-3)


def test_hli_bits() -> None:
    bench = spindle_bench()
    bench.run(10)
    assert bench.column("status_bits")[-1] == SpindleBit.POSITION_CONTROL
    bench.accepted("stop_at_program_end", enabled=True)
    bench.accepted("start", direction="cw", speed_rpm=100.0)
    bench.run(10)
    wanted = SpindleBit.POSITION_CONTROL | SpindleBit.MONITORING_ACTIVE | SpindleBit.STOP_AT_PROGRAM_END
    assert bench.column("status_bits")[-1] == wanted
    bench.accepted("stop_at_program_end", enabled=False)
    bench.run(10)
    assert bench.column("status_bits")[-1] == SpindleBit.POSITION_CONTROL | SpindleBit.MONITORING_ACTIVE


def test_hli_speeds_and_positions() -> None:
    bench = spindle_bench()
    bench.accepted("set_override", percent=50.0)
    bench.accepted("start", direction="ccw", speed_rpm=100.0)
    bench.run(100)
    assert bench.column("programmed_speed_rpm")[-1] == -100.0 and bench.column("set_speed_rpm")[-1] == -50.0
    assert bench.column("target_position_deg") == bench.column("set_position_deg")
    assert set(bench.column("distance_to_go_deg")) == {0.0}
    bench.accepted("orient", position_deg=90.0, speed_rpm=60.0)
    bench.run(300)
    target, position, left = (
        bench.column(f"{name}_deg")[150] for name in ("target_position", "set_position", "distance_to_go")
    )
    assert target % 360.0 == pytest.approx(90.0) and left == target - position != 0.0


def test_a_speed_reached_of_before_does_not_hold_for_the_next_speed() -> None:
    bench = spindle_bench()
    bench.accepted("start", direction="cw", speed_rpm=1000.0)
    bench.run(400)
    bench.accepted("set_speed", speed_rpm=3000.0)
    bench.run(10)
    assert bench.column("speed_reached")[399] and not any(bench.column("speed_reached")[400:])


def test_settled_blocks_give_the_same_numbers_as_others() -> None:
    """One bench cannot take the shorter direction."""
    benches = [spindle_bench(), spindle_bench()]
    for bench in benches:
        for command, arguments in (
            ("start", {"direction": "cw", "speed_rpm": 777.0}),
            ("set_override", {"percent": 70.0}),
            ("orient", {"position_deg": 12.0}),
            ("upstream_lost", {"source": "plc"}),
            ("reset", {}),
            ("power", {"enabled": False}),
        ):
            bench.accepted(command, **arguments)
            for _ in range(60):
                bench.unit.spindle.unsettled |= bench is benches[1]
                bench.run(10)
    assert benches[0].columns() == benches[1].columns()
    assert first_cycle(benches[0], "state", lambda state: state == S.DISABLED) == 3000
