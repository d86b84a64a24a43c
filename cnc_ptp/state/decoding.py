"""Rows of a state (encoding.py) -> objects.

What can be made empty (instances, lists, dicts, sets) is made when it is met and filled afterwards, so that objects may
lead to each other in circles; mappings and sets last, because their keys need their own values then.
"""

from __future__ import annotations

import base64
import enum
import itertools
from collections import defaultdict, deque
from collections.abc import Mapping
from functools import partial
from typing import Any

import numpy as np

from cnc_ptp.compiled.instances import bare_instance
from cnc_ptp.state.encoding import Row, named
from cnc_ptp.state.made_again import AGAIN
from cnc_ptp.state.roots import PACKAGE, Roots, follow

MISSING: Any = object()


class Decoder:
    """The objects of one state."""

    def __init__(self, rows: list[Row], shapes: list[list[Any]], roots: Roots, texts: Mapping[str, str]) -> None:
        self._rows, self._roots, self._texts = rows, roots, texts
        self._shapes = [(kernel_class(name), names) for name, names in shapes]
        self._found: list[Any] = [MISSING] * len(rows)
        self._open: list[tuple[Any, Row]] = []
        self._hashed: list[tuple[Any, Row]] = []

    def decode(self, value: Any) -> Any:
        """The object of a value. Raises what Python raises for rows that no state has."""
        for name in AGAIN:
            for number, row in enumerate(self._rows):
                if row[:2] == ["R", name]:
                    self._complete([number])
        return self._complete(value)

    def _again(self, row: Row) -> Any:
        """Its parts must have all that they lead to."""
        make: Any = AGAIN[row[1]]
        return make(*[self._complete(value) for value in row[2:]])

    def _live(self, row: Row) -> Any:
        """A part of the state of an interpreter, which has come to where it was."""
        here: Any = self._value(row[1]).state
        for step in row[2]:
            here = follow(here, step)
        return here

    def _complete(self, value: Any) -> Any:
        """An object that has all that it leads to."""
        before = self._open, self._hashed
        self._open, self._hashed = [], []
        found = self._value(value)
        while self._open or self._hashed:
            empty, row = (self._open or self._hashed).pop()
            FILL[row[0]](self, empty, row)
        self._open, self._hashed = before
        return found

    def _value(self, value: Any) -> Any:
        if not isinstance(value, list):
            return value
        number = value[0]
        found = self._found[number]
        if found is MISSING:
            row = self._rows[number]
            found = self._found[number] = MAKE[row[0]](self, row)
            if row[0] in FILL:
                (self._hashed if row[0] in "sdD" else self._open).append((found, row))
        return found

    def _values(self, values: list[Any]) -> list[Any]:
        return [self._value(value) for value in values]

    # what is made at once

    def _tuple(self, row: Row) -> Any:
        return tuple(self._values(row[1:]))

    def _frozenset(self, row: Row) -> Any:
        return frozenset(self._values(row[1:]))

    def _named_tuple(self, row: Row) -> Any:
        return tuple.__new__(named_tuple_class(row[1]), self._values(row[2:]))

    def _member(self, row: Row) -> Any:
        cls = kernel_class(row[1])
        return cls[row[2]] if issubclass(cls, enum.Enum) else MISSING

    def _array(self, row: Row) -> Any:
        data = np.frombuffer(base64.b64decode(row[3]), dtype=np.dtype(row[1]))
        return data.reshape(row[2]).copy()

    def _bytes(self, row: Row) -> Any:
        return base64.b64decode(row[1])

    def _method(self, row: Row) -> Any:
        return getattr(self._value(row[1]), row[2])

    def _partial(self, row: Row) -> Any:
        """Its keywords are copied when it is made."""
        keywords = self._rows[row[3][0]]
        values = self._values(keywords[1:])
        return partial(self._value(row[1]), *self._value(row[2]), **dict(zip(values[::2], values[1::2], strict=True)))

    def _iterator(self, row: Row) -> Any:
        return iter(self._values(row[1:]))

    def _count(self, row: Row) -> Any:
        return itertools.count(*row[1:])

    def _root(self, row: Row) -> Any:
        return self._roots.at(row[1])

    def _function(self, row: Row) -> Any:
        return named(row[1], row[2])

    def _text(self, row: Row) -> Any:
        return self._texts[row[1]]

    def _marked_text(self, row: Row) -> Any:
        return str.__new__(text_class(row[1]), row[2])

    # what is made empty

    def _object(self, row: Row) -> Any:
        return bare_instance(self._shapes[row[1]][0])

    def _exception(self, row: Row) -> Any:
        cls: Any = kernel_class(row[1])
        return cls.__new__(cls)

    def _empty_defaultdict(self, row: Row) -> Any:
        return defaultdict(self._value(row[1]))

    # how it is filled

    def _fill_object(self, found: Any, row: Row) -> None:
        cls, names = self._shapes[row[1]]
        for name, value in zip(names, row[2:], strict=True):
            set_attribute(cls, found, name, self._value(value))

    def _fill_list(self, found: Any, row: Row) -> None:
        found.extend(self._values(row[1:]))

    def _fill_deque(self, found: Any, row: Row) -> None:
        found.extend(self._values(row[2:]))

    def _fill_set(self, found: Any, row: Row) -> None:
        values = self._values(row[1:])
        self._postpone(found, row, values) or found.update(values)

    def _fill_pairs(self, found: Any, row: Row, begin: int) -> None:
        values = self._values(row[begin:])
        self._postpone(found, row, values[::2]) or found.update(zip(values[::2], values[1::2], strict=True))

    def _postpone(self, found: Any, row: Row, keys: list[Any]) -> bool:
        """Objects that were met only now are still empty."""
        if not self._open or all(isinstance(key, (str, int, float, enum.Enum, type(None))) for key in keys):
            return False
        self._hashed.insert(0, (found, row))
        return True

    def _fill_dict(self, found: Any, row: Row) -> None:
        self._fill_pairs(found, row, 1)

    def _fill_defaultdict(self, found: Any, row: Row) -> None:
        self._fill_pairs(found, row, 2)

    def _fill_exception(self, found: Any, row: Row) -> None:
        found.args = self._value(row[2])
        row_of_names = self._rows[row[3][0]]
        values = self._values(row_of_names[1:])
        vars(found).update(zip(values[::2], values[1::2], strict=True))

    def _fill_marked_text(self, found: Any, row: Row) -> None:
        row_of_names = self._rows[row[3][0]]
        values = self._values(row_of_names[1:])
        vars(found).update(zip(values[::2], values[1::2], strict=True))


MAKE: dict[str, Any] = {
    "o": Decoder._object,
    "t": Decoder._tuple,
    "l": lambda decoder, row: [],
    "s": lambda decoder, row: set(),
    "f": Decoder._frozenset,
    "q": lambda decoder, row: deque(maxlen=row[1]),
    "d": lambda decoder, row: {},
    "D": Decoder._empty_defaultdict,
    "n": Decoder._named_tuple,
    "e": Decoder._member,
    "a": Decoder._array,
    "b": Decoder._bytes,
    "m": Decoder._method,
    "p": Decoder._partial,
    "i": Decoder._iterator,
    "c": Decoder._count,
    "E": Decoder._exception,
    "g": Decoder._root,
    "F": Decoder._function,
    "R": Decoder._again,
    "L": Decoder._live,
    "x": Decoder._text,
    "T": Decoder._marked_text,
}
FILL: dict[str, Any] = {
    "o": Decoder._fill_object,
    "l": Decoder._fill_list,
    "s": Decoder._fill_set,
    "q": Decoder._fill_deque,
    "d": Decoder._fill_dict,
    "D": Decoder._fill_defaultdict,
    "E": Decoder._fill_exception,
    "T": Decoder._fill_marked_text,
}


def kernel_class(name: str) -> type:
    """The class with this name. Raises LookupError for one that is not of this package."""
    module, _, qualified = name.partition(":")
    found = named(module, qualified)
    if not module.startswith(PACKAGE) or not isinstance(found, type):
        raise LookupError(f"{name} is no class of the kernel")
    return found


def named_tuple_class(name: str) -> type[tuple[Any, ...]]:
    """As kernel_class."""
    found = kernel_class(name)
    if not issubclass(found, tuple):
        raise LookupError(f"{name} is no NamedTuple")
    return found


def text_class(name: str) -> type[str]:
    """As kernel_class."""
    found = kernel_class(name)
    if not issubclass(found, str):
        raise LookupError(f"{name} is no text")
    return found


def set_attribute(cls: type, found: Any, name: str, value: Any) -> None:
    """Also where the class permits no change."""
    object.__setattr__(found, name, value)
