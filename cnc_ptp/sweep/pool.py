"""Variants on Dask: processes of this computer, or workers of a scheduler elsewhere. No other file knows Dask."""

from __future__ import annotations

import logging
import os
import re
import socket
import time
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import CancelledError
from types import TracebackType
from typing import Any

from cnc_ptp.errors import CncError
from cnc_ptp.sweep.faults import NO_SCHEDULER, NOTHING, UNFIT_WORKERS, WORKER_LOST, sweep_package
from cnc_ptp.sweep.results import Row, Variant
from cnc_ptp.sweep.variant_run import Job, compute, failed

PATIENCE = 10.0
"""s for a scheduler that does not answer, or has no worker."""
RESTART = 120.0
"""s within which a worker process of this computer that has died is there again; Dask forgets it after 15 s."""
GLANCE = 0.2
"""s between two looks at whether the sweep is to end."""
IN_STOCK = 2
"""Variants that are on their way for each thread of a worker."""
ADDRESS = re.compile(r"(tcp|tls)://(?P<name>[^\[\]:/]+)")
START_IT = "start it with `dask scheduler`, or leave out --scheduler: processes of this computer compute then"
START_WORKER = "start one with `dask worker {}`"
KEPT = "what is finished is kept, the same command continues"


class Pool:
    """Workers for a `with` block.

    Raises CncError 26013 without Dask, 26181 for a scheduler that is not there, 26186 for processes that do not start.

    A variant whose worker dies is computed by another one. If that happens again and again it is computed alone at the
    end, and fails if its worker dies then, too: the other variants on that worker were not at fault.
    """

    def __init__(self, workers: int | None, scheduler: str | None) -> None:
        """`workers`: processes, None: one for each processor; none of them with a `scheduler`."""
        self._distributed = sweep_package("distributed")
        logging.getLogger("distributed").setLevel(logging.CRITICAL)  # what counts is said by errors and rows
        self._cluster: Any = None
        self._worked_at = time.monotonic()
        self._client: Any = self._connected(scheduler) if scheduler else self._started(workers or os.cpu_count() or 1)

    def _started(self, workers: int) -> Any:
        """Raises CncError 26186."""
        try:
            self._cluster = self._distributed.LocalCluster(
                n_workers=workers,
                threads_per_worker=1,
                processes=True,
                memory_limit=0,
                dashboard_address=None,
                silence_logs=logging.CRITICAL,
                preload="cnc_ptp.sweep.worker",
            )
        except (RuntimeError, OSError) as error:
            raise CncError(UNFIT_WORKERS, f"the worker processes do not start: {error}", NOTHING) from None
        return self._distributed.Client(self._cluster)

    def _connected(self, scheduler: str) -> Any:
        """Raises CncError 26181."""
        require_known(scheduler)
        try:
            client = self._distributed.Client(scheduler, timeout=PATIENCE)
        except (OSError, TimeoutError, ValueError, TypeError) as error:
            reason = str(error).splitlines()[0] if str(error) else type(error).__name__
            raise no_scheduler(f"{scheduler} does not answer: {reason}", START_IT) from None
        try:
            client.wait_for_workers(1, timeout=PATIENCE)
        except TimeoutError:
            client.close()
            raise no_scheduler(f"{scheduler} has no worker", START_WORKER.format(scheduler)) from None
        return client

    @property
    def threads(self) -> int:
        """Of all workers at this moment."""
        return sum(self._client.nthreads().values()) or 1

    def compute(self, job: Job, variants: Iterable[Variant], ended: Callable[[], bool]) -> Iterator[Row]:
        """The rows as they are finished, until `ended` says that the sweep is to end. Raises CncError 26181, 26186."""
        suspects: list[Variant] = []
        for variant, future in self._finished(job, variants, IN_STOCK * self.threads, ended):
            if future.status == "error" and self._killed(future):
                suspects.append(variant)
            else:
                yield self._row(future)
        for variant, future in self._finished(job, suspects, 1, ended):
            if future.status == "error" and self._killed(future):
                yield failed(job, variant, WORKER_LOST, "the worker process dies whenever it computes this variant")
            else:
                yield self._row(future)

    def _finished(
        self, job: Job, variants: Iterable[Variant], most: int, ended: Callable[[], bool]
    ) -> Iterator[tuple[Variant, Any]]:
        """Each with its future, at most so many of them on their way."""
        waiting = deque(variants)
        running: dict[Any, Variant] = {}
        while (waiting or running) and not ended():
            while waiting and len(running) < most:
                variant = waiting.popleft()
                running[self._client.submit(compute, job, variant, pure=False)] = variant
            for future in self._done(running):
                yield running.pop(future), future
        for future in running:
            future.cancel()

    def _done(self, running: Iterable[Any]) -> list[Any]:
        """Those that are finished, at most GLANCE later. Raises CncError 26181 when the scheduler is gone, 26186 when
        no worker of this computer comes back.
        """
        try:
            done = self._finished_of(running)
            if self._cluster is not None and not done:
                self._require_worker()
        except (CancelledError, OSError):
            raise CncError(NO_SCHEDULER, "the scheduler is gone", KEPT) from None
        return sorted(done, key=lambda future: str(future.key))

    def _finished_of(self, running: Iterable[Any]) -> set[Any]:
        try:
            done: set[Any] = self._distributed.wait([*running], timeout=GLANCE, return_when="FIRST_COMPLETED").done
        except (TimeoutError, self._distributed.TimeoutError):
            return set()
        return done

    def _require_worker(self) -> None:
        """Asks for the lost ones of this computer: Dask gives up one that dies while it starts.

        Raises CncError 26186 when none comes.
        """
        now = time.monotonic()
        if self._client.nthreads():
            self._worked_at = now
            return
        self._cluster.scale(len(self._cluster.worker_spec))
        if now - self._worked_at > RESTART:
            reason = f"no worker process lives, and none has started for {RESTART:g} s"
            raise CncError(UNFIT_WORKERS, reason, KEPT)

    def _killed(self, future: Any) -> bool:
        return isinstance(future.exception(), self._distributed.KilledWorker)

    def _row(self, future: Any) -> Row:
        """Raises CncError 26186 where a worker cannot compute (what is wrong with a variant is in its row), 26181 when
        the scheduler is gone.
        """
        if future.status == "error":
            error = future.exception()
            if isinstance(error, CncError):
                raise CncError(UNFIT_WORKERS, error.reason, KEPT)
            raise CncError(UNFIT_WORKERS, f"a worker cannot compute: {type(error).__name__}: {error}", KEPT)
        try:
            row: Row = future.result()
        except (CancelledError, OSError):
            raise CncError(NO_SCHEDULER, "the scheduler is gone", KEPT) from None
        return row

    def close(self) -> None:
        self._client.close()
        if self._cluster is not None:
            self._cluster.close()

    def __enter__(self) -> Pool:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


def require_known(scheduler: str) -> None:
    """Raises CncError 26181 for a computer whose name nobody knows: Dask would only say that it does not answer."""
    found = ADDRESS.match(scheduler)
    if found is None:  # Dask says what is wrong with the address
        return
    try:
        socket.getaddrinfo(found["name"], None)
    except (OSError, UnicodeError):
        reason = f"{scheduler}: no computer '{found['name']}' is known here"
        raise no_scheduler(reason, "write its name as `getent hosts` knows it, or its address") from None


def no_scheduler(reason: str, remedy: str) -> CncError:
    return CncError(NO_SCHEDULER, f"scheduler {reason}", f"{NOTHING}, {remedy}")
