"""SIGINT and SIGTERM as a flag, so that a run ends in order instead of being torn apart."""

from __future__ import annotations

import signal
import sys
import threading
import time
from types import FrameType, TracebackType

INTERRUPTED = 26106
"""The run or command was interrupted."""


def end_command(number: int, frame: FrameType | None) -> None:
    """Handler of a signal while no run is active: reports it, and ends the process with 128 + `number`."""
    name = signal.Signals(number).name
    text = f"the command was interrupted ({name}); no run was active"
    print(f"P-ERR-{INTERRUPTED} {text}", file=sys.stderr)
    sys.exit(128 + number)


class EndRequest:
    """Takes the signals from its making to `restore`, or for a `with` block; an active callback is finished first."""

    def __init__(self) -> None:
        self.number = 0
        """The last signal that came, 0 = none."""
        self.deadline = 0.0
        """Monotonic time by which the process ends; 0 = not decided yet."""
        self._count = 0
        self._before = {number: signal.signal(number, self._handle) for number in (signal.SIGINT, signal.SIGTERM)}

    def _handle(self, number: int, frame: FrameType | None) -> None:
        self.number = number
        self._count += 1

    @property
    def given(self) -> bool:
        return self._count > 0

    @property
    def repeated(self) -> bool:
        return self._count > 1

    def over(self, patience: float) -> bool:
        """True at the second signal, or `patience` seconds after the first was seen."""
        if self.deadline == 0.0:
            self.deadline = time.monotonic() + patience
        return self.repeated or time.monotonic() > self.deadline

    def text(self, what_follows: str) -> str:
        """The message about it."""
        name = signal.Signals(self.number).name
        return f"P-ERR-{INTERRUPTED} the run was interrupted ({name}); {what_follows}"

    def restore(self) -> None:
        for number, handler in self._before.items():
            signal.signal(number, handler)

    def __enter__(self) -> EndRequest:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.restore()


class HeldSignals:
    """Holds SIGINT and SIGTERM back for a `with` block, in the main thread, and lets them act at its end."""

    def __init__(self) -> None:
        self.given: list[int] = []

    def __enter__(self) -> HeldSignals:
        main = threading.current_thread() is threading.main_thread()
        self._before = {number: signal.signal(number, self._hold) for number in HELD} if main else {}
        return self

    def _hold(self, number: int, frame: FrameType | None) -> None:
        self.given.append(number)

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        for number, handler in self._before.items():
            signal.signal(number, handler)
        for given in self.given:
            signal.raise_signal(given)


HELD = (signal.SIGINT, signal.SIGTERM)
