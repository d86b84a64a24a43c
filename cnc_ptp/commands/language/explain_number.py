"""`cnc_ptp explain 70349`: what an error number means; a whole line of a run may be given."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from cnc_ptp.catalogue import Entry, entry, neighbours, numbers_in, range_of
from cnc_ptp.errors import CncError

UNKNOWN_NUMBER = 26124
SHOWN_TEXTS = 6
"""Wordings of one number that are printed."""


def numbers_of(words: Sequence[str]) -> list[int]:
    """The numbers that are asked for; empty where words of the language are."""
    line = " ".join(words)
    return numbers_in(line) or ([int(word) for word in words] if all(word.isdigit() for word in words) else [])


def explained(numbers: Sequence[int]) -> str:
    """The text about each number. Raises CncError 26124."""
    return "\n\n".join("\n".join(lines(known(number))) for number in numbers)


def known(number: int) -> Entry:
    found = entry(number)
    if found is None:
        about = range_of(number)
        where = f"its range is about {about}" if about else "no range has it"
        near = ", ".join(f"{each.number} {each.name}" for each in neighbours(number))
        raise CncError(UNKNOWN_NUMBER, f"there is no number {number}, {where}; nearest are: {near}")
    return found


def lines(found: Entry) -> Iterator[str]:
    """One heading, then a line for each thing that there is to say."""
    prefix = "P-ERR" if found.is_error else "P-WARN"
    yield f"{prefix}-{found.number} {found.name} ({found.error_class}, {found.severity})"
    yield f"  group:    {found.title}"
    yield from labelled("text:", [text.shown() for text in found.texts[:SHOWN_TEXTS]])
    if len(found.texts) > SHOWN_TEXTS:
        yield f"            and {len(found.texts) - SHOWN_TEXTS} more"
    yield f"  cause:    {found.cause}"
    yield f"  remedy:   {found.remedy}"
    yield from labelled("reaction:", [reaction.text for reaction in found.reactions])
    stops = [f"{reaction.stop} ({reaction.axes})" for reaction in found.reactions if reaction.stop != "none"]
    yield from labelled("stops:", stops)
    yield f"  docs:     docs/errors.md#p-err-{found.number}, docs/{found.page}"
    if found.manual:
        yield f"  manual:   {found.manual}"


def labelled(label: str, rows: Sequence[str]) -> Iterator[str]:
    for index, row in enumerate(rows):
        yield f"  {'' if index else label:9} {row}"
