"""The name of a line -> its declaration: as it is declared, in an old spelling, without its prefix or an index."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from functools import cache
from typing import Final, NamedTuple

from cnc_ptp.errors import did_you_mean, nearest
from cnc_ptp.parameters.declare.declarations import Declaration, catalogue

_INDEX: Final = re.compile(r"\[([^\]]*)\]")
LONGEST_INDEX: Final = 9
"""Digits; longer ones are no index of any array."""


class Found(NamedTuple):
    """The parameter that a name means; `correction` is empty if it is written as declared."""

    declaration: Declaration
    indexes: tuple[int, ...]
    correction: str = ""


class UnknownName(Exception):
    """A name that no list of these nodes has; carries the reason, with the nearest name."""


class BadIndex(Exception):
    """An index that is none; carries the reason."""


class Match(NamedTuple):
    """A pattern of names, already looked up."""

    declaration: Declaration | None
    reason: str
    """Why the name is corrected, or unknown; empty if no list has it, or not of this kind of nodes."""
    words: tuple[str, ...] = ()
    """The parts of the name in the spelling of the declarations."""


def resolve(node: str, name: str) -> Found:
    """The parameter of an axis, channel or machine. Raises UnknownName, BadIndex."""
    indexes = _INDEX.findall(name)
    match = look_up(node, _INDEX.sub("[]", name) if indexes else name)
    declaration = match.declaration
    if declaration is None:
        raise UnknownName(match.reason or unknown(node, ".".join(word.partition("[")[0] for word in match.words)))
    numbers, filled = read_indexes(declaration, match.words, indexes)
    meant = declaration.list_style_name(numbers)
    reasons = ", ".join(reason for reason in (match.reason, filled) if reason)
    return Found(declaration, numbers, f"{name} is read as {meant} ({reasons})" if reasons else "")


def read_indexes(declaration: Declaration, words: tuple[str, ...], given: list[str]) -> tuple[tuple[int, ...], str]:
    """The indexes of a declaration from those of a name, 0 where the name has none. Raises BadIndex."""
    texts = iter(given)
    arrays = [part.partition("[")[0] for part in words if "[" in part]
    numbers: list[int] = []
    reason = ""
    for part in declaration.name.split("."):
        if "[" not in part:
            continue
        text = next(texts) if arrays and arrays.pop(0) == part.partition("[")[0] else ""
        number = index_of(text)
        if not text.isdecimal():
            reason = "an index was missing" if not text else f"{text} is no number"
        numbers.append(number)
    return tuple(numbers), reason


def index_of(text: str) -> int:
    """A letter is the placeholder of the manuals, and reads as 0 like an empty one. Raises BadIndex."""
    if text == "" or (len(text) == 1 and text.isascii() and text.isalpha()):
        return 0
    if text.isascii() and text.isdecimal() and len(text) <= LONGEST_INDEX:
        return int(text)
    raise BadIndex(f"index {text[:20]!r} is none; write a number from 0")


@cache
def look_up(node: str, pattern: str) -> Match:
    """The declaration of a name whose indexes are left out: getriebe[].kv."""
    words = tuple(pattern.split("."))
    plain = ".".join(word.partition("[")[0] for word in words)
    names = known_names(node)
    if found := names.whole.get(plain):
        return _found(found, words, "")
    aliases = catalogue().aliases
    now = tuple(f"{aliases.get(bare, bare)}{bracket}" for word in words for bare, bracket in [_split(word)])
    now = tuple(part for word in now for part in word.split("."))
    spelled = ".".join(word.partition("[")[0] for word in now)
    old = "old spelling" if spelled != plain else ""
    if found := names.whole.get(spelled):
        return _found(found, now, old)
    ends = names.ends.get(spelled, ())
    if len(ends) == 1:
        return _found(ends[0], now, ", ".join(part for part in (old, "its prefix was missing") if part))
    if ends:
        return Match(None, f"it may be {' or '.join(entry.name for entry in ends[:4])}; write the whole name")
    if found := names.whole.get(spelled.lower()) or names.whole.get(plain.lower()):
        return _found(found, tuple(word.lower() for word in now), "names are in small letters")
    return Match(None, "", now)


def _found(declaration: Declaration, words: tuple[str, ...], reason: str) -> Match:
    """Brackets that the declaration does not have make the name another one."""
    arrays = [part.partition("[")[0] for part in declaration.name.split(".") if "[" in part]
    for word in words:
        bare, bracket = _split(word)
        if bracket and (bracket != "[]" or bare not in arrays):
            return Match(None, f"{bare} has no such index{did_you_mean([declaration.name])}")
    return Match(declaration, reason, words)


def _split(word: str) -> tuple[str, str]:
    bare, bracket, rest = word.partition("[")
    return bare, bracket + rest


@cache
def unknown(node: str, plain: str) -> str:
    """That no list has the name: the nodes that do, or the nearest names."""
    others = [kind for kind in ("axis", "channel", "machine") if kind != node and plain in known_names(kind).whole]
    if others:
        declaration = known_names(others[0]).whole[plain]
        return f"{declaration.id} belongs to the lists of {' and '.join(others)} nodes"
    names = known_names(node)
    last = {entry.name.rpartition(".")[2].partition("[")[0]: entry for entry in names.whole.values()}
    close = [names.whole[name] for name in nearest(plain, names.whole, cutoff=0.85)]
    close = close or [last[name] for name in nearest(plain.rpartition(".")[2], last, cutoff=0.75)]
    return f"no list has it{did_you_mean([f'{entry.name} ({entry.id})' for entry in close])}"


class Names(NamedTuple):
    """The names of a kind of nodes without indexes -> declarations; `ends`: by the end of a name."""

    whole: Mapping[str, Declaration]
    ends: Mapping[str, tuple[Declaration, ...]]


@cache
def known_names(node: str) -> Names:
    whole: dict[str, Declaration] = {}
    ends: dict[str, tuple[Declaration, ...]] = {}
    for kind in ("axis", "spindle") if node == "axis" else (node,):
        for declaration in catalogue().of_node(kind):
            bare = declaration.key.replace(".*", "")
            if bare in whole:
                continue
            whole[bare] = declaration
            for end in ends_of(bare):
                ends[end] = (*ends.get(end, ()), declaration)
    return Names(whole, ends)


def ends_of(name: str) -> Iterator[str]:
    """kv and dynamik.kv of getriebe.dynamik.kv."""
    while "." in name:
        name = name.partition(".")[2]
        yield name
