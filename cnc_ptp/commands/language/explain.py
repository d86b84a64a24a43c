"""`cnc_ptp explain G61`, `cnc_ptp explain 70349`: what a word of the NC language or an error number means."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from cnc_ptp.commands.language.explain_number import explained, numbers_of
from cnc_ptp.commands.language.word_errors import error_texts
from cnc_ptp.commands.language.words import Entry, find


def explain(words: Sequence[str], dialect: str = "twincat") -> int:
    """Prints syntax, meaning, group and an example of each word, or all about each number.

    Raises CncError 26123 for an unknown word, 26124 for an unknown number.
    """
    numbers = numbers_of(words)
    if numbers:
        print(explained(numbers))
        return 0
    found = [entry for word in words for entry in find(word, dialect)]
    print("\n\n".join("\n".join(lines(entry, dialect)) for entry in found))
    return 0


def lines(entry: Entry, dialect: str) -> Iterator[str]:
    """The text about one word."""
    yield f"{entry.name} ({entry.kind})"
    yield f"  syntax:   {entry.explanation.syntax}"
    yield f"  meaning:  {entry.explanation.meaning}"
    if entry.group:
        yield f"  group:    {entry.group}, {'modal' if entry.modal else 'for its block'}"
    for index, line in enumerate(entry.explanation.example.splitlines()):
        yield f"  {'' if index else 'example:':9} {line}"
    texts = error_texts(dialect) if entry.errors else {}
    for index, number in enumerate(entry.errors):
        yield f"  {'' if index else 'errors:':9} {number} {texts[number]}"
    if entry.later:
        yield "  not available yet: a program with it is refused when it is read"
