"""The alarms of a machine: warnings and errors, and who has seen them."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from typing import Any

from cnc_ptp.errors import CncError
from cnc_ptp.protocol.blocks import Event, Severity
from cnc_ptp.web.faces.acknowledged_file import Acknowledged, AcknowledgedFile
from cnc_ptp.web.numbers import BAD_MESSAGE
from cnc_ptp.web.protocol import NOTHING, number_fields

KEPT = 1000
"""Alarms that are remembered, the newest ones."""
NAMED = 3
"""Alarms that the event of an acknowledgement names."""
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

    def __init__(self, file: AcknowledgedFile | None = None) -> None:
        """`file`: of a machine that runs, what was acknowledged before."""
        self._alarms: deque[dict[str, Any]] = deque(maxlen=KEPT)
        self._last = 0
        self._file = file
        self._seen: dict[tuple[Any, ...], list[str]] = {}
        """Alarm that comes again -> who has acknowledged it."""
        self._expect(file.read() if file else [])

    def _expect(self, acknowledged: Sequence[Acknowledged]) -> None:
        for *alarm, user in acknowledged:
            self._seen.setdefault(tuple(alarm), []).append(user)

    def begin_again(self, events: Sequence[Event], cycle_time: float) -> None:
        """Those of a recording up to another time. An alarm has its number at every time, and stays acknowledged."""
        self._expect([acknowledged(alarm) for alarm in self._alarms if alarm["acknowledged"]])
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
        users = self._seen.get(identity(fields))
        alarm = {
            **fields,
            "alarm": self._last,
            "acknowledged": bool(users),
            "acknowledged_by": users.pop(0) if users else "",
        }
        self._alarms.append(alarm)
        return alarm

    def acknowledge(self, number: int | None, user: str) -> list[dict[str, Any]]:
        """One alarm, or all (None); those that were not before. Raises CncError 26233."""
        wanted = [alarm for alarm in self._alarms if number is None or alarm["alarm"] == number]
        if number is not None and not wanted:
            raise CncError(BAD_MESSAGE, f"acknowledge: there is no alarm {number}", NOTHING)
        fresh = [alarm for alarm in wanted if not alarm["acknowledged"]]
        for alarm in fresh:
            alarm.update(acknowledged=True, acknowledged_by=user)
        return fresh

    def keep(self, fresh: Sequence[dict[str, Any]]) -> str:
        """For servers that begin later, that these were acknowledged; a warning where that cannot be."""
        reason = self._file.add([acknowledged(alarm) for alarm in fresh]) if self._file and fresh else ""
        return f"{reason}; a server that begins later shows these alarms open" if reason else ""

    def list(self) -> list[dict[str, Any]]:
        return [*self._alarms]


def identity(alarm: dict[str, Any]) -> tuple[Any, ...]:
    """What it has wherever it is seen."""
    return alarm["source"], alarm["cycle"], alarm["number"], alarm["text"]


def acknowledged(alarm: dict[str, Any]) -> Acknowledged:
    return *identity(alarm), alarm["acknowledged_by"]


def acknowledged_text(alarms: Sequence[dict[str, Any]]) -> str:
    """For others, who do not have the numbers of this server."""
    named = ", ".join(f"{name_of(alarm)} of {alarm['source']} in cycle {alarm['cycle']}" for alarm in alarms[:NAMED])
    return f"{named} and {len(alarms) - NAMED} more" if len(alarms) > NAMED else named


def name_of(alarm: dict[str, Any]) -> str:
    word = "P-ERR" if alarm["severity"] == "error" else "P-WARN"
    return f"{word}-{alarm['number']}" if alarm["number"] else alarm["severity"]
