"""Acknowledgements of alarms as events: by them every page server knows which alarms were acknowledged, and by whom."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple
from zlib import crc32

from cnc_ptp.protocol.blocks import Event, EventValue, Severity
from cnc_ptp.web.faces.face import SOURCE
from cnc_ptp.web.numbers import ALARM_ACKNOWLEDGED

Alarm = Mapping[str, Any]
"""Its fields, as pages have them."""
ALARMS, UP_TO = "alarms", "up to cycle"
"""Units of values: the name of the first one is the user, names of the others are sources of alarms."""


class Acknowledgement(NamedTuple):
    """What its event says."""

    user: str
    values: Mapping[tuple[str, str], float]
    """By source and unit: of one alarm what tells it from others, of all alarms the last cycle of each source."""

    def covers(self, alarm: Alarm) -> bool:
        source = alarm["source"]
        if alarm["cycle"] <= self.values.get((source, UP_TO), -1.0):
            return True
        return all(self.values.get((source, unit)) == value for unit, value in identity(alarm))


def identity(alarm: Alarm) -> Iterator[tuple[str, float]]:
    """What tells an alarm from others of its source, by unit; notices of a machine file differ in their texts alone."""
    yield "cycle", float(alarm["cycle"])
    yield "P-ERR", float(alarm["number"])
    yield "CRC-32 of its text", float(crc32(alarm["text"].encode(errors="replace")))


def of_one(alarm: Alarm, user: str, cycle: int) -> Event:
    number, source, at = alarm["number"], alarm["source"], alarm["cycle"]
    values = [EventValue(source, value, unit) for unit, value in identity(alarm)]
    return told_by(cycle, user, 1, f"P-ERR-{number} of {source} in cycle {at}", values)


def of_all(alarms: Sequence[Alarm], user: str, cycle: int) -> Event:
    """Each source up to its last one, however many there are; what it tells later of cycles before counts as known."""
    last: dict[str, int] = {}
    for alarm in alarms:
        last[alarm["source"]] = max(last.get(alarm["source"], 0), alarm["cycle"])
    until = max(last.values())
    values = [EventValue(source, float(end), UP_TO) for source, end in last.items()]
    return told_by(cycle, user, len(alarms), f"all alarms up to cycle {until}", values)


def told_by(cycle: int, user: str, count: int, what: str, values: list[EventValue]) -> Event:
    text = f"{user}: {what} acknowledged"
    given = [EventValue(user, float(count), ALARMS), *values]
    return Event(cycle, SOURCE, Severity.INFO, ALARM_ACKNOWLEDGED, text, values=given)


def acknowledgement_of(event: Event) -> Acknowledgement | None:
    """None for another event."""
    told = event.source, event.severity, event.error_id
    if told != (SOURCE, Severity.INFO, ALARM_ACKNOWLEDGED) or not event.values:
        return None
    user, *values = event.values
    return Acknowledgement(user.name, {(value.name, value.unit): value.value for value in values})
