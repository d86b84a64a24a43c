"""Whole sweeps computed in this process: results, failures, what is taken over, what is refused."""

import json
import math
import os
import sys
from contextlib import suppress
from types import SimpleNamespace

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from commands_support import MILL, call
from sweep_support import KV, LARGEST, PROGRAM, Here, machine, program_in, run_here, sweep_in

import cnc_ptp.recording
from cnc_ptp.errors import CncError
from cnc_ptp.protocol.blocks import PlcBlock
from cnc_ptp.sweep.journal import Journal
from cnc_ptp.sweep.optimiser import OptimisedPlan
from cnc_ptp.sweep.plans import random_plan
from cnc_ptp.sweep.pool import Pool
from cnc_ptp.sweep.results import Results, Row
from cnc_ptp.sweep.table import write_table
from cnc_ptp.sweep.variant_run import Failure, Run, compute

NEW_NAME = "; nothing was started, give another name"


def test_goals_are_those_of_a_recording_of_the_same_run(tmp_path):
    """A second way: the machine file is changed as text, simulated, recorded and read again."""
    goals = [LARGEST, "rms(following_error.y)", "max(path_velocity)", "program_time"]
    sweep = sweep_in(tmp_path, "x.getriebe.0.kv=3000,7000", goals=goals)
    assert run_here(sweep)
    for row in sweep.results.rows:
        text = MILL.read_text().replace("kv: 5000  # 50 1/s", f"kv: {row.values[0]}")
        (tmp_path / "mill.yaml").write_text(text)
        record = tmp_path / f"{row.number}.mcap"
        done = call("simulate", tmp_path / "mill.yaml", "--program", program_in(tmp_path), "--record", record)
        assert f"program time {row.goals[3]:.3f} s" in done.output
        assert f"largest following error x: {row.goals[0]:.4f} mm" in done.output
        with cnc_ptp.recording.open(record) as recording:
            x, y = (recording.columns(f"/{axis}/state", "following_error")["following_error"] for axis in "xy")
            velocity = recording.columns("/channel/state", "path_velocity")["path_velocity"]
        assert row.goals[:3] == (np.abs(x).max(), np.sqrt(np.mean(np.square(np.abs(y)))), velocity.max())


def test_the_following_error_falls_with_kv(tmp_path):
    """At a constant velocity it is v / Kv; here nearly, as the axis is never at one for long."""
    sweep = sweep_in(tmp_path)
    assert run_here(sweep)
    table = pq.read_table(sweep.target).to_pydict()
    assert table["variant"] == [0, 1, 2, 3, 4]
    assert table["x.getriebe.0.kv"] == [2000, 3500, 5000, 6500, 8000]
    errors = table[LARGEST]
    assert errors == sorted(errors, reverse=True) and errors[0] == pytest.approx(errors[-1] * 4.0, rel=0.5)
    assert table["program_time"] == [pytest.approx(0.53, abs=0.2)] * 5
    assert (table["error"], table["message"]) == ([0] * 5, [""] * 5)
    assert not sweep.journal.exists()


def test_failures_are_rows(tmp_path):
    """The soft limit refuses the program, the following error monitoring stops it, the file is contradictory."""
    varied = "x.kenngr.swe_pos=3000000,20000", "x.getriebe.0.slep_max=150000,1000"
    sweep = sweep_in(tmp_path, *varied)
    assert run_here(sweep)
    whole, followed, refused, also = sweep.results.rows
    assert whole.error == 0 and math.isfinite(whole.goals[0])
    assert followed.error == 17744 and followed.message.startswith("axis x: following error 0.1")
    assert refused.error == also.error == 120002
    assert refused.message.endswith(
        ": axis X: 5 mm lies beyond the positive soft limit 2 mm (P-AXIS-00178); nothing was started"
    )
    assert all(map(math.isnan, (*followed.goals, *refused.goals)))
    assert pq.read_table(sweep.target)[LARGEST].to_pylist()[1:] == [None] * 3
    assert [row.number for row in sweep.results.failed] == [1, 2, 3]


def test_a_machine_that_contradicts_itself_is_a_row(tmp_path):
    varied = "x.getriebe.0.vb_eilgang=300000,600000", "x.getriebe.0.dynamik.vb_max=500000,700000"
    sweep = sweep_in(tmp_path, *varied, goals=["program_time"])
    assert run_here(sweep)
    assert [row.error for row in sweep.results.rows] == [0, 0, 25009, 0]
    message = sweep.results.rows[2].message
    assert "value 600000 is above the maximum 500000" in message
    assert message.endswith("; the variant was not computed")


def test_a_program_that_the_duration_cuts_off_is_a_row(tmp_path):
    sweep = sweep_in(tmp_path, "x.getriebe.0.kv=5000", seconds=0.2)
    assert run_here(sweep)
    (row,) = sweep.results.rows
    assert row.error == 26121
    assert row.message.startswith("channel channel: --duration 0.2 s has cut off the program in line ")


def test_a_goal_that_is_not_finite_is_a_row(tmp_path):
    sweep = sweep_in(tmp_path, "x.getriebe.0.kv=5000", goals=["1 / max(actual_torque.z)"])
    assert run_here(sweep)
    (row,) = sweep.results.rows
    assert (row.error, row.message) == (26179, "--goal: 1 / max(actual_torque.z) is inf, not a finite number")


def test_a_run_that_breaks_off_is_a_row(tmp_path, monkeypatch):
    sweep = sweep_in(tmp_path, "x.getriebe.0.kv=5000")

    def broken(*arguments, **options):
        raise ZeroDivisionError("division by zero")

    monkeypatch.setattr("cnc_ptp.sweep.variant_run.build_units", broken)
    (variant,) = next(sweep.plan.batches())
    row = compute(sweep.job, variant)
    assert (row.error, row.message) == (26187, "the run broke off, ZeroDivisionError: division by zero")


def test_a_run_that_fails_without_an_error_is_a_row(tmp_path):
    """Here the PLC's report alone says so: a run that nobody can continue is aborted by it."""
    sweep = sweep_in(tmp_path, "x.getriebe.0.kv=5000")
    run = Run(machine(), [])
    run.add({"plc": SimpleNamespace(name="plc", block=PlcBlock(0, 10, run_failed=True), events=[], records=[])})
    with pytest.raises(Failure) as caught:
        run.require_whole(sweep.job.seconds)
    assert (caught.value.number, caught.value.text) == (26187, "the run failed")


def test_an_interrupted_sweep_continues_and_ends_as_one_without_a_break(tmp_path):
    whole = sweep_in(tmp_path)
    assert run_here(whole)
    expected = whole.target.read_bytes()
    whole.target.unlink()
    first, second, third = sweep_in(tmp_path), sweep_in(tmp_path), sweep_in(tmp_path)
    assert not run_here(first, Here(after=2))
    assert not first.target.exists() and len(first.journal.read_text().splitlines()) == 3
    with first.journal.open("a") as file:
        file.write('{"variant": [2, [50')  # as a process leaves it that is killed while it writes
    pool = Here()
    assert run_here(second, pool)
    assert (pool.computed, second.taken_over) == ([2, 3, 4], 2)
    assert second.target.read_bytes() == expected and not second.journal.exists()
    none = Here()
    assert run_here(third, none)
    assert (none.computed, third.taken_over, third.results.rows) == ([], 5, whole.results.rows)


@pytest.mark.parametrize("damaged", ["damaged", '{"variant": [1, 5, [], 0, ""]}', '{"variant": 7}'])
def test_a_damaged_line_of_a_journal_is_computed_again(tmp_path, damaged):
    """Numbers in place of lists: bench.fuzz sweep-journal seed 420 number 5684."""
    sweep = sweep_in(tmp_path)
    assert not run_here(sweep, Here(after=3))
    lines = sweep.journal.read_text().splitlines()
    sweep.journal.write_text("\n".join([*lines[:2], damaged, lines[3]]) + "\n")
    pool = Here()
    assert run_here(sweep_in(tmp_path), pool)
    assert pool.computed == [1, 3, 4]


def test_another_sweep_into_the_same_file_is_refused(tmp_path):
    sweep = sweep_in(tmp_path)
    assert run_here(sweep)
    before = sweep.target.read_bytes()
    other = sweep_in(
        tmp_path, "x.getriebe.0.kv=2000:8000:3", goals=[LARGEST], program=PROGRAM.replace("X5", "X6"), seconds=9.0
    )
    with pytest.raises(CncError) as caught:
        run_here(other)
    assert str(caught.value) == (
        f"P-ERR-26182 {sweep.target} is of another sweep: the program or scenario file has another content, "
        "--vary was x.getriebe.0.kv=2000:8000:5, is x.getriebe.0.kv=2000:8000:3, "
        "--goal was max(following_error.x) program_time, is max(following_error.x), --duration was not given, is 9.0"
        f"{NEW_NAME}"
    )
    assert sweep.target.read_bytes() == before


def test_a_journal_of_another_sweep_is_refused(tmp_path):
    sweep = sweep_in(tmp_path)
    assert not run_here(sweep, Here(after=2))
    kept = sweep.journal.read_text()
    other = sweep_in(tmp_path, KV, make_plan=lambda variations: random_plan(variations, 3, 7))
    with pytest.raises(CncError) as caught:
        run_here(other)
    assert (
        str(caught.value)
        == f"P-ERR-26182 {sweep.journal} is of another sweep: plan was grid, is random 3, seed 7{NEW_NAME}"
    )
    assert sweep.journal.read_text() == kept


def test_a_file_that_is_no_journal_is_refused(tmp_path):
    sweep = sweep_in(tmp_path)
    sweep.journal.write_text("notes of mine\n")
    with pytest.raises(CncError) as caught:
        run_here(sweep)
    assert str(caught.value) == f"P-ERR-26182 {sweep.journal} is no journal of a sweep{NEW_NAME}"
    assert sweep.journal.read_text() == "notes of mine\n"


def test_two_at_a_time_are_refused(tmp_path):
    sweep = sweep_in(tmp_path)
    with Journal(sweep.journal, sweep.description()), pytest.raises(CncError) as caught:
        run_here(sweep_in(tmp_path))
    assert str(caught.value) == f"P-ERR-26182 {sweep.journal} is being written by another sweep; nothing was started"


def test_other_values_of_a_variant_are_refused(tmp_path):
    sweep = sweep_in(tmp_path)
    with Journal(sweep.journal, sweep.description()) as journal:
        journal.add(Row(0, (2001,), (1.0, 1.0)))
    with pytest.raises(CncError) as caught:
        run_here(sweep)
    reason = f"{sweep.journal} has other values of variant 0: (2001,), not (2000,)"
    assert str(caught.value) == f"P-ERR-26182 {reason}{NEW_NAME}"


def test_a_foreign_parquet_file_is_refused(tmp_path):
    sweep = sweep_in(tmp_path)
    pq.write_table(pa.table({"a": [1]}), sweep.target)
    with pytest.raises(CncError) as caught:
        run_here(sweep)
    assert str(caught.value) == f"P-ERR-26183 {sweep.target} exists and is no table of a sweep{NEW_NAME}"


def test_a_file_that_is_no_parquet_is_refused(tmp_path):
    sweep = sweep_in(tmp_path)
    sweep.target.write_text("text")
    with pytest.raises(CncError) as caught:
        run_here(sweep)
    assert str(caught.value).startswith(f"P-ERR-26183 {sweep.target} exists and cannot be read as Parquet: ")
    assert str(caught.value).endswith(NEW_NAME)
    assert sweep.target.read_text() == "text"


def test_a_folder_that_cannot_be_written(tmp_path):
    """A folder in the place of the journal: as root, no rights are missing."""
    sweep = sweep_in(tmp_path)
    sweep.journal.mkdir()
    with pytest.raises(CncError) as caught:
        run_here(sweep)
    assert str(caught.value) == f"P-ERR-27030 {sweep.journal} cannot be written: Is a directory; nothing was started"


class Full:
    """A file on a disk that is full."""

    def write(self, text):
        raise OSError(28, "No space left on device")

    def close(self):
        raise OSError(28, "No space left on device")


def test_a_full_disk_keeps_what_is_finished(tmp_path):
    sweep = sweep_in(tmp_path)
    with pytest.raises(CncError) as caught, Journal(sweep.journal, sweep.description()) as journal:
        journal.add(Row(0, (2000,), (0.5, 1.0)))
        own, journal._file = journal._file, Full()
        with suppress(KeyError):
            journal.add(Row(1, (3500,), (0.5, 1.0)))
    own.close()
    kept = "what is finished is kept, the same command continues"
    assert str(caught.value) == f"P-ERR-27030 {sweep.journal} cannot be written: No space left on device; {kept}"
    assert json.loads(sweep.journal.read_text().splitlines()[1]) == {"variant": [0, [2000], [0.5, 1.0], 0, ""]}


def test_a_table_that_cannot_be_written_leaves_the_journal(tmp_path, monkeypatch):
    sweep = sweep_in(tmp_path, "x.getriebe.0.kv=5000")

    def full(table, file, **options):
        file.write_bytes(b"PAR1")
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(pq, "write_table", full)
    with pytest.raises(CncError) as caught:
        run_here(sweep)
    kept = "what is finished is kept, the same command continues"
    assert str(caught.value) == f"P-ERR-27030 {sweep.target} cannot be written: No space left on device; {kept}"
    assert sorted(os.listdir(tmp_path)) == ["short.nc", "sweep.parquet.journal"]


def test_an_optimiser_finds_the_best_kv_and_can_be_interrupted(tmp_path):
    """The goal has one minimum, at Kv = 5200; nothing is run for it."""

    def new():
        sweep = sweep_in(
            tmp_path, "x.getriebe.0.kv=2000:8000", goals=["program_time"], make_plan=lambda variations: None
        )
        sweep.plan = OptimisedPlan(sweep.variations, sweep.goals, 40, 3)
        return sweep

    def parabola(variant):
        return Row(*variant, ((variant.values[0] - 5200) ** 2 * 1.0,))

    whole = new()
    assert run_here(whole, Here(fails=parabola))
    best = whole.results.best(0)
    assert abs(best.values[0] - 5200) < 150
    expected = whole.target.read_bytes()
    whole.target.unlink()
    first, second = new(), new()
    assert not run_here(first, Here(after=19, fails=parabola))
    pool = Here(fails=parabola)
    assert run_here(second, pool)
    assert pool.computed == [*range(19, 40)] and second.target.read_bytes() == expected


def test_an_optimiser_goes_on_after_failures(tmp_path):
    sweep = sweep_in(
        tmp_path,
        "x.getriebe.0.kv=2000:8000",
        "y.getriebe.0.kv=2000,4000",
        goals=["program_time", "max:run_time"],
        make_plan=lambda variations: None,
    )
    sweep.plan = OptimisedPlan(sweep.variations, sweep.goals, 20, 1)

    def half(variant):
        return Row(*variant, (math.nan, math.nan), 26187, "x") if variant.number % 2 else Row(*variant, (1.0, 2.0))

    assert run_here(sweep, Here(fails=half))
    assert len(sweep.results.failed) == 10 and {row.values[1] for row in sweep.results.rows} == {2000, 4000}


def test_pareto_front_against_all_pairs(tmp_path):
    goals = sweep_in(tmp_path, goals=["program_time", "max:run_time"]).goals
    draws = np.random.default_rng(1).integers(0, 8, (60, 2)).astype(float)
    rows = [Row(number, (number,), tuple(draw)) for number, draw in enumerate(draws.tolist())]
    rows.append(Row(60, (60,), (math.nan, math.nan), 1, "failed"))

    def beats(one, other):
        return one[0] <= other[0] and one[1] >= other[1] and one != other

    expected = [row for row in rows[:60] if not any(beats(other.goals, row.goals) for other in rows[:60])]
    assert Results(["a"], goals, rows).pareto_front() == expected


def test_texts_and_mixed_values_become_columns(tmp_path):
    sweep = sweep_in(tmp_path)
    rows = [Row(0, ("VEL", 1), (0.5, 1.0)), Row(1, ("VEL | ACC", 2.5), (0.25, 1.0))]
    write_table(sweep.target, Results(["a", "b"], sweep.goals, rows), sweep.description())
    table = pq.read_table(sweep.target).to_pydict()
    assert (table["a"], table["b"]) == (["VEL", "VEL | ACC"], [1.0, 2.5])


def test_a_package_that_is_missing(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "optuna", None)
    sweep = sweep_in(tmp_path)
    with pytest.raises(CncError) as caught:
        OptimisedPlan(sweep.variations, sweep.goals, 8, 0)
    text = "optuna is not installed; nothing was started, install it with: pip install 'cnc_ptp[sweep]'"
    assert str(caught.value) == f"P-ERR-26013 {text}"


@pytest.mark.parametrize("name", ["pyarrow", "distributed"])
def test_nothing_is_computed_without_a_package(tmp_path, monkeypatch, name):
    monkeypatch.setitem(sys.modules, name, None)
    sweep, pool = sweep_in(tmp_path), Here()
    with pytest.raises(CncError) as caught:
        sweep.run(lambda: Pool(1, None) if name == "distributed" else pool, lambda: False, lambda count: None)
    text = f"{name} is not installed; nothing was started, install it with: pip install 'cnc_ptp[sweep]'"
    assert str(caught.value) == f"P-ERR-26013 {text}"
    assert not pool.computed and not sweep.journal.exists()


def test_an_interrupt_while_workers_start_is_no_error_of_theirs(tmp_path):
    def broken():
        raise CncError(26186, "the worker processes do not start: interrupted", "nothing was started")

    sweep = sweep_in(tmp_path)
    assert not sweep.run(broken, lambda: True, lambda count: None)
    assert not sweep.journal.exists()


@pytest.mark.parametrize("content", [b"my own notes", b"\xff\xfe\n", b"{}\n", b"notes\nmore"])
def test_a_foreign_file_of_the_name_of_the_journal_is_kept(tmp_path, content):
    sweep = sweep_in(tmp_path)
    sweep.journal.write_bytes(content)
    with pytest.raises(CncError) as refused:
        run_here(sweep)
    assert str(refused.value) == (
        f"P-ERR-26182 {sweep.journal} is no journal of a sweep; nothing was started, give another name"
    )
    assert sweep.journal.read_bytes() == content


@pytest.mark.parametrize("content", [b"", b'{"cnc_', b'{"cnc_ptp sweep": {"pro'])
def test_a_journal_that_was_cut_in_its_first_line_begins_again(tmp_path, content):
    sweep = sweep_in(tmp_path)
    sweep.journal.write_bytes(content)
    assert run_here(sweep) and not sweep.journal.exists()
