"""Jobs of units: what the PLC is told of each command that moves something."""

from __future__ import annotations

from machine_support import MachineBench, axis_bench

from cnc_ptp.protocol.blocks import JobEvent
from cnc_ptp.protocol.jobs import Jobs, JobStatus

ACTIVE, DONE, ABORTED, FAILED = JobStatus


def told(bench: object, unit: str | None = None) -> list[tuple[int, int]]:
    blocks = bench.blocks if unit is None else bench.blocks[unit]  # type: ignore[attr-defined]
    return [(event.job, event.status) for block in blocks for event in block.job_events]


def events(bench: object) -> list[JobEvent]:
    return [event for block in bench.blocks for event in block.job_events]  # type: ignore[attr-defined]


def test_a_positioning_is_active_until_its_target_and_done_in_that_cycle() -> None:
    bench = axis_bench()
    record = bench.give("move_absolute", target=10.0)
    bench.run(1000)
    assert record.job == 1 and bench.blocks[0].job == 1 and bench.last.job == 0
    begun, done = events(bench)
    assert begun == JobEvent(1, ACTIVE, 0)
    assert done.status == DONE and bench.column("set_position")[done.cycle] == 10.0
    assert bench.column("set_position")[done.cycle - 1] != 10.0


def test_a_halt_aborts_a_positioning_and_is_done_at_the_standstill() -> None:
    bench = axis_bench()
    bench.accepted("move_absolute", target=1000.0)
    bench.run(200)
    bench.accepted("halt")
    bench.run(2000)
    assert told(bench) == [(1, ACTIVE), (1, ABORTED), (2, ACTIVE), (2, DONE)]
    assert events(bench)[1].cycle == 200 and bench.column("set_velocity")[events(bench)[3].cycle] == 0.0


def test_a_refused_command_has_no_job() -> None:
    bench = axis_bench()
    record = bench.give("move_absolute", target=1e9)
    bench.run(20)
    assert (record.accepted, record.job) == (False, 0) and told(bench) == []


def test_a_distance_below_an_increment_is_done_at_once() -> None:
    bench = axis_bench()
    bench.accepted("move_relative", distance=0.0)
    bench.run(10)
    assert told(bench) == [(1, ACTIVE), (1, DONE)]


def test_a_jog_is_active_until_it_is_ended_and_no_jog_is_ended_where_there_is_none() -> None:
    bench = axis_bench()
    bench.accepted("jog", velocity=0.0)
    bench.run(10)
    assert told(bench) == []
    bench.accepted("jog", velocity=20.0)
    bench.run(500)
    assert told(bench) == [(1, ACTIVE)]
    bench.accepted("jog", velocity=0.0)
    bench.run(500)
    assert told(bench)[1:] == [(1, ABORTED), (2, ACTIVE), (2, DONE)]


def test_a_fault_fails_the_job_with_its_number() -> None:
    bench = axis_bench()
    bench.accepted("move_absolute", target=1000.0)
    bench.run(200)
    bench.accepted("upstream_lost", source="plc")
    bench.run(10)
    assert events(bench)[-1] == JobEvent(1, FAILED, 200, 26101)


def test_a_job_without_power_is_aborted() -> None:
    bench = axis_bench()
    bench.accepted("move_absolute", target=1000.0)
    bench.run(200)
    bench.accepted("power", enabled=False)
    bench.run(3000)
    assert told(bench) == [(1, ACTIVE), (1, ABORTED)]


def test_the_plc_is_told_what_became_of_its_commands() -> None:
    """A positioning and one that must wait, a rotation, a program; ids as the PLC has sent them."""
    scenario = (
        "- {at: 2, to: x, do: move_absolute, target: 1}\n- {at: 2, to: x, do: move_absolute, target: 2}\n"
        "- {at: 0, to: s, do: start, direction: cw, speed_rpm: 600}\n- {at: 1, to: s, do: stop}"
    )
    bench = MachineBench("%P\nG01 Y1 F3000\nM30", scenario).run()
    answers = {unit: [a for block in bench.blocks[unit] for a in block.answers] for unit in ("x", "s", "channel")}
    sent = {command.id: command.target for block in bench.blocks["plc"] for command in block.commands}
    assert all(sent[answer.id] == unit for unit, given in answers.items() for answer in given)
    accepted, refused = answers["x"]
    assert (accepted.error_id, accepted.job, accepted.message) == (0, 1, "")
    assert refused.error_id == 23005 and refused.job == 0 and "move_absolute refused" in refused.message
    assert told(bench, "x") == [(1, ACTIVE), (1, DONE)]
    assert told(bench, "s") == [(1, ACTIVE), (1, ABORTED), (2, ACTIVE), (2, DONE)]
    assert [a.job for a in answers["channel"]] == [0, 1] and told(bench, "channel") == [(1, ACTIVE), (1, DONE)]


def test_a_gear_change_is_part_of_the_rotation_that_needs_it_and_a_waiting_job_is_aborted_by_a_stop() -> None:
    """Job 2 waits behind the homing (job 1); job 3, a stop, aborts both."""
    scenario = (
        "- {at: 0, to: s, do: home, source: plc}\n- {at: 0.05, to: s, do: orient, position_deg: 90, source: plc}\n"
        "- {at: 0.1, to: s, do: stop, source: plc}"
    )
    bench = MachineBench(None, scenario).run()
    assert sorted(told(bench, "s")) == sorted([(1, ACTIVE), (1, ABORTED), (2, ABORTED), (3, ACTIVE), (3, DONE)])


def test_a_reset_in_motion_aborts_the_job_of_an_axis_and_of_a_spindle() -> None:
    """It stops them, and is no job."""
    scenario = (
        "- {at: 0, to: x, do: move_absolute, target: 200}\n- {at: 0, to: s, do: start, direction: cw, speed_rpm: 600}\n"
        "- {at: 0.3, to: x, do: reset}\n- {at: 0.3, to: s, do: reset}"
    )
    bench = MachineBench(None, scenario).run()
    for unit in ("x", "s"):
        assert told(bench, unit) == [(1, ACTIVE), (1, ABORTED)]


def test_power_off_aborts_the_job_immediately() -> None:
    """Also if the enable is back before the axis is at a standstill."""
    bench = axis_bench()
    bench.accepted("move_absolute", target=1000.0)
    bench.run(200)
    bench.accepted("power", enabled=False)
    bench.run(10)
    bench.accepted("power", enabled=True)
    bench.run(3000)
    assert events(bench) == [JobEvent(1, ACTIVE, 0), JobEvent(1, ABORTED, 200)]


def test_a_new_target_that_waits_for_the_end_of_a_stop_is_active_then() -> None:
    bench = axis_bench()
    bench.accepted("move_absolute", target=1000.0)
    bench.run(200)
    bench.accepted("stop")
    bench.run(10)
    bench.accepted("new_target", target=900.0)
    bench.run(10)
    bench.accepted("new_target", target=950.0)
    bench.run(3000)
    active = events(bench)[-2]
    assert told(bench) == [
        (1, ACTIVE), (1, ABORTED), (2, ACTIVE), (3, ABORTED), (2, DONE), (4, ACTIVE), (4, DONE)
    ]  # fmt: skip
    assert bench.column("set_velocity")[active.cycle] == 0.0 and bench.column("set_position")[-1] == 950.0


def test_a_stop_drops_a_new_target_that_waits() -> None:
    bench = axis_bench()
    bench.accepted("move_absolute", target=1000.0)
    bench.run(200)
    bench.accepted("stop")
    bench.accepted("new_target", target=900.0)
    bench.accepted("stop")
    bench.run(3000)
    assert told(bench) == [
        (1, ACTIVE), (1, ABORTED), (2, ACTIVE), (3, ABORTED), (2, ABORTED), (4, ACTIVE), (4, DONE)
    ]  # fmt: skip


def test_a_coupling_that_cannot_start_has_failed() -> None:
    """A flying saw whose master is at a standstill."""
    scenario = "- {at: 0, to: y, do: couple_flying_saw, master: x, factor: 1, master_position: 9, slave_position: 9}"
    bench = MachineBench(None, scenario).run()
    (failed,) = [event for block in bench.blocks["y"] for event in block.job_events if event.status != ACTIVE]
    assert (failed.status, failed.error_id) == (FAILED, 23051)


def test_a_program_that_is_resumed_is_the_same_job_and_a_reset_aborts_it() -> None:
    scenario = "- {at: 1, to: channel, do: start}\n- {at: 1.2, to: channel, do: reset}"
    bench = MachineBench("%P\nG01 X1 F3000\nM00\nG01 X100 F1000\nM30", scenario).run()
    assert told(bench, "channel") == [(1, ACTIVE), (1, ABORTED), (2, ACTIVE), (2, DONE)]


def test_jobs_alone() -> None:
    jobs = Jobs()
    assert (jobs.begin(5), jobs.begin(7), jobs.accept()) == (1, 2, 3)
    jobs.drop(8, 3)
    jobs.end(9, FAILED, 42)
    jobs.end(10, DONE)
    assert jobs.take_events() == [
        JobEvent(1, ACTIVE, 5), JobEvent(1, ABORTED, 7), JobEvent(2, ACTIVE, 7), JobEvent(3, ABORTED, 8),
        JobEvent(2, FAILED, 9, 42),
    ]  # fmt: skip
    assert jobs.take_events() == [] and jobs.active == 0


def test_a_superimposed_job_is_active_beside_the_other() -> None:
    jobs = Jobs()
    assert (jobs.begin(5), jobs.begin_superimposed(6), jobs.begin_superimposed(7)) == (1, 2, 3)
    assert (jobs.active, jobs.superimposed) == (1, 3)
    jobs.end(8, DONE)
    jobs.end_superimposed(9, FAILED, 42)
    jobs.end_superimposed(9, DONE)
    assert jobs.take_events() == [
        JobEvent(1, ACTIVE, 5), JobEvent(2, ACTIVE, 6), JobEvent(2, ABORTED, 7), JobEvent(3, ACTIVE, 7),
        JobEvent(1, DONE, 8), JobEvent(3, FAILED, 9, 42),
    ]  # fmt: skip
