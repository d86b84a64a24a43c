"""Measures the time of each cycle of a PLC in a file; breaks off one that takes too long, and reports many that do."""

from __future__ import annotations

import signal
import threading
import time
from collections.abc import Callable
from types import FrameType, TracebackType

from cnc_ptp.plc.program.faults import CyclesBehind, CycleTooLong


class PlcWatch:
    """Entered for each call of the PLC.

    A cycle that takes longer than the limit is broken off where it is; in another thread than the main one, which gets
    no signals, and when the PLC has caught that, the fault comes at the end of the cycle. In real time, cycles that
    last longer than their block add up: more than the limit behind is a fault too.
    """

    def __init__(self, limit_ms: float, *, block_ms: float, paced: Callable[[], bool]) -> None:
        """`paced`: whether blocks come in real time."""
        self._limit_ms = limit_ms
        self._block_ms = block_ms
        self._paced = paced
        self._within = False
        self._begun = 0.0
        self._behind_ms = 0.0
        self._raised: CycleTooLong | None = None
        """What has broken the present cycle off, with the line that it met."""
        self._on = threading.current_thread() is threading.main_thread()
        if self._on:
            signal.signal(signal.SIGALRM, self._break_off)

    def _break_off(self, number: int, frame: FrameType | None) -> None:
        if self._within:
            error = self._too_long()
            self._raised = self._raised or error
            raise error

    def _too_long(self) -> CycleTooLong:
        return CycleTooLong(f"the PLC cycle takes longer than {self._limit_ms:g} ms (P-MACH watchdog_ms)")

    def __enter__(self) -> None:
        self._raised, self._begun = None, time.monotonic()
        if self._on:
            self._within = True
            signal.setitimer(signal.ITIMER_REAL, *[self._limit_ms / 1000.0] * 2)  # again, should the PLC catch it

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._on:
            self._within = False
            signal.setitimer(signal.ITIMER_REAL, 0.0)
        if error is None:
            self._judge(1000.0 * (time.monotonic() - self._begun))

    def _judge(self, took_ms: float) -> None:
        """A cycle that has come to its end. Raises what is wrong with its time."""
        if self._raised is not None:
            raise self._raised
        if took_ms > self._limit_ms:
            raise self._too_long()
        self._behind_ms = max(0.0, self._behind_ms + took_ms - self._block_ms) if self._paced() else 0.0
        if self._behind_ms > self._limit_ms:
            keep = f"its cycles keep taking longer than the {self._block_ms:g} ms of a block"
            raise CyclesBehind(f"{keep}, it is more than {self._limit_ms:g} ms behind (P-MACH watchdog_ms)")
