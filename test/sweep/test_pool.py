"""Sweeps on workers: the same bytes on any number of them and on a scheduler elsewhere, whatever dies meanwhile."""

import os
import signal
import socket
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import psutil
import pytest
from commands_support import MILL, ROOT
from sweep_support import LARGEST, deadly, program_in, run_here, sweep_in

from cnc_ptp.errors import CncError
from cnc_ptp.sweep import pool as pool_module
from cnc_ptp.sweep.pool import Pool

BIN = Path(sys.executable).parent
PATIENCE = 60.0


@pytest.fixture(scope="module")
def expected(tmp_path_factory):
    """The table of a sweep computed in this process."""
    sweep = sweep_in(tmp_path_factory.mktemp("expected"))
    assert run_here(sweep)
    return sweep.target.read_bytes()


def never():
    return False


def nothing(count):
    pass


def test_four_workers_of_which_one_is_killed_give_the_same_bytes(tmp_path, expected):
    sweep = sweep_in(tmp_path)
    killed = []
    with Pool(4, None) as pool:

        def kill_one(finished):
            if finished == 1:
                killed.append(next(iter(pool._client.run(os.getpid).values())))
                os.kill(killed[0], signal.SIGKILL)

        assert sweep.run(lambda: pool, never, kill_one)
    assert killed
    assert sweep.target.read_bytes() == expected


@pytest.mark.long
def test_a_variant_that_kills_its_workers_is_a_row_and_the_others_are_computed(tmp_path, monkeypatch):
    monkeypatch.setattr(pool_module, "compute", deadly)
    sweep = sweep_in(tmp_path)
    assert sweep.run(lambda: Pool(1, None), never, nothing)
    assert [row.error for row in sweep.results.rows] == [0, 26188, 0, 0, 0]
    row = sweep.results.rows[1]
    assert (row.error, row.message) == (26188, "the worker process dies whenever it computes this variant")


@pytest.mark.long
def test_a_worker_that_dask_has_given_up_is_started_again(tmp_path, expected):
    sweep = sweep_in(tmp_path)
    with Pool(1, None) as pool:
        (nanny,) = pool._cluster.workers.values()
        pool._cluster.sync(nanny.close)
        assert sweep.run(lambda: pool, never, nothing)
    assert sweep.target.read_bytes() == expected


def test_a_sweep_without_workers_ends(tmp_path, monkeypatch):
    """It would wait for ever for processes that Dask no longer starts."""
    monkeypatch.setattr(pool_module, "RESTART", 0.5)
    pool = Pool(1, None)
    pool._cluster.scale(0)
    with pytest.raises(CncError) as caught:
        sweep_in(tmp_path).run(lambda: pool, never, nothing)
    kept = "what is finished is kept, the same command continues"
    assert str(caught.value) == f"P-ERR-26186 no worker process lives, and none has started for 0.5 s; {kept}"


def test_a_worker_with_another_kernel_is_refused(tmp_path):
    sweep = sweep_in(tmp_path)
    sweep.job = replace(sweep.job, kernel="0.0.9 1234")
    with pytest.raises(CncError) as caught:
        sweep.run(lambda: Pool(1, None), never, nothing)
    own = sweep_in(tmp_path).job.kernel
    kept = "what is finished is kept, the same command continues"
    assert str(caught.value) == f"P-ERR-26186 a worker has cnc_ptp {own}, this is 0.0.9 1234; {kept}"
    assert not sweep.journal.exists()


def test_a_worker_that_cannot_compute_at_all(tmp_path, monkeypatch):
    monkeypatch.setattr(pool_module, "compute", lambda job, variant: 1 // 0)
    sweep = sweep_in(tmp_path)
    with pytest.raises(CncError) as caught:
        sweep.run(lambda: Pool(1, None), never, nothing)
    reason = "a worker cannot compute: ZeroDivisionError: integer division or modulo by zero"
    assert str(caught.value) == f"P-ERR-26186 {reason}; what is finished is kept, the same command continues"


@pytest.fixture
def scheduler(tmp_path):
    """A scheduler in a process of its own: its address and process."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    options = ["--host", "127.0.0.1", "--port", str(port), "--no-dashboard", "--no-show"]
    with (tmp_path / "scheduler.log").open("w") as log:
        process = subprocess.Popen([BIN / "dask", "scheduler", *options], stdout=log, stderr=log, cwd=tmp_path)
    yield f"tcp://127.0.0.1:{port}", process
    process.terminate()
    process.wait(PATIENCE)


@pytest.fixture
def workers(scheduler, tmp_path):
    """Two workers of it."""
    options = [scheduler[0], "--nworkers", "2", "--nthreads", "1", "--no-dashboard"]
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    with (tmp_path / "workers.log").open("w") as log:
        process = subprocess.Popen(
            [BIN / "dask", "worker", *options], stdout=log, stderr=log, cwd=tmp_path, env=environment
        )
    yield process
    process.terminate()
    process.wait(PATIENCE)


def test_a_scheduler_in_another_process_gives_the_same_bytes(tmp_path, expected, scheduler, workers, monkeypatch):
    monkeypatch.setattr(pool_module, "PATIENCE", PATIENCE)
    sweep = sweep_in(tmp_path)
    assert sweep.run(lambda: Pool(None, scheduler[0]), never, nothing)
    assert sweep.target.read_bytes() == expected
    gone = sweep_in(tmp_path / "..", "x.getriebe.0.kv=2000:8000:100")
    gone.target = tmp_path / "gone.parquet"

    def end_scheduler(finished):
        if finished == 2:
            scheduler[1].kill()

    with pytest.raises(CncError) as caught:
        gone.run(lambda: Pool(None, scheduler[0]), never, end_scheduler)
    text = "P-ERR-26181 the scheduler is gone; what is finished is kept, the same command continues"
    assert str(caught.value) == text
    assert len(gone.journal.read_text().splitlines()) >= 3


def test_a_scheduler_without_workers(tmp_path, scheduler, monkeypatch):
    monkeypatch.setattr(pool_module, "PATIENCE", PATIENCE)
    Pool.close(_connected_to(scheduler[0]))
    monkeypatch.setattr(pool_module, "PATIENCE", 1.0)
    with pytest.raises(CncError) as caught:
        Pool(None, scheduler[0])
    assert str(caught.value) == (
        f"P-ERR-26181 scheduler {scheduler[0]} has no worker; nothing was started, start one with `dask worker "
        f"{scheduler[0]}`"
    )


def _connected_to(address):
    """Waits until the scheduler answers."""
    import distributed

    pool = object.__new__(Pool)
    pool._client, pool._cluster = distributed.Client(address, timeout=PATIENCE), None
    return pool


@pytest.mark.parametrize("address", ["tcp://127.0.0.1:1", "nonsense://a", "127.0.0.1:none"])
def test_a_scheduler_that_is_not_there(tmp_path, address, monkeypatch):
    monkeypatch.setattr(pool_module, "PATIENCE", 1.0)
    started = time.monotonic()
    with pytest.raises(CncError) as caught:
        Pool(None, address)
    assert time.monotonic() - started < 20.0
    assert str(caught.value).startswith(f"P-ERR-26181 scheduler {address} does not answer: ")
    assert str(caught.value).endswith(
        "; nothing was started, start it with `dask scheduler`, or leave out --scheduler: processes of this computer "
        "compute then"
    )


@pytest.mark.parametrize("scheme", ["tcp", "tls"])
def test_a_scheduler_on_a_computer_that_nobody_knows_is_refused_at_once(scheme):
    started = time.monotonic()
    with pytest.raises(CncError) as caught:
        Pool(None, f"{scheme}://no-such-computer.invalid:8786")
    assert time.monotonic() - started < pool_module.PATIENCE
    assert str(caught.value) == (
        f"P-ERR-26181 scheduler {scheme}://no-such-computer.invalid:8786: no computer 'no-such-computer.invalid' is known "
        "here; nothing was started, write its name as `getent hosts` knows it, or its address"
    )


def test_ctrl_c_keeps_what_is_finished_and_leaves_no_process(tmp_path):
    """SIGINT to the whole group, as a terminal sends it."""
    target = tmp_path / "sweep.parquet"
    journal = tmp_path / "sweep.parquet.journal"
    words = [
        BIN / "cnc_ptp",
        "sweep",
        MILL,
        "--program",
        program_in(tmp_path),
        "--vary",
        "x.getriebe.0.kv=2000:8000:2000",
    ]
    words += ["--goal", LARGEST, "--workers", "1", "-o", target]
    process = subprocess.Popen(words, stdout=-1, stderr=-1, text=True, cwd=ROOT, start_new_session=True)
    deadline = time.monotonic() + PATIENCE
    while time.monotonic() < deadline and not (journal.exists() and len(journal.read_text().splitlines()) > 3):
        time.sleep(0.05)
    children = psutil.Process(process.pid).children(recursive=True)
    os.killpg(process.pid, signal.SIGINT)
    output, errors = process.communicate(timeout=PATIENCE)
    kept = len(journal.read_text().splitlines()) - 1
    assert (process.returncode, output) == (130, "")
    text = f"{kept} of 2000 variants are kept in {journal}, the same command computes the others"
    assert errors == f"P-ERR-26106 the sweep was interrupted; {text}\n"
    assert kept >= 3 and not target.exists()
    assert children and not psutil.wait_procs(children, timeout=10.0)[1]


def test_processes_that_do_not_start(monkeypatch):
    def no_cluster(**options):
        raise RuntimeError("Nanny failed to start.")

    monkeypatch.setattr("distributed.LocalCluster", no_cluster)
    with pytest.raises(CncError) as caught:
        Pool(1, None)
    reason = "the worker processes do not start: Nanny failed to start."
    assert str(caught.value) == f"P-ERR-26186 {reason}; nothing was started"
