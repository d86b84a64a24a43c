"""Measures the time of each cycle of a PLC in a file, and breaks off one that takes too long."""

from __future__ import annotations

import signal
import threading
from types import FrameType, TracebackType

from cnc_ptp.plc.program.faults import CycleTooLong


class PlcWatch:
    """Entered for each call of the PLC; without effect in another thread than the main one, which gets no signals."""

    def __init__(self, limit_ms: float) -> None:
        self._limit_ms = limit_ms
        self._within = False
        self._on = threading.current_thread() is threading.main_thread()
        if self._on:
            signal.signal(signal.SIGALRM, self._break_off)

    def _break_off(self, number: int, frame: FrameType | None) -> None:
        if self._within:
            raise CycleTooLong(f"the PLC cycle takes longer than {self._limit_ms:g} ms (P-MACH watchdog_ms)")

    def __enter__(self) -> None:
        if self._on:
            self._within = True
            signal.setitimer(signal.ITIMER_REAL, *[self._limit_ms / 1000.0] * 2)  # again, should the PLC catch it

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._on:
            self._within = False
            signal.setitimer(signal.ITIMER_REAL, 0.0)
