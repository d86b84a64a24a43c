"""Object graph -> plain lists for JSON: one row for each object, whatever refers to it how often.

A value is null, a boolean, a number or a text as it is; anything else is [number of its row]. A row begins with the
letter of its form:

    o class, names | values   instance; the pair (class, names) stands once in a table of shapes
    t l s f q                 tuple, list, set, frozenset, deque (its longest length before its items)
    d k, v, k, v …            dict
    D factory, k, v …         defaultdict
    n class, items            NamedTuple
    e class, name             member of an enumeration
    a dtype, shape, base64    array of NumPy
    b base64                  bytes
    m object, name            bound method
    p function, args, names   partial: function, positional arguments, dict of the others
    i items                   iterator over what is left
    N digest                  list of very many floats, which is kept beside the state: their bytes in base64
    c next, step              itertools.count
    E class, args, attributes exception
    g path                    what a root leads to (roots.py)
    F module, name            function or class of a module
    R name, parts             what is made again of its parts (made_again.py)
    L interpreter, path       what the state of an interpreter leads to that is made again
    x digest                  long text, which is kept beside the state
    T class, text, attributes text with attributes
"""

from __future__ import annotations

import base64
import enum
import itertools
import math
from collections import OrderedDict, defaultdict, deque
from collections.abc import Callable, Iterable
from functools import partial
from hashlib import blake2b
from operator import is_
from types import BuiltinFunctionType, BuiltinMethodType, FunctionType, MappingProxyType, MethodType, ModuleType
from typing import Any

import numpy as np

from cnc_ptp.channel.listed_blocks import ListedBlocks
from cnc_ptp.channel.program_memory import PreparedProgram
from cnc_ptp.channel.running_blocks import RunningBlocks
from cnc_ptp.nc.flow.sections import Program
from cnc_ptp.nc.streamed_program import StreamedProgram
from cnc_ptp.state.faults import not_storable
from cnc_ptp.state.made_again import interpreter_parts, is_open, list_parts, program_parts
from cnc_ptp.state.roots import PACKAGE, Path, Roots, kernel_module, names_and_values

Row = list[Any]
FLOAT = "<f8"
LONG_TEXT = 500
"""Characters from which on a text is kept beside the state, once for all states of a run."""
MANY_FLOATS = 1000
"""Floats from which on a list is kept beside the state: the times of a long program's blocks, mostly."""
LongLists = dict[int, tuple[list[float], list[float], str]]
"""By identity: the list of floats itself, a copy with the same objects, and its digest."""
AS_THEY_ARE = frozenset((type(None), bool, int, float))
Place = tuple[Any, str, Any]
"""Where an object was met: the place of what leads to it, and the text of the step from there with its value."""
ROOT: Place = (None, "", None)


class Encoder:
    """Rows of one state; `texts` takes the long ones by their digest."""

    def __init__(
        self,
        roots: Roots,
        texts: dict[str, str],
        interpreters: Iterable[RunningBlocks] = (),
        lists: LongLists | None = None,
    ) -> None:
        """`interpreters` that the graph leads to; `lists` that were kept beside the state before."""
        self._known_lists: LongLists = {} if lists is None else lists
        self.lists: LongLists = {}
        """Those that are kept beside this one."""
        self.rows: list[Row] = []
        self.shapes: list[list[Any]] = []
        self._roots, self._texts = roots, texts
        self._shape_of: dict[tuple[type, tuple[str, ...]], int] = {}
        self._number: dict[int, int] = {}
        self._kept: list[Any] = []
        """All objects that have a row: what a compiled attribute gives may be made for the occasion."""
        self._waiting: list[tuple[Any, Row, Place]] = []
        self._place = ROOT
        self._live: dict[int, tuple[RunningBlocks, Path]] = {}
        for blocks in interpreters:
            if is_open(blocks):
                self._note_live(blocks)

    def encode(self, root: object) -> Any:
        """The value of an object; all that it leads to gets a row. Raises CncError 26150."""
        value = self._value(root)
        while self._waiting:
            found, row, self._place = self._waiting.pop()
            self._fill(found, row)
        return value

    def _note_live(self, blocks: RunningBlocks) -> None:
        """The state of an interpreter comes back with it; but for what it begins with."""
        given = {id(part) for part, _ in self._roots.beyond(interpreter_parts(blocks))}
        for part, path in self._roots.beyond(blocks.state):
            if id(part) not in given:
                self._live[id(part)] = blocks, path
                self._kept.append(part)

    def _value(self, found: Any, step: str = "", key: object = None) -> Any:
        """`step` and `key`: from what is being filled to `found`."""
        kind = type(found)
        if kind in AS_THEY_ARE:
            return found
        if kind is str:
            return self._text(found) if len(found) >= LONG_TEXT else found
        if kind is PreparedProgram:  # it is interpreted again when it starts
            return None
        number = self._number.get(id(found))
        if number is None:
            number = self._new_row(found)
            self._waiting.append((found, self.rows[number], (self._place, step, key)))
        return [number]

    def _new_row(self, found: Any) -> int:
        number = self._number[id(found)] = len(self.rows)
        self._kept.append(found)
        self.rows.append([])
        return number

    def _kept_beside(self, text: str) -> str:
        """Its digest."""
        digest = digest_of(text)
        self._texts[digest] = text
        return digest

    def _text(self, text: str) -> Any:
        digest = self._kept_beside(text)
        number = self._number.get(id(text))
        if number is None:
            number = self._new_row(text)
            self.rows[number] += ["x", digest]
        return [number]

    def _values(self, items: Iterable[Any], step: str = "[]") -> list[Any]:
        """Most are no objects: a call for each would take half of the time."""
        return [item if type(item) in AS_THEY_ARE else self._value(item, step) for item in items]

    def _fill(self, found: Any, row: Row) -> None:
        path = self._roots.path(found)
        if path is not None:
            row += ["g", path]
            return
        live = self._live.get(id(found))
        if live is not None:
            row += ["L", self._value(live[0]), live[1]]
            return
        form = FORMS.get(type(found)) or form_of(found)
        if form is None:
            raise not_storable(written(self._place) or "its root", described(found))
        form(self, found, row)

    # forms

    def _object(self, found: Any, row: Row) -> None:
        names, values = names_and_values(found)
        key = (type(found), names)
        shape = self._shape_of.get(key)
        if shape is None:
            shape = self._shape_of[key] = len(self.shapes)
            self.shapes.append([class_name(type(found)), list(names)])
        row += ["o", shape]
        row += [
            value if type(value) in AS_THEY_ARE else self._value(value, ".{}", name)
            for name, value in zip(names, values, strict=True)
        ]

    def _tuple(self, found: tuple[Any, ...], row: Row) -> None:
        row += ["t", *self._values(found)]

    def _list(self, found: list[Any], row: Row) -> None:
        digest = self._floats_beside(found) if len(found) >= MANY_FLOATS else None
        row += ["l", *self._values(found)] if digest is None else ["N", digest]

    def _floats_beside(self, found: list[Any]) -> str | None:
        """The digest of a list of floats that is kept beside the states; None where it holds anything else."""
        known = self._known_lists.get(id(found))
        if known is not None and len(known[1]) == len(found) and all(map(is_, known[1], found)):
            self.lists[id(found)] = known
            return known[2]
        if {*map(type, found)} != {float}:
            return None
        digest = self._kept_beside(base64.b64encode(np.array(found, FLOAT).tobytes()).decode())
        self.lists[id(found)] = found, found.copy(), digest
        return digest

    def _set(self, found: set[Any], row: Row) -> None:
        row += ["s", *self._values(in_order(found))]

    def _frozenset(self, found: frozenset[Any], row: Row) -> None:
        row += ["f", *self._values(in_order(found))]

    def _deque(self, found: deque[Any], row: Row) -> None:
        row += ["q", found.maxlen, *self._values(found)]

    def _pairs(self, found: dict[Any, Any]) -> list[Any]:
        return [
            part
            for key, value in found.items()
            for part in (self._value(key), value if type(value) in AS_THEY_ARE else self._value(value, "[{}]", key))
        ]

    def _dict(self, found: dict[Any, Any], row: Row) -> None:
        row += ["d", *self._pairs(found)]

    def _defaultdict(self, found: defaultdict[Any, Any], row: Row) -> None:
        row += ["D", self._value(found.default_factory), *self._pairs(found)]

    def _named_tuple(self, found: tuple[Any, ...], row: Row) -> None:
        row += ["n", class_name(type(found)), *self._values(found)]

    def _member(self, found: enum.Enum, row: Row) -> None:
        row += ["e", class_name(type(found)), found.name]

    def _array(self, found: np.ndarray[Any, Any], row: Row) -> None:
        data = base64.b64encode(np.ascontiguousarray(found).tobytes()).decode()
        row += ["a", found.dtype.str, list(found.shape), data]

    def _bytes(self, found: bytes, row: Row) -> None:
        row += ["b", base64.b64encode(found).decode()]

    def _method(self, found: Any, row: Row) -> None:
        row += ["m", self._value(found.__self__, ".__self__"), found.__name__]

    def _program(self, found: Program, row: Row) -> None:
        self._again("program", program_parts(found), row)

    def _interpreter(self, found: RunningBlocks, row: Row) -> None:
        if found.ended:
            row += ["i"]
        else:
            self._again("interpreter", interpreter_parts(found), row)

    def _listed_blocks(self, found: ListedBlocks, row: Row) -> None:
        if found.ended:
            row += ["i"]
        else:
            self._again("list of blocks", list_parts(found), row)

    def _again(self, name: str, parts: tuple[Any, ...] | None, row: Row) -> None:
        if parts is None:
            raise not_storable(written(self._place), f"a {name} that cannot be made again")
        row += ["R", name, *self._values(parts, "()")]

    def _partial(self, found: partial[Any], row: Row) -> None:
        parts = (found.func, found.args, dict(found.keywords))
        row += ["p", *self._values(parts, "()")]

    def _iterator(self, found: Any, row: Row) -> None:
        """Of a list or tuple; what was taken from it is not needed."""
        state = found.__reduce__()
        items, taken = state[1][0], state[2] if len(state) > 2 else 0
        row += ["i", *self._values(items[taken:])]

    def _count(self, found: Any, row: Row) -> None:
        arguments = found.__reduce__()[1]
        row += ["c", *arguments]

    def _exception(self, found: Exception, row: Row) -> None:
        row += ["E", class_name(type(found)), self._value(found.args, ".args"), self._value(dict(vars(found)))]

    def _function(self, found: Any, row: Row) -> None:
        row += ["F", found.__module__, found.__qualname__]

    def _marked_text(self, found: str, row: Row) -> None:
        row += ["T", class_name(type(found)), str.__str__(found), self._value(dict(vars(found)))]


Form = Callable[[Encoder, Any, Row], None]
FORMS: dict[type, Form] = {
    tuple: Encoder._tuple,
    list: Encoder._list,
    set: Encoder._set,
    frozenset: Encoder._frozenset,
    deque: Encoder._deque,
    dict: Encoder._dict,
    OrderedDict: Encoder._dict,
    defaultdict: Encoder._defaultdict,
    np.ndarray: Encoder._array,
    bytes: Encoder._bytes,
    partial: Encoder._partial,
    type(iter([])): Encoder._iterator,
    type(iter(())): Encoder._iterator,
    itertools.count: Encoder._count,
    MappingProxyType: Encoder._dict,
    Program: Encoder._program,
    StreamedProgram: Encoder._program,
    RunningBlocks: Encoder._interpreter,
    ListedBlocks: Encoder._listed_blocks,
}


def form_of(found: Any) -> Form | None:
    """The form of an object whose class alone does not say it, None if it has none."""
    form = _form_of_class(type(found))
    if form is not None:
        return form
    owner = getattr(found, "__self__", None)
    if isinstance(found, (MethodType, BuiltinMethodType)) and owner is not None and not isinstance(owner, ModuleType):
        return Encoder._method
    if isinstance(found, (FunctionType, BuiltinFunctionType, type)) and is_reachable(found):
        return Encoder._function
    return None


def _form_of_class(cls: type) -> Form | None:
    form: Form | None = None
    if issubclass(cls, enum.Enum):
        form = Encoder._member
    elif issubclass(cls, tuple) and hasattr(cls, "_fields"):
        form = Encoder._named_tuple
    elif not cls.__module__.startswith(PACKAGE):
        return None
    elif issubclass(cls, Exception):
        form = Encoder._exception
    elif issubclass(cls, str):
        form = Encoder._marked_text
    elif is_reachable(cls):
        form = Encoder._object
    if form is not None:
        FORMS[cls] = form
    return form


def written(place: Place) -> str:
    """A place in words."""
    steps: list[str] = []
    here: Any = place
    while here is not None:
        here, step, key = here
        steps.append(step.format(key))
    return "".join(reversed(steps))


def digest_of(text: str) -> str:
    return blake2b(text.encode(errors="surrogatepass"), digest_size=16).hexdigest()


def is_reachable(found: Any) -> bool:
    """Whether a function or class is found by its name."""
    if not isinstance(found.__module__, str) or not found.__module__.startswith((PACKAGE, "builtins", "math")):
        return False
    try:
        return named(found.__module__, found.__qualname__) is found
    except (LookupError, AttributeError):
        return False


HARMLESS = {each.__name__: each for each in (bool, int, float, str, list, dict, set, tuple, frozenset, abs, min, max)}
"""What a state may name of the language itself."""


def named(module: str, name: str) -> Any:
    """The function or class of a kernel module, of math or of the language. Raises LookupError, AttributeError.

    What a module has imported is not its own: a state must not lead to anything that acts on the computer.
    """
    if module == "builtins":
        return HARMLESS[name]
    here: Any = math if module == "math" else kernel_module(module)
    for part in name.split("."):
        here = getattr(here, part)
    if (here.__module__, here.__qualname__) != (module, name):
        raise LookupError(f"{module} has no {name} of its own")
    return here


def class_name(cls: type) -> str:
    return f"{cls.__module__}:{cls.__qualname__}"


def described(found: object) -> str:
    kind = type(found)
    return f"a {kind.__module__}.{kind.__qualname__}".replace("builtins.", "")


def in_order(items: Iterable[Any]) -> list[Any]:
    """The items of a set in the same order whatever their hashes are."""
    return sorted(items, key=repr)
