"""What a state refers to and does not hold: the objects of kernel modules, and those of the machine's parameters."""

from __future__ import annotations

import enum
import sys
from collections.abc import Iterable, Iterator
from functools import cache
from importlib import import_module
from operator import attrgetter
from types import BuiltinFunctionType, FunctionType, MappingProxyType, ModuleType
from typing import Any

from cnc_ptp.compiled.instances import COMPILED, is_compiled
from cnc_ptp.compiled.sources import ROOMS, sources
from cnc_ptp.errors import CncError

PACKAGE = "cnc_ptp."
UNIT_ROOMS = (*ROOMS, "parameters", "errors", "number_range")
"""Parts of the package that objects of a state are from."""
READ_FILES = ("plc_file", "program_files", "run_entries")
"""Modules that read files, or execute them; nothing of a unit is from them."""
PLAIN = (type(None), bool, int, float, complex, str, bytes)
"""Values that have no identity."""
WITHOUT_PATH = (*PLAIN, type, FunctionType, BuiltinFunctionType)
Step = str | int | list[Any]
"""To a part of an object: the name of its attribute, its place, or, in a mapping, [its key]."""
Path = list[Any]
"""Root, then steps."""
NO_STEPS: Path = []


class Roots:
    """Objects by the path to them, and back.

    They must not change as long as states are made: what they lead to is looked up once. The constants of kernel
    modules always are among them, by the name of their module.
    """

    def __init__(self, roots: dict[str, Any]) -> None:
        self._roots = roots
        self._paths: dict[int, Path] = {}
        self._kept: list[Any] = []
        """So that no other object gets the identity of one that is known."""
        for module in kernel_modules():
            self._add(module, [module.__name__])
        for name, root in roots.items():
            self._add(root, [name])

    def path(self, found: object) -> Path | None:
        """The way to an object, None if no root leads to it."""
        return self._paths.get(id(found))

    def at(self, path: Path) -> Any:
        """The object at the end of a path. Raises LookupError, AttributeError, TypeError for one that leads nowhere."""
        name = path[0]
        here = self._roots[name] if name in self._roots else kernel_module(name)
        for step in path[1:]:
            here = follow(here, step)
        return here

    def beyond(self, root: object, path: Path = NO_STEPS) -> Iterator[tuple[Any, Path]]:
        """All that `root` leads to and no root of these, with the path to it."""
        waiting: list[tuple[Any, Path]] = [(root, path)]
        seen: set[int] = set()
        while waiting:
            found, way = waiting.pop()
            if isinstance(found, WITHOUT_PATH) or id(found) in self._paths or id(found) in seen:
                continue
            if isinstance(found, tuple) and not found:
                continue
            seen.add(id(found))
            yield found, way
            waiting.extend((part, [*way, step]) for step, part in parts(found))

    def _add(self, root: object, path: Path) -> None:
        for found, way in self.beyond(root, path):
            self._paths[id(found)] = way
            self._kept.append(found)


def parts(found: Any) -> Iterator[tuple[Step, Any]]:
    """The parts of an object that paths lead through."""
    if isinstance(found, (list, tuple)):
        yield from enumerate(found)
    elif isinstance(found, (dict, MappingProxyType)):
        yield from (([key], value) for key, value in found.items() if isinstance(key, (str, int)))
    elif isinstance(found, ModuleType):
        yield from ((name, value) for name, value in vars(found).items() if name.isupper() and name[0] != "_")
    elif type(found).__module__.startswith(PACKAGE) and not isinstance(found, (enum.Enum, type, CncError)):
        yield from attributes(found)


def follow(here: Any, step: Step) -> Any:
    """One step of a path."""
    if isinstance(step, str):
        return here.__dict__[step] if isinstance(here, ModuleType) else getattr(here, step)
    if isinstance(step, int):
        return here[step]
    return here[step[0]]


ATTRIBUTES: dict[type, tuple[str, ...]] = {}
"""What was found for each class."""


def attribute_names(cls: type) -> tuple[str, ...]:
    """Names of the attributes that all instances may have beside those in their `__dict__`."""
    known = ATTRIBUTES.get(cls)
    if known is not None:
        return known
    names: list[str] = []
    for base in cls.__mro__:
        declared = vars(base).get(COMPILED if is_compiled(base) else "__slots__", ())
        names += [declared] if isinstance(declared, str) else declared
    known = ATTRIBUTES[cls] = tuple(name for name in dict.fromkeys(names) if not name.startswith("__"))
    return known


GETTERS: dict[type, attrgetter[tuple[Any, ...]]] = {}
"""For each class with two attributes or more: all at once."""


def names_and_values(found: Any) -> tuple[tuple[str, ...], tuple[Any, ...]]:
    """The attributes of an instance that have a value."""
    cls = type(found)
    names, values = attribute_names(cls), None
    if len(names) > 1:
        getter = GETTERS.get(cls)
        if getter is None:
            getter = GETTERS[cls] = attrgetter(*names)
        try:
            values = getter(found)
        except AttributeError:
            values = None
    if values is None:
        names = tuple(name for name in names if hasattr(found, name))
        values = tuple(getattr(found, name) for name in names)
    own: dict[str, Any] | None = getattr(found, "__dict__", None)
    return ((*names, *own), (*values, *own.values())) if own else (names, values)


def attributes(found: Any) -> Iterator[tuple[str, Any]]:
    """The same in pairs."""
    return zip(*names_and_values(found), strict=True)


@cache
def kernel_names() -> tuple[str, ...]:
    return tuple(sources())


def kernel_modules() -> Iterable[ModuleType]:
    """The modules of the kernel and of the parameters that are there."""
    names = [*kernel_names(), *sorted(name for name in sys.modules if name.startswith("cnc_ptp.parameters."))]
    return (sys.modules[name] for name in names if name in sys.modules)


def kernel_module(name: str) -> ModuleType:
    """One that units may be of. Raises LookupError for a name that none has."""
    steps = name.split(".")
    if not name.startswith(PACKAGE) or steps[1] not in UNIT_ROOMS or steps[-1] in READ_FILES:
        raise LookupError(f"there is no root {name}")
    try:
        return import_module(name)
    except ImportError as error:
        raise LookupError(str(error)) from error
