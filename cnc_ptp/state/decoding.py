"""Rows of a state (encoding.py) -> objects.

What can be made empty (instances, lists, dicts, sets) is made when it is met and filled afterwards, so that objects may
lead to each other in circles; mappings and sets last, because their keys need their own values then.

Rows are checked before anything is made of them; what they name need not be there, and need not fit. That much is
expected and is 26151. Any other exception is a mistake in here and stays what it is.
"""

from __future__ import annotations

import base64
import enum
import itertools
from collections import defaultdict, deque
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from functools import partial
from typing import Any

import numpy as np

from cnc_ptp.compiled.instances import bare_instance
from cnc_ptp.state.encoding import FLOAT, Row, digest_of, named
from cnc_ptp.state.faults import damaged
from cnc_ptp.state.made_again import AGAIN, FAULTS
from cnc_ptp.state.roots import PACKAGE, Roots, follow
from cnc_ptp.state.rows import check_rows

MISSING: Any = object()
IN_THE_MAKING: Any = object()


class Decoder:
    """The objects of one state."""

    def __init__(self, rows: list[Row], shapes: list[list[Any]], roots: Roots, texts: Mapping[str, str]) -> None:
        """Raises CncError 26151."""
        check_rows(rows, shapes)
        self._rows, self._roots, self._texts = rows, roots, texts
        self._shapes = [(kernel_class(name), names) for name, names in shapes]
        self._classes: dict[tuple[str, type], Any] = {}
        self._found: list[Any] = [MISSING] * len(rows)
        self._open: list[tuple[Any, Row]] = []
        self._hashed: list[tuple[Any, Row]] = []

    def decode(self, value: Any) -> Any:
        """The object of a value. Raises CncError 26151."""
        for name in AGAIN:
            for number, row in enumerate(self._rows):
                if row[:2] == ["R", name]:
                    self._complete([number])
        return self._complete(value)

    def _again(self, row: Row) -> Any:
        """Its parts must have all that they lead to."""
        make: Any = AGAIN[row[1]]
        parts = [self._complete(value) for value in row[2:]]
        with refused(f"the {row[1]} cannot be made again", *FAULTS):
            return make(*parts)

    def _live(self, row: Row) -> Any:
        """A part of the state of an interpreter, which has come to where it was."""
        blocks = self._value(row[1])
        with refused(f"nothing is at {row[2]}", LookupError, AttributeError, TypeError):
            here: Any = blocks.state
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
        if found is IN_THE_MAKING:
            raise damaged(f"row {number} is a part of itself")
        if found is MISSING:
            row = self._rows[number]
            self._found[number] = IN_THE_MAKING
            found = self._found[number] = MAKE[row[0]](self, row)
            if row[0] in FILL:
                (self._hashed if row[0] in "sdD" else self._open).append((found, row))
        return found

    def _values(self, values: list[Any]) -> list[Any]:
        """Most are no list, or were made before: a call for each would take half of the time."""
        found = self._found
        return [
            value
            if type(value) is not list
            else known
            if (known := found[value[0]]) is not MISSING and known is not IN_THE_MAKING
            else self._value(value)
            for value in values
        ]

    # what is made at once

    def _tuple(self, row: Row) -> Any:
        return tuple(self._values(row[1:]))

    def _frozenset(self, row: Row) -> Any:
        values = self._values(row[1:])
        with refused("a set", TypeError):
            return frozenset(values)

    def _named_tuple(self, row: Row) -> Any:
        return tuple.__new__(self._class(row[1], tuple), self._values(row[2:]))

    def _class(self, name: str, kind: type) -> Any:
        found = self._classes.get((name, kind))
        if found is None:
            found = self._classes[name, kind] = class_of(name, kind)
        return found

    def _member(self, row: Row) -> Any:
        cls = kernel_class(row[1])
        if not issubclass(cls, enum.Enum) or row[2] not in cls.__members__:
            raise damaged(f"{row[1]} has no member {row[2]}")
        return cls[row[2]]

    def _array(self, row: Row) -> Any:
        with refused("an array", TypeError, ValueError):
            data = np.frombuffer(base64.b64decode(row[3]), dtype=np.dtype(row[1]))
            return data.reshape(row[2]).copy()

    def _bytes(self, row: Row) -> Any:
        with refused("bytes", ValueError):
            return base64.b64decode(row[1])

    def _method(self, row: Row) -> Any:
        owner = self._value(row[1])
        with refused("a method", AttributeError):
            return getattr(owner, row[2])

    def _partial(self, row: Row) -> Any:
        """Its keywords are copied when it is made."""
        function, arguments, keywords = self._value(row[1]), self._value(row[2]), self._names(row[3])
        with refused("a partial", TypeError):
            return partial(function, *arguments, **keywords)

    def _names(self, value: Any) -> dict[str, Any]:
        """A dict of attributes or keywords, which is needed at once."""
        row = self._rows[value[0]]
        if row[0] != "d":
            raise damaged(f"row {value[0]} holds no names")
        values = self._values(row[1:])
        return dict(zip(values[::2], values[1::2], strict=True))

    def _iterator(self, row: Row) -> Any:
        return iter(self._values(row[1:]))

    def _many_floats(self, row: Row) -> Any:
        with refused("a list of floats", ValueError):
            return np.frombuffer(base64.b64decode(self._text(row), validate=True), FLOAT).tolist()

    def _count(self, row: Row) -> Any:
        return itertools.count(*row[1:])

    def _root(self, row: Row) -> Any:
        with refused(f"nothing is at {row[1]}", LookupError, AttributeError, TypeError):
            return self._roots.at(row[1])

    def _function(self, row: Row) -> Any:
        with refused(f"{row[1]} has no {row[2]}", LookupError, AttributeError):
            return named(row[1], row[2])

    def _text(self, row: Row) -> Any:
        if row[1] not in self._texts:
            raise damaged(f"its text {row[1]} is missing")
        text = self._texts[row[1]]
        if digest_of(text) != row[1]:
            raise damaged(f"its text {row[1]} is another one")
        return text

    def _marked_text(self, row: Row) -> Any:
        return str.__new__(class_of(row[1], str), row[2])

    # what is made empty

    def _object(self, row: Row) -> Any:
        return bare_instance(self._shapes[row[1]][0])

    def _exception(self, row: Row) -> Any:
        cls = class_of(row[1], Exception)
        return cls.__new__(cls)

    def _empty_defaultdict(self, row: Row) -> Any:
        return defaultdict(self._value(row[1]))

    # how it is filled

    def _fill_object(self, found: Any, row: Row) -> None:
        cls, names = self._shapes[row[1]]
        values = self._values(row[2:])
        for name, value in zip(names, values, strict=True):
            with refused(f"{cls.__qualname__}.{name}", AttributeError, TypeError):
                set_attribute(cls, found, name, value)

    def _fill_list(self, found: Any, row: Row) -> None:
        found.extend(self._values(row[1:]))

    def _fill_deque(self, found: Any, row: Row) -> None:
        found.extend(self._values(row[2:]))

    def _fill_set(self, found: Any, row: Row) -> None:
        values = self._values(row[1:])
        with refused("a set", TypeError):
            self._postpone(found, row, values) or found.update(values)

    def _fill_pairs(self, found: Any, row: Row, begin: int) -> None:
        values = self._values(row[begin:])
        with refused("a dict", TypeError):
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
        vars(found).update(self._names(row[3]))

    def _fill_marked_text(self, found: Any, row: Row) -> None:
        vars(found).update(self._names(row[3]))


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
    "N": Decoder._many_floats,
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
    """The class with this name. Raises CncError 26151 for one that is not of this package."""
    module, _, qualified = name.partition(":")
    with refused(f"{name} is no class of the kernel", LookupError, AttributeError):
        found = named(module, qualified)
    if not module.startswith(PACKAGE) or not isinstance(found, type):
        raise damaged(f"{name} is no class of the kernel")
    return found


def class_of(name: str, kind: type) -> Any:
    """As kernel_class, for one that is derived of `kind`."""
    found = kernel_class(name)
    if not issubclass(found, kind):
        raise damaged(f"{name} is no {kind.__name__}")
    return found


@contextmanager
def refused(what: str, *errors: type[Exception]) -> Iterator[None]:
    """The errors that a state may cause which no encoder has made. Raises CncError 26151 for them."""
    try:
        yield
    except errors as error:
        raise damaged(f"{what}: {error}" if str(error) else what) from error


def set_attribute(cls: type, found: Any, name: str, value: Any) -> None:
    """Also where the class permits no change."""
    object.__setattr__(found, name, value)
