"""What can go wrong with a client, besides what units refuse."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from numbers import Real
from reprlib import repr as repr_of

from cnc_ptp.errors import CncError, Value, nearest_name
from cnc_ptp.machine.wiring import UNKNOWN_UNIT
from cnc_ptp.protocol.blocks import Event
from cnc_ptp.protocol.commands import BAD_ARGUMENT, is_finite

TIMEOUT = 26170
GONE = 26171
CLOSED = 26172
ABORTED = 26173
NOTHING_MOVES = 26174
UNSEEN = 26175
NOT_STARTED = 26176
NO_RECORDER = 26221
IT_CONTINUES = "it continues"


def check_seconds(where: str, name: str, value: float | None, effect: str, *, finite: bool = False) -> None:
    """Raises CncError 22001 for a time that is no number, or has no end or is below 0 where it must pass."""
    if value is None:
        return
    if not isinstance(value, Real) or value != value:
        why = "not finite" if finite and isinstance(value, Real) else "not a number"
    elif finite and not is_finite(value):
        why = "not finite"
    elif finite and value < 0.0:
        why = "below 0"
    else:
        return
    raise CncError(BAD_ARGUMENT, f"{name} = {repr_of(value)} is {why}", effect, where=f"{where} refused")


def check_callable(where: str, name: str, value: object, effect: str) -> None:
    """Raises CncError 22001 for what cannot be called."""
    if not callable(value):
        raise CncError(BAD_ARGUMENT, f"{name} = {value!r} is no function", effect, where=f"{where} refused")


class UnknownUnit(CncError, AttributeError, KeyError):
    """The machine has no unit of this name: `m.q` is an AttributeError, `m["q"]` a KeyError."""


def unknown_unit(name: str, known: Iterable[str], what: str = "unit") -> UnknownUnit:
    names = [*known]
    reason = f"the machine has no {what} '{name}'{nearest_name(name, names)}"
    return UnknownUnit(UNKNOWN_UNIT, reason, f"nothing was sent. Known: {', '.join(names) or 'none'}")


def no_recorder(command: str) -> CncError:
    remedy = "nothing was changed, give record or recorder to Machine.start or Machine.offline"
    return CncError(NO_RECORDER, "this machine has no recorder", remedy, where=f"recorder: {command} refused")


def error_of(number: int, text: str, values: Mapping[str, Value]) -> CncError:
    """An error with the whole text of a unit and the values in it."""
    error = CncError(number, text)
    error.values = values
    return error


def fault_of(event: Event) -> CncError:
    """The error of an event."""
    return error_of(event.error_id, event.text, {value.name: value.value for value in event.values})
