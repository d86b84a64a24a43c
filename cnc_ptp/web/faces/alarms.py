"""The alarms of a machine: warnings and errors, and who has seen them."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from typing import Any

from cnc_ptp.errors import CncError
from cnc_ptp.protocol.blocks import Event, Severity
from cnc_ptp.web.faces.acknowledgement import Acknowledgement, acknowledgement_of, of_all, of_one
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
        self._told: deque[Acknowledgement] = deque(maxlen=KEPT)
        """By events: one may come before its alarm, which another node tells."""
        self._given: deque[Acknowledgement] = deque(maxlen=KEPT)
        """Here; those of a page of a recording hold at every time."""

    def begin_again(self, events: Sequence[Event], cycle_time: float) -> None:
        """Those of a recording up to another time. An alarm has its number at every time."""
        found = [event for event in events if event.severity != Severity.INFO]
        self._alarms.clear()
        self._told.clear()
        self._told.extend(filter(None, map(acknowledgement_of, events)))
        self._last = max(0, len(found) - KEPT)
        for event in found[-KEPT:]:
            self.take(event_fields(event, cycle_time))

    def take(self, fields: dict[str, Any]) -> dict[str, Any] | None:
        """The alarm of an event, None for one that is none."""
        if fields["severity"] == "info":
            return None
        self._last += 1
        given = next((each for each in (*self._told, *self._given) if each.covers(fields)), None)
        alarm = {
            **fields,
            "alarm": self._last,
            "acknowledged": given is not None,
            "acknowledged_by": given.user if given is not None else "",
        }
        self._alarms.append(alarm)
        return alarm

    def acknowledgement(self, number: int | None, user: str, cycle: int) -> Event | None:
        """Of one alarm, or of all (None), by a user in a cycle; None where none is open. Raises CncError 26233."""
        wanted = [alarm for alarm in self._alarms if number is None or alarm["alarm"] == number]
        if number is not None and not wanted:
            raise CncError(BAD_MESSAGE, f"acknowledge: there is no alarm {number}", NOTHING)
        fresh = [alarm for alarm in wanted if not alarm["acknowledged"]]
        if not fresh:
            return None
        return of_all(fresh, user, cycle) if number is None else of_one(fresh[0], user, cycle)

    def acknowledge(self, event: Event, *, is_own: bool = False) -> dict[str, Any] | None:
        """What an event acknowledges: numbers of alarms that were not before, and the user; None for another event."""
        given = acknowledgement_of(event)
        if given is None:
            return None
        (self._given if is_own else self._told).append(given)
        fresh = [alarm for alarm in self._alarms if not alarm["acknowledged"] and given.covers(alarm)]
        for alarm in fresh:
            alarm.update(acknowledged=True, acknowledged_by=given.user)
        return {"alarms": [alarm["alarm"] for alarm in fresh], "user": given.user}

    def list(self) -> list[dict[str, Any]]:
        return [*self._alarms]
