"""The alarms of a machine: warnings and errors, and who has seen them."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from typing import Any

from cnc_ptp.errors import CncError
from cnc_ptp.protocol.blocks import Event, Severity
from cnc_ptp.web.numbers import BAD_MESSAGE
from cnc_ptp.web.protocol import NOTHING, number_fields

KEPT = 1000
"""Alarms that are remembered, the newest ones."""
SEVERITIES = {Severity.INFO: "info", Severity.WARNING: "warning", Severity.ERROR: "error"}


def event_fields(event: Event, cycle_time: float) -> dict[str, Any]:
    """An event as pages show it; `cycle_time` in s."""
    return {
        "time": round(event.cycle * cycle_time, 6),
        "cycle": event.cycle,
        "source": event.source,
        "severity": SEVERITIES[Severity(event.severity)],
        "text": event.text,
        "line": event.line,
        "values": [value._asdict() for value in event.values],
        **number_fields(event.error_id),
    }


class Alarms:
    """Each warning and error with a number of its own, until it is acknowledged; then it is history."""

    def __init__(self) -> None:
        self._alarms: deque[dict[str, Any]] = deque(maxlen=KEPT)
        self._last = 0
        self._seen: dict[int, str] = {}
        """Of a recording: alarm -> who has acknowledged it."""

    def begin_again(self, events: Sequence[Event], cycle_time: float) -> None:
        """Those of a recording up to another time. An alarm has its number at every time, and stays acknowledged."""
        self._seen |= {alarm["alarm"]: alarm["acknowledged_by"] for alarm in self._alarms if alarm["acknowledged"]}
        found = [event for event in events if event.severity != Severity.INFO]
        self._alarms.clear()
        self._last = max(0, len(found) - KEPT)
        for event in found[-KEPT:]:
            self.take(event_fields(event, cycle_time))

    def take(self, fields: dict[str, Any]) -> dict[str, Any] | None:
        """The alarm of an event, None for one that is none."""
        if fields["severity"] == "info":
            return None
        self._last += 1
        user = self._seen.get(self._last)
        alarm = {
            **fields,
            "alarm": self._last,
            "acknowledged": user is not None,
            "acknowledged_by": user or "",
        }
        self._alarms.append(alarm)
        return alarm

    def acknowledge(self, number: int | None, user: str) -> list[int]:
        """One alarm, or all (None); the numbers of those that were not before. Raises CncError 26233."""
        wanted = [alarm for alarm in self._alarms if number is None or alarm["alarm"] == number]
        if number is not None and not wanted:
            raise CncError(BAD_MESSAGE, f"acknowledge: there is no alarm {number}", NOTHING)
        fresh = [alarm for alarm in wanted if not alarm["acknowledged"]]
        for alarm in fresh:
            alarm.update(acknowledged=True, acknowledged_by=user)
        return [alarm["alarm"] for alarm in fresh]

    def list(self) -> list[dict[str, Any]]:
        return [*self._alarms]
