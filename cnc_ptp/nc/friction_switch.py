"""Compensations of an axis in programs: `X[COMP ON FRICT]`, `X[COMP OFF FRICT]`.

Source: TF5200 friction compensation 2.3.1. COMP comes first; what it switches is kept beyond the program end.
"""

import re
from collections.abc import Iterator

from cnc_ptp.nc import faults
from cnc_ptp.nc.canonical import CompensationSwitch, Source
from cnc_ptp.nc.lexer import Token

KEYWORD = "COMP"
SWITCHES = ("ON", "OFF")
KINDS = ("FRICT",)
"""Compensations that can be switched: friction compensation."""


def bracket(token: Token, source: Source) -> CompensationSwitch:
    """The words in an axis' brackets: COMP, ON or OFF, what is switched.

    Raises 21039 for empty brackets, 21096 when COMP is not the first word, 21097 for unknown words, 21012 and 21042 for
    words that exclude each other or come twice, 21098 when a word is missing.
    """
    words = list(_words(token))
    if not words:
        raise faults.BRACKET_EMPTY.at(source, token.column, spindle=token.name)
    first, column = words[0]
    if first != KEYWORD:
        raise faults.COMP_FIRST.at(source, column, axis=token.name, word=first)
    switch = ""
    kinds: list[str] = []
    for word, place in words[1:]:
        _check(token.name, switch, kinds, word, source, place)
        if word in SWITCHES:
            switch = word
        else:
            kinds.append(word)
    missing = "ON or OFF" if not switch else "what is switched (FRICT)" if not kinds else ""
    if missing:
        raise faults.COMP_INCOMPLETE.at(source, column, axis=token.name, missing=missing)
    return CompensationSwitch(token.name, switch == "ON", tuple(kinds))


def _words(token: Token) -> Iterator[tuple[str, int]]:
    """Words between blanks with their columns."""
    begin = token.column + token.shown.index("[") + 1
    return ((match[0], begin + match.start()) for match in re.finditer(r"\S+", token.text))


def _check(axis: str, switch: str, kinds: list[str], word: str, source: Source, column: int) -> None:
    """Raises for a word that cannot follow `switch` and `kinds`."""
    if word not in SWITCHES and word not in KINDS:
        known = ", ".join((*SWITCHES, *KINDS))
        raise faults.COMP_WORD.at(source, column, axis=axis, word=word, known=known)
    if word == switch or word in kinds:
        raise faults.TWICE.at(source, column, word=word)
    if switch and word in SWITCHES:
        raise faults.SAME_GROUP.at(source, column, first=switch, second=word, group=f"COMP of axis {axis}")
